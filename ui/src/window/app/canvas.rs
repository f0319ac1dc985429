//! The viewport: its place in the window, what is drawn over it, and the newest frame.

use super::overlay;
use crate::window::gpu::timewarp::Reprojection;
use crate::window::gpu::viewport;
use crate::window::panels::{self, statistics};
use crate::window::rendering::Quantity;
use crate::window::state::{AppState, Heatmap, Overlay, Presentation, Statistics};
use egui_wgpu::RenderState;

/// Colour of the viewport before the first frame.
const EMPTY: egui::Color32 = egui::Color32::from_gray(24);

/// Place in the window where the frame is drawn.
pub(super) struct Canvas {
    painter: egui::Painter,
    shape: egui::layers::ShapeIdx,
    rect: egui::Rect,
}

impl Canvas {
    /// Allocates the rest of the window and draws the figures over it. The frame is drawn later,
    /// when the pose of this update is known.
    pub(super) fn allocate(ui: &mut egui::Ui, state: &mut AppState) -> (egui::Response, Self) {
        let rect = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(rect, egui::Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "3D viewport"));
        let points_to_pixels = ui.ctx().pixels_per_point();
        state.viewport_size =
            [rect.width(), rect.height()].map(|points| (points * points_to_pixels).round() as u32);
        let canvas = Self { painter: ui.painter().clone(), shape: ui.painter().add(egui::Shape::Noop), rect };
        let unit =
            |at: egui::Pos2| [(at.x - rect.left()) / rect.width(), (at.y - rect.top()) / rect.height()];
        state.lighting.cursor = response.hover_pos().filter(|_| response.contains_pointer()).map(unit);
        panels::overlay::show(ui, rect, state);
        let inner = rect.shrink(10.0);
        let has_figures = state.options.statistics != Statistics::Off || state.options.is_paused;
        if has_figures && inner.is_positive() {
            ui.scope_builder(egui::UiBuilder::new().max_rect(inner), |ui| statistics::show(ui, state));
        }
        if state.options.heatmap != Heatmap::Off && inner.is_positive() {
            panels::legend::over_viewport(ui.ctx(), inner, state);
        }
        if state.options.quantity != Quantity::Picture && inner.is_positive() {
            panels::light_legend::over_viewport(ui.ctx(), inner, state);
        }
        if !state.navigation.has_moved && state.loading.is_none() && inner.is_positive() {
            statistics::hint(ui, rect);
        }
        (response, canvas)
    }

    /// Draws the newest frame as it is seen from the current pose. `first_generation` is that of
    /// the scene.
    pub(super) fn draw(self, state: &AppState, graphics: Option<&RenderState>, first_generation: u64) {
        let shape = match (graphics, &state.frame) {
            (Some(graphics), Some(frame)) if self.rect.is_positive() => {
                let points_to_pixels = self.painter.ctx().pixels_per_point();
                // The full tracer's picture and its errors are pictures.
                let is_picture = state.shown_quantity() == Quantity::Picture;
                let overlay = if is_picture { overlay(&state.comparison) } else { Overlay::None };
                let presentation = Presentation { overlay, ..state.presentation() };
                let reprojection = reprojection(state, first_generation);
                viewport::upload_for(graphics, frame, &presentation, reprojection.as_ref());
                viewport::shape(self.rect, points_to_pixels, presentation, reprojection)
            }
            _ => egui::Shape::rect_filled(self.rect, 0.0, EMPTY),
        };
        self.painter.set(self.shape, shape);
    }
}

/// Returns how the newest frame is reprojected to the camera; `None` where it has the same pose,
/// for frames of an older scene, and while the next frame is soon there.
fn reprojection(state: &AppState, first_generation: u64) -> Option<Reprojection> {
    let (frame, camera) = (state.frame.as_ref()?, state.navigation.fly.camera());
    let is_near = frame.camera == *camera || state.waits_for_frames();
    if is_near || frame.generation < first_generation {
        return None;
    }
    let nearest = frame.depth_ranges.nearest();
    Some(Reprojection::new(&frame.camera, camera, &frame.scene_frame, frame.size, nearest))
}
