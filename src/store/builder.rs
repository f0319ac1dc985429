//! A store that is filled on purpose: references are added one by one, none is removed, and a
//! failure to write is an error.

use super::append::{Appender, SEGMENT_BYTES};
use super::codec::encode;
use super::content::SceneContent;
use super::index::StoreIndex;
use super::record::write_record;
use super::summary::{Purpose, RecordSummary};
use super::writer::now;
use super::{StoreError, StoreSettings};
use crate::camera::Camera;
use crate::reference::ReferenceFrame;
use crate::trace::{TraceSettings, Tracer};
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

/// Adds references for look-ups to a store.
pub struct StoreBuilder {
    settings: StoreSettings,
    tracer: Arc<Tracer>,
    content: SceneContent,
    known: Vec<Identity>,
    appender: Appender,
    /// Size of the store, without what other processes have added since.
    bytes: u64,
    problems: Vec<String>,
}

/// What tells a reference from others of the same scene.
#[derive(Clone, Copy, PartialEq)]
struct Identity {
    camera: Camera,
    size: [u32; 2],
    settings: TraceSettings,
}

impl StoreBuilder {
    /// Opens a store, and makes sure that it can be written.
    ///
    /// # Errors
    /// [`StoreError`] if the folder cannot be created, read or written.
    pub fn open(settings: &StoreSettings, tracer: &Arc<Tracer>) -> Result<Self, StoreError> {
        let folder = &settings.folder;
        try_writing(folder).map_err(|cause| StoreError::Write { path: folder.clone(), cause })?;
        let index = StoreIndex::read(folder)?;
        let content = SceneContent::new(tracer.scene());
        let summaries = index.records().map(|(_, summary, _)| summary);
        let fits =
            |summary: &&RecordSummary| summary.purpose == Purpose::LookUp && summary.holds_in(&content);
        let known = summaries.filter(fits).map(Identity::of).collect();
        Ok(Self {
            settings: settings.clone(),
            tracer: Arc::clone(tracer),
            known,
            appender: Appender::new(folder, SEGMENT_BYTES),
            bytes: index.bytes(),
            problems: index.problems,
            content,
        })
    }

    /// The scene whose references are added.
    pub fn tracer(&self) -> &Arc<Tracer> {
        &self.tracer
    }

    /// What of the store is damaged, one line each.
    pub fn problems(&self) -> &[String] {
        &self.problems
    }

    /// True where the store has a reference of this camera, size and settings whose light holds.
    pub fn holds(&self, camera: &Camera, size: [u32; 2], settings: &TraceSettings) -> bool {
        self.known.contains(&Identity { camera: *camera, size, settings: *settings })
    }

    /// Adds a reference, which is written when this returns.
    ///
    /// # Errors
    /// [`StoreError::Write`] if it cannot be written, [`StoreError::Full`] if the store would
    /// exceed its limit. What was stored before stays.
    pub fn add(&mut self, reference: &ReferenceFrame) -> Result<(), StoreError> {
        let path = || self.settings.folder.clone();
        let summary = RecordSummary::of(reference, Purpose::LookUp, self.tracer.scene(), &self.content);
        let pixels = encode(reference, &self.tracer, &self.content);
        let too_large = || StoreError::Write { path: path(), cause: io::ErrorKind::FileTooLarge.into() };
        let record = write_record(&summary.write(), &pixels, now()).ok_or_else(too_large)?;
        let bytes = self.bytes + record.len() as u64;
        if bytes > self.settings.max_bytes {
            return Err(StoreError::Full { path: path(), max_bytes: self.settings.max_bytes });
        }
        let written = self.appender.append(&record);
        written.map_err(|cause| StoreError::Write { path: path(), cause })?;
        self.bytes = bytes;
        self.known.push(Identity::of(&summary));
        Ok(())
    }

    /// Waits until the disk has everything.
    ///
    /// # Errors
    /// [`StoreError::Write`] if it cannot be written.
    pub fn finish(&self) -> Result<(), StoreError> {
        let failed = |cause| StoreError::Write { path: self.settings.folder.clone(), cause };
        self.appender.sync().map_err(failed)
    }

    /// Size of the store in bytes, without what other processes have added since it was opened.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

impl Identity {
    fn of(summary: &RecordSummary) -> Self {
        Self { camera: summary.camera, size: summary.size, settings: summary.settings }
    }
}

/// Creates a folder unless it exists, and writes a file to it, which is removed again.
fn try_writing(folder: &Path) -> io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let path = folder.join(format!(".writing-{}", std::process::id()));
    let written = File::create(&path).and_then(|mut file| file.write_all(&[0]));
    let _ = std::fs::remove_file(&path);
    written
}
