//! `--section`: planes and a box that cut a scene open for the camera.

use super::output;
use super::{failure::Failure, flags::Flags, scene::Loaded};
use afterimage::raster::color::radiance_shown_as;
use afterimage::trace::section::{CAP_TONES, CutPlane, SectionError, check_planes};
use afterimage::{Camera, Mode, Tracer, camera::View};
use clap::Args;
use glam::DVec3;
use serde_json::{Value, json};
use std::sync::Arc;

#[derive(Args, Clone, Debug, Default)]
pub(crate) struct SectionFlags {
    /// Cut the model open with a plane, in world metres, or keep what lies in a box; may be
    /// repeated. The side of a plane on which the camera is is removed, or the one that keep=low or
    /// keep=high (smaller or greater coordinates) does not name. Light is that of the whole model.
    #[arg(long = "section", value_name = "x|y|z=AT[,keep=low|high]|box=X0..X1,Y0..Y1,Z0..Z1")]
    #[arg(allow_hyphen_values = true, value_parser = str::parse::<Cut>)]
    sections: Vec<Cut>,
}

/// One `--section`.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Cut {
    /// A plane across an axis; the side that is kept, if it is given.
    Plane { axis: usize, at_m: f64, keeps_above: Option<bool> },
    /// A box by its lower and upper corner, world metres.
    Box([DVec3; 2]),
}

/// Rays along the longer side of the picture by which a view is checked.
const RAYS: u64 = 96;

const FORMS: &str = "a section is x=2.5, y=1.2,keep=low or box=0..4,0..2.7,-1..3, in metres";

impl std::str::FromStr for Cut {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, rest) = text.split_once('=').ok_or(FORMS)?;
        if name.trim() == "box" {
            return parse_box(rest).map(Self::Box);
        }
        let axis = ["x", "y", "z"].into_iter().position(|axis| axis == name.trim()).ok_or(FORMS)?;
        let (at, side) = rest.split_once(',').map_or((rest, None), |(at, side)| (at, Some(side.trim())));
        let keeps_above = match side {
            None => None,
            Some("keep=low") => Some(false),
            Some("keep=high") => Some(true),
            Some(other) => return Err(format!("'{other}' is neither keep=low nor keep=high; {FORMS}")),
        };
        Ok(Self::Plane { axis, at_m: metres(at)?, keeps_above })
    }
}

fn parse_box(text: &str) -> Result<[DVec3; 2], String> {
    let parts: Vec<&str> = text.split(',').collect();
    let [x, y, z] = parts[..] else { return Err(format!("a box has three ranges; {FORMS}")) };
    let range = |text: &str| {
        let (low, high) = text.split_once("..").ok_or(FORMS)?;
        let ends = [metres(low)?, metres(high)?];
        if ends[0] < ends[1] { Ok(ends) } else { Err(format!("'{text}' does not ascend; {FORMS}")) }
    };
    let [x, y, z] = [range(x)?, range(y)?, range(z)?];
    Ok([0, 1].map(|end| DVec3::new(x[end], y[end], z[end])))
}

fn metres(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok().filter(|m: &f64| m.abs() < 1e7);
    number.ok_or_else(|| format!("'{text}' is no number of metres; {FORMS}"))
}

impl SectionFlags {
    /// True where a section is given.
    pub(super) fn is_given(&self) -> bool {
        !self.sections.is_empty()
    }

    /// Refuses the mode that cannot show a section.
    pub(super) fn check_mode(&self, mode: Mode) -> Result<(), Failure> {
        if self.sections.is_empty() || mode != Mode::Paper {
            return Ok(());
        }
        let message = "--section is for the modes exact, fast and full; mode paper warps pictures of the \
                       whole model";
        Err(Failure::Usage(message.to_owned()))
    }

    /// Cuts a loaded scene for a camera. The exposure must be known.
    pub(super) fn cut(&self, loaded: Loaded, camera: &Camera, flags: &Flags) -> Result<Loaded, Failure> {
        if self.sections.is_empty() {
            return Ok(loaded);
        }
        let planes = self.planes(camera);
        check_planes(loaded.scene(), &planes).map_err(failure)?;
        let tones = CAP_TONES.map(|tone| radiance_shown_as(tone, flags.exposure_ev(), flags.tone_map));
        let tracer = Arc::new(loaded.tracer.with_section(&planes, tones));
        if tracer.solid_count() == 0 {
            output::say("note: the model has no closed solids, so that the section shows no cut surfaces");
        }
        Ok(Loaded { tracer, ..loaded })
    }

    /// Refuses a section that leaves nothing of what a view shows without it.
    pub(super) fn check_view(&self, loaded: &Loaded, camera: &Camera, size: [u32; 2]) -> Result<(), Failure> {
        if self.sections.is_empty() {
            return Ok(());
        }
        let longest = u64::from(size[0].max(size[1]).max(1));
        let few = size.map(|side| (u64::from(side) * RAYS).div_ceil(longest).max(1) as u32);
        let view = View::new(camera, &loaded.scene().frame, few);
        let rays = || (0..view.pixel_count() as u32).map(|pixel| Tracer::primary_ray(&view, pixel));
        let sees_some =
            rays().any(|ray| loaded.tracer.closest_seen(&ray).is_some() || loaded.tracer.cap(&ray).is_some());
        match sees_some || !rays().any(|ray| loaded.tracer.closest(&ray).is_some()) {
            true => Ok(()),
            false => Err(Failure::Failed(
                "--section leaves nothing of what the camera sees; move the plane, keep the other side with \
                 keep=low or keep=high, or move the camera"
                    .to_owned(),
            )),
        }
    }

    fn planes(&self, camera: &Camera) -> Vec<CutPlane> {
        let planes_of = |cut: &Cut| match *cut {
            Cut::Plane { axis, at_m, keeps_above: Some(keeps_above) } => {
                vec![CutPlane { axis, at_m, keeps_above }]
            }
            Cut::Plane { axis, at_m, keeps_above: None } => {
                // Of an eye in the plane, the side that it looks at is kept.
                let eye = camera.eye - camera.forward() * 1e-3;
                vec![CutPlane::away_from(axis, at_m, eye)]
            }
            Cut::Box(corners) => CutPlane::of_box(corners).to_vec(),
        };
        self.sections.iter().flat_map(planes_of).collect()
    }
}

fn failure(error: SectionError) -> Failure {
    Failure::Failed(format!("--section: {error}"))
}

/// The section of a loaded scene as `--json` has it.
pub(super) fn record(loaded: &Loaded) -> Value {
    let Some(section) = loaded.tracer.section() else { return json!({}) };
    json!({"section": {"planes": section.planes(), "closed_solids": loaded.tracer.solid_count()}})
}

/// The section of a loaded scene in words.
pub(super) fn table(loaded: &Loaded) -> String {
    let Some(section) = loaded.tracer.section() else { return String::new() };
    let side = |plane: &CutPlane| if plane.keeps_above { ">" } else { "<" };
    let plane = |plane: &CutPlane| format!("{} {} {}", ["x", "y", "z"][plane.axis], side(plane), plane.at_m);
    let planes: Vec<String> = section.planes().iter().map(plane).collect();
    output::table(&[
        ("section", format!("keeps {}", planes.join(", "))),
        ("closed solids", format!("{}, whose cut surfaces are hatched", loaded.tracer.solid_count())),
    ])
}
