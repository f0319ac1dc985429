//! Looking more closely, as deeds: pixels, distances, single references, the plan.

use crate::window::app::App;
use crate::window::app::event::AppEvent;
use crate::window::gpu::projection::Projection;
use crate::window::rendering::exchange::{PublishedFrame, supplier_byte};
use crate::window::rendering::plan::Plan;
use crate::window::rendering::render_thread::{ReferenceRadiance, RenderCommand};
use crate::window::state::{InspectCommand, Inspection, PixelFacts, ReferenceView, Snap, Work};
use afterimage::raster::color;
use afterimage::raster::pixel_types::PixelType;
use afterimage::raster::rgb9e5;
use afterimage::reference::ReferenceId;
use afterimage::trace::Probe;
use egui::{Context, PointerButton, Response};
use glam::DVec3;
use std::sync::Arc;

/// The plan of another floor is made where the eye is higher or lower by more than this, metres.
const SAME_FLOOR_M: f64 = 0.7;

impl App {
    /// Does what was asked for.
    pub(crate) fn look_closer(&mut self, seeing: InspectCommand) {
        let selection = &mut self.state.selection;
        match seeing {
            InspectCommand::CloseInspector => selection.inspection = None,
            InspectCommand::SelectMaterial(id) => selection.material = Some(id),
            InspectCommand::ToggleMeasure => {
                selection.measure.is_on = !selection.measure.is_on;
                selection.measure.hover = None;
            }
            InspectCommand::ClearMeasure => selection.measure = Default::default(),
            InspectCommand::SelectReference(id) => selection.reference = id,
            InspectCommand::EnableReference(id, is_enabled) => {
                self.threads.send(RenderCommand::Enable(id, is_enabled));
            }
            InspectCommand::ShowReference(id) => {
                self.threads.send(RenderCommand::ShowReference(id));
            }
            InspectCommand::CloseReference => selection.reference_view = None,
            InspectCommand::SetPlanView(view) => self.state.plan.view = view,
            InspectCommand::FilterReport(text) => selection.report_filter = text,
        }
    }

    /// A click over the viewport inspects or measures; what would be measured is shown before.
    pub(crate) fn click(&mut self, viewport: &Response) {
        let measures = self.state.selection.measure.is_on;
        if measures {
            self.state.selection.measure.hover = self.cursor.and_then(|at| self.snap_at(at, viewport));
        }
        if !viewport.clicked_by(PointerButton::Primary) {
            return;
        }
        let Some(at) =
            viewport.interact_pointer_pos().map(|at| crate::window::input::pointer::unit(viewport, at))
        else {
            return;
        };
        if measures {
            let snap = self.snap_at(at, viewport);
            snap.into_iter().for_each(|snap| self.state.selection.measure.set(snap));
        } else {
            self.state.selection.inspection = self.inspect(at);
            if let Some(found) = &self.state.selection.inspection {
                self.state.selection.material = Some(found.material);
            }
        }
    }

    fn snap_at(&self, at: [f64; 2], viewport: &Response) -> Option<Snap> {
        let probe = self.probe_at(at)?;
        let projection = Projection::new(self.state.navigation.fly.camera(), viewport.rect);
        Some(projection.snapped(probe.position_m, &self.corners_m(&probe)?))
    }

    fn corners_m(&self, probe: &Probe) -> Option<[DVec3; 3]> {
        let scene = self.obstacles.as_ref()?.tracer().scene();
        Some(scene.corners(probe.triangle).map(|p| scene.frame.world_from_scene(p)))
    }

    fn inspect(&self, at: [f64; 2]) -> Option<Inspection> {
        let probe = self.probe_at(at)?;
        let camera = self.state.navigation.fly.camera();
        let frame = self.state.frame.as_ref().filter(|f| f.camera == *camera);
        Some(Inspection {
            position_m: probe.position_m,
            distance_m: probe.distance_m,
            depth_m: (probe.position_m - camera.eye).dot(camera.forward()),
            normal: probe.normal,
            triangle: probe.triangle,
            corners_m: self.corners_m(&probe)?,
            material: probe.material,
            pixel: frame.and_then(|frame| pixel_facts(frame, at, self.aspect())),
        })
    }

