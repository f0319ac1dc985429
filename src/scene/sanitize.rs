//! Repairs values that cannot be traced, once and with a count, so that the tracer need not check
//! for them: numbers that are negative, not finite or out of range, and materials that reflect more
//! light than arrives.

use super::{Material, MaterialKind, Repairs, SceneBuilder, Sun, Texture};
use glam::{Vec2, Vec3};

/// Range of indices of refraction. No known material lies outside.
const ETA: std::ops::RangeInclusive<f32> = 1.0..=10.0;

/// Largest radiance or intensity. Sums of a million of them stay finite.
const MAX_RADIANCE: f32 = 1e30;

/// Repairs materials, lights, sky, textures, texture coordinates and normals, and records a warning
/// about what was done.
pub(super) fn sanitize(builder: &mut SceneBuilder) -> Repairs {
    let mut clamped = sanitize_lights(builder);
    let mut scaled = Vec::new();
    for material in &mut builder.materials {
        let (values, is_scaled) = sanitize_material(material);
        clamped += values;
        if is_scaled {
            scaled.push(material.name.clone());
        }
    }
    clamped += builder.textures.iter_mut().map(sanitize_texture).sum::<usize>();
    clamped += builder.uvs.iter_mut().map(|uv| replace(uv, uv.is_finite(), Vec2::ZERO)).sum::<usize>();
    clamped += builder.normals.iter_mut().map(sanitize_normal).sum::<usize>();
    if clamped > 0 {
        builder.warn_of_scene(format!(
            "{clamped} values were not finite, negative or out of range; they were clamped"
        ));
    }
    if let Some(first) = scaled.first() {
        let count = scaled.len();
        builder.warn_of_scene(format!(
            "{count} materials reflected more light than arrives, first '{first}'; they were scaled down"
        ));
    }
    Repairs { materials_scaled: scaled.len(), values_clamped: clamped, ..Repairs::default() }
}

/// Replaces a value that is not right. Returns the number of values that changed: 0 or 1.
fn replace<T>(value: &mut T, is_right: bool, with: T) -> usize {
    if !is_right {
        *value = with;
    }
    usize::from(!is_right)
}

/// Clamps each channel to 0 to [`MAX_RADIANCE`]; NaN becomes 0. Returns 1 if a channel changed.
fn clamp(color: &mut Vec3) -> usize {
    let right = color.to_array().map(|c| if c.is_nan() { 0.0 } else { c.clamp(0.0, MAX_RADIANCE) });
    let right = Vec3::from_array(right);
    replace(color, right == *color, right)
}

/// Repairs a material. Returns the number of clamped values, and whether the material was scaled
/// down.
pub(super) fn sanitize_material(material: &mut Material) -> (usize, bool) {
    // Reflectances above one are not clamped here: they are scaled down afterwards, which keeps the
    // hue.
    let mut clamped = clamp(&mut material.diffuse) + clamp(&mut material.emission);
    clamped += material.specular_mut().map_or(0, clamp);
    if let MaterialKind::Glossy { roughness, .. } | MaterialKind::Frosted { roughness, .. } =
        &mut material.kind
    {
        let right = if roughness.is_nan() { 1.0 } else { roughness.clamp(0.0, 1.0) };
        clamped += replace(roughness, right == *roughness, right);
    }
    if let MaterialKind::Glass { eta, .. } | MaterialKind::Frosted { eta, .. } = &mut material.kind {
        let right = if eta.is_nan() { *ETA.start() } else { eta.clamp(*ETA.start(), *ETA.end()) };
        clamped += replace(eta, right == *eta, right);
    }
    clamped += material.sanitize_detail();
    // What is covered in part lets light through, as a film does; other surfaces are cut out.
    let is_film = matches!(material.kind, MaterialKind::Glass { eta, .. } if eta == 1.0);
    if let Some(coverage) = material.coverage_texture.take_if(|_| !is_film) {
        material.alpha_texture.get_or_insert(coverage);
    }
    (clamped, material.scale_to_conserve())
}

fn sanitize_lights(builder: &mut SceneBuilder) -> usize {
    let before = builder.point_lights.len();
    builder.point_lights.retain(|(position, _)| position.is_finite());
    let mut clamped = before - builder.point_lights.len();
    clamped += builder.point_lights.iter_mut().map(|(_, intensity)| clamp(intensity)).sum::<usize>();
    let spots = builder.spot_lights.len();
    builder.spot_lights.retain(|spot| spot.position_m.is_finite() && spot.beam.direction.is_finite());
    clamped += spots - builder.spot_lights.len();
    clamped += builder.spot_lights.iter_mut().map(|spot| clamp(&mut spot.intensity)).sum::<usize>();
    let profiled = builder.profile_lights.len();
    builder.profile_lights.retain(|lamp| lamp.position_m.is_finite());
    clamped += profiled - builder.profile_lights.len();
    clamped += builder.profile_lights.iter_mut().map(|lamp| clamp(&mut lamp.intensity)).sum::<usize>();
    if let Some(sky) = &mut builder.sky {
        clamped += sky.colors_mut().into_iter().map(clamp).sum::<usize>();
    }
    if let Some(Sun { direction, angular_radius, irradiance }) = &mut builder.sun {
        clamped += clamp(irradiance);
        let right = direction.normalize_or(Vec3::Y);
        let is_unit = (right - *direction).length() < 1.0 / 1024.0;
        clamped += replace(direction, is_unit, right);
        let is_angle = (0.0..=std::f32::consts::FRAC_PI_2).contains(angular_radius);
        clamped += replace(angular_radius, is_angle, 0.0);
    }
    clamped
}

/// Replaces a texture that has fewer or more texels than its size says by a single grey texel.
fn sanitize_texture(texture: &mut Texture) -> usize {
    let expected = texture.width as usize * texture.height as usize;
    let is_right = expected > 0 && texture.texels.len() == expected;
    let grey =
        Texture { width: 1, height: 1, texels: vec![[128, 128, 128, 255]], encoding: texture.encoding };
    replace(texture, is_right, grey)
}

/// Normalizes a normal. Zero, which stands for the face normal, stays.
fn sanitize_normal(normal: &mut Vec3) -> usize {
    let is_right = *normal == Vec3::ZERO || (normal.length() - 1.0).abs() < 1.0 / 64.0;
    let right = normal.normalize_or(Vec3::ZERO);
    replace(normal, is_right, right)
}
