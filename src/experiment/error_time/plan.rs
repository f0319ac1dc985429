//! The cells, and where views and references stand along the walk.

use crate::camera::Camera;
use crate::experiment::run::{
    Cell, Effort, ExperimentContext, ExperimentError, ExperimentSettings, RunRecord,
};
use crate::render::Mode;

/// Modes that reuse references.
pub(super) const REUSING: [Mode; 3] = [Mode::Paper, Mode::Fast, Mode::Exact];

/// Distance between two references of a still view, as a share of the walk.
pub(super) const SPACING: f64 = 0.02;

/// Number of references in the headline: about as many as a walk holds near one place.
pub(super) const DEFAULT_REFERENCES: usize = 4;

/// Values that are varied.
struct Steps {
    full_samples: &'static [u32],
    references: &'static [usize],
    samples: &'static [u32],
    flown_samples: &'static [u32],
}

fn steps(effort: Effort) -> Steps {
    match effort {
        Effort::Quick => Steps {
            full_samples: &[1, 4, 16, 64],
            references: &[1, DEFAULT_REFERENCES],
            samples: &[4, 16],
            flown_samples: &[16],
        },
        Effort::Usual => Steps {
            full_samples: &[1, 2, 4, 8, 16, 32, 64, 128, 256],
            references: &[1, 2, DEFAULT_REFERENCES, 8],
            samples: &[1, 4, 16, 64],
            flown_samples: &[4, 16],
        },
    }
}

pub(crate) fn settings(effort: Effort) -> ExperimentSettings {
    let usual = ExperimentSettings { effort, truth_samples: 2048, ..ExperimentSettings::default() };
    match effort {
        Effort::Usual => usual,
        Effort::Quick => ExperimentSettings { size: [160, 90], views: 3, truth_samples: 512, ..usual },
    }
}

pub(crate) fn cells(context: &ExperimentContext<'_>) -> Vec<Cell> {
    let steps = steps(context.settings.effort);
    let cell = |kind: &str| RunRecord::default().with("kind", kind);
    let mut cells = vec![cell("pictures")];
    cells.extend(steps.full_samples.iter().map(|s| cell("still").with("references", 0).with("samples", *s)));
    for references in steps.references {
        let with = |samples: &u32| cell("still").with("references", *references).with("samples", *samples);
        cells.extend(steps.samples.iter().map(with));
    }
    for mode in REUSING {
        let flown = |samples: &u32| cell("flown").with("mode", mode.name()).with("samples", *samples);
        cells.extend(steps.flown_samples.iter().map(flown));
    }
    cells.into_iter().map(Cell).collect()
}

/// Position of a view as a share of the walk: the middle of one of equal parts.
pub(super) fn view_share(context: &ExperimentContext<'_>, view: u32) -> f64 {
    (f64::from(view) + 0.5) / f64::from(context.settings.views)
}

/// Returns the camera of a view and of the references nearest to it: behind, ahead, further behind,
/// and so on.
pub(super) fn poses(
    context: &ExperimentContext<'_>,
    share: f64,
    count: usize,
) -> Result<(Camera, Vec<Camera>), ExperimentError> {
    let offset = |n: usize| (n / 2) as f64 + 0.5;
    let side = |n: usize| if n.is_multiple_of(2) { -SPACING } else { SPACING };
    let references = (0..count).map(|n| context.camera_on_walk(share + side(n) * offset(n)));
    Ok((context.camera_on_walk(share)?, references.collect::<Result<_, _>>()?))
}
