//! The gallery on which speed is measured: six rooms with columns, statues, paintings, a raised
//! platform behind a railing, mirrors and a vitrine. It never changes.
//!
//! ```text
//!        0         10               24         34   x
//!    0   +----------+----------------+----------+
//!        | mirrors      red room       vitrine  |
//!    9   +---    ---+----    ----+---+---    ---+
//!        | court        hall           terrace  |
//!        |          |  o    o    |   |          |
//!        |          |  o    o    |   | railing  |
//!   24   +----------+----------------+----------+
//!    z
//! ```

mod columns;
mod exhibits;
mod lights;
mod palette;
mod pictures;
mod plan;
mod rooms;
mod statues;
mod terrace;
mod trim;
mod walk;

use crate::scene::{SceneBuilder, SceneError};
use palette::Palette;

pub(super) fn add_to(b: &mut SceneBuilder) -> Result<(), SceneError> {
    let palette = Palette::add_to(b)?;
    rooms::add_to(b, &palette);
    trim::add_to(b, &palette);
    lights::add_to(b, &palette);
    columns::add_to(b, &palette);
    terrace::add_to(b, &palette);
    statues::add_to(b, &palette);
    pictures::add_to(b, &palette);
    exhibits::add_to(b, &palette);
    b.views = walk::views();
    b.walk = Some(walk::walk());
    Ok(())
}
