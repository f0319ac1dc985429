//! The paintings: two that are files of the program, parts of them, and four that are computed.

use crate::scene::builtin::parts::{HARBOUR, TIDE, texture};
use crate::scene::{Encoding, Material, MaterialId, SceneBuilder, SceneError, Texture, TextureRef};
use glam::{DVec2, DVec3, Vec2, Vec3};

/// Side length of a computed painting in texels.
const SIDE: u32 = 160;

/// Returns the sRGB colour of a painting at a point of the unit square, y pointing up.
type Brush = fn(DVec2) -> DVec3;

/// Adds the materials of all paintings.
pub(super) fn add_to(b: &mut SceneBuilder) -> Result<Vec<MaterialId>, SceneError> {
    let [harbour, tide] = [texture(b, &HARBOUR)?, texture(b, &TIDE)?];
    let brushes: [Brush; 4] = [fields, hills, squares, circles];
    let [fields, hills, squares, circles] = brushes.map(|brush| b.add_texture(paint(brush)));
    let hung = [
        (harbour, [1.0, 1.0], [0.0, 0.0], [1.0, 1.0, 1.0]),
        (tide, [1.0, 1.0], [0.0, 0.0], [1.0, 1.0, 1.0]),
        (hills, [1.0, 1.0], [0.0, 0.0], [1.0, 1.0, 1.0]),
        (fields, [1.0, 1.0], [0.0, 0.0], [1.0, 1.0, 1.0]),
        (squares, [1.0, 1.0], [0.0, 0.0], [1.0, 1.0, 1.0]),
        (circles, [1.0, 1.0], [0.0, 0.0], [1.0, 1.0, 1.0]),
        (hills, [-0.5, 0.5], [0.75, 0.3], [1.0, 0.93, 0.82]),
        (tide, [0.5, 0.5], [0.3, 0.1], [1.0, 0.9, 0.75]),
        (harbour, [-0.5, 0.5], [0.62, 0.02], [0.95, 1.0, 0.92]),
    ];
    let materials = hung.iter().enumerate().map(|(i, &(texture, scale, offset, tint))| {
        let map = TextureRef::new(texture, Vec2::from(scale), Vec2::from(offset));
        b.add_material(Material {
            diffuse_texture: Some(map),
            ..Material::diffuse(&format!("painting {}", i + 1), Vec3::from(tint))
        })
    });
    Ok(materials.collect())
}

fn paint(brush: Brush) -> Texture {
    let share = |i: u32| (f64::from(i) + 0.5) / f64::from(SIDE);
    let at = |x: u32, y: u32| {
        let p = DVec2::new(share(x), 1.0 - share(y));
        let color = brush(p) * (1.0 + 0.05 * weave(p)) * 255.0;
        let [r, g, b] = color.clamp(DVec3::ZERO, DVec3::splat(255.0)).to_array().map(|c| c.round() as u8);
        [r, g, b, 255]
    };
    let texels = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))).map(|(x, y)| at(x, y)).collect();
    Texture { width: SIDE, height: SIDE, texels, encoding: Encoding::Srgb }
}

/// Returns strokes of a brush: values of -1 to 1 that vary slowly along x.
fn weave(p: DVec2) -> f64 {
    let a = (p.y * 151.0 + 3.0 * (p.x * 9.0).sin()).sin();
    let b = (p.y * 83.0 - 2.0 * (p.x * 17.0 + 1.0).sin()).sin();
    let c = (p.x * 23.0 + p.y * 7.0).sin();
    (a + b + c) / 3.0
}

fn rgb(r: u8, g: u8, b: u8) -> DVec3 {
    DVec3::new(f64::from(r), f64::from(g), f64::from(b)) / 255.0
}

