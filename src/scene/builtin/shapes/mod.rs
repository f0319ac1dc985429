//! Parametric shapes for the embedded scenes.

pub(super) mod blocks;
pub(super) mod bodies;
pub(super) mod surface;
pub(super) mod walls;

pub(super) use blocks::{Faces, Local, block};
pub(super) use surface::{Closing, Grid};
pub(super) use walls::{Opening, Wall};
