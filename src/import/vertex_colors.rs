//! Colours of vertices, shown by a picture that is painted from them: each triangle has a block of
//! two by two texels, between which the texture filter blends as between the corners.

use super::context::Import;
use super::{options::Limits, tally::list};
use crate::raster::color::{linear_from_srgb, srgb_from_linear};
use crate::scene::{Encoding, MaterialId, MaterialKind, SceneBuilder, Texture, TextureRef};
use glam::{Vec2, Vec3};
use std::collections::BTreeMap;

/// Largest number of blocks in a row of the picture.
const MAX_BLOCKS: usize = 8192;

/// Colours of the vertices of a builder, as sRGB from 0 to 1.
#[derive(Debug, Default)]
pub(super) struct VertexColors(Vec<Option<Vec3>>);

impl VertexColors {
    /// Sets the colour of a vertex.
    pub(super) fn set(&mut self, vertex: u32, srgb: Vec3) {
        let vertex = vertex as usize;
        if self.0.len() <= vertex {
            self.0.resize(vertex + 1, None);
        }
        self.0[vertex] = Some(srgb);
    }

    fn of(&self, triangle: [u32; 3]) -> Option<[Vec3; 3]> {
        let [a, b, c] = triangle.map(|v| self.0.get(v as usize).copied().flatten());
        Some([a?, b?, c?])
    }

    /// Divides all colours by 255 where they are not from 0 to 1.
    fn normalized(&self) -> Self {
        let most = self.0.iter().flatten().fold(0.0, |most: f32, c| most.max(c.max_element()));
        // Rounding and scanners exceed one by a little.
        let scale = if most > 2.0 { 1.0 / 255.0 } else { 1.0 };
        let known = |color: Vec3| (color * scale).clamp(Vec3::ZERO, Vec3::ONE);
        Self(self.0.iter().map(|color| color.map(known)).collect())
    }
}

/// Shows the colours of vertices on the materials of the model, multiplied with theirs. Where a
/// material cannot show them, it is reported.
pub(super) fn show(colors: &VertexColors, import: &mut Import) {
    if colors.0.is_empty() {
        return;
    }
    let colors = colors.normalized();
    let mut hidden = Vec::new();
    let mut left = import.options.limits.textures_bytes;
    let mut too_large = Vec::new();
    for (material, triangles) in colored(&colors, &import.builder) {
        let shown = &import.builder.materials[material.0 as usize];
        if shown.kind != MaterialKind::Diffuse || shown.diffuse_texture.is_some() {
            hidden.push(shown.name.clone());
        } else if !fits(triangles.len(), &import.options.limits, &mut left) {
            too_large.push(shown.name.clone());
        } else {
            let is_defined = import.defined_materials.contains(&shown.name);
            if !is_defined {
                // The neutral grey of an undefined material is no colour of the model.
                import.builder.materials[material.0 as usize].diffuse = Vec3::ONE;
            }
            paint(material, &triangles, &colors, &mut import.builder);
        }
    }
    if !too_large.is_empty() {
        let megabytes = import.options.limits.textures_bytes >> 20;
        let message =
            format!("vertex colours are not shown where they need pictures of more than {megabytes} MB");
        import.warn(format!("{message}, or too many texels on a side: {}", list(&too_large)));
    }
    if !hidden.is_empty() {
        let message = "vertex colours are not shown on materials with a picture, and on mirrors and glass";
        import.warn(format!("{message}: {}", list(&hidden)));
    }
}

/// True where a picture of this number of triangles is within the limits; takes its bytes from
/// those that are left.
fn fits(triangles: usize, limits: &Limits, left: &mut u64) -> bool {
    let [width, height] = size_of_picture(triangles);
    let rest = left.checked_sub(width as u64 * height as u64 * 4);
    let is_possible = width.max(height) <= limits.texture_side as usize && rest.is_some();
    *left = rest.filter(|_| is_possible).unwrap_or(*left);
    is_possible
}

/// Returns width and height of the picture for the colours of triangles, in texels.
fn size_of_picture(triangles: usize) -> [usize; 2] {
    let columns = ((triangles as f64).sqrt().ceil() as usize).clamp(1, MAX_BLOCKS);
    [2 * columns, 2 * triangles.div_ceil(columns)]
}

/// Returns the coloured triangles of each material. White ones are left out where all are.
fn colored(colors: &VertexColors, builder: &SceneBuilder) -> BTreeMap<MaterialId, Vec<usize>> {
    let mut found: BTreeMap<MaterialId, (Vec<usize>, bool)> = BTreeMap::new();
    for (i, (triangle, material)) in builder.triangles.iter().zip(&builder.triangle_materials).enumerate() {
        let Some(of_triangle) = colors.of(*triangle) else { continue };
        let (triangles, is_white) = found.entry(*material).or_insert((Vec::new(), true));
        triangles.push(i);
        *is_white &= of_triangle == [Vec3::ONE; 3];
    }
    found.into_iter().filter(|(_, (_, is_white))| !is_white).map(|(m, (t, _))| (m, t)).collect()
}

fn paint(material: MaterialId, triangles: &[usize], colors: &VertexColors, builder: &mut SceneBuilder) {
    let size = size_of_picture(triangles.len());
    let columns = size[0] / 2;
    let mut texels = vec![[255; 4]; size[0] * size[1]];
    for (block, &triangle) in triangles.iter().enumerate() {
        let [x, y] = [2 * (block % columns), 2 * (block / columns)];
        let Some([a, b, c]) = colors.of(builder.triangles[triangle]) else { continue };
        let places = [(x, y, a), (x + 1, y, b), (x, y + 1, c), (x + 1, y + 1, opposite(a, b, c))];
        for (x, y, color) in places {
            texels[y * size[0] + x] = texel(color);
        }
        let uv = |x: usize, y: usize| {
            Vec2::new((x as f32 + 0.5) / size[0] as f32, 1.0 - (y as f32 + 0.5) / size[1] as f32)
        };
        // Vertices are no longer shared: each triangle has a block of its own.
        let uvs = [uv(x, y), uv(x + 1, y), uv(x, y + 1)];
        let vertices = builder.triangles[triangle];
        builder.triangles[triangle] = std::array::from_fn(|i| {
            let v = vertices[i] as usize;
            builder.add_vertex(builder.positions[v], builder.normals[v], uvs[i])
        });
    }
    let [width, height] = size.map(|side| side as u32);
    let texture = builder.add_texture(Texture { width, height, texels, encoding: Encoding::Srgb });
    builder.materials[material.0 as usize].diffuse_texture = Some(TextureRef::plain(texture));
}

/// Returns the colour at the fourth corner of a block, with which the filter is linear.
fn opposite(a: Vec3, b: Vec3, c: Vec3) -> Vec3 {
    let linear = |color: Vec3| color.map(linear_from_srgb);
    (linear(b) + linear(c) - linear(a)).clamp(Vec3::ZERO, Vec3::ONE).map(srgb_from_linear)
}

fn texel(srgb: Vec3) -> [u8; 4] {
    let [r, g, b] = srgb.to_array().map(|c| (c * 255.0 + 0.5) as u8);
    [r, g, b, 255]
}
