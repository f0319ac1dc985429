//! Messages between the window and its render thread.

use super::{Quantity, SeenSection};
use afterimage::reference::{ReferenceFrame, ReferenceId};
use afterimage::{Camera, RefineState, RenderSettings, Scene, Tracer, WalkthroughSettings};
use glam::Vec3;
use std::sync::Arc;
use std::time::Duration;

/// Everything that decides the next frame. A newer request replaces an older one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderRequest {
    /// Pose at which the next frame is rendered.
    pub camera: Camera,
    /// Width and height in pixels. Nothing is rendered while one of them is zero.
    pub size: [u32; 2],
    /// Mode, samples, placement and cache of the walkthrough.
    pub settings: WalkthroughSettings,
    /// After this time the frame is shown as it is, the worst pixels done first, and then
    /// completed. With `None` it is shown when it is complete, and abandoned when a newer request
    /// arrives.
    pub budget: Option<Duration>,
    /// The camera was moving before it came to this pose, so frames must not be late.
    pub is_moving: bool,
    /// What the frame shows.
    pub quantity: Quantity,
    /// Nothing is rendered while this is set.
    pub is_paused: bool,
    /// The picture is being compared, so it is not refined beyond what its mode renders.
    pub is_compared: bool,
    /// The section through which the camera sees the scene.
    pub section: Option<SeenSection>,
    /// The edges of surfaces are drawn.
    pub has_edges: bool,
    /// The picture at rest is refined until something changes, and not only until it counts as
    /// converged.
    pub is_endless: bool,
}

/// Something that is done once, in the order of sending.
#[derive(Clone, Debug)]
pub enum RenderCommand {
    /// Changes to another scene. Nothing is rendered before the next request.
    SetTracer(Arc<Tracer>),
    /// Traces a reference at a pose, whatever the placement policy decides.
    AddReference(Camera),
    /// Removes a reference from the cache.
    Remove(ReferenceId),
    /// Enables or disables a reference.
    Enable(ReferenceId, bool),
    /// Asks for [`Message::Reference`] of a reference.
    ShowReference(ReferenceId),
    /// Removes all references from the cache, and cancels the one that is being traced.
    Clear,
    /// Reads again what the store holds: something else has added to it.
    ReadStore,
    /// Whether the light of references is traced by groups of lights, so that these are dimmed
    /// without a ray, before any is dimmed.
    KnowLights(bool),
    /// Asks for [`Message::Picture`] of the next complete frame, or of the current one while
    /// paused.
    Picture,
}

/// A finished frame as radiance, to be saved.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Linear radiance of the pixels, row-major from the top.
    pub radiance: Vec<Vec3>,
    /// Scene that the picture shows.
    pub scene: Arc<Scene>,
    /// Pose at which the picture was rendered.
    pub camera: Camera,
    /// Settings with which the picture was rendered.
    pub settings: RenderSettings,
    /// False where the frame was taken before it was complete, while paused.
    pub is_complete: bool,
    /// Progress of refinement when the picture was taken.
    pub refined: RefineState,
    /// References from which the view can be rendered again: those the frame used, or all in modes
    /// that look light up.
    pub references: Vec<Arc<ReferenceFrame>>,
}

/// The light that a reference holds.
#[derive(Clone, Debug)]
pub struct ReferenceRadiance {
    /// Identity of the reference in the cache.
    pub id: ReferenceId,
    /// Pose at which the reference was traced.
    pub camera: Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Diffuse radiance per pixel, `None` where the pixel holds no light. `None` as a whole where
    /// the reference is no longer in the cache.
    pub radiance: Option<Vec<Option<Vec3>>>,
}

/// A message of the render thread; frames arrive separately.
#[derive(Clone, Debug)]
pub enum Message {
    /// The picture that [`RenderCommand::Picture`] has requested.
    Picture(Picture),
    /// The reference that [`RenderCommand::ShowReference`] has requested.
    Reference(ReferenceRadiance),
    /// Something failed. The threads continue.
    Failed(String),
}
