//! What identifies a run and a cell.

use super::record::RunRecord;
use crate::trace::BounceLimit;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// The smallest part of an experiment that is finished or not: the settings that distinguish it
/// from the other cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell(pub RunRecord);

/// What all cells of a run share. Two runs can be merged if their identities are equal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identity {
    /// Name of the experiment.
    pub experiment: String,
    /// Version of the program; another version may give other figures.
    pub version: String,
    /// Scene as the user named it.
    pub scene: String,
    /// SHA-256 of everything in the scene that decides a pixel, as lower-case hex.
    pub scene_sha256: String,
    /// All settings after defaults were filled in.
    pub settings: RunRecord,
}

impl Identity {
    /// Returns a stable name of a cell: SHA-256 of the run's identity and the cell's own settings
    /// as JSON.
    pub fn key(&self, cell: &Cell) -> String {
        sha256_hex(serde_json::to_string(&(self, &cell.0)).unwrap_or_default().as_bytes())
    }

    /// The light that the run's pictures show, as a sentence; `None` if its settings do not say.
    pub fn light(&self) -> Option<String> {
        let limit = serde_json::from_value::<BounceLimit>(self.settings.0.get("bounces")?.clone()).ok()?;
        Some(format!("Light of every picture: {} (--bounces {limit}).", limit.light()))
    }

    /// Returns the first difference from another run's identity as a phrase, or `None` if they are
    /// equal.
    pub fn difference(&self, other: &Identity) -> Option<String> {
        let found = self.fields(other).zip(other.fields(self)).find(|(ours, theirs)| ours != theirs);
        found.map(|((name, ours), (_, theirs))| format!("{name} {theirs} there, {ours} here"))
    }

    /// Names and values of all fields, with the settings of either identity.
    fn fields<'a>(&'a self, other: &'a Identity) -> impl Iterator<Item = (&'a str, String)> {
        let fixed = [
            ("experiment", &self.experiment),
            ("version", &self.version),
            ("scene", &self.scene),
            ("scene SHA-256", &self.scene_sha256),
        ];
        let mut names: Vec<&String> = self.settings.0.keys().chain(other.settings.0.keys()).collect();
        names.sort();
        names.dedup();
        let value = |name: &str| self.settings.0.get(name).map_or("none".to_owned(), ToString::to_string);
        let settings = names.into_iter().map(move |name| (name.as_str(), value(name)));
        fixed.into_iter().map(|(name, value)| (name, value.clone())).chain(settings)
    }
}

/// SHA-256 of bytes, as lower-case hex.
pub(super) fn sha256_hex(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}
