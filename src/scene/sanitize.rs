//! What cannot be traced is mended here, once and counted, so that no ray ever has to ask: numbers that are negative, not
//! finite or out of range, and materials that reflect more than arrives.

use crate::scene::{Material, MaterialKind, Repairs, SceneBuilder, Sun, Texture};
use glam::Vec3;

/// The range of indices of refraction; beyond it nothing known lies.
const ETA: std::ops::RangeInclusive<f32> = 1.0..=10.0;

/// The brightest radiance or intensity. Sums of a million of them stay finite.
const BRIGHTEST: f32 = 1e30;

/// Mends materials, lights, sky, textures and coordinates, and says in a warning of the scene what was done.
pub(crate) fn sanitize(builder: &mut SceneBuilder) -> Repairs {
    let mut clamped = 0;
    let mut scaled = Vec::new();
    for material in &mut builder.materials {
        let (values, is_scaled) = mend_material(material);
        clamped += values;
        if is_scaled {
            scaled.push(material.name.clone());
        }
    }
    clamped += mend_lights(builder);
    clamped += builder.textures.iter_mut().map(mend_texture).sum::<usize>();
    clamped += builder
        .uvs
        .iter_mut()
        .map(|uv| usize::from(replace(uv, uv.is_finite(), glam::Vec2::ZERO)))
        .sum::<usize>();
    clamped += builder.normals.iter_mut().map(mend_normal).sum::<usize>();
    let name = builder.name.clone();
    if clamped > 0 {
        builder.warn(
            &name,
            0,
            format!("{clamped} values were not finite, negative or out of range; they were clamped"),
        );
    }
    if let Some(first) = scaled.first() {
        let count = scaled.len();
        builder.warn(
            &name,
            0,
            format!(
                "{count} materials reflected more light than arrives, first '{first}'; they were scaled down"
            ),
        );
    }
    Repairs { materials_scaled: scaled.len(), values_clamped: clamped, ..Repairs::default() }
}

fn replace<T>(value: &mut T, is_right: bool, with: T) -> bool {
    if !is_right {
        *value = with;
    }
    !is_right
}

/// Each channel into 0..`most`; what is not a number becomes 0. Returns 1 where something changed.
fn clamp(color: &mut Vec3, most: f32) -> usize {
    let right = Vec3::from_array(color.to_array().map(|c| if c.is_nan() { 0.0 } else { c.clamp(0.0, most) }));
    let is_right = right == *color;
    usize::from(replace(color, is_right, right))
}

/// How many of a material's values were clamped, and whether it was scaled down.
pub(crate) fn mend_material(material: &mut Material) -> (usize, bool) {
    (mend_values(material), material.scale_to_conserve())
}

fn mend_values(material: &mut Material) -> usize {
    // Reflectances above one are scaled with their hue afterwards; only what is no number at all is cut.
    let values = clamp(&mut material.diffuse, BRIGHTEST) + clamp(&mut material.emission, BRIGHTEST);
    values
        + match &mut material.kind {
            MaterialKind::Diffuse => 0,
            MaterialKind::Mirror { reflectance, .. } => clamp(reflectance, BRIGHTEST),
            MaterialKind::Glass { eta, transmittance } => {
                let right = if eta.is_nan() { *ETA.start() } else { eta.clamp(*ETA.start(), *ETA.end()) };
                let is_right = right == *eta;
                usize::from(replace(eta, is_right, right)) + clamp(transmittance, BRIGHTEST)
            }
        }
}

fn mend_lights(builder: &mut SceneBuilder) -> usize {
    let before = builder.point_lights.len();
    builder.point_lights.retain(|(position, _)| position.is_finite());
    let mut clamped = before - builder.point_lights.len();
    clamped +=
        builder.point_lights.iter_mut().map(|(_, intensity)| clamp(intensity, BRIGHTEST)).sum::<usize>();
    if let Some(sky) = &mut builder.sky {
        clamped += [&mut sky.zenith, &mut sky.horizon, &mut sky.ground]
            .map(|c| clamp(c, BRIGHTEST))
            .iter()
            .sum::<usize>();
    }
    if let Some(Sun { direction, angular_radius, irradiance }) = &mut builder.sun {
        clamped += clamp(irradiance, BRIGHTEST);
        let right = direction.normalize_or(Vec3::Y);
        let is_unit = (right - *direction).length() < 1.0 / 1024.0;
        clamped += usize::from(replace(direction, is_unit, right));
        let is_angle = (0.0..=std::f32::consts::FRAC_PI_2).contains(angular_radius);
        clamped += usize::from(replace(angular_radius, is_angle, 0.0));
    }
    clamped
}

/// A texture without the texels it promises becomes a grey one.
fn mend_texture(texture: &mut Texture) -> usize {
    let promised = texture.width as usize * texture.height as usize;
    let is_right = promised > 0 && texture.texels.len() == promised;
    let grey =
        Texture { width: 1, height: 1, texels: vec![[128, 128, 128, 255]], encoding: texture.encoding };
    usize::from(replace(texture, is_right, grey))
}

/// Unit length, or zero where the face's own normal is meant.
fn mend_normal(normal: &mut Vec3) -> usize {
    let length = normal.length();
    let is_right = *normal == Vec3::ZERO || (length - 1.0).abs() < 1.0 / 64.0;
    let right = normal.normalize_or(Vec3::ZERO);
    usize::from(replace(normal, is_right, right))
}
