//! `render --show`: illuminance and luminance in false colour, and the model in white clay.

use super::flags::Flags;
use super::scene::Loaded;
use super::{failure::Failure, interrupt, output};
use afterimage::raster::color::{ToneMap, luminance};
use afterimage::raster::false_color::{automatic_scale, line_step, picture};
use afterimage::raster::save::{ChannelValues, Target, save_png};
use afterimage::raster::stream::{Contents, PictureFile, Rows};
use afterimage::reference::ReferenceCache;
use afterimage::render::aov::display_rows;
use afterimage::render::lighting::SurfaceLight;
use afterimage::render::outlines::outlines_of_view;
use afterimage::{Camera, FrameRequest, Renderer};
use clap::ValueEnum;
use glam::Vec3;
use serde_json::json;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Quantity that a picture of `render` shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Show {
    /// The picture itself.
    #[default]
    Radiance,
    /// Illuminance of the surfaces in lux, in false colour.
    Illuminance,
    /// Luminance of the picture in cd/m2, in false colour.
    Luminance,
    /// The model in white clay, lit as it is.
    Clay,
}

/// End of a scale of false colours.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Scale {
    /// Chosen from the picture.
    #[default]
    Auto,
    /// A value in lux or cd/m2.
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

/// Reflectance of clay.
const CLAY: f32 = 0.7;

/// Quantity that is shown, the end of its scale, and whether lines of equal value are drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shown {
    pub(super) show: Show,
    pub(super) scale: Scale,
    pub(super) isolines: bool,
    /// Width of the lines along the edges of surfaces, pixels; for clay.
    pub(super) outlines: Option<u32>,
}

impl Shown {
    /// Unit of the values; empty for clay.
    fn unit(self) -> &'static str {
        match self.show {
            Show::Illuminance => "lx",
            Show::Luminance => "cd/m2",
            Show::Radiance | Show::Clay => "",
        }
    }

    /// Renders the view and writes its file.
    pub(super) fn run(
        self,
        (path, camera): (&Path, &Camera),
        flags: &Flags,
        loaded: &Loaded,
    ) -> Result<(), Failure> {
        let start = Instant::now();
        let (tracer, size, stop) = (&loaded.tracer, flags.size(), &interrupt::is_cancelled);
        let light =
            SurfaceLight::trace(tracer, camera, size, &flags.trace(), stop).ok_or(Failure::Interrupted)?;
        let nits = loaded.scene().nits_per_unit();
        if self.show == Show::Clay {
            let mut clay: Vec<Vec3> =
                light.light.iter().map(|l| if l.is_finite() { *l * CLAY } else { Vec3::ONE }).collect();
            if let Some(width) = self.outlines {
                let lines = outlines_of_view(tracer, camera, size, width);
                clay.iter_mut().zip(lines).for_each(|(clay, covered)| *clay *= 1.0 - covered);
            }
            write_picture(path, size, &clay, flags)?;
            return self.answer(path, flags, loaded, (None, start));
        }
        let values = match self.show {
            Show::Luminance => luminances(light, camera, flags, loaded),
            _ => light.lux(nits),
        };
        let max = match self.scale {
            Scale::Max(max) => max,
            Scale::Auto => automatic_scale(&values).ok_or_else(|| {
                Failure::Failed(
                    "nothing in the picture is lit, so there is no scale; give one with --scale".to_owned(),
                )
            })?,
        };
        self.write(path, size, &values, max)?;
        self.say_unit(loaded, max);
        self.answer(path, flags, loaded, (Some((&values, max)), start))
    }

    fn write(self, path: &Path, size: [u32; 2], values: &[f32], max: f32) -> Result<(), Failure> {
        if is_exr(path) {
            return write_values(path, size, values);
        }
        let step = self.isolines.then(|| line_step(max));
        let colors = picture(values, size[0] as usize, max, step);
        let lines = step.map_or(String::new(), |step| format!(", lines every {step} {}", self.unit()));
        let note = format!("false colour from 0 to {max} {}{lines}", self.unit());
        Ok(save_png(path, size, &colors, &[("Description", note)])?)
    }

    fn say_unit(self, loaded: &Loaded, max: f32) {
        let unit = self.unit();
        output::say(&format!(
            "the scale is from 0 (dark blue) to {max} {unit} (pale yellow); grey has no value"
        ));
        if self.isolines {
            output::say(&format!("a line every {} {unit}", line_step(max)));
        }
        if !loaded.scene().is_photometric {
            output::say(
                "note: the model gives its lights without photometric units, so that the values are relative",
            );
        }
    }

    fn answer(
        self,
        path: &Path,
        flags: &Flags,
        loaded: &Loaded,
        (values, start): (Option<(&[f32], f32)>, Instant),
    ) -> Result<(), Failure> {
        let known = || values.iter().flat_map(|(values, _)| values.iter()).filter(|v| v.is_finite());
        let count = known().count().max(1) as f64;
        let object = json!({
            "scene": loaded.name,
            "show": self.show.to_possible_value().map(|v| v.get_name().to_owned()),
            "unit": self.unit(),
            "is_photometric": loaded.scene().is_photometric,
            "size": flags.size(),
            "scale_max": values.map(|(_, max)| max),
            "line_step": values.filter(|_| self.isolines).map(|(_, max)| line_step(max)),
            "mean": values.map(|_| known().map(|v| f64::from(*v)).sum::<f64>() / count),
            "max": values.map(|_| known().copied().fold(0.0, f32::max)),
            "secs": start.elapsed().as_secs_f64(),
        });
        output::result(flags.json, &object, || {
            output::table(&[
                ("picture", path.display().to_string()),
                ("time", format!("{:.1} s", start.elapsed().as_secs_f64())),
            ])
        });
        loaded.verdict(flags)
    }
}

