//! Settings that every experiment takes.

use crate::raster::exposure::serialize_decimal;
use crate::trace::{BounceLimit, TraceSettings};
use serde::{Deserialize, Serialize};

/// Size of a run: picture size, number of steps and so its duration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Effort {
    /// Small pictures and few steps: seconds to a few minutes on two cores.
    Quick,
    /// Full-size pictures and all steps: some minutes on two cores.
    #[default]
    Usual,
}

/// Settings of a run. An experiment ignores those that it does not use.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExperimentSettings {
    /// Number of configurations and steps to measure.
    pub effort: Effort,
    /// Width and height of the pictures in pixels.
    pub size: [u32; 2],
    /// Light samples per pixel, as [`TraceSettings::samples`], unless the experiment varies them.
    pub samples: u32,
    /// Largest number of diffuse bounces.
    pub bounces: BounceLimit,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Timed repetitions of a frame, after one warm-up that does not count.
    pub repetitions: u32,
    /// Number of views along the walk.
    pub views: u32,
    /// Number of frames of a walk.
    pub frames: u32,
    /// Samples, as [`Self::samples`], of the converged pictures that errors are measured against.
    pub truth_samples: u32,
    /// Memory limit of the reference cache in megabytes.
    pub cache_mb: u64,
    /// Times in seconds after which experiment `at-rest` looks at the picture, in rising order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub seconds: Vec<f64>,
    /// Samples per pixel of the picture of mode `full` that experiment `at-rest` compares with; 0
    /// for none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub full_samples: Option<u32>,
    /// Exposure in stops at which all pictures are shown and compared.
    #[serde(serialize_with = "serialize_decimal")]
    pub exposure_ev: f32,
}

impl Default for ExperimentSettings {
    fn default() -> Self {
        Self {
            effort: Effort::Usual,
            size: [320, 180],
            samples: 16,
            bounces: BounceLimit::ALL,
            seed: 0,
            repetitions: 3,
            views: 5,
            frames: 300,
            truth_samples: 1024,
            cache_mb: 1024,
            seconds: Vec::new(),
            full_samples: None,
            exposure_ev: 0.0,
        }
    }
}

impl ExperimentSettings {
    /// Samples, bounces and seed as settings of the tracer.
    pub fn trace(&self) -> TraceSettings {
        TraceSettings { samples: self.samples, bounces: self.bounces.0, seed: self.seed }
    }

    /// Memory limit of the reference cache in bytes.
    pub fn cache_bytes(&self) -> usize {
        usize::try_from(self.cache_mb << 20).unwrap_or(usize::MAX)
    }
}
