//! What a job will need in memory, said before anything is reserved.

use super::failure::Failure;
use crate::memory::refusal;

/// Refuses a picture that is too large, with the number. `references` of the same size are held beside it.
pub(crate) fn check(pixels: u64, references: u64) -> Result<(), Failure> {
    match refusal(pixels, references) {
        Some(why) => Err(Failure::Usage(format!("{why}; make --size smaller"))),
        None => Ok(()),
    }
}
