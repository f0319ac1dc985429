//! A tree over the lamps of a scene, in which lamps that are near each other and face the same way
//! lie together. A node bounds the light of all its lamps at a point, so that a few of thousands
//! are chosen without looking at the others.
//!
//! Source: Conty Estevez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree
//! Splitting", HPG 2018 (bounds of direction, cost of a split, importance). We differ: a node
//! passes on a number of samples instead of one random choice, so all samples of a point are
//! stratified along the tree; axes of lamps that emit from both sides have no sign; and lamps of
//! different groups only meet at the top, so that groups can be compared on their own.

use super::arrays::LampArrays;
use super::emission::{Emission, turned_back};
use crate::scene::{Light, MAX_LIGHT_GROUPS, Scene};
use glam::Vec3;

/// Number of places between which a node's lamps are divided.
const BINS: usize = 16;

/// Depth from which on lamps are divided by number, so that no tree is deep.
const MAX_UNEVEN_DEPTH: u32 = 40;

/// Share of a node's samples that its children divide by their numbers of lamps: a child whose
/// light was estimated too low by any factor is still sampled, with a bounded weight.
const EQUAL_PART: f64 = 1.0 / 16.0;

/// The lamps of a scene that are on: all lights but those at infinity.
#[derive(Debug, Default)]
pub(in crate::trace) struct LightTree {
    nodes: Vec<Node>,
    /// Lamps by their place in the tree: indices into the scene's lights.
    lamps: Vec<u32>,
    /// Place in the tree of each of the scene's lights; `u32::MAX` for those that are not in it.
    places: Vec<u32>,
    /// Sum of the power of all lamps up to and including each place.
    cumulative_power: Vec<f64>,
    /// The tree of each group of lights.
    roots: Vec<u32>,
    /// The lamps in the order of the tree.
    arrays: LampArrays,
}

/// Some lamps that are near each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// Sphere around the lamps, scene space.
    pub(super) centre: Vec3,
    pub(super) radius: f32,
    /// Sum of the lamps' largest intensities.
    pub(super) power: f32,
    /// Directions in which they emit.
    emission: Emission,
    /// Places of the lamps.
    pub(super) first: u32,
    pub(super) count: u32,
    /// Index of the second child; the first one follows the node. Zero for a single lamp.
    second: u32,
}

/// A lamp while the tree is built.
struct Lamp {
    light: u32,
    low: Vec3,
    high: Vec3,
    power: f32,
    emission: Emission,
}

impl Lamp {
    fn of((light, of): (u32, &Light)) -> Option<Self> {
        let (points, power): (Vec<Vec3>, Vec3) = match of {
            Light::Quad { corner: c, edge_u: u, edge_v: v, radiance, .. } => {
                (vec![*c, *c + *u, *c + *v, *c + *u + *v], *radiance * u.cross(*v).length())
            }
            Light::Triangles { corners, area, radiance, picture, .. } => {
                (Light::outline(corners, picture).iter().flatten().copied().collect(), *radiance * *area)
            }
            Light::Point { position, intensity, .. } => (vec![*position], *intensity),
            Light::Sun { .. } | Light::Sky | Light::SkySuns => return None,
        };
        let bound = |(l, h): (Vec3, Vec3), p: Vec3| (l.min(p), h.max(p));
        let (low, high) = points.into_iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), bound);
        // Lamps that are all but black keep a chance.
        let power = power.max_element().clamp(f32::MIN_POSITIVE, f32::MAX);
        Some(Self { light, low, high, power, emission: Emission::of(of) })
    }

    fn middle(&self) -> Vec3 {
        (self.low + self.high) / 2.0
    }
}

impl LightTree {
    /// The tree over the lamps of a scene that are on.
    pub(super) fn new(scene: &Scene) -> Self {
        let lamps = (0..).zip(&scene.lights).filter(|(l, _)| !scene.is_switched_off(*l as usize));
        let mut groups: Vec<Vec<Lamp>> = (0..=MAX_LIGHT_GROUPS).map(|_| Vec::new()).collect();
        for lamp in lamps.filter_map(Lamp::of) {
            groups[group_of(scene, lamp.light)].push(lamp);
        }
        let mut tree = Self { places: vec![u32::MAX; scene.lights.len()], ..Self::default() };
        // Leaves lie in the order of their lamps.
        for group in groups.iter_mut().filter(|group| !group.is_empty()) {
            tree.roots.push(tree.nodes.len() as u32);
            tree.build(group, 0);
        }
        let leaves = tree.nodes.iter().filter(|node| node.second == 0);
        for (place, (&light, node)) in tree.lamps.iter().zip(leaves).enumerate() {
            tree.places[light as usize] = place as u32;
            let sphere = (node.centre, node.radius, node.power);
            tree.arrays.push(place, sphere, &scene.lights[light as usize]);
        }
        tree
    }

