//! The folder of a run: never overwritten, resumed where it is of the same run, written by one process at a time.

use super::csv::csv;
use super::error::ExperimentError;
use super::identity::Identity;
use super::journal::{Done, Journal};
use super::manifest::{FORMAT, Manifest, Session};
use super::record::RunRecord;
use super::report::Report;
use super::shard::Shard;
use crate::raster::load::read_bounded;
use crate::raster::save::write_atomically;
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

const MANIFEST: &str = "manifest.json";
const LOCK: &str = ".lock";
/// A thousand sessions have less.
const MANIFEST_BYTES: u64 = 16 << 20;

/// A run folder that this process may write to.
#[derive(Debug)]
pub struct RunFolder {
    path: PathBuf,
    manifest: Manifest,
    journal: Journal,
    /// Held as long as this lives; the system lets go of it when the process ends, however it ends.
    _lock: File,
}

impl RunFolder {
    /// Opens the folder of a run: a new one, or one in which the very same run was begun.
    ///
    /// # Errors
    /// [`ExperimentError`] where it holds anything else, where another process writes to it, or where it cannot be written.
    pub fn open(
        path: &Path,
        identity: Identity,
        shard: Shard,
        cells: usize,
        session: Session,
    ) -> Result<Self, ExperimentError> {
        if !is_new(path)? {
            check(path, &read_manifest(path)?, &identity, shard)?;
        }
        std::fs::create_dir_all(path.join("images")).map_err(|e| ExperimentError::at(path, e))?;
        let lock = lock(path)?;
        // Another process may have begun in between.
        let known = if path.join(MANIFEST).exists() { Some(read_manifest(path)?) } else { None };
        if let Some(manifest) = &known {
            check(path, manifest, &identity, shard)?;
        }
        let seed = identity.settings.0.get("seed").and_then(serde_json::Value::as_u64).unwrap_or(0);
        let mut manifest = known.unwrap_or(Manifest {
            format: FORMAT,
            identity,
            seed,
            shard,
            cells,
            cells_done: 0,
            is_complete: false,
            sessions: Vec::new(),
        });
        manifest.sessions.push(session);
        let folder = Self { path: path.to_owned(), journal: Journal::open(path)?, manifest, _lock: lock };
        folder.write_manifest()?;
        let config = toml::to_string(&folder.manifest.identity.settings)
            .map_err(|e| ExperimentError::Folder { path: path.to_owned(), cause: e.to_string() })?;
        write_atomically(&path.join("config.toml"), config.as_bytes())?;
        Ok(folder)
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What it says of itself.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// Remembers where else its cells were done; on the disk with the next export.
    pub(super) fn also_ran(&mut self, sessions: Vec<Session>) {
        self.manifest.sessions.splice(0..0, sessions);
    }

    /// True where a cell is done.
    pub fn has(&self, key: &str) -> bool {
        self.journal.done().iter().any(|d| d.key == key)
    }

    /// Keeps what a cell left.
    ///
    /// # Errors
    /// [`ExperimentError`] where it cannot be written.
    pub fn add(&mut self, done: Done) -> Result<(), ExperimentError> {
        self.journal.add(done)
    }

    /// All records, in the order of the plan whatever the order they were made in.
    pub fn records(&self) -> Vec<RunRecord> {
        let mut done: Vec<&Done> = self.journal.done().iter().collect();
        done.sort_by_key(|d| d.place);
        done.into_iter().flat_map(|d| d.records.iter().cloned()).collect()
    }

    /// Brings the tables up to what the journal holds: `records.csv`, `summary.json`, `manifest.json`.
    ///
    /// # Errors
    /// [`ExperimentError`] where one cannot be written.
    pub fn export(&mut self, report: &Report) -> Result<(), ExperimentError> {
        write_atomically(&self.path.join("records.csv"), csv(&self.records()).as_bytes())?;
        let summary = serde_json::to_string_pretty(&report.summary).unwrap_or_default();
        write_atomically(&self.path.join("summary.json"), (summary + "\n").as_bytes())?;
        let manifest = &mut self.manifest;
        manifest.cells_done = self.journal.done().len();
        let wanted = (0..manifest.cells).filter(|&cell| manifest.shard.has(cell)).count();
        manifest.is_complete = manifest.cells_done >= wanted;
        self.write_manifest()
    }

    fn write_manifest(&self) -> Result<(), ExperimentError> {
        let text = serde_json::to_string_pretty(&self.manifest).unwrap_or_default();
        Ok(write_atomically(&self.path.join(MANIFEST), (text + "\n").as_bytes())?)
    }
}

/// True where nothing is there yet.
fn is_new(path: &Path) -> Result<bool, ExperimentError> {
    match std::fs::read_dir(path) {
        // A lock alone is left by a run that ended before it began.
        Ok(mut entries) => {
            Ok(entries.all(|e| e.is_ok_and(|e| e.file_name() == LOCK || e.file_name() == "images")))
        }
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(true),
        Err(error) => Err(ExperimentError::at(path, error)),
    }
}

/// What a run folder says of itself.
///
/// # Errors
/// [`ExperimentError`] where it is none, or one of another form.
pub fn read_manifest(path: &Path) -> Result<Manifest, ExperimentError> {
    let not_ours = |cause: String| ExperimentError::Folder { path: path.to_owned(), cause };
    let bytes = read_bounded(&path.join(MANIFEST), MANIFEST_BYTES)
        .map_err(|e| not_ours(format!("it is no run folder: its {MANIFEST} cannot be read ({})", e.cause)))?;
    let value: serde_json::Value =
        serde_json::from_slice(&bytes).map_err(|e| not_ours(format!("its {MANIFEST} is damaged: {e}")))?;
    let format = value.get("format").and_then(serde_json::Value::as_u64);
    if format != Some(FORMAT.into()) {
        let found = format.map_or("none".to_owned(), |f| f.to_string());
        return Err(not_ours(format!("it is of form {found}, this version reads form {FORMAT}")));
    }
    serde_json::from_value(value).map_err(|e| not_ours(format!("its {MANIFEST} is damaged: {e}")))
}

fn check(path: &Path, found: &Manifest, identity: &Identity, shard: Shard) -> Result<(), ExperimentError> {
    let other = |difference: String| {
        let cause = format!("it holds another run ({difference}); nothing was changed, choose another --out");
        Err(ExperimentError::Folder { path: path.to_owned(), cause })
    };
    if let Some(difference) = identity.difference(&found.identity) {
        return other(difference);
    }
    if found.shard != shard {
        let (a, b) = (found.shard, shard);
        return other(format!("shard {}/{} there, {}/{} here", a.index, a.count, b.index, b.count));
    }
    Ok(())
}

fn lock(path: &Path) -> Result<File, ExperimentError> {
    let lock = path.join(LOCK);
    let file = File::options().create(true).truncate(false).write(true).open(&lock);
    let file = file.map_err(|e| ExperimentError::at(&lock, e))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => {
            let cause = "another process is writing to it; every shard needs a folder of its own".to_owned();
            Err(ExperimentError::Folder { path: path.to_owned(), cause })
        }
        // Some network file systems know no locks; two writers are then the user's to avoid.
        Err(TryLockError::Error(_)) => Ok(file),
    }
}
