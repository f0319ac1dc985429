//! Afterimage: interactive ray tracing that reuses reference images.
//!
//! Diffuse radiance does not depend on the viewer: light that was computed for a surface point once
//! is right from every other viewpoint as well. A *reference* is a picture whose light is kept for
//! reuse. The default mode, [`Mode::Exact`], makes a frame like this:
//!
//! ```text
//! Camera -> a primary ray per pixel        -> the surface point that the pixel shows
//!        -> look-up in the references      -> its diffuse light, a mean over the references
//!        -> unseen points                  -> lit by the Tracer; the frame can become a reference
//!        -> mirror and glass               -> secondary rays; the points they hit are looked up
//!        -> uncertain points               -> where the look-up is a guess: checked by tracing
//!        -> Frame                          -> PlacementPolicy: where the next reference should be
//! ```
//!
//! A look-up is a guess where light is extrapolated past an edge, where neighbouring samples jump,
//! as at the edge of a shadow, or where interpolation smooths too much. Only light straight from
//! sun and lamps has such edges and is checked. Light from the sky and from other surfaces is
//! smooth: references share it between neighbours on a surface, and bounce rays end in [`cells`] of
//! light.
//!
//! [`Mode::Fast`] takes the light of the single best reference and checks nothing. [`Mode::Full`]
//! is the ordinary ray tracer, the truth that the others are measured against. [`Mode::Paper`] is
//! the published algorithm, kept unchanged for comparison. It has no primary rays but warps
//! references into the new view:
//!
//! ```text
//! Camera -> warp::ReferenceSelector::select -> the references that know most of this view
//!        -> WarpBuffer::warp                -> the nearest sample per pixel
//!        -> classify                        -> Type 1: diffuse, copied without a ray
//!                                              Type 2: mirror or glass, secondary rays
//!                                                      from the known point
//!                                              Type 3: no sample, traced by the Tracer
//! ```
//!
//! # The bare engine
//! Without default features the crate is the engine alone: scenes built in code, the tracer,
//! references, all modes. A [`Walkthrough`] owns the cache of references and renders frame after
//! frame:
//!
//! ```
//! use afterimage::scene::{Material, SceneBuilder};
//! use afterimage::trace::parallel::NEVER;
//! use afterimage::{Camera, Tracer, Walkthrough, WalkthroughSettings};
//! use glam::{DVec3, Vec2, Vec3};
//! use std::sync::Arc;
//!
//! // A floor of 4 x 4 m and a lamp 3 m above it. World space: metres, +Y up.
//! let mut builder = SceneBuilder::new("lamp");
//! let floor = builder.add_material(Material::diffuse("floor", Vec3::splat(0.7)));
//! let lamp = builder.add_material(Material::emissive("lamp", Vec3::splat(10.0)));
//! let square = |y: f64, half: f64| {
//!     let corners = [[-half, half], [half, half], [half, -half], [-half, -half]];
//!     corners.map(|[x, z]| DVec3::new(x, y, z))
//! };
//! builder.add_quad(square(0.0, 2.0), Vec2::ONE, floor);
//! builder.add_quad(square(3.0, 0.5), Vec2::ONE, lamp);
//! let tracer = Arc::new(Tracer::new(Arc::new(builder.finish()?)));
//!
//! // Trace: without references every floor pixel is lit by shadow rays.
//! let mut walk = Walkthrough::new(tracer, WalkthroughSettings::default());
//! let camera = |x: f64| Camera::look_at(DVec3::new(x, 1.6, 3.0), DVec3::ZERO, 60.0);
//! let first = walk.render(&camera(0.0), [64, 36], NEVER).stats;
//! assert!(first.types.unseen > 0 && walk.has_kept_frame());
//!
//! // Reuse: that frame became a reference. From 5 cm to the side little is unseen.
//! let second = walk.render(&camera(0.05), [64, 36], NEVER).stats;
//! assert!(second.types.unseen < first.types.unseen / 4);
//! # Ok::<(), afterimage::scene::SceneError>(())
//! ```
//!
//! # Single frames and single rays
//! A [`Renderer`] makes one frame from a [`FrameRequest`], which names the references to reuse.
//! Here mode `paper` warps one reference; `reusing(&cache)` passes a whole
//! [`reference::ReferenceCache`] to any mode:
//!
//! ```
//! use afterimage::reference::ReferenceFrame;
//! use afterimage::scene::builtin;
//! use afterimage::trace::{TraceSettings, parallel::NEVER};
//! use afterimage::{FrameRequest, Mode, RenderSettings, Renderer, Tracer};
//! use std::sync::Arc;
//!
//! let tracer = Tracer::new(Arc::new(builtin::build("cornell")?));
//! let (camera, size, trace) = (*tracer.scene().start(), [48, 48], TraceSettings::default());
//! let reference = ReferenceFrame::trace(&tracer, &camera, size, &trace, NEVER);
//! let reference = reference.expect("it is never stopped");
//!
//! let settings = RenderSettings { mode: Mode::Paper, trace };
//! let references = [&reference];
//! let request = FrameRequest::new(&tracer, &camera, size, &settings).warping(&references);
//! let mut renderer = Renderer::default();
//! let frame = renderer.render(&request);
//! assert_eq!(frame.stats.types.unseen, 0); // from the same pose, every pixel is copied
//! # Ok::<(), afterimage::scene::SceneError>(())
//! ```
//!
//! A [`Tracer`] also answers single rays, in world metres:
//!
//! ```
//! use afterimage::{Tracer, scene::builtin};
//! use glam::DVec3;
//! use std::sync::Arc;
//!
//! let tracer = Tracer::new(Arc::new(builtin::build("cornell")?));
//! let floor = tracer.probe(DVec3::new(0.0, 2.0, -0.5), DVec3::NEG_Y, 10.0).expect("a floor");
//! assert!((floor.distance_m - 2.0).abs() < 1e-3);
//! assert_eq!(tracer.scene().materials[floor.material.0 as usize].name, "white");
//! # Ok::<(), afterimage::scene::SceneError>(())
//! ```
//!
//! # Features
//! All three are on by default.
//!
//! - `import`: the module `import` (OBJ, glTF, textures, sidecars) and walks from JSON
//! - `pictures`: PNG and OpenEXR files, pictures of a frame's data (`render::aov`), the metrics
//!   PSNR, SSIM and FLIP, and the embedded scenes `gallery` and `gallery-bench`, whose textures are
//!   PNG. The other embedded scenes are always there.
//! - `experiments`: the module `experiment`, which measures all this; brings `import` and
//!   `pictures`
//!
//! `docs/` in the repository holds the architecture, the algorithm, the measured results, and
//! runnable examples.

pub mod bsdf;
pub mod camera;
pub mod cells;
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
pub mod store;
pub mod trace;
pub mod warp;

pub use camera::{Camera, View};
pub use render::{
    Frame, FrameRequest, Mode, ReferenceJob, RefineState, RenderSettings, Renderer, Walkthrough,
    WalkthroughSettings,
};
pub use scene::Scene;
pub use trace::Tracer;