    /// Appends the nodes over some lamps.
    fn build(&mut self, lamps: &mut [Lamp], depth: u32) {
        let at = self.nodes.len();
        let bound = |(l, h): (Vec3, Vec3), lamp: &Lamp| (l.min(lamp.low), h.max(lamp.high));
        let (low, high) = lamps.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), bound);
        let mut emission = lamps[0].emission;
        lamps[1..].iter().for_each(|lamp| emission = emission.with(&lamp.emission));
        self.nodes.push(Node {
            centre: (low + high) / 2.0,
            radius: (high - low).length() / 2.0,
            power: lamps.iter().map(|lamp| lamp.power).sum::<f32>().min(f32::MAX),
            emission,
            first: self.lamps.len() as u32,
            count: lamps.len() as u32,
            second: 0,
        });
        if let [lamp] = lamps {
            let before = self.cumulative_power.last().copied().unwrap_or(0.0);
            self.lamps.push(lamp.light);
            self.cumulative_power.push(before + f64::from(lamp.power));
            return;
        }
        let middle = divide(lamps, depth);
        let (left, right) = lamps.split_at_mut(middle);
        self.build(left, depth + 1);
        self.nodes[at].second = self.nodes.len() as u32;
        self.build(right, depth + 1);
    }

    pub(super) fn len(&self) -> usize {
        self.lamps.len()
    }

    pub(super) fn node(&self, node: u32) -> &Node {
        &self.nodes[node as usize]
    }

    /// The nodes that together hold all lamps.
    pub(super) fn roots(&self) -> &[u32] {
        &self.roots
    }

    /// The halves of a node; `None` for a single lamp.
    pub(super) fn children(&self, node: u32) -> Option<[u32; 2]> {
        let second = self.nodes[node as usize].second;
        (second != 0).then_some([node + 1, second])
    }

    /// Lamps of a node: indices into the scene's lights.
    pub(super) fn lamps_of(&self, node: u32) -> &[u32] {
        let Node { first, count, .. } = self.nodes[node as usize];
        &self.lamps[first as usize..][..count as usize]
    }

    /// Estimates what each lamp of a node brings to a surface point, times a factor, and appends
    /// it; zero only where it brings none.
    pub(super) fn append_estimates(
        &self,
        node: u32,
        at: (Vec3, Vec3),
        factor: f32,
        estimates: &mut Vec<f32>,
    ) {
        let Node { first, count, .. } = self.nodes[node as usize];
        self.arrays.append([first, first + count].map(|place| place as usize), at, factor, estimates);
    }

    /// Place of a light in the tree; `u32::MAX` for one that is not in it.
    pub(super) fn place(&self, light: u32) -> u32 {
        self.places.get(light as usize).copied().unwrap_or(u32::MAX)
    }

    /// A lamp of a node, chosen by its power, for a random number in [0, 1).
    pub(super) fn lamp_by_power(&self, node: u32, random: f32) -> u32 {
        let Node { first, count, .. } = self.nodes[node as usize];
        let (first, last) = (first as usize, (first + count - 1) as usize);
        let below = if first == 0 { 0.0 } else { self.cumulative_power[first - 1] };
        let target = below + f64::from(random) * (self.cumulative_power[last] - below);
        let place = first + self.cumulative_power[first..last].partition_point(|end| *end <= target);
        self.lamps[place]
    }

    /// Estimates the irradiance that a node brings to a surface point; zero only where it brings
    /// none.
    pub(super) fn importance(&self, node: u32, position: Vec3, normal: Vec3) -> f32 {
        /// Least cosine of a node that may bring light, so that rounding leaves none out.
        const MIN_COS: f32 = 1.0 / 256.0;
        let node = &self.nodes[node as usize];
        let d = node.centre - position;
        let (distance2, radius2) = (d.length_squared(), node.radius * node.radius);
        let bound = (node.power / distance2.max(radius2).max(f32::MIN_POSITIVE)).min(f32::MAX);
        if distance2 <= radius2 {
            return bound;
        }
        // Turn both directions towards each other by the angle that the sphere covers.
        let distance = distance2.sqrt();
        let sin = node.radius / distance;
        let cos = (1.0 - sin * sin).max(0.0).sqrt();
        let received = turned_back(normal.dot(d) / distance, cos, sin);
        let emitted = node.emission.cos_towards(-d / distance, [cos, sin]);
        if received < -MIN_COS || !node.emission.reaches(emitted, MIN_COS) {
            return 0.0;
        }
        bound * received.max(MIN_COS) * emitted.max(MIN_COS)
    }

    /// Divides the expected number of samples of a node between its halves, whose importance is
    /// given. Returns that of the first.
    pub(super) fn divide(&self, expected: f64, halves: [u32; 2], importance: [f32; 2]) -> f64 {
        let [left, right] = halves.map(|node| f64::from(self.nodes[node as usize].count));
        match importance.map(|importance| importance > 0.0) {
            [true, false] => expected,
            [false, _] => 0.0,
            [true, true] => {
                let [a, b] = importance.map(f64::from);
                share(expected, left + right, [left / (left + right), a / (a + b)])
            }
        }
    }
}

