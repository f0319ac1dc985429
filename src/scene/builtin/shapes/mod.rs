//! Parametric shapes for the embedded scenes.

mod blocks;
mod bodies;
mod surface;
mod walls;

pub(super) use blocks::{Faces, Local, block, ceiling, floor, stairs};
pub(super) use bodies::{fluted_shaft, gear, icosphere, torus, torus_knot};
pub(super) use surface::{Closing, Grid, bar, closed_tube, lathe, on_circle};
pub(super) use walls::{Opening, Wall};
