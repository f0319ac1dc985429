//! The flags about what pictures show, and pictures in false colour.

use super::failure::Failure;
use super::output;
use afterimage::raster::false_color::{above_scale, automatic_scale, line_step, picture};
use afterimage::raster::legend::{Legend, beside};
use afterimage::render::lighting::SeenSurfaces;
use afterimage::{Frame, Scene};
use clap::{Args, ValueEnum};

/// Quantity that a picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Show {
    /// The picture itself.
    #[default]
    Radiance,
    /// Illuminance of the surfaces in lux, in false colour.
    Illuminance,
    /// Luminance of the picture in cd/m2, in false colour.
    Luminance,
    /// Daylight factor of the surfaces in percent, in false colour.
    DaylightFactor,
    /// The model in white clay, lit as it is.
    Clay,
}

impl Show {
    /// True for quantities that are shown in false colour.
    pub(super) fn has_values(self) -> bool {
        !matches!(self, Self::Radiance | Self::Clay)
    }

    /// Unit of the values; empty where there are none.
    pub(super) fn unit(self) -> &'static str {
        match self {
            Self::Illuminance => "lx",
            Self::Luminance => "cd/m2",
            Self::DaylightFactor => "%",
            Self::Radiance | Self::Clay => "",
        }
    }

    /// True where the values of a scene are relative: its lights have no photometric units. A
    /// daylight factor needs none.
    pub(super) fn is_relative(self, scene: &Scene) -> bool {
        matches!(self, Self::Illuminance | Self::Luminance) && !scene.is_photometric
    }
}

/// End of a scale of false colours.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Scale {
    /// Chosen from the picture.
    #[default]
    Auto,
    /// A value in the unit of the quantity.
    Max(f32),
}

impl std::str::FromStr for Scale {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        const WRONG: &str = "a scale is 'auto' or a value above 0";
        if text == "auto" {
            return Ok(Self::Auto);
        }
        let max: f32 = text.parse().map_err(|_| WRONG)?;
        if max > 0.0 && max.is_finite() { Ok(Self::Max(max)) } else { Err(WRONG) }
    }
}

/// What pictures show.
#[derive(Args, Clone, Copy, Debug, Default)]
pub(crate) struct ShowArgs {
    /// What a picture shows: radiance as a camera does; illuminance in lux, luminance in cd/m2 or
    /// the daylight factor in percent, in false colour (in an EXR as numbers in the channel Y); or
    /// the model in white clay.
    #[arg(long, value_name = "radiance|illuminance|luminance|daylight-factor|clay")]
    #[arg(value_enum, hide_possible_values = true, default_value = "radiance", hide_default_value = true)]
    pub(super) show: Show,
    /// End of the scale of false colours, in the unit of what is shown: `auto` is a round number
    /// that nearly all of the picture is below, apart from patches of direct sun.
    #[arg(long, value_name = "MAX|auto", value_parser = str::parse::<Scale>)]
    pub(super) scale: Option<Scale>,
    /// Draw lines of equal value.
    #[arg(long)]
    pub(super) isolines: bool,
    /// Draw the scale with its numbers to the right of the picture, which grows wider by it.
    #[arg(long)]
    pub(super) legend: bool,
}

impl ShowArgs {
    /// Checks that the flags of false colour have a quantity to show.
    pub(super) fn check(&self) -> Result<(), Failure> {
        if (self.scale.is_some() || self.isolines || self.legend) && !self.show.has_values() {
            let message = "--scale, --isolines and --legend are for --show illuminance, luminance and \
                           daylight-factor";
            return Err(Failure::Usage(message.to_owned()));
        }
        Ok(())
    }

    /// The end of the scale for a picture.
    pub(super) fn scale_of(&self, values: &[f32]) -> Result<f32, Failure> {
        match self.scale.unwrap_or_default() {
            Scale::Max(max) => Ok(max),
            Scale::Auto => automatic_scale(values).ok_or_else(|| {
                Failure::Failed(
                    "nothing in the picture is lit, so there is no scale; give one with --scale".to_owned(),
                )
            }),
        }
    }

    /// The picture of values on a scale that ends at `max`, its size, and what it shows in words.
    pub(super) fn false_color(
        &self,
        values: &[f32],
        max: f32,
        surfaces: &SeenSurfaces<'_>,
    ) -> (Vec<[u8; 3]>, [u32; 2], String) {
        let (size, unit) = (surfaces.view.size, self.show.unit());
        let step = self.isolines.then(|| line_step(max));
        let colors = picture(values, size[0] as usize, max, step, |a, b| surfaces.are_one(a, b));
        let is_relative = self.show.is_relative(surfaces.scene);
        let lines = step.map_or(String::new(), |step| format!(", lines every {step} {unit}"));
        let relative = if is_relative { ", relative" } else { "" };
        let note = format!("false colour from 0 to {max} {unit}{lines}{relative}");
        if self.legend {
            let (colors, size) = beside(&colors, size, Legend { max, unit, is_relative });
            return (colors, size, note);
        }
        (colors, size, note)
    }

    /// Says the scale, and what is above it.
    pub(super) fn say_scale(&self, scene: &Scene, values: &[f32], max: f32) {
        let unit = self.show.unit();
        output::say(&format!(
            "the scale is from 0 (dark blue) to {max} {unit} (pale yellow); grey has no value"
        ));
        let (share, largest) = above_scale(values, max);
        if share > 0.0 {
            let percent = (100.0 * share).max(0.1);
            output::say(&format!("{percent:.1} % of the picture is above, up to {largest:.0} {unit}"));
        }
        if self.isolines {
            output::say(&format!("a line every {} {unit}", line_step(max)));
        }
        if self.show.is_relative(scene) {
            output::say(
                "note: the model gives its lights without photometric units, so that the values are relative",
            );
        }
    }
}

/// The values of a frame, NaN where a pixel has none. Except for luminances, the frame must show
/// the light that arrives at surfaces.
pub(super) fn values_of(show: Show, frame: &Frame, scene: &Scene) -> Vec<f32> {
    use afterimage::raster::color::luminance;
    let nits = scene.nits_per_unit();
    let surfaces = surfaces_of(frame, scene);
    let value = |(pixel, radiance): (usize, &glam::Vec3)| match show {
        Show::Luminance => luminance(*radiance) * nits,
        _ if surfaces.scatters(pixel) => luminance(*radiance) * std::f32::consts::PI * nits,
        _ => f32::NAN,
    };
    frame.radiance.iter().enumerate().map(value).collect()
}

/// The surfaces of a frame.
pub(super) fn surfaces_of<'a>(frame: &'a Frame, scene: &'a Scene) -> SeenSurfaces<'a> {
    SeenSurfaces { scene, view: &frame.view, triangle: &frame.triangle, disparity: &frame.disparity }
}
