//! What the viewport shows, and how a frame carries it to the graphics card.

use afterimage::raster::color::luminance;
use afterimage::raster::false_color::usual_maximum;
use afterimage::raster::rgb9e5;
use afterimage::render::frame::Frame;
use afterimage::render::lighting::SeenSurfaces;
use afterimage::scene::Scene;
use glam::Vec3;
use rayon::prelude::*;
use std::f32::consts::PI;

/// What the viewport shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quantity {
    /// The picture, as a camera takes it.
    #[default]
    Picture,
    /// Illuminance of the surfaces, in false colour.
    Illuminance,
    /// Luminance of the picture, in false colour.
    Luminance,
    /// Daylight factor of the surfaces under the overcast sky, in false colour.
    DaylightFactor,
    /// The model in white clay, lit as it is.
    Clay,
}

/// Reflectance of clay.
const CLAY: f32 = 0.7;

/// Values from which the automatic scale is chosen, at most: every n-th pixel is enough.
const MAX_SAMPLES: usize = 20_000;

/// Radiance of pixels without a value, which no light has: the largest green that a texture holds.
const NO_VALUE: Vec3 = Vec3::new(0.0, 65_408.0, 0.0);

/// Value of a pixel that is packed as one. The format holds 6e-8 to 65408, and direct sun brings
/// 100,000 lux.
const PACKED_UNIT: f32 = 4.0;

impl Quantity {
    /// All quantities, in the order of their keys.
    pub const ALL: [Self; 5] =
        [Self::Picture, Self::Illuminance, Self::Luminance, Self::DaylightFactor, Self::Clay];

    /// Name of the quantity.
    pub fn name(self) -> &'static str {
        match self {
            Self::Picture => "Picture",
            Self::Illuminance => "Illuminance",
            Self::Luminance => "Luminance",
            Self::DaylightFactor => "Daylight factor",
            Self::Clay => "Clay",
        }
    }

    /// What the quantity is, for people who do not know its name.
    pub fn help(self) -> &'static str {
        match self {
            Self::Picture => "The picture, as a camera takes it",
            Self::Illuminance => "Light that arrives at the surfaces, in lux",
            Self::Luminance => "Light that comes to the eye, in cd/m2",
            Self::DaylightFactor => {
                "Light that arrives at the surfaces under a standard overcast sky, in percent of that \
                 outdoors; without sun and lamps"
            }
            Self::Clay => "All surfaces in white clay, lit as they are",
        }
    }

    /// Unit of the values; empty where there are none.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Illuminance => "lx",
            Self::Luminance => "cd/m2",
            Self::DaylightFactor => "%",
            Self::Picture | Self::Clay => "",
        }
    }

    /// True for quantities that are shown in false colour.
    pub fn has_values(self) -> bool {
        !matches!(self, Self::Picture | Self::Clay)
    }

    /// True where frames show the light that arrives at surfaces, without their colours.
    pub fn shows_light(self) -> bool {
        matches!(self, Self::Illuminance | Self::DaylightFactor | Self::Clay)
    }

    /// The value of a radiance of one: of a white surface where light is shown.
    fn factor(self, scene: &Scene) -> f32 {
        let of_light = if self == Self::Luminance { 1.0 } else { PI };
        of_light * scene.nits_per_unit()
    }
}

/// The values of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameValues {
    /// What the packed pixels of the frame hold.
    pub quantity: Quantity,
    /// Nearly all values are below, apart from patches of direct sun; `None` where all is dark.
    pub usual_max: Option<f32>,
    /// True where the values are relative, because the lights of the scene have no photometric
    /// units.
    pub is_relative: bool,
}

impl Default for FrameValues {
    fn default() -> Self {
        Self { quantity: Quantity::Picture, usual_max: None, is_relative: false }
    }
}

impl FrameValues {
    /// Share of a scale that ends at `max` for a pixel that is packed as one.
    pub fn share_of_packed(max: f32) -> f32 {
        PACKED_UNIT / max
    }

