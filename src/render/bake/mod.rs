//! Baking: fills the space where one can walk with stored references, before anybody walks there.
//!
//! | File | Contents |
//! |---|---|
//! | `poses` | where one can stand and look, and the poses to choose from |
//! | `pictures` | which surfaces a pose shows: coarse pictures of first hits |
//! | `demand` | what viewers see of each surface, and how much of that references light |
//! | `choose` | the poses of a plan, the most useful first |
//! | `mask` | which pixels a reference of the plan lights |
//! | `plan` | [`BakePlan`]: poses with masks, and the random numbers of each |
//! | `error` | the error of a reference, estimated without knowing the truth |
//! | `floor` | [`FloorCover`]: how much a store lights of what is seen from each place |
//! | `run` | [`bake`]: lights the references of a plan, or every n-th of them |
//!
//! A plan is made without any light. A reference of the plan is a function of the scene, its entry
//! in the plan, and the settings: it looks no light up in others, and the cells in which its paths
//! end hold what their place alone decides. So processes that share a plan need not know of each
//! other, in whatever order they work, and what was interrupted is continued with the same bits.

mod choose;
mod demand;
mod error;
mod floor;
mod mask;
mod pictures;
mod plan;
mod poses;
mod run;

pub use floor::FloorCover;
pub use plan::{BakeError, BakePlacement, BakePlan};
pub use run::{BakeProgress, BakeReport, BakeSettings, bake};
