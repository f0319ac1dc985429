//! The picture in the middle of the window: its room, what lies over it, and the newest frame in it.

use crate::window::app::App;
use crate::window::gpu::presentation::Presentation;
use crate::window::gpu::timewarp::Reprojection;
use crate::window::gpu::viewport;
use crate::window::panels;

/// Where there is no picture yet.
const EMPTY: egui::Color32 = egui::Color32::from_gray(24);

/// Where the picture is to be drawn.
pub(crate) struct Canvas {
    painter: egui::Painter,
    shape: egui::layers::ShapeIdx,
    rect: egui::Rect,
}

impl App {
    /// Takes the viewport's room; its picture is drawn once it is known where the camera goes in this very frame.
    pub(crate) fn viewport(&mut self, ui: &mut egui::Ui) -> (egui::Response, Canvas) {
        let rect = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(rect, egui::Sense::click_and_drag());
        self.viewport = Some(response.id);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "3D viewport"));
        let points_to_pixels = ui.ctx().pixels_per_point();
        self.viewport_size =
            [rect.width(), rect.height()].map(|points| (points * points_to_pixels).round() as u32);
        let canvas =
            Canvas { painter: ui.painter().clone(), shape: ui.painter().add(egui::Shape::Noop), rect };
        panels::overlay::show(ui, rect, &self.state);
        let inner = rect.shrink(10.0);
        if self.state.options.shows_statistics && inner.is_positive() {
            ui.scope_builder(egui::UiBuilder::new().max_rect(inner), |ui| panels::hud::show(ui, &self.state));
        }
        if self.state.navigation.shows_hint && self.state.loading.is_none() && inner.is_positive() {
            panels::hud::hint(ui, rect);
        }
        (response, canvas)
    }

    /// Draws the newest frame, as it is seen from where the camera is by now. It covers the whole room.
    pub(crate) fn draw(&self, canvas: Canvas) {
        let shape = if self.graphics.is_some() && self.state.frame.is_some() && canvas.rect.is_positive() {
            let points_to_pixels = canvas.painter.ctx().pixels_per_point();
            let presentation = Presentation { overlay: self.overlay(), ..self.state.presentation() };
            viewport::shape(canvas.rect, points_to_pixels, presentation, self.reprojection())
        } else {
            egui::Shape::rect_filled(canvas.rect, 0.0, EMPTY)
        };
        canvas.painter.set(canvas.shape, shape);
    }

    /// The way from the newest frame to the camera; `None` at rest, and for frames of a scene that was left.
    fn reprojection(&self) -> Option<Reprojection> {
        let (frame, camera) = (self.state.frame.as_ref()?, self.state.navigation.fly.camera());
        let is_elsewhere = frame.camera != *camera && frame.generation >= self.scene_since;
        let nearest = frame.depth_ranges.nearest();
        is_elsewhere
            .then(|| Reprojection::new(&frame.camera, camera, &frame.scene_frame, frame.size, nearest))
    }
}
