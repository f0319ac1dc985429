//! Afterimage: ray tracing that reuses reference images.
//!
//! The diffuse part of radiance does not depend on the viewer, so a picture already traced lends it to new views:
//!
//! ```text
//! Camera -> ReferenceCache::select -> references          which pictures know most of this view
//!        -> WarpBuffer::warp       -> nearest sample per pixel
//!        -> classify               -> Type 1: copied, no ray
//!                                     Type 2: mirror or glass, secondary rays from the known point
//!                                     Type 3: nothing known, traced by the ordinary Tracer
//!        -> Frame                  -> PlacementPolicy::decide -> where the next reference should stand
//! ```
//!
//! [`Walkthrough`] is that loop, [`Renderer`] one turn of it, [`Tracer`] the ordinary ray tracer that everything is
//! measured against, and [`scene::import::load`] or [`scene::builtin::build`] where scenes come from. `docs/` in the
//! repository holds the architecture, the algorithm against the paper, and every measured figure with its command.
//!
//! ```
//! use afterimage::trace::parallel::NEVER;
//! use afterimage::{Tracer, Walkthrough, WalkthroughSettings, scene::builtin};
//! use std::sync::Arc;
//!
//! let scene = builtin::build("cornell")?;
//! let camera = *scene.start();
//! let mut walk = Walkthrough::new(Arc::new(Tracer::new(Arc::new(scene))), WalkthroughSettings::default());
//! let frame = walk.render(&camera, [32, 32], NEVER);
//! let types = frame.stats.types;
//! assert_eq!(types.unseen + types.reused, 32 * 32); // no reference yet: shaded, but lamp and sky
//! # Ok::<(), afterimage::scene::SceneError>(())
//! ```

pub mod camera;
#[cfg(feature = "experiments")]
pub mod experiment;
#[cfg(feature = "import")]
pub mod import;
pub mod lookup;
pub mod math;
pub mod raster;
pub mod reference;
pub mod render;
pub mod scene;
pub mod trace;
pub mod warp;

pub use camera::{Camera, View};
pub use render::{
    Frame, Mode, ReferenceJob, RefineState, RenderSettings, Renderer, Walkthrough, WalkthroughSettings,
};
pub use scene::Scene;
pub use trace::Tracer;