/// Expected number of samples of a part of `lamps` lamps, of which all together expect `expected`.
/// `parts` are the share (0..1) of the part of their number and of their importance. Where there
/// are enough samples, each lamp gets one before importance divides the rest.
pub(super) fn share(expected: f64, lamps: f64, [by_number, by_importance]: [f64; 2]) -> f64 {
    if expected >= lamps {
        return lamps * by_number + (expected - lamps) * by_importance;
    }
    expected * ((1.0 - EQUAL_PART) * by_importance + EQUAL_PART * by_number)
}

/// Group of a light, or one more than there are.
pub(super) fn group_of(scene: &Scene, light: u32) -> usize {
    let group = scene.light_groups.of_light.get(light as usize);
    group.map_or(MAX_LIGHT_GROUPS, |&group| usize::from(group).min(MAX_LIGHT_GROUPS))
}

/// Sorts lamps into two halves, neither empty, and returns the length of the first.
fn divide(lamps: &mut [Lamp], depth: u32) -> usize {
    let bound = |(l, h): (Vec3, Vec3), lamp: &Lamp| (l.min(lamp.middle()), h.max(lamp.middle()));
    let (low, high) = lamps.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), bound);
    let size = high - low;
    let axis = if size.x >= size.y.max(size.z) { 0 } else { 1 + usize::from(size.z > size.y) };
    let order =
        |a: &Lamp, b: &Lamp| a.middle()[axis].total_cmp(&b.middle()[axis]).then(a.light.cmp(&b.light));
    lamps.sort_unstable_by(order);
    // Lamps in one place, and those of a tree that grows deep, are divided by number.
    let half = lamps.len() / 2;
    if size[axis] <= 0.0 || !size[axis].is_finite() || depth >= MAX_UNEVEN_DEPTH {
        return half;
    }
    let bin_end = |bin: usize| low[axis] + size[axis] * (bin as f32 / BINS as f32);
    let ends = (1..BINS).map(|bin| lamps.partition_point(|lamp| lamp.middle()[axis] < bin_end(bin)));
    let ends: Vec<usize> = ends.filter(|end| (1..lamps.len()).contains(end)).collect();
    let cost = |end: &usize| cost(&lamps[..*end]) + cost(&lamps[*end..]);
    ends.into_iter().min_by(|a, b| cost(a).total_cmp(&cost(b))).unwrap_or(half)
}

/// Cost of a node over some lamps: by their power, the extent, and the spread of directions.
fn cost(lamps: &[Lamp]) -> f64 {
    let bound = |(l, h): (Vec3, Vec3), lamp: &Lamp| (l.min(lamp.low), h.max(lamp.high));
    let (low, high) = lamps.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), bound);
    let mut emission = lamps[0].emission;
    lamps[1..].iter().for_each(|lamp| emission = emission.with(&lamp.emission));
    let power: f64 = lamps.iter().map(|lamp| f64::from(lamp.power)).sum();
    power * f64::from((high - low).length_squared()) * f64::from(emission.spread())
}
