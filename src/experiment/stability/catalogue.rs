//! The list of all cases.

use super::case::Case;
use super::{artefacts, cache, camera, geometry, materials, scale, theorems};

/// Every case, in the order of the catalogue.
pub fn cases() -> impl Iterator<Item = &'static Case> {
    let groups: [&[Case]; 7] = [
        scale::CASES,
        camera::CASES,
        geometry::CASES,
        materials::CASES,
        cache::CASES,
        theorems::CASES,
        artefacts::CASES,
    ];
    groups.into_iter().flatten()
}
