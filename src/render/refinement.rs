//! The refinement of a picture while the camera is stationary: which of the two ways a mode takes.

use super::accumulate::{Accumulation, CONVERGED_PASSES};
use super::frame::{Frame, RefineState};
use super::request::FrameRequest;
use super::rest::RestPicture;
use super::settings::RenderSettings;
use super::stages::PASSES;
use crate::reference::{ReferenceCache, ReferenceFrame};
use crate::trace::{Tracer, parallel::Stop};
use std::sync::Arc;

/// A picture on its way to convergence.
#[derive(Debug)]
pub(super) enum Refinement {
    /// The mean of passes of the full tracer.
    Full(Box<Accumulation>),
    /// The picture at rest of a mode that looks smooth light up.
    Rest(Box<RestPicture>),
}

impl Refinement {
    /// Begins the picture of a request: of the full tracer, from `first_pass` where there is one,
    /// or of the mode where it looks smooth light up.
    pub(super) fn new(request: &FrameRequest<'_>, first_pass: Option<&Frame>) -> Self {
        let RenderSettings { mode, trace } = *request.settings;
        if mode.looks_up() && trace.bounces > 0 {
            return Self::Rest(Box::new(RestPicture::new(request)));
        }
        let mut full = Accumulation::new(request, CONVERGED_PASSES);
        if let Some(frame) = first_pass {
            full.take_first_pass(frame);
        }
        Self::Full(Box::new(full))
    }

    /// True where this is the picture of a request.
    pub(super) fn is_of(&self, request: &FrameRequest<'_>) -> bool {
        match self {
            Self::Full(full) => full.is_of(request),
            Self::Rest(rest) => rest.is_of(request),
        }
    }

    /// Sets whether the picture is refined for as long as there is time.
    pub(super) fn set_endless(&mut self, is_endless: bool) {
        match self {
            Self::Full(full) => full.set_endless(is_endless),
            Self::Rest(rest) => rest.full.set_endless(is_endless),
        }
    }

    /// Works on the picture until it has converged or `stop` is true. What is done then is kept.
    pub(super) fn run(&mut self, tracer: &Tracer, cache: &mut ReferenceCache, stop: Stop<'_>) {
        match self {
            Self::Full(full) => full.run(tracer, stop),
            Self::Rest(rest) => {
                rest.run(tracer, cache, stop);
                // After the last stage, passes follow where there is no end.
                if rest.full.passes_done() >= PASSES {
                    rest.full.run(tracer, stop);
                }
            }
        }
    }

    /// Shows in a frame of the same size what is done.
    pub(super) fn write_to(&self, frame: &mut Frame) {
        match self {
            Self::Full(full) => full.write_to(frame),
            Self::Rest(rest) => rest.write_to(frame),
        }
    }

    /// The reference of the view that was lit for the picture, if it has one.
    pub(super) fn reference(&self, cache: &ReferenceCache) -> Option<Arc<ReferenceFrame>> {
        match self {
            Self::Full(_) => None,
            Self::Rest(rest) => rest.reference(cache),
        }
    }

    /// How far the picture has come.
    pub(super) fn state(&self) -> RefineState {
        match self {
            Self::Full(full) => full.state(),
            Self::Rest(rest) => rest.state(),
        }
    }
}