/// Two soft fields of colour on a warm ground.
fn fields(p: DVec2) -> DVec3 {
    let edge = 0.012 * weave(DVec2::new(p.y, p.x));
    let inside = |low: DVec2, high: DVec2| {
        let soft = |d: f64| (d / 0.03 + 0.5).clamp(0.0, 1.0);
        let d = (p - low).min(high - p).min_element() + edge;
        soft(d)
    };
    let ground = rgb(120, 40, 32).lerp(rgb(150, 58, 36), p.y);
    let upper = inside(DVec2::new(0.09, 0.46), DVec2::new(0.91, 0.93));
    let lower = inside(DVec2::new(0.09, 0.08), DVec2::new(0.91, 0.40));
    ground.lerp(rgb(222, 128, 48), 0.92 * upper).lerp(rgb(238, 196, 96), 0.9 * lower)
}

/// Hills behind hills below an evening sky.
fn hills(p: DVec2) -> DVec3 {
    let mut color = rgb(246, 204, 150).lerp(rgb(112, 158, 190), ((p.y - 0.45) / 0.55).clamp(0.0, 1.0));
    let sun = p.distance(DVec2::new(0.68, 0.66));
    if sun < 0.075 {
        color = rgb(252, 236, 190);
    }
    let ridges: [(f64, f64, f64, DVec3); 4] = [
        (0.56, 0.06, 0.4, rgb(140, 150, 178)),
        (0.45, 0.08, 2.1, rgb(96, 122, 142)),
        (0.32, 0.07, 4.4, rgb(64, 96, 92)),
        (0.17, 0.06, 1.3, rgb(38, 62, 50)),
    ];
    for (height, swing, phase, shade) in ridges {
        let ridge =
            height + swing * (p.x * 5.3 + phase).sin() + 0.4 * swing * (p.x * 12.7 + 2.0 * phase).sin();
        if p.y < ridge {
            color = shade.lerp(rgb(214, 196, 168), 0.35 * ((ridge - p.y) / 0.3).min(1.0));
        }
    }
    color
}

/// Rectangles in primary colours between black lines.
fn squares(p: DVec2) -> DVec3 {
    let cells: [([f64; 4], DVec3); 5] = [
        ([0.36, 1.0, 0.40, 1.0], rgb(190, 40, 34)),
        ([0.0, 0.36, 0.0, 0.22], rgb(38, 70, 136)),
        ([0.80, 1.0, 0.0, 0.16], rgb(232, 188, 58)),
        ([0.0, 0.36, 0.70, 1.0], rgb(226, 221, 208)),
        ([0.36, 0.80, 0.0, 0.40], rgb(234, 229, 216)),
    ];
    let lines: [([f64; 2], f64, bool); 6] = [
        ([0.0, 1.0], 0.36, true),
        ([0.0, 1.0], 0.40, false),
        ([0.0, 0.36], 0.70, false),
        ([0.0, 0.36], 0.22, false),
        ([0.0, 0.40], 0.80, true),
        ([0.80, 1.0], 0.16, false),
    ];
    for ([from, to], at, is_upright) in lines {
        let (along, across) = if is_upright { (p.y, p.x) } else { (p.x, p.y) };
        if (from..=to).contains(&along) && (across - at).abs() < 0.013 {
            return rgb(26, 26, 28);
        }
    }
    let cell =
        cells.iter().find(|([x0, x1, y0, y1], _)| (*x0..*x1).contains(&p.x) && (*y0..*y1).contains(&p.y));
    cell.map_or(rgb(230, 225, 212), |(_, color)| *color)
}

/// Overlapping rings of colour.
fn circles(p: DVec2) -> DVec3 {
    let rings: [(DVec2, f64, DVec3); 5] = [
        (DVec2::new(0.38, 0.60), 0.30, rgb(204, 92, 62)),
        (DVec2::new(0.66, 0.42), 0.24, rgb(52, 110, 128)),
        (DVec2::new(0.42, 0.28), 0.15, rgb(226, 176, 78)),
        (DVec2::new(0.74, 0.76), 0.11, rgb(64, 60, 92)),
        (DVec2::new(0.38, 0.60), 0.12, rgb(240, 222, 186)),
    ];
    let mut color = rgb(226, 216, 196);
    for (centre, radius, paint) in rings {
        if p.distance(centre) < radius {
            color = color.lerp(paint, 0.82);
        }
    }
    let distance = (p.x - 0.18 - 0.5 * p.y).abs();
    if distance < 0.008 { rgb(40, 38, 44) } else { color }
}
