//! Sections: what camera rays see of a scene that is cut open by planes.
//!
//! The kept region is an intersection of half-spaces and so convex: a ray has one piece in it. A
//! camera ray begins where it enters the region, and its reflections end where they leave it. Where
//! it enters inside of a closed body, it sees the *cap*: the cut material, hatched. Light does not
//! see the section. Shadow rays, bounces, cells and the light that references hold are those of the
//! whole scene, and so stay valid.

mod cut;
mod plane;
mod profile;
mod seen;
mod solids;

pub use cut::{CAP_TONES, Section, SectionError, check_planes};
pub use plane::CutPlane;
pub use seen::Cap;
pub(super) use solids::Solids;
