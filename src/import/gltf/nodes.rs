//! Walking the tree of nodes: meshes, lights and cameras with their world transforms. There is no
//! recursion, because a file may be arbitrarily deep or contain circles.

use super::document::{Document, Found, List};
use super::schema::{self, Node};
use super::{accessor::Accessor, buffers::Buffers, profiles::Profiles};
use crate::camera::Camera;
use crate::import::progress::{Phase, Steps};
use crate::import::{options::Limits, search::Finder, tally::Tally, trouble::Trouble};
use crate::scene::{Beam, NamedView, SceneBuilder, SceneError, SpotLight, Sun, is_valid_position};
use glam::{DMat4, DQuat, DVec3, DVec4, Vec3};

/// Roll in radians that is rounding of the matrices in a file.
const LEVEL: f64 = 1e-4;

/// Largest number of instances of meshes in a file.
const MAX_INSTANCES: usize = 1 << 20;

/// An instance of a mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    pub(super) mesh: usize,
    pub(super) world_from_mesh: DMat4,
    /// Object of the node.
    pub(super) object: u32,
}

/// Walks the nodes of a document. Adds lights and views to the builder, and returns the instances
/// of meshes, sorted by mesh.
pub(super) fn walk(
    (document, buffers): (&Document, &Buffers),
    world_from_root: DMat4,
    builder: &mut SceneBuilder,
    finder: &mut Finder,
    tally: &mut Tally,
    steps: &Steps,
) -> Result<Vec<Placement>, SceneError> {
    /// Number of nodes between two reports of progress.
    const STEP_NODES: usize = 4096;
    let profiles = Profiles::new(finder);
    let mut walker = Walker { document, buffers, builder, profiles, tally, placements: Vec::new() };
    let mut seen = vec![false; document.root.nodes.len()];
    let mut open: Vec<(usize, DMat4)> = Vec::new();
    let roots = walker.roots();
    walker.open(&roots, world_from_root, &mut seen, &mut open);
    let mut visited = 0;
    while let Some((index, world_from_parent)) = open.pop() {
        if visited % STEP_NODES == 0 {
            steps.at(Phase::Parsing, visited as f32 / seen.len() as f32)?;
        }
        visited += 1;
        match document.item::<Node>(List::Nodes, index) {
            Ok(node) => {
                if node.extensions.visibility.as_ref().is_some_and(|v| v.visible == Some(false)) {
                    walker.note(index, Trouble::INVISIBLE, node.name.as_deref().unwrap_or(""));
                    continue;
                }
                let world_from_node = world_from_parent * walker.local(index, &node);
                walker.place(index, &node, world_from_node)?;
                walker.open(&node.children, world_from_node, &mut seen, &mut open);
            }
            Err(fault) => document.note(fault, walker.tally),
        }
    }
    let mut placements = walker.placements;
    placements.sort_by_key(|p| p.mesh);
    Ok(placements)
}

struct Walker<'a, 't> {
    document: &'a Document<'t>,
    buffers: &'a Buffers<'t>,
    builder: &'a mut SceneBuilder,
    profiles: Profiles<'a>,
    tally: &'a mut Tally,
    placements: Vec<Placement>,
}

impl Walker<'_, '_> {
    /// Returns the root nodes of the scene that is shown; without a scene, the nodes without a
    /// parent.
    fn roots(&mut self) -> Vec<usize> {
        let root = &self.document.root;
        if root.scenes.is_empty() {
            return self.parentless();
        }
        match self.document.item::<schema::Scene>(List::Scenes, root.scene.unwrap_or(0)) {
            Ok(scene) => scene.nodes,
            Err(fault) => {
                self.document.note(fault, self.tally);
                self.parentless()
            }
        }
    }

    fn parentless(&self) -> Vec<usize> {
        let count = self.document.root.nodes.len();
        let mut is_child = vec![false; count];
        for index in 0..count {
            let Ok(node) = self.document.item::<Node>(List::Nodes, index) else { continue };
            for child in node.children.into_iter().filter(|child| *child < count) {
                is_child[child] = true;
            }
        }
        (0..count).filter(|i| !is_child[*i]).collect()
    }

