//! Files that are cut, damaged, foreign, or written by several.

use super::*;
use crate::store::append::{Appender, SegmentWriter};
use crate::store::maintain::{merge, prune, verify};
use crate::store::record::{HEADER_BYTES, VERSION};
use crate::store::segment::{SEGMENT_HEADER_BYTES, Segment, segment_paths, segment_start};
use crate::store::{StoreIndex, budget, hash::checksum};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use tempfile::TempDir;

static STAGE: LazyLock<Stage> = LazyLock::new(|| Stage::new("cornell"));

/// Four small records of one scene.
static RECORDS: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let of = |seed| STAGE.sparse([8, 6], &TraceSettings { seed, ..TRACE }, 0.3);
    [1, 2].into_iter().flat_map(of).map(|reference| STAGE.record(&reference)).collect()
});

/// A segment of all records, as bytes.
fn segment() -> Vec<u8> {
    RECORDS.iter().fold(segment_start(VERSION).to_vec(), |bytes, record| [bytes, record.clone()].concat())
}

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

/// The references that a store reads, as bytes of records without their time.
fn read_all(folder: &Path) -> (Vec<Vec<u8>>, Vec<String>) {
    let index = StoreIndex::read(folder).unwrap();
    let mut problems = index.problems.clone();
    let mut read = Vec::new();
    for place in index.places() {
        match index.load(place, &STAGE.tracer, &STAGE.content) {
            Ok((reference, _)) => read.push(STAGE.record(&reference)),
            Err(problem) => problems.push(problem),
        }
    }
    (read, problems)
}

fn with_file(bytes: &[u8]) -> (TempDir, PathBuf) {
    let folder = folder();
    let path = folder.path().join("00000001.seg");
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}

#[test]
fn a_segment_that_is_cut_anywhere_in_its_last_record_keeps_all_others() {
    let whole = segment();
    let start = whole.len() - RECORDS[3].len();
    let (folder, path) = with_file(&whole);
    for length in (start..=whole.len()).rev() {
        std::fs::File::options().write(true).open(&path).unwrap().set_len(length as u64).unwrap();
        let found = Segment::scan(&path).unwrap();
        let is_cut = length > start && length < whole.len();
        let expected = (if length == whole.len() { 4 } else { 3 }, usize::from(is_cut));
        assert_eq!((found.records.len(), found.problems.len()), expected, "{length} bytes");
    }
    assert!(read_all(folder.path()) == (RECORDS[..3].to_vec(), Vec::new()));
    // The first bytes of a segment.
    for length in 0..SEGMENT_HEADER_BYTES as usize {
        std::fs::write(&path, &whole[..length]).unwrap();
        let found = Segment::scan(&path).unwrap();
        assert_eq!(
            (found.records.len(), found.problems.len()),
            (0, usize::from(length > 0)),
            "{length} bytes"
        );
    }
}

#[test]
fn of_a_thousand_flipped_bits_each_costs_one_record_at_most_and_no_pixel_is_wrong() {
    let whole = segment();
    let (folder, path) = with_file(&whole);
    for number in 0..1000 {
        let bit = (crate::math::key::Key::of_pixel(9, number).bits() % (8 * whole.len() as u64)) as usize;
        let mut damaged = whole.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        std::fs::write(&path, &damaged).unwrap();
        let (read, problems) = read_all(folder.path());
        assert!(read.len() >= 3 && read.iter().all(|record| RECORDS.contains(record)), "bit {bit}");
        // A flipped bit of the time of writing is found too; nothing else of a record is free.
        assert_eq!(problems.len(), 1, "bit {bit}: {problems:?}");
    }
}

#[test]
fn segments_of_another_version_or_kind_are_left_as_they_are() {
    let mut foreign = segment_start(VERSION + 1).to_vec();
    foreign.extend_from_slice(&[7; 500]);
    let (folder, path) = with_file(&foreign);
    let (read, problems) = read_all(folder.path());
    assert!(
        read.is_empty() && problems.len() == 1 && problems[0].contains(&format!("format {}", VERSION + 1)),
        "{problems:?}"
    );
    prune(folder.path(), u64::MAX).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), foreign);
    // A record of another version between others.
    let mut mixed = segment();
    let at = SEGMENT_HEADER_BYTES as usize;
    mixed[at + 4] = 9;
    let sum = checksum(&mixed[at..at + HEADER_BYTES - 8]);
    mixed[at + HEADER_BYTES - 8..at + HEADER_BYTES].copy_from_slice(&sum.to_le_bytes());
    std::fs::write(&path, &mixed).unwrap();
    let (read, problems) = read_all(folder.path());
    assert!(read == RECORDS[1..] && problems.len() == 1 && problems[0].contains("another version"));
    // Any other file.
    std::fs::write(&path, vec![b'x'; 100_000]).unwrap();
    let (read, problems) = read_all(folder.path());
    assert!(read.is_empty() && !problems.is_empty() && problems.len() <= 2, "{problems:?}");
}

