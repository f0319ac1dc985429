//! `render --show`: illuminance, luminance and daylight factor in false colour, and the model in
//! white clay.

use super::flags::Flags;
use super::jpeg::save_display;
use super::scene::Loaded;
use super::show_flags::{Show, ShowArgs, values_of};
use super::{failure::Failure, interrupt, output};
use afterimage::raster::color::ToneMap;
use afterimage::raster::false_color::{above_scale, line_step};
use afterimage::raster::save::{ChannelValues, Target};
use afterimage::raster::stream::{Contents, PictureFile, Rows};
use afterimage::reference::ReferenceCache;
use afterimage::render::aov::display_rows;
use afterimage::render::lighting::{SurfaceLight, under_overcast_sky};
use afterimage::render::outlines::outlines_of_view;
use afterimage::{Camera, FrameRequest, Renderer};
use clap::ValueEnum;
use glam::Vec3;
use serde_json::json;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Reflectance of clay.
pub(super) const CLAY: f32 = 0.7;

/// What is shown, and how.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shown {
    pub(super) args: ShowArgs,
    /// Width of the lines along the edges of surfaces, pixels; for clay.
    pub(super) outlines: Option<u32>,
}

impl Shown {
    /// Renders the view and writes its file.
    pub(super) fn run(
        self,
        (path, camera): (&Path, &Camera),
        flags: &Flags,
        loaded: &Loaded,
    ) -> Result<(), Failure> {
        let start = Instant::now();
        let (size, stop, show) = (flags.size(), &interrupt::is_cancelled, self.args.show);
        let tracer = match show {
            Show::DaylightFactor => Arc::new(under_overcast_sky(&loaded.tracer)),
            _ => loaded.tracer.clone(),
        };
        let light =
            SurfaceLight::trace(&tracer, camera, size, &flags.trace(), stop).ok_or(Failure::Interrupted)?;
        if show == Show::Clay {
            let mut clay: Vec<Vec3> =
                light.light.iter().map(|l| if l.is_finite() { *l * CLAY } else { Vec3::ONE }).collect();
            if let Some(width) = self.outlines {
                let lines = outlines_of_view(&tracer, camera, size, width);
                clay.iter_mut().zip(lines).for_each(|(clay, covered)| *clay *= 1.0 - covered);
            }
            write_picture(path, size, &clay, flags)?;
            return self.answer(path, flags, loaded, (None, start));
        }
        let light = Arc::new(light);
        let values = match show {
            Show::Luminance => luminances(&light, camera, flags, loaded)?,
            _ => light.lux(loaded.scene().nits_per_unit()),
        };
        let max = self.args.scale_of(&values)?;
        match is_exr(path) {
            true => write_values(path, size, &values)?,
            false => {
                let (colors, size, note) =
                    self.args.false_color(&values, max, &light.surfaces(loaded.scene()));
                save_display(path, size, colors, &[("Description", note)])?;
            }
        }
        self.args.say_scale(loaded.scene(), &values, max);
        self.answer(path, flags, loaded, (Some((&values, max)), start))
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
            "show": self.args.show.to_possible_value().map(|v| v.get_name().to_owned()),
            "unit": self.args.show.unit(),
            "is_photometric": loaded.scene().is_photometric,
            "size": flags.size(),
            "above_scale_percent": values.map(|(values, max)| 100.0 * above_scale(values, max).0),
            "scale_max": values.map(|(_, max)| max),
            "line_step": values.filter(|_| self.args.isolines).map(|(_, max)| line_step(max)),
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
fn luminances(
    light: &SurfaceLight,
    camera: &Camera,
    flags: &Flags,
    loaded: &Loaded,
) -> Result<Vec<f32>, Failure> {
    let mut cache = ReferenceCache::new(loaded.scene(), usize::MAX);
    cache.insert(light.reference.clone());
    let (settings, mut renderer) = (flags.render(), Renderer::default());
    let request = FrameRequest::new(&loaded.tracer, camera, flags.size(), &settings)
        .with_stop(&interrupt::is_cancelled);
    let frame = renderer.render(&request.reusing(&cache));
    if !frame.stats.is_complete {
        return Err(Failure::Interrupted);
    }
    Ok(values_of(Show::Luminance, frame, loaded.scene()))
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
    Ok(save_display(path, size, colors, &[])?)
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
