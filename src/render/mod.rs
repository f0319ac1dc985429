//! Rendering: from a pose and the references at hand to a finished frame, and from frames to a
//! walk.
//!
//! [`Renderer`] renders one [`FrameRequest`], [`Walkthrough`] renders frame after frame from a
//! cache of references, [`StillView`] brings one view to convergence, and [`render_antialiased`]
//! and [`bands`] render pictures without references. [`schedule`] decides what is done next.

mod accumulate;
#[cfg(feature = "pictures")]
pub mod aov;
pub mod audit;
pub mod bake;
pub mod bands;
mod begin_stage;
mod carried_light;
mod carry;
mod deadline;
pub mod frame;
mod light_around;
mod light_layers;
pub mod lighting;
mod measures;
mod mixture;
pub mod orthographic;
pub mod outlines;
mod pace;
pub mod panorama;
mod paper_pixels;
mod placeholders;
mod placing;
mod prefetch;
mod preview;
mod reference_job;
mod refinement;
mod renderer;
mod request;
mod rest;
pub mod schedule;
mod settings;
mod shared_light;
mod stages;
mod still_view;
mod stored_walk;
mod temporal_stability;
#[cfg(feature = "pictures")]
mod timed_picture;
#[cfg(feature = "pictures")]
mod timed_rest;
mod walkthrough;
mod worklist;

pub use accumulate::{CONVERGED_PASSES, render_antialiased};
pub use audit::AuditEstimate;
pub use frame::{Frame, FrameStats, RefineState, StageSecs, TemporalStability};
pub use light_layers::{LayerJob, TracedLayers};
pub use pace::Pace;
pub use reference_job::ReferenceJob;
pub use renderer::Renderer;
pub use request::{FrameRequest, References};
pub use settings::{Mode, RenderSettings, WalkthroughSettings};
pub use still_view::StillView;
#[cfg(feature = "pictures")]
pub use timed_picture::TimedPicture;
pub use walkthrough::Walkthrough;
