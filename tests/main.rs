//! The engine's tests, one binary: one module per area.

mod builtin;
