//! The gallery: a daylit hall under a glazed lantern, a garden room with tall windows, and four
//! rooms with lamps. It is meant to be lit by all bounces of light.
//!
//! ```text
//!        0         10               24         34   x
//!    0   +----------+----------------+----------+
//!        | mirrors      salon         treasury  |
//!        |  (lamp)      (lamps)        (lamps)  |
//!    9   +---    ---+----    ----+---+---    ---+
//!        | long         hall           garden   #
//!        | gallery  |  o ::::: o  |    room     #  windows
//!        | (lamps)  |  o lantern o|   railing   |
//!        |          |  o ::::: o  |             #
//!   24   +---####---+-----####-------+----------+
//!    z      window       entrance      garden around
//! ```

mod exhibits;
mod fabric;
mod furniture;
mod garden;
mod glazing;
mod lamps;
mod lantern;
mod paintings;
mod palette;
mod parquet;
mod pictures;
mod plan;
mod planting;
mod rooms;
mod trim;
mod walk;
mod weave;

use crate::scene::{Gradient, SceneBuilder, SceneError, Sky, Sun};
use glam::{DVec3, Vec3};
use palette::Palette;

/// The sky of a bright, hazy morning. It is dimmer relative to the rooms than a real one, so that
/// one exposure shows both.
const SKY: Gradient = Gradient {
    zenith: Vec3::new(1.0, 1.35, 1.95),
    horizon: Vec3::new(1.75, 1.9, 2.0),
    ground: Vec3::new(0.35, 0.36, 0.28),
};

pub(super) fn add_to(b: &mut SceneBuilder) -> Result<(), SceneError> {
    let palette = Palette::add_to(b)?;
    rooms::add_to(b, &palette);
    trim::add_to(b, &palette);
    lantern::add_to(b, &palette);
    glazing::add_to(b, &palette);
    lamps::add_to(b, &palette);
    exhibits::add_to(b, &palette);
    pictures::add_to(b, &palette);
    furniture::add_to(b, &palette);
    fabric::add_to(b, &palette);
    garden::add_to(b, &palette);
    b.sky = Some(Sky::Gradient(SKY));
    b.sun = Some(morning_sun());
    b.views = walk::views();
    b.walk = Some(walk::walk());
    Ok(())
}

/// Returns the sun 38 degrees high in the south-east: it shines through the eastern windows, the
/// entrance and the lantern.
fn morning_sun() -> Sun {
    Sun {
        direction: DVec3::new(0.66, 0.62, 0.43).normalize_or(DVec3::Y).as_vec3(),
        irradiance: Vec3::new(7.8, 7.0, 5.8),
        ..Sun::clear_day()
    }
}