    /// Pushes nodes on the stack, the first one on top. A node has one parent; a node that was
    /// visited already is left out.
    fn open(&mut self, nodes: &[usize], parent: DMat4, seen: &mut [bool], open: &mut Vec<(usize, DMat4)>) {
        let first = open.len();
        for &node in nodes {
            match seen.get_mut(node) {
                Some(seen) if !*seen => {
                    *seen = true;
                    open.push((node, parent));
                }
                Some(_) => self.note(node, Trouble::NODE_AGAIN, ""),
                None => self.note(node, Trouble::ITEM_MISSING, &format!("of {}", seen.len())),
            }
        }
        open[first..].reverse();
    }

    fn note(&mut self, node: usize, trouble: Trouble, detail: &str) {
        self.document.note(self.document.fault(List::Nodes, node, trouble, detail), self.tally);
    }

    fn local(&mut self, index: usize, node: &Node) -> DMat4 {
        if let Some(matrix) = node.matrix {
            return DMat4::from_cols_array(&matrix);
        }
        let rotation = DQuat::from_array(node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
        let length = rotation.length();
        let is_rotation = length > 0.0 && length.is_finite();
        if !is_rotation {
            self.note(index, Trouble::ROTATION, "");
        }
        let rotation = if is_rotation { rotation * (1.0 / length) } else { DQuat::IDENTITY };
        let scale = DVec3::from_array(node.scale.unwrap_or([1.0; 3]));
        DMat4::from_scale_rotation_translation(scale, rotation, node.translation.unwrap_or([0.0; 3]).into())
    }

    fn place(&mut self, index: usize, node: &Node, world_from_node: DMat4) -> Result<(), SceneError> {
        if let Some(mesh) = node.mesh {
            if node.skin.is_some() {
                self.note(index, Trouble::SKIN, node.name.as_deref().unwrap_or(""));
            }
            let name = node.name.clone().filter(|name| name.len() <= Limits::NAME_BYTES);
            let object = self.builder.objects.add(&name.unwrap_or_else(|| format!("node {index}")));
            for local in self.instances(node) {
                self.placements.push(Placement { mesh, world_from_mesh: world_from_node * local, object });
            }
            let (count, limit) = (self.placements.len(), MAX_INSTANCES);
            if count > limit {
                let name = self.builder.name.clone();
                return Err(SceneError::TooLarge { name, what: "instances", count, limit });
            }
        }
        if let Some(camera) = node.camera {
            let view = self.view(camera, node, world_from_node);
            view.map_or_else(|f| self.document.note(f, self.tally), |view| self.builder.views.push(view));
        }
        if let Some(light) = &node.extensions.light {
            let added = self.light(light.light, world_from_node);
            added.unwrap_or_else(|fault| self.document.note(fault, self.tally));
        }
        if let Some(lamp) = &node.extensions.profile {
            let file = (self.document, self.buffers);
            self.profiles.add_lamp(file, lamp, world_from_node, self.builder, self.tally);
        }
        Ok(())
    }

    /// Returns the transforms of the instances of a node's mesh: its own where it has none.
    fn instances(&mut self, node: &Node) -> Vec<DMat4> {
        let Some(instancing) = &node.extensions.instancing else { return vec![DMat4::IDENTITY] };
        let of = &instancing.attributes;
        let mut open = |index: Option<usize>, shape: &str| {
            let opened = Accessor::open(self.document, self.buffers, index?, shape);
            opened.map_err(|fault| self.document.note(fault, self.tally)).ok()
        };
        let translations = open(of.translation, "VEC3");
        let rotations = open(of.rotation, "VEC4");
        let scales = open(of.scale, "VEC3");
        let counts = [&translations, &rotations, &scales].map(|list| list.as_ref().map(|list| list.count));
        let Some(count) = counts.into_iter().flatten().min() else { return vec![DMat4::IDENTITY] };
        // One more than allowed is enough to be refused.
        let instance = |i: u32| {
            let vector = |list: &Option<Accessor>, or: f32| {
                list.as_ref()
                    .map_or(DVec3::splat(or.into()), |list| Vec3::from_array(list.vector(i)).as_dvec3())
            };
            let rotation = rotations.as_ref().map_or(DQuat::IDENTITY, |list| {
                let [x, y, z, w] = list.vector::<4>(i).map(f64::from);
                let length = DVec4::new(x, y, z, w).length();
                if length > 0.0 {
                    DQuat::from_xyzw(x / length, y / length, z / length, w / length)
                } else {
                    DQuat::IDENTITY
                }
            });
            DMat4::from_scale_rotation_translation(vector(&scales, 1.0), rotation, vector(&translations, 0.0))
        };
        (0..count.min(MAX_INSTANCES + 1) as u32).map(instance).collect()
    }

    /// Converts a camera, which looks along its -Z, to a saved view. Its aspect ratio is lost.
    fn view(&self, index: usize, node: &Node, world: DMat4) -> Found<NamedView> {
        let camera: schema::Camera = self.document.item(List::Cameras, index)?;
        let fault = |trouble| self.document.fault(List::Cameras, index, trouble, "");
        let Some(perspective) = camera.perspective else { return Err(fault(Trouble::ORTHOGRAPHIC)) };
        let (eye, behind) = (world.w_axis.truncate(), world.z_axis.truncate());
        let degrees = perspective.yfov.to_degrees();
        let looks = behind.try_normalize().filter(|_| is_valid_position(eye) && degrees > 0.0);
        let back = looks.ok_or_else(|| fault(Trouble::CAMERA))?;
        let name = node.name.clone().or(camera.name).unwrap_or_else(|| format!("camera {index}"));
        let rolled = Camera::look_at(eye, eye - back, degrees).with_up(world.y_axis.truncate());
        let is_level = rolled.roll.is_nan() || rolled.roll.abs() <= LEVEL;
        Ok(NamedView { name, camera: if is_level { Camera { roll: 0.0, ..rolled } } else { rolled } })
    }

    /// Adds a light. Candela and lux are taken as radiant intensity and irradiance, as nits are
    /// taken as radiance.
    fn light(&mut self, index: usize, world: DMat4) -> Found<()> {
        let light: schema::Light = self.document.item(List::Lights, index)?;
        let note =
            |trouble| self.document.fault(List::Lights, index, trouble, light.name.as_deref().unwrap_or(""));
        let strength = light.intensity.unwrap_or(1.0);
        let color = DVec3::from_array(light.color.unwrap_or([1.0; 3])) * strength;
        let (at, back) = (world.w_axis.truncate(), world.z_axis.truncate().try_normalize());
        let is_possible = color.min_element() >= 0.0 && color.max_element() <= f64::from(Limits::RADIANCE);
        if !is_possible || !is_valid_position(at) {
            return Err(note(Trouble::LIGHT));
        }
        let color: Vec3 = color.as_vec3();
        self.builder.is_photometric = true;
        match (light.kind.as_str(), back) {
            ("point", _) => self.builder.point_lights.push((at, color)),
            ("spot", Some(back)) => {
                let cone = light.spot.as_ref();
                let angle =
                    |given: Option<f64>, or: f64| given.unwrap_or(or).clamp(0.0, std::f64::consts::FRAC_PI_2);
                let outer = angle(cone.and_then(|c| c.outer_cone_angle), std::f64::consts::FRAC_PI_4);
                let inner = angle(cone.and_then(|c| c.inner_cone_angle), 0.0).min(outer);
                let beam = Beam::new(-back.as_vec3(), inner as f32, outer as f32);
                self.builder.spot_lights.push(SpotLight { position_m: at, intensity: color, beam });
            }
            ("directional", Some(towards)) if self.builder.sun.is_none() => {
                self.builder.sun = Some(Sun {
                    direction: towards.as_vec3(),
                    angular_radius: Sun::ANGULAR_RADIUS,
                    irradiance: color,
                });
            }
            ("directional", Some(_)) => return Err(note(Trouble::SECOND_SUN)),
            _ => return Err(note(Trouble::LIGHT)),
        }
        Ok(())
    }
}
