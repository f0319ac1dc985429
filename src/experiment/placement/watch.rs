//! What became of each reference of a walk.

use crate::camera::Camera;
use crate::experiment::run::RunRecord;
use crate::reference::ReferenceId;
use crate::render::Walkthrough;

/// A reference made for the frames to come is judged by so many of them.
const SOON_FRAMES: u32 = 30;

/// One of them.
#[derive(Clone, Debug)]
pub(super) struct Watched {
    id: ReferenceId,
    pub(super) camera: Camera,
    /// Share of its pixels that it holds the light of.
    lit: f64,
    /// The frame after which it was there.
    born: u32,
    is_prediction: bool,
    /// Shares of frames' pixels that it supplied, added up over frames.
    pub(super) supplied: f64,
    /// The largest share within [`SOON_FRAMES`].
    best_soon: f64,
}

/// All of them.
#[derive(Clone, Debug, Default)]
pub(super) struct Watch {
    pub(super) references: Vec<Watched>,
    most_bytes: usize,
}

impl Watch {
    /// Takes note of a frame and of the references that came after it.
    pub(super) fn see(&mut self, frame: u32, walk: &Walkthrough) {
        let shares = walk.frame().supplier_shares(walk.used().len());
        for (id, share) in walk.used().iter().zip(shares) {
            if let Some(found) = self.references.iter_mut().find(|r| r.id == *id) {
                found.supplied += f64::from(share);
                if frame <= found.born + SOON_FRAMES {
                    found.best_soon = found.best_soon.max(share.into());
                }
            }
        }
        self.most_bytes = self.most_bytes.max(walk.cache().bytes());
        for entry in walk.cache().entries() {
            if self.references.iter().any(|r| r.id == entry.id) {
                continue;
            }
            let pixels = entry.frame.view.pixel_count().max(1);
            self.references.push(Watched {
                id: entry.id,
                camera: entry.frame.camera,
                lit: entry.frame.lit() as f64 / pixels as f64,
                born: frame,
                is_prediction: entry.frame.camera != walk.frame().camera,
                supplied: 0.0,
                best_soon: 0.0,
            });
        }
    }

    /// The most memory that references held.
    pub(super) fn most_bytes(&self) -> usize {
        self.most_bytes
    }

    /// References that stood elsewhere than the viewer when they were made.
    pub(super) fn predictions(&self) -> usize {
        self.references.iter().filter(|r| r.is_prediction).count()
    }

    /// How much of what a prediction lit one of the next [`SOON_FRAMES`] frames used, on average; `None` without any.
    pub(super) fn prediction_use_percent(&self) -> Option<f64> {
        let used = |r: &Watched| 100.0 * (r.best_soon / r.lit.max(f64::MIN_POSITIVE)).min(1.0);
        let uses = self.references.iter().filter(|r| r.is_prediction).map(used);
        let sum = uses.fold(0.0, |a, b| a + b);
        (self.predictions() > 0).then(|| sum / self.predictions() as f64)
    }

    /// A line for each.
    pub(super) fn records(&self, frames: u32) -> impl Iterator<Item = RunRecord> {
        self.references.iter().map(move |r| {
            RunRecord::default()
                .with("kind", "reference")
                .with("after_frame", r.born)
                .with("is_prediction", r.is_prediction)
                .with("eye_x_m", r.camera.eye.x)
                .with("eye_y_m", r.camera.eye.y)
                .with("eye_z_m", r.camera.eye.z)
                .with("yaw_deg", r.camera.yaw.to_degrees())
                .with("lit_percent", 100.0 * r.lit)
                .with("supplied_percent", 100.0 * r.supplied / f64::from(frames.max(1)))
        })
    }
}