/// Luminance of the picture in cd/m2, rendered with the light that was traced.
fn luminances(light: SurfaceLight, camera: &Camera, flags: &Flags, loaded: &Loaded) -> Vec<f32> {
    let mut cache = ReferenceCache::new(loaded.scene(), usize::MAX);
    cache.insert(Arc::new(light.reference));
    let (settings, mut renderer) = (flags.render(), Renderer::default());
    let request = FrameRequest::new(&loaded.tracer, camera, flags.size(), &settings)
        .with_stop(&interrupt::is_cancelled);
    let frame = renderer.render(&request.reusing(&cache));
    let nits = loaded.scene().nits_per_unit();
    frame.radiance.iter().map(|radiance| luminance(*radiance) * nits).collect()
}

fn is_exr(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"))
}

fn write_picture(path: &Path, size: [u32; 2], radiance: &[Vec3], flags: &Flags) -> Result<(), Failure> {
    if is_exr(path) {
        let channels = ["R", "G", "B"].map(|name| (name.to_owned(), false)).into();
        let rows = [0, 1, 2].map(|axis| ChannelValues::Real(radiance.iter().map(|r| r[axis]).collect()));
        return write_exr(path, size, channels, rows.into());
    }
    let tone_map: ToneMap = flags.tone_map;
    let colors = display_rows(radiance, flags.exposure_ev(), tone_map);
    Ok(save_png(path, size, &colors, &[])?)
}

/// Writes values as the channel Y, and where there are any as the channel A.
fn write_values(path: &Path, size: [u32; 2], values: &[f32]) -> Result<(), Failure> {
    let known = values.iter().map(|v| if v.is_finite() { [*v, 1.0] } else { [0.0; 2] });
    let (value, alpha) = known.map(|[value, alpha]| (value, alpha)).unzip();
    let channels = vec![("Y".to_owned(), false), ("A".to_owned(), false)];
    write_exr(path, size, channels, vec![ChannelValues::Real(value), ChannelValues::Real(alpha)])
}

fn write_exr(
    path: &Path,
    size: [u32; 2],
    channels: Vec<(String, bool)>,
    values: Vec<ChannelValues>,
) -> Result<(), Failure> {
    let mut file = PictureFile::begin(Target::File(path.to_owned()), Contents::Exr(channels), size, &[])?;
    file.write(Rows::Channels(values))?;
    file.finish(true)?;
    Ok(())
}
