//! Tracing references: when one is requested, and what is done with its outcome.

use super::super::{Job, Message, Outcome, Traceable};
use super::state::Worker;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

impl Worker {
    /// Inserts a reference that was traced into the cache, or notes why there is none.
    pub(super) fn take_reference(&mut self, outcome: Outcome) {
        if let Outcome::Layers(traced) = outcome {
            return self.take_layers(traced);
        }
        let is_wanted = self.running.take().is_some_and(|cancel| !cancel.load(Ordering::Acquire));
        self.schedule.end_reference(is_wanted && matches!(outcome, Outcome::Panicked(_)));
        self.shared.is_adding.store(false, Ordering::Release);
        match outcome {
            Outcome::Traced(frame) if is_wanted => {
                if let Some(walk) = &mut self.walk {
                    let id = walk.insert(*frame);
                    self.added.extend(id.map(|id| (id, Instant::now())));
                    self.added.retain(|(id, _)| walk.cache().entries().iter().any(|e| e.id == *id));
                }
            }
            Outcome::Panicked(text) => {
                self.send(Message::Failed(format!("tracing a reference failed: {text}")));
            }
            Outcome::Traced(_) | Outcome::Cancelled | Outcome::Layers(_) => {}
        }
        (self.wake)();
    }

    /// Starts to trace the reference that the user has added or that the policy wants, unless one
    /// is being traced.
    pub(super) fn request_reference(&mut self) {
        if !self.can_render() {
            return;
        }
        let generation = self.shared.generation.load(Ordering::Acquire);
        let (Some(walk), Some(request)) = (&mut self.walk, self.request) else { return };
        let Some(camera) = self.schedule.next_reference(walk, generation, request.size) else { return };
        let cancel = Arc::new(AtomicBool::new(false));
        let work = Traceable::Reference(walk.reference_job(camera, request.size));
        let job = Job { work, cancel: cancel.clone() };
        // Light of a view that is unknown comes before that of groups.
        self.cancel_layers();
        if self.jobs.send(job).is_ok() {
            self.running = Some(cancel);
            self.shared.is_adding.store(true, Ordering::Release);
            (self.wake)();
        }
    }

    /// Cancels the reference that is being traced. Its outcome still arrives and is then dropped.
    pub(super) fn cancel_reference(&mut self) {
        self.schedule.add_reference(None);
        if let Some(cancel) = &self.running {
            cancel.store(true, Ordering::Release);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::rendering::Quantity;
    use crate::window::rendering::messages::RenderRequest;
    use afterimage::reference::PlacementPolicy;
    use afterimage::reference::placement::THRESHOLD;
    use afterimage::scene::{Material, SceneBuilder};
    use afterimage::{Camera, Mode, Tracer, Walkthrough, WalkthroughSettings};
    use crossbeam_channel::{Receiver, unbounded};
    use glam::{DVec3, Vec2, Vec3};
    use std::time::Duration;

    fn worker() -> (Worker, Receiver<Job>, Receiver<Message>) {
        let mut builder = SceneBuilder::new("square");
        let material = builder.add_material(Material::diffuse("m", Vec3::ONE));
        let corners = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
        builder.add_quad(corners, Vec2::ONE, material);
        let tracer = Arc::new(Tracer::new(Arc::new(builder.finish().unwrap())));
        let mut settings = WalkthroughSettings {
            placement: PlacementPolicy::new(&THRESHOLD, 5.0),
            ..WalkthroughSettings::default()
        };
        settings.render.mode = Mode::Paper;
        let camera = Camera::look_at(DVec3::new(0.5, 0.5, 0.5), DVec3::new(0.5, 0.5, 0.0), 60.0);
        let request = RenderRequest {
            camera,
            size: [16, 16],
            settings,
            budget: Some(Duration::from_secs(3600)),
            is_moving: false,
            quantity: Quantity::Picture,
            is_paused: false,
            is_compared: false,
            section: None,
            has_edges: false,
            is_endless: false,
        };
        let (jobs, sent) = unbounded();
        let (messages, said) = unbounded();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let mut worker = Worker::new(Arc::default(), pool, jobs, messages, Arc::new(|| {}));
        (worker.walk, worker.request) = (Some(Walkthrough::new(tracer, settings)), Some(request));
        (worker, sent, said)
    }

    #[test]
    fn a_reference_that_failed_is_not_requested_again_until_settings_change() {
        let (mut worker, sent, said) = worker();
        worker.render(0);
        worker.request_reference();
        assert_eq!(sent.try_iter().count(), 1, "the first view has no reference");
        worker.take_reference(Outcome::Panicked("a bug".to_owned()));
        assert!(matches!(said.try_recv(), Ok(Message::Failed(text)) if text.contains("a bug")));
        worker.request_reference();
        worker.render(0);
        worker.request_reference();
        assert_eq!(sent.try_iter().count(), 0);
        if let Some(request) = &mut worker.request {
            request.settings.render.trace.samples += 1;
        }
        worker.render(0);
        worker.request_reference();
        assert_eq!(sent.try_iter().count(), 1);
    }

    #[test]
    fn a_reference_that_is_switched_off_is_replaced_at_its_pose_and_only_once() {
        let (mut worker, sent, _said) = worker();
        worker.render(0);
        let trace_one = |worker: &mut Worker| {
            worker.request_reference();
            let job = sent.try_recv().ok()?;
            let Traceable::Reference(reference) = job.work else { return None };
            let frame = reference.trace(&|| false).expect("it is not stopped");
            worker.take_reference(Outcome::Traced(Box::new(frame)));
            worker.render(0);
            Some(())
        };
        assert!(trace_one(&mut worker).is_some() && trace_one(&mut worker).is_none());
        let walk = worker.walk.as_mut().unwrap();
        let first = walk.cache().entries()[0].id;
        walk.cache_mut().set_enabled(first, false);
        worker.render(0);
        assert!(trace_one(&mut worker).is_some() && trace_one(&mut worker).is_none());
        let entries = worker.walk.as_ref().unwrap().cache().entries();
        assert!(entries.len() == 2 && entries[0].frame.camera == entries[1].frame.camera);
    }
}
