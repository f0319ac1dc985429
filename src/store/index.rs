//! The records of a store, found by a scan of its segments.

use super::StoreError;
use super::codec::{decode, state_of};
use super::content::SceneContent;
use super::segment::{Segment, segment_paths};
use super::summary::RecordSummary;
use crate::reference::ReferenceFrame;
use crate::trace::Tracer;
use rayon::prelude::*;
use std::path::Path;
use std::time::SystemTime;

/// All records of a store, without their pixels.
#[derive(Debug, Default)]
pub struct StoreIndex {
    pub(super) segments: Vec<Segment>,
    /// Damage, one line each. What is damaged is left out.
    pub problems: Vec<String>,
}

/// Place of a record in a [`StoreIndex`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct RecordPlace {
    pub(super) segment: usize,
    record: usize,
}

impl StoreIndex {
    /// Scans the segments of a folder. A folder that does not exist is an empty store.
    ///
    /// # Errors
    /// [`StoreError::Folder`] if the folder cannot be listed.
    pub fn read(folder: &Path) -> Result<Self, StoreError> {
        let failed = |cause| StoreError::Folder { path: folder.to_owned(), cause };
        let paths = segment_paths(folder).map_err(failed)?;
        let scanned: Vec<_> = paths.par_iter().map(|path| (path, Segment::scan(path))).collect();
        let mut index = Self::default();
        for (path, segment) in scanned {
            match segment {
                Ok(segment) => {
                    let line = |problem: &String| format!("{} {problem}", path.display());
                    index.problems.extend(segment.problems.iter().map(line));
                    index.segments.push(segment);
                }
                Err(error) => index.problems.push(format!("{} cannot be read: {error}", path.display())),
            }
        }
        Ok(index)
    }

    /// Number of records.
    pub fn len(&self) -> usize {
        self.segments.iter().map(|segment| segment.records.len()).sum()
    }

    /// True if there are no records.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Size of all segments in bytes.
    pub fn bytes(&self) -> u64 {
        self.segments.iter().map(|segment| segment.bytes).sum()
    }

    /// All records with the file that holds each, and its size in bytes.
    pub fn records(&self) -> impl Iterator<Item = (&Path, &RecordSummary, u64)> {
        self.segments.iter().flat_map(|segment| {
            let records = segment.records.iter();
            records.map(|r| (&*segment.path, &r.summary, r.header.record_bytes()))
        })
    }

    pub(super) fn places(&self) -> Vec<RecordPlace> {
        let of = |segment: usize| {
            (0..self.segments[segment].records.len()).map(move |record| RecordPlace { segment, record })
        };
        (0..self.segments.len()).flat_map(of).collect()
    }

    pub(super) fn summary(&self, place: RecordPlace) -> &RecordSummary {
        &self.segments[place.segment].records[place.record].summary
    }

    /// Reads a reference, and the state of the scene that it was lit in. The error is one line.
    pub(super) fn load(
        &self,
        place: RecordPlace,
        tracer: &Tracer,
        content: &SceneContent,
    ) -> Result<(ReferenceFrame, Vec<u8>), String> {
        let segment = &self.segments[place.segment];
        let record = &segment.records[place.record];
        let path = segment.path.display();
        let payload = record.payload(&segment.path).map_err(|e| format!("{path} cannot be read: {e}"))?;
        let reference = payload.and_then(|bytes| {
            let reference = decode(&bytes, &record.summary, tracer, content)?;
            Some((reference, state_of(&bytes)?.to_vec()))
        });
        reference.ok_or_else(|| format!("{path} has a damaged record at {}; it is skipped", record.offset))
    }

    /// Marks the segment of a record as just used: segments that were not used for long are removed
    /// first. Without permission to do so nothing happens.
    pub(super) fn touch(&self, place: RecordPlace) {
        let file = std::fs::File::open(&self.segments[place.segment].path);
        let _ = file.and_then(|file| file.set_modified(SystemTime::now()));
    }
}
