//! Which light of references still holds after the scene has changed.
//!
//! A reference remembers the state of the scene that its light was traced in. When the scene
//! changes, each pixel is compared with that state, not with the last one, so that many small edits
//! do not add up unnoticed, and light that holds again after an edit is undone is used again.
//!
//! | File | Contents |
//! |---|---|
//! | `sources` | what sends other light than before; the equation of the difference |
//! | `elements` | surfaces cut into pieces and grouped by place |
//! | `doubt` | a bound on the difference of the light at a point |
//! | `places` | the same for all places that references show |
//! | `samples` | samples of a difference, and what they say |
//! | `renumber` | the triangles of a model that was loaded again |
//! | `moved` | what surfaces that moved, came, went or let light pass otherwise can change |
//! | `changed_lights` | lights that came or went |
//! | `shaft` | what lies between two boxes |
//! | `transport` | the difference of smooth light that surfaces make which are not in both states |
//!
//! Sources: shafts decide what an object that moved can hide (Haines and Wallace, "Shaft Culling
//! for Efficient Ray-Traced Radiosity", 1991; Drettakis and Sillion, "Interactive Update of Global
//! Illumination Using a Line-Space Hierarchy", SIGGRAPH 1997). We differ: what light an edit of a
//! material or a lamp can change is not bounded by form factors of boxes, but estimated as the
//! light of other lamps, because the difference of two pictures obeys the rendering equation too.

mod changed_lights;
mod doubt;
mod elements;
mod mark;
mod moved;
mod places;
mod renumber;
mod samples;
mod shaft;
mod sources;
mod transport;

use super::{Directory, ReferenceFrame};
use crate::trace::{TraceSettings, Tracer, parallel::Stop};
use doubt::DifferenceLight;
pub use mark::{MAX_CHANGE, Mark};
use mark::{SAFETY, was_black};
use moved::Moved;
pub(crate) use moved::keeps_direct_light;
use places::Places;
use rayon::prelude::*;
pub(crate) use renumber::Renumbering;
use transport::TransportDifference;

/// The share of the change that direct light may have where it is kept.
const MAX_DIRECT_SHARE: f32 = 0.25;

/// What an edit left of the references of a cache.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Carried {
    /// Pixels whose light was traced.
    pub pixels: usize,
    /// Of these, those whose light no longer holds.
    pub stale: usize,
    /// Of the stale ones, those whose direct light holds.
    pub direct_holds: usize,
    /// References about which nothing can be said, and that were dropped.
    pub dropped: usize,
    /// Places whose light was compared.
    pub places: usize,
    /// Time that it took, seconds.
    pub secs: f64,
}

/// Marks the pixels of references whose light was traced in one state of the scene. Returns `None`
/// where nothing can be said about them.
pub(crate) fn marks_of(
    frames: &[&ReferenceFrame],
    tracer: &Tracer,
    directory: &Directory,
    carried: &mut Carried,
    stop: Stop<'_>,
) -> Option<Vec<Vec<Mark>>> {
    let origin = &frames.first()?.origin;
    let bounces = frames.iter().map(|frame| frame.settings.bounces).max()?;
    let settings = TraceSettings { bounces, ..frames.first()?.settings };
    let holds = || Some(frames.iter().map(|frame| vec![Mark::Holds; frame.view.pixel_count()]).collect());
    if origin.hash == tracer.scene().hash {
        return holds();
    }
    if stop() || !origin.has_same_geometry(tracer.scene()) {
        return None;
    }
    let Some(difference) = DifferenceLight::new(origin, tracer, &settings) else {
        let old = tracer.with_same_geometry(origin.clone());
        let moved = Moved::by_transmission(origin, tracer.scene());
        return Some(moved.marks(frames, [&old, tracer], directory, &|triangle| triangle, stop));
    };
    if difference.is_dark() {
        return holds();
    }
    let places = match difference.states(tracer) {
        Some(states) => {
            let transport = TransportDifference::new(states, &[], &settings).with_direct(&difference);
            Places::new(&transport, (tracer, directory), frames, stop)
        }
        None => Places::new(&difference, (tracer, directory), frames, stop),
    };
    carried.places += places.len();
    let least = if difference.changes_mirrors() { Mark::DirectHolds } else { Mark::Holds };
    Some(frames.iter().map(|frame| marks_of_frame(frame, tracer, &places, least)).collect())
}

/// Marks the pixels of a reference. Pixels that hold get the mark `least`.
fn marks_of_frame(frame: &ReferenceFrame, tracer: &Tracer, places: &Places<'_>, least: Mark) -> Vec<Mark> {
    let mark = |pixel: u32| {
        let Some(doubt) = places.doubt(tracer, frame, pixel) else { return Mark::Holds };
        let light = frame.traced_light(pixel).max_element();
        let most = frame.share_of_change() * SAFETY * MAX_CHANGE * light;
        // No ray was traced for black surfaces.
        let triangle = frame.triangle()[pixel as usize];
        if light == 0.0 && was_black([(&frame.origin, triangle), (tracer.scene(), triangle)]) {
            return Mark::Stale;
        }
        if doubt.direct + doubt.smooth <= most {
            least
        } else if doubt.direct <= MAX_DIRECT_SHARE * most {
            Mark::DirectHolds
        } else {
            Mark::Stale
        }
    };
    (0..frame.view.pixel_count() as u32).into_par_iter().map(mark).collect()
}
