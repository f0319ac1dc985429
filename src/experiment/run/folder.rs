//! The folder of a run: never overwritten, resumed by the same run, and written by one process at a
//! time.

use super::journal::{Done, Journal};
use super::manifest::{FORMAT, Manifest, Session};
use super::shard::Shard;
use super::{csv::csv, error::ExperimentError, identity::Identity, record::RunRecord, report::Report};
use crate::raster::{load::read_bounded, save::write_atomically};
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

const MANIFEST: &str = "manifest.json";
const LOCK: &str = ".lock";
/// Maximum size of a manifest in bytes. A manifest of a thousand sessions is smaller.
const MAX_MANIFEST_BYTES: u64 = 16 << 20;

/// A run folder that is locked for this process.
#[derive(Debug)]
pub struct RunFolder {
    path: PathBuf,
    manifest: Manifest,
    journal: Journal,
    /// Locked as long as this value lives. The operating system releases it when the process ends.
    _lock: File,
}

impl RunFolder {
    /// Opens a new folder, or the folder of a run with the same identity and shard.
    ///
    /// # Errors
    /// [`ExperimentError`] if the folder holds anything else, if another process is writing to it,
    /// or if it cannot be written.
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
        // Another process may have started the run before the lock was taken.
        let known = if path.join(MANIFEST).exists() { Some(read_manifest(path)?) } else { None };
        if let Some(manifest) = &known {
            check(path, manifest, &identity, shard)?;
        }
        let mut manifest = known.unwrap_or_else(|| Manifest::new(identity, shard, cells));
        manifest.sessions.push(session);
        let folder = Self { path: path.to_owned(), journal: Journal::open(path)?, manifest, _lock: lock };
        folder.write_manifest()?;
        let config = toml::to_string(&folder.manifest.identity.settings)
            .map_err(|e| ExperimentError::folder(path, e.to_string()))?;
        write_atomically(&path.join("config.toml"), config.as_bytes())?;
        Ok(folder)
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Manifest of the run.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// Adds the sessions of merged folders to the manifest; the next export writes them.
    pub(super) fn add_sessions(&mut self, sessions: Vec<Session>) {
        self.manifest.sessions.splice(0..0, sessions);
    }

    /// Returns true if the cell of this key is finished.
    pub fn has(&self, key: &str) -> bool {
        self.journal.done().iter().any(|d| d.key == key)
    }

    /// Stores a finished cell.
    ///
    /// # Errors
    /// [`ExperimentError`] if the journal cannot be written.
    pub fn add(&mut self, done: Done) -> Result<(), ExperimentError> {
        self.journal.add(done)
    }

    /// All records, in the order of the cells, whatever the order in which the cells were finished.
    pub fn records(&self) -> Vec<RunRecord> {
        let mut done: Vec<&Done> = self.journal.done().iter().collect();
        done.sort_by_key(|d| d.place);
        done.into_iter().flat_map(|d| d.records.iter().cloned()).collect()
    }

    /// Writes `records.csv`, `summary.json` and `manifest.json` from the journal and the report.
    ///
    /// # Errors
    /// [`ExperimentError`] if a file cannot be written.
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

/// Returns true if the folder does not exist or no run has started in it.
fn is_new(path: &Path) -> Result<bool, ExperimentError> {
    match std::fs::read_dir(path) {
        // A run that ended before it wrote its manifest leaves a lock and an empty folder of
        // pictures.
        Ok(mut entries) => {
            Ok(entries.all(|e| e.is_ok_and(|e| e.file_name() == LOCK || e.file_name() == "images")))
        }
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(true),
        Err(error) => Err(ExperimentError::at(path, error)),
    }
}

/// Reads the manifest of a run folder.
///
/// # Errors
/// [`ExperimentError`] if the folder is not a run folder or has another format.
pub fn read_manifest(path: &Path) -> Result<Manifest, ExperimentError> {
    let damaged = |e| ExperimentError::folder(path, format!("its {MANIFEST} is damaged: {e}"));
    let bytes = read_bounded(&path.join(MANIFEST), MAX_MANIFEST_BYTES).map_err(|e| {
        ExperimentError::folder(
            path,
            format!("not a run folder: its {MANIFEST} cannot be read ({})", e.cause),
        )
    })?;
    let value: serde_json::Value = serde_json::from_slice(&bytes).map_err(damaged)?;
    let format = value.get("format").and_then(serde_json::Value::as_u64);
    if format != Some(FORMAT.into()) {
        let found = format.map_or("none".to_owned(), |f| f.to_string());
        let cause = format!("it has format {found}, but this version reads format {FORMAT}");
        return Err(ExperimentError::folder(path, cause));
    }
    serde_json::from_value(value).map_err(damaged)
}

fn check(path: &Path, found: &Manifest, identity: &Identity, shard: Shard) -> Result<(), ExperimentError> {
    let shards = || {
        let ([a, b], [c, d]) = ([found.shard.index, found.shard.count], [shard.index, shard.count]);
        (found.shard != shard).then(|| format!("shard {a}/{b} there, {c}/{d} here"))
    };
    match identity.difference(&found.identity).or_else(shards) {
        None => Ok(()),
        Some(difference) => Err(ExperimentError::folder(
            path,
            format!("it holds another run ({difference}); nothing was changed, choose another --out"),
        )),
    }
}

fn lock(path: &Path) -> Result<File, ExperimentError> {
    let lock = path.join(LOCK);
    let file = File::options().create(true).truncate(false).write(true).open(&lock);
    let file = file.map_err(|e| ExperimentError::at(&lock, e))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => {
            let cause = "another process is writing to it; give every shard a folder of its own";
            Err(ExperimentError::folder(path, cause))
        }
        // Some network file systems do not support locks. The user must then avoid two writers.
        Err(TryLockError::Error(_)) => Ok(file),
    }
}
