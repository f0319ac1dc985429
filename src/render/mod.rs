//! The stages in order, timed: from a pose and the references at hand to a finished frame.

#[cfg(feature = "pictures")]
pub mod aov;
pub mod audit;
pub mod bands;
mod finish;
pub mod frame;
mod look_up;
mod placeholders;
mod prefetch;
mod reference_job;
pub mod refine;
pub mod renderer;
mod request;
mod settings;
mod temporal_stability;
pub mod walkthrough;

pub use audit::statistics::AuditEstimate;
pub use frame::{Frame, FrameStats, StageSecs};
pub use reference_job::ReferenceJob;
pub use refine::{RefineState, render_antialiased};
pub use renderer::Renderer;
pub use request::{FrameRequest, References};
pub use settings::{Mode, RenderSettings};
pub use temporal_stability::TemporalStability;
pub use walkthrough::{Walkthrough, WalkthroughSettings};