    /// Has the building cut at eye height, anew where one is on another floor.
    pub(crate) fn follow_plan(&mut self) {
        let Some(obstacles) = self.obstacles.as_ref().filter(|_| !self.is_planning) else { return };
        let eye_m = self.state.navigation.fly.camera().eye.y;
        let serves = |plan: &Plan| (plan.height_m - eye_m).abs() <= SAME_FLOOR_M;
        if self.state.plan.cut.as_deref().is_some_and(serves) || self.state.work == Work::Moving {
            return;
        }
        let (scene, number) = (obstacles.tracer().scene().clone(), self.scenes_opened);
        self.is_planning = true;
        self.in_background("afterimage-plan", move || AppEvent::Plan(number, Plan::cut(&scene, eye_m)));
    }

    /// Takes in a plan, unless another scene has been opened meanwhile.
    pub(crate) fn take_plan(&mut self, scene: u64, plan: Plan) {
        if scene == self.scenes_opened {
            (self.state.plan.cut, self.is_planning) = (Some(Arc::new(plan)), false);
        }
    }

    /// Has small pictures of all views and references made while the renderer rests.
    pub(crate) fn want_thumbnails(&mut self, ctx: &Context) {
        let Some(thumbnails) = &mut self.state.thumbnails else { return };
        thumbnails.poll(ctx);
        if !matches!(self.state.work, Work::Complete | Work::Refining | Work::Converged | Work::Paused) {
            return;
        }
        let views = self.state.scene.iter().flat_map(|s| s.views.iter().map(|v| &v.camera));
        let references = self.state.frame.iter().flat_map(|f| f.references.iter().map(|r| &r.camera));
        thumbnails.want(views.chain(references));
    }

    /// Makes a picture of what a reference holds, developed as the viewport is.
    pub(crate) fn show_reference(&mut self, ctx: &Context, reference: &ReferenceRadiance) {
        let Some(radiance) = &reference.radiance else {
            let text = format!("reference {} is no longer held", reference.id.0);
            return self.state.info(text);
        };
        let q = &self.state.quality;
        // What a reference does not hold is grey and hatched.
        let [width, _] = reference.size.map(|s| s as usize);
        let pixels = radiance.iter().enumerate().map(|(i, light)| match light {
            Some(light) => color::srgb8(*light, q.exposure_ev, q.tone_map),
            None => [if (i % width + i / width) % 8 < 2 { 52 } else { 38 }; 3],
        });
        let rgb: Vec<u8> = pixels.flatten().collect();
        let image = egui::ColorImage::from_rgb(reference.size.map(|s| s as usize), &rgb);
        let texture = ctx.load_texture("reference", image, egui::TextureOptions::LINEAR);
        let lit = radiance.iter().flatten().count() as f32 / radiance.len().max(1) as f32;
        self.state.selection.reference_view =
            Some(ReferenceView { id: reference.id, camera: reference.camera, lit, texture });
    }
}

/// What a frame knows of the pixel at a point of the viewport, right and up from its centre in -1..1.
fn pixel_facts(frame: &PublishedFrame, [x, y]: [f64; 2], aspect: f64) -> Option<PixelFacts> {
    let [width, height] = frame.size;
    // The frame's height fills the viewport's.
    let from_centre = x * aspect * f64::from(height) / 2.0;
    let column = (f64::from(width) / 2.0 + from_centre).floor();
    let row = ((1.0 - y) / 2.0 * f64::from(height)).floor().clamp(0.0, f64::from(height.max(1) - 1));
    if !(column >= 0.0 && column < f64::from(width)) || height == 0 {
        return None;
    }
    let at = [column as u32, row as u32];
    let pixel = at[1] as usize * width as usize + at[0] as usize;
    let byte = *frame.suppliers.get(pixel)?;
    Some(PixelFacts {
        at,
        kind: pixel_type(*frame.types.get(pixel)?),
        supplier: supplier(frame, byte),
        radiance: rgb9e5::unpack(*frame.radiance.get(pixel)?),
    })
}

fn supplier(frame: &PublishedFrame, byte: u8) -> Option<ReferenceId> {
    frame.references.iter().map(|r| r.id).find(|id| supplier_byte(*id) == byte)
}

/// A type by its number.
fn pixel_type(byte: u8) -> PixelType {
    use PixelType::{Reused, Secondary, Uncertain, Unseen};
    let all = [Unseen, Reused, Secondary, Uncertain];
    all.into_iter().find(|t| *t as u8 == byte).unwrap_or_default()
}
