//! Care of stores: verify, prune, merge.

use super::append::{Appender, SEGMENT_BYTES};
use super::codec::is_sound;
use super::index::StoreIndex;
use super::segment::{Segment, StoredRecord};
use super::summary::RecordSummary;
use super::{StoreError, budget};
use std::collections::HashSet;
use std::fs::File;
use std::path::{Path, PathBuf};

/// What was found in a store, or done with it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MaintenanceReport {
    /// Whole records that are in the store afterwards.
    pub records: usize,
    /// Size of the store afterwards, bytes.
    pub bytes: u64,
    /// Records that were added.
    pub added: usize,
    /// Whole records that were there more than once, and those whose light another one holds.
    pub duplicates: usize,
    /// Records and other bytes that are damaged, or cannot be read, one line each.
    pub problems: Vec<String>,
}

/// Identities of records.
type Known = HashSet<(u64, u64, u64)>;

/// Reads every record of a store and checks it. Nothing is changed.
///
/// # Errors
/// [`StoreError`] if the folder cannot be read.
pub fn verify(folder: &Path) -> Result<MaintenanceReport, StoreError> {
    let index = StoreIndex::read(folder)?;
    let mut report = MaintenanceReport { bytes: index.bytes(), ..MaintenanceReport::default() };
    report.problems.clone_from(&index.problems);
    let mut known = Known::new();
    for segment in &index.segments {
        whole_records(segment, &mut known, &mut report);
    }
    report.records = known.len();
    Ok(report)
}

/// Removes what is damaged or there twice, records whose light a later one holds, and then whole
/// segments, the longest unused first, until the store has at most `max_bytes`. Segments that a
/// process is writing, and those of another version of the program, are not rewritten.
///
/// # Errors
/// [`StoreError`] if the folder cannot be read or written.
pub fn prune(folder: &Path, max_bytes: u64) -> Result<MaintenanceReport, StoreError> {
    let index = StoreIndex::read(folder)?;
    let mut report = MaintenanceReport { problems: index.problems.clone(), ..MaintenanceReport::default() };
    let mut known = Known::new();
    let refined = refined_records(&index);
    for segment in &index.segments {
        // The lock is held until the segment is replaced.
        let lock = File::open(&segment.path).ok().filter(|file| file.try_lock().is_ok());
        let Some(mut whole) = whole_records(segment, &mut known, &mut report) else { continue };
        let count = whole.len();
        whole.retain(|record| !refined.iter().any(|other| record.summary.is_in(other)));
        report.duplicates += count - whole.len();
        let is_clean = segment.problems.is_empty() && whole.len() == segment.records.len();
        if !is_clean && !segment.is_foreign && lock.is_some() {
            let mut appender = Appender::new(folder, u64::MAX);
            copy(segment, &whole, &mut appender)?;
            std::fs::remove_file(&segment.path)
                .map_err(|cause| StoreError::Folder { path: segment.path.clone(), cause })?;
        }
    }
    budget::shrink(folder, max_bytes, None);
    let index = StoreIndex::read(folder)?;
    (report.records, report.bytes) = (index.len(), index.bytes());
    Ok(report)
}

/// Adds the records of other stores to a store, those that it does not have.
///
/// # Errors
/// [`StoreError`] if a folder cannot be read, or the first one cannot be written.
pub fn merge(folder: &Path, others: &[PathBuf]) -> Result<MaintenanceReport, StoreError> {
    let mut report = verify(folder)?;
    let mut known: Known = StoreIndex::read(folder)?
        .segments
        .iter()
        .flat_map(|segment| segment.records.iter().map(|record| record.header.identity()))
        .collect();
    let mut appender = Appender::new(folder, SEGMENT_BYTES);
    for other in others {
        let index = StoreIndex::read(other)?;
        report.problems.extend(index.problems.iter().cloned());
        for segment in &index.segments {
            let Some(whole) = whole_records(segment, &mut known, &mut report) else { continue };
            copy(segment, &whole, &mut appender)?;
            report.added += whole.len();
        }
    }
    let index = StoreIndex::read(folder)?;
    (report.records, report.bytes) = (index.len(), index.bytes());
    Ok(report)
}

/// The whole records of views that were refined.
fn refined_records(index: &StoreIndex) -> Vec<&RecordSummary> {
    let is_whole = |segment: &Segment, record: &StoredRecord| {
        let payload = record.payload(&segment.path).ok().flatten();
        payload.is_some_and(|bytes| is_sound(&bytes, &record.summary))
    };
    let of = |segment| move |record: &&StoredRecord| record.summary.is_refined && is_whole(segment, record);
    let records = index.segments.iter().flat_map(|segment| segment.records.iter().filter(of(segment)));
    records.map(|record| &record.summary).collect()
}

/// The records of a segment that are whole and not known yet. They are known afterwards. `None`
/// where the segment cannot be read, which says nothing about its records.
fn whole_records<'s>(
    segment: &'s Segment,
    known: &mut Known,
    report: &mut MaintenanceReport,
) -> Option<Vec<&'s StoredRecord>> {
    let mut whole = Vec::new();
    let path = segment.path.display();
    for record in &segment.records {
        let payload = record.payload(&segment.path);
        let payload =
            payload.map_err(|e| report.problems.push(format!("{path} cannot be read: {e}"))).ok()?;
        if !payload.is_some_and(|bytes| is_sound(&bytes, &record.summary)) {
            report.problems.push(format!("{path} has a damaged record at {}", record.offset));
        } else if known.insert(record.header.identity()) {
            whole.push(record);
        } else {
            report.duplicates += 1;
        }
    }
    Some(whole)
}

/// Copies records as they are.
fn copy(segment: &Segment, records: &[&StoredRecord], to: &mut Appender) -> Result<(), StoreError> {
    let failed = |cause| StoreError::Folder { path: segment.path.clone(), cause };
    for record in records {
        let bytes = record.bytes(&segment.path).map_err(failed)?;
        to.append(&bytes).map_err(failed)?;
    }
    to.sync().map_err(failed)
}
