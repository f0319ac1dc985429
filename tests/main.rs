//! Tests of the engine: theorems and slow reference implementations first, a small golden map of
//! pixel types second. One binary, linked once, whose modules share the cores.

#![allow(missing_docs, clippy::unwrap_used, clippy::print_stderr, reason = "tests")]

mod audit;
mod baking;
mod bands;
mod bsdf;
mod budget;
mod builtin;
mod bundles;
mod bvh;
mod coincident;
mod content;
mod corpus;
mod entry_points;
mod experiments;
mod exposure;
mod features;
mod film;
mod golden;
mod ground;
mod import;

mod layers;
mod light_theorems;
mod light_views;
mod lighting;
mod lights;
mod lookup;
mod metrics;
mod moving;
mod numbers;
mod objects;
mod outlines;
mod pictures_of_light;
mod placement;
mod refine;
mod relief;
mod repository;
mod reuse;
mod rooms;
mod rough_lobes;
mod rough_scenes;
mod save;
mod sections;
mod stability;
mod stale;
mod start_view;
mod still_view;
mod stored_walks;
mod tiles;
mod tour;
mod tracing;
mod visibility;
mod walks;
mod warp;
