//! Everything that runs outside the window's thread: rendering, references, background tasks, and
//! the data that they exchange with the window.

pub(crate) mod baking;
pub mod depth_ranges;
pub mod exchange;
pub mod floor_plan;
pub(crate) mod full_trace;
pub(crate) mod lock;
pub mod messages;
mod outline;
pub(crate) mod pool;
pub mod quantity;
mod references;
pub mod render_thread;
pub mod scene_loading;
mod seen_section;
mod shared;
pub mod task;
pub mod thumbnails;
mod worker;

pub use exchange::{Exchange, PublishedFrame, ReferenceInfo, SUPPLIED_BY_NONE, supplier_byte};
pub use floor_plan::{CUT_M, Plan, PlanView};
pub(crate) use full_trace::{FullTrace, Subject};
pub(crate) use lock::locked;
pub use messages::{Message, Picture, ReferenceRadiance, RenderCommand, RenderRequest};
pub use outline::surface_outline;
pub(crate) use pool::{background_pool, lower_priority, reference_pool};
pub(crate) use quantity::pack;
pub use quantity::{FrameValues, Quantity};
use references::{Job, Outcome, Traceable};
pub use render_thread::RenderThread;
pub use scene_loading::SceneSource;
pub(crate) use scene_loading::{LoadedScene, Loading, ReadEdit};
pub use seen_section::SeenSection;
use shared::Shared;
pub(crate) use task::panic_text;
pub use task::{Progress, Task, TaskError, TaskHandle, Wake, spawn_activity, spawn_task, take_result};
pub use thumbnails::Thumbnails;
use worker::Worker;
