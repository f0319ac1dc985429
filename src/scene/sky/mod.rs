//! The sky: the background of rays that leave the scene, and the light that it sends onto surfaces.

mod cie;
mod gradient;
mod image;
mod physical;
mod picture;
mod suns;

pub(super) use cie::horizontal_irradiance;
pub use cie::{CieKind, CieSky};
pub use gradient::Gradient;
pub use image::{SkyImage, SkyImageError};
pub use physical::PhysicalSky;
pub use picture::{PictureSky, SkySample};

use glam::Vec3;

/// A sky. Directions are those of world and scene space, which have the same axes; radiances are
/// linear Rec. 709.
#[derive(Clone, Debug, PartialEq)]
pub enum Sky {
    /// A gradient over the elevation.
    Gradient(Gradient),
    /// A standard sky of the CIE, overcast or clear.
    Cie(CieSky),
    /// A clear sky computed from the scattering of sunlight.
    Physical(PhysicalSky),
    /// A picture in latitude and longitude.
    Picture(PictureSky),
    /// Another sky whose light is dimmed or coloured.
    Dimmed(Box<DimmedSky>),
}

/// A sky whose light is dimmed or coloured.
#[derive(Clone, Debug, PartialEq)]
pub struct DimmedSky {
    /// The sky at full light.
    pub sky: Sky,
    /// Factor of each channel of its light.
    pub factor: Vec3,
}

/// The kinds of skies, without their values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SkyKind {
    /// [`Sky::Gradient`].
    #[default]
    Gradient,
    /// [`Sky::Cie`] with [`CieKind::Overcast`].
    Overcast,
    /// [`Sky::Cie`] with [`CieKind::Clear`].
    Clear,
    /// [`Sky::Physical`].
    Physical,
    /// [`Sky::Picture`].
    Picture,
}

impl SkyKind {
    /// The kinds that follow from the position of the sun: all but pictures.
    pub const MODELS: [Self; 4] = [Self::Gradient, Self::Overcast, Self::Clear, Self::Physical];

    /// Name of the kind in sidecars and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gradient => "gradient",
            Self::Overcast => "overcast",
            Self::Clear => "clear",
            Self::Physical => "physical",
            Self::Picture => "picture",
        }
    }
}

impl Sky {
    /// The sky of a clear day, used where a file does not describe its own.
    pub const CLEAR_DAY: Self = Self::Gradient(Gradient::CLEAR_DAY);

    /// Returns a sky that has the same radiance in all directions.
    pub const fn even(radiance: Vec3) -> Self {
        Self::Gradient(Gradient { zenith: radiance, horizon: radiance, ground: radiance })
    }

    /// Returns the kind of the sky.
    pub fn kind(&self) -> SkyKind {
        match self {
            Self::Gradient(_) => SkyKind::Gradient,
            Self::Cie(CieSky { kind: CieKind::Overcast, .. }) => SkyKind::Overcast,
            Self::Cie(CieSky { kind: CieKind::Clear, .. }) => SkyKind::Clear,
            Self::Physical(_) => SkyKind::Physical,
            Self::Picture(_) => SkyKind::Picture,
            Self::Dimmed(dimmed) => dimmed.sky.kind(),
        }
    }

    /// Returns what the sky is, in words for the user.
    pub fn describe(&self) -> String {
        match self {
            Self::Gradient(_) => "gradient".to_owned(),
            Self::Cie(sky) => match sky.kind {
                CieKind::Overcast => "CIE overcast".to_owned(),
                CieKind::Clear => "CIE clear".to_owned(),
            },
            Self::Physical(sky) => format!("physical, turbidity {:.1}", sky.turbidity()),
            Self::Picture(sky) => {
                let ([width, height], suns) = (sky.image.size(), sky.image.sun_texels());
                let file = sky.image.file().display();
                format!("picture {file}, {width}x{height}, {suns} texels sampled as suns")
            }
            Self::Dimmed(dimmed) => format!("{}, dimmed", dimmed.sky.describe()),
        }
    }

    /// Returns the radiance that is seen in a unit direction.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        match self {
            Self::Gradient(sky) => sky.radiance(direction),
            Self::Cie(sky) => sky.radiance(direction),
            Self::Physical(sky) => sky.radiance(direction),
            Self::Picture(sky) => sky.radiance(direction),
            Self::Dimmed(dimmed) => dimmed.sky.radiance(direction) * dimmed.factor,
        }
    }

    /// Returns the radiance with which a unit direction of the sky lights surfaces, without the
    /// parts that are lights of their own: what a ray adds that leaves a diffuse surface and the
    /// scene.
    pub fn diffuse_radiance(&self, direction: Vec3) -> Vec3 {
        match self {
            Self::Picture(sky) => sky.diffuse_radiance(direction),
            Self::Dimmed(dimmed) => dimmed.sky.diffuse_radiance(direction) * dimmed.factor,
            other => other.radiance(direction),
        }
    }

    /// Returns the picture, where parts of it are lights of their own:
    /// [`Light::SkySuns`](super::Light::SkySuns).
    pub fn with_suns(&self) -> Option<&PictureSky> {
        match self {
            Self::Picture(sky) if sky.image.sun_texels() > 0 => Some(sky),
            Self::Dimmed(dimmed) => dimmed.sky.with_suns(),
            _ => None,
        }
    }

    /// Returns a direction of the suns of the picture for a point `u` of the unit square, chosen by
    /// luminance; none where there are no suns.
    pub fn sample_suns(&self, u: [f32; 2]) -> Option<SkySample> {
        match self {
            Self::Dimmed(dimmed) => {
                let sample = dimmed.sky.sample_suns(u)?;
                Some(SkySample { radiance: sample.radiance * dimmed.factor, ..sample })
            }
            sky => sky.with_suns()?.sample_suns(u),
        }
    }

    /// Returns the radiance from straight above.
    pub fn zenith(&self) -> Vec3 {
        match self {
            Self::Gradient(sky) => sky.zenith,
            Self::Cie(sky) => sky.zenith,
            Self::Physical(_) | Self::Picture(_) | Self::Dimmed(_) => self.radiance(Vec3::Y),
        }
    }

    /// Returns the colours that a file may have given wrongly.
    pub(super) fn colors_mut(&mut self) -> Vec<&mut Vec3> {
        match self {
            Self::Gradient(sky) => vec![&mut sky.zenith, &mut sky.horizon, &mut sky.ground],
            Self::Cie(sky) => vec![&mut sky.zenith, &mut sky.ground],
            Self::Physical(sky) => vec![sky.ground_mut()],
            Self::Picture(_) => Vec::new(),
            Self::Dimmed(dimmed) => dimmed.sky.colors_mut(),
        }
    }
}