    /// The value of a packed pixel; `None` where it has none.
    pub fn value(&self, packed: u32) -> Option<f32> {
        let texel = rgb9e5::unpack(packed);
        (self.quantity.has_values() && !is_without_value(texel)).then_some(texel.x * PACKED_UNIT)
    }

    /// True where a packed pixel and its neighbours to the right and below are of one surface.
    pub fn goes_on(packed: u32) -> [bool; 2] {
        let texel = rgb9e5::unpack(packed);
        [texel.y == texel.x, texel.z == texel.x]
    }
}

fn is_without_value(texel: Vec3) -> bool {
    texel.x == 0.0 && texel.y > 60_000.0
}

/// Packs the pixels of a frame for the graphics card as a texture of format `Rgb9e5Ufloat`:
/// radiance, or of values the value itself in red, in green and blue the same where the surface goes
/// on to the right and below, and there zero where it ends.
pub(crate) fn pack(quantity: Quantity, frame: &Frame, scene: &Scene, packed: &mut Vec<u32>) -> FrameValues {
    let pixels = frame.radiance.par_iter().enumerate();
    let (view, triangle, disparity) = (&frame.view, &frame.triangle, &frame.disparity);
    let surfaces = SeenSurfaces { scene, view, triangle, disparity };
    match quantity {
        Quantity::Picture => pixels.map(|(_, c)| rgb9e5::pack(*c)).collect_into_vec(packed),
        Quantity::Clay => pixels
            .map(|(at, c)| rgb9e5::pack(if surfaces.scatters(at) { *c * CLAY } else { NO_VALUE }))
            .collect_into_vec(packed),
        _ => pixels.map(|(at, c)| value_of(quantity, &surfaces, at, *c)).collect_into_vec(packed),
    }
    let values = FrameValues { quantity, ..FrameValues::default() };
    let every = packed.len().div_ceil(MAX_SAMPLES).max(1);
    let samples: Vec<f32> = packed.iter().step_by(every).filter_map(|p| values.value(*p)).collect();
    let is_relative = !scene.is_photometric && quantity != Quantity::DaylightFactor;
    FrameValues { usual_max: usual_maximum(&samples), is_relative, ..values }
}

fn value_of(quantity: Quantity, surfaces: &SeenSurfaces<'_>, at: usize, radiance: Vec3) -> u32 {
    if quantity.shows_light() && !surfaces.scatters(at) {
        return rgb9e5::pack(NO_VALUE);
    }
    let value = luminance(radiance).max(0.0) * quantity.factor(surfaces.scene) / PACKED_UNIT;
    let [width, height] = surfaces.view.size.map(|side| side as usize);
    let right = at % width + 1 < width && surfaces.are_one(at, at + 1);
    let below = at / width + 1 < height && surfaces.are_one(at, at + width);
    rgb9e5::pack(Vec3::new(value, if right { value } else { 0.0 }, if below { value } else { 0.0 }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_ends_of_surfaces_survive_packing() {
        let values = FrameValues { quantity: Quantity::Illuminance, ..FrameValues::default() };
        for value in [1e-3f32, 0.7, 31.4, 5e4] {
            for ends in [[true, true], [true, false], [false, true], [false, false]] {
                let [right, below] = ends.map(|goes_on| if goes_on { value } else { 0.0 });
                let packed = rgb9e5::pack(Vec3::new(value, right, below));
                let read = values.value(packed).expect("a value");
                assert!((read / (PACKED_UNIT * value) - 1.0).abs() < 1.0 / 256.0, "{value}: {read}");
                assert_eq!(FrameValues::goes_on(packed), ends);
            }
        }
        assert_eq!(values.value(rgb9e5::pack(NO_VALUE)), None);
        assert_eq!(FrameValues::default().value(rgb9e5::pack(Vec3::ONE)), None, "a picture has no values");
    }
}
