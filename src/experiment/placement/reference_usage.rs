//! How much each reference of a walk supplied to its frames.

use crate::camera::Camera;
use crate::experiment::run::RunRecord;
use crate::reference::ReferenceId;
use crate::render::Walkthrough;

/// Number of frames after its creation by which a reference traced ahead is judged.
const SOON_FRAMES: u32 = 30;

/// A reference of the walk.
#[derive(Clone, Debug)]
pub(super) struct UsedReference {
    id: ReferenceId,
    pub(super) camera: Camera,
    /// Share of its pixels that are lit.
    lit: f64,
    /// Number of the frame after which it was available.
    born: u32,
    is_prediction: bool,
    /// Sum over frames of the share of pixels that it supplied.
    pub(super) supplied: f64,
    /// Largest share of a frame within [`SOON_FRAMES`].
    best_soon: f64,
}

/// What all references of a walk supplied.
#[derive(Clone, Debug, Default)]
pub(super) struct ReferenceUsage {
    pub(super) references: Vec<UsedReference>,
    max_bytes: usize,
}

impl ReferenceUsage {
    /// Records a frame, and the references that were added after it.
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
        self.max_bytes = self.max_bytes.max(walk.cache().bytes());
        for entry in walk.cache().entries() {
            if self.references.iter().any(|r| r.id == entry.id) {
                continue;
            }
            let pixels = entry.frame.view.pixel_count().max(1);
            self.references.push(UsedReference {
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

    /// Maximum memory of the references in bytes.
    pub(super) fn max_bytes(&self) -> usize {
        self.max_bytes
    }

    /// Number of references that were traced elsewhere than at the viewer.
    pub(super) fn predictions(&self) -> usize {
        self.references.iter().filter(|r| r.is_prediction).count()
    }

    /// Mean share of the lit pixels of a reference traced ahead that one of the next
    /// [`SOON_FRAMES`] frames used, in percent. `None` without such references.
    pub(super) fn prediction_use_percent(&self) -> Option<f64> {
        let used = |r: &UsedReference| 100.0 * (r.best_soon / r.lit.max(f64::MIN_POSITIVE)).min(1.0);
        let uses = self.references.iter().filter(|r| r.is_prediction).map(used);
        let sum = uses.fold(0.0, |a, b| a + b);
        (self.predictions() > 0).then(|| sum / self.predictions() as f64)
    }

    /// A record of each reference.
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