#[test]
fn writers_have_segments_of_their_own_and_all_records_are_found() {
    let folder = folder();
    let write = |which: usize| {
        let mut appender = Appender::new(folder.path(), u64::MAX);
        (0..20).for_each(|_| appender.append(&RECORDS[which]).unwrap());
        appender
    };
    let appenders = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..4).map(|which| scope.spawn(move || write(which))).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect::<Vec<_>>()
    });
    let (read, problems) = read_all(folder.path());
    assert_eq!((read.len(), segment_paths(folder.path()).unwrap().len()), (80, 4));
    assert!(
        problems.is_empty()
            && RECORDS.iter().all(|record| read.iter().filter(|r| *r == record).count() == 20)
    );
    // While they are written, neither the budget nor a prune removes them.
    assert_eq!(budget::shrink(folder.path(), 0, None), StoreIndex::read(folder.path()).unwrap().bytes());
    prune(folder.path(), 0).unwrap();
    assert_eq!(read_all(folder.path()).0.len(), 80);
    drop(appenders);
    let report = prune(folder.path(), u64::MAX).unwrap();
    assert_eq!((report.records, report.duplicates, report.problems.len()), (4, 76, 0));
    assert_eq!(budget::shrink(folder.path(), 0, None), 0);
}

#[test]
fn the_longest_unused_segment_is_removed_first() {
    let folder = folder();
    let mut appender = Appender::new(folder.path(), 1);
    RECORDS.iter().for_each(|record| appender.append(record).unwrap());
    drop(appender);
    let paths = segment_paths(folder.path()).unwrap();
    assert_eq!(paths.len(), 4);
    for (age, path) in paths.iter().rev().enumerate() {
        let time = std::time::UNIX_EPOCH + std::time::Duration::from_secs(age as u64);
        std::fs::File::open(path).unwrap().set_modified(time).unwrap();
    }
    let index = StoreIndex::read(folder.path()).unwrap();
    index.touch(index.places()[3]);
    let most = index.bytes() - 1;
    assert!(budget::shrink(folder.path(), most, None) <= most);
    assert_eq!(segment_paths(folder.path()).unwrap(), [&paths[0], &paths[1], &paths[3]].map(Clone::clone));
}

#[test]
fn a_prune_removes_damage_and_a_merge_adds_what_is_missing() {
    let mut damaged = segment();
    let last = damaged.len() - 1;
    damaged[last] ^= 1;
    damaged.extend_from_slice(&RECORDS[0][..30]);
    let (first, _) = with_file(&damaged);
    let report = verify(first.path()).unwrap();
    assert_eq!((report.records, report.problems.len()), (3, 2));
    let report = prune(first.path(), u64::MAX).unwrap();
    assert_eq!((report.records, report.problems.len()), (3, 2));
    assert_eq!(verify(first.path()).unwrap().problems, Vec::<String>::new());
    let (second, _) = with_file(&segment());
    let report = merge(first.path(), &[second.path().to_owned()]).unwrap();
    assert_eq!((report.records, report.added, report.duplicates), (4, 1, 3));
    let mut read = read_all(first.path()).0;
    let mut expected = RECORDS.clone();
    read.sort();
    expected.sort();
    assert!(read == expected);
    // A store that does not exist yet.
    let whole = first.path().join("whole");
    let report = merge(&whole, &[first.path().to_owned(), second.path().to_owned()]).unwrap();
    assert_eq!((report.records, report.added, report.duplicates), (4, 4, 4));
}

#[test]
fn a_folder_that_cannot_be_read_or_written_is_one_error() {
    let (folder, path) = with_file(b"");
    assert!(StoreIndex::read(&path).is_err());
    assert!(StoreIndex::read(&folder.path().join("missing")).unwrap().is_empty());
    assert!(SegmentWriter::create(&path).is_err());
    assert!(Appender::new(&path.join("below"), 1).append(&RECORDS[0]).is_err());
}
