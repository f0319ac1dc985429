//! The keys of the window: one table for the window, the help overlay and `--help`.
//!
//! Keys are identified by their position on the keyboard, so that WASD forms the same block on
//! every layout.

mod chord;
mod help;
mod keyboard;
mod rebinding;
mod table;

pub use chord::Chord;
pub use help::{HelpGroup, help_groups, help_text, keys_of};
pub use keyboard::{Attention, Keyboard, Pressed};
pub use rebinding::{KeysError, bindings, install, rebound};
pub use table::{Action, BINDINGS, Binding, GROUPS, MOUSE};
