//! Faults that strike while a segment is written: full disks and kills.

use super::*;
use crate::store::StoreIndex;
use crate::store::append::{Appender, GrowingFile, SegmentWriter};
use crate::store::maintain::verify;
use crate::store::segment::segment_paths;
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::process::{Command, Stdio};

/// A file on a disk that is full after some bytes.
struct FullDisk {
    file: File,
    left: usize,
    can_be_cut: bool,
}

impl Write for FullDisk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = bytes.len().min(self.left);
        if count == 0 && !bytes.is_empty() {
            return Err(io::ErrorKind::StorageFull.into());
        }
        self.left -= count;
        self.file.write(&bytes[..count])
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl GrowingFile for FullDisk {
    fn cut(&mut self, length: u64) -> io::Result<()> {
        if self.can_be_cut { self.file.cut(length) } else { Err(io::ErrorKind::Other.into()) }
    }

    fn sync(&self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_disk_that_is_full_at_any_byte_keeps_the_records_before() {
    let stage = Stage::new("cornell");
    let record = stage.record(&stage.sparse([4, 3], &TRACE, 0.1)[0]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("00000001.seg");
    for left in 0..2 * record.len() + 20 {
        for can_be_cut in [true, false] {
            let file = FullDisk { file: File::create(&path).unwrap(), left, can_be_cut };
            let written = match SegmentWriter::begin(path.clone(), Box::new(file)) {
                Err(_) => 0,
                Ok(mut writer) => (0..4).take_while(|_| writer.append(&record).is_ok()).count(),
            };
            let index = StoreIndex::read(folder.path()).unwrap();
            assert_eq!(
                (index.len(), written),
                (written, left.saturating_sub(16) / record.len()),
                "{left} bytes"
            );
            assert!(!can_be_cut || index.problems.is_empty(), "{left} bytes: {:?}", index.problems);
            assert!(index.problems.len() <= 1);
        }
    }
}

/// Name of the environment variable that turns the test below into a writer.
const WRITER: &str = "AFTERIMAGE_TEST_STORE";

#[test]
fn a_writer_that_is_killed_loses_at_most_the_record_being_written() {
    let stage = Stage::new("cornell");
    let record = stage.record(&stage.sparse([60, 40], &TRACE, 0.1)[0]);
    if let Some(folder) = std::env::var_os(WRITER) {
        // More than the test waits for, so that the kill strikes while it writes.
        let mut appender = Appender::new(Path::new(&folder), 1 << 20);
        (0..1000).for_each(|_| appender.append(&record).unwrap());
        return;
    }
    const KILLS: u64 = 50;
    let folder = tempfile::tempdir().unwrap();
    let size = || {
        let paths = segment_paths(folder.path()).unwrap();
        paths.iter().filter_map(|path| path.metadata().ok()).map(|metadata| metadata.len()).sum::<u64>()
    };
    for kill in 1..=KILLS {
        let name = "store::tests::faults::a_writer_that_is_killed_loses_at_most_the_record_being_written";
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", name])
            .env(WRITER, folder.path())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        let until = size() + kill * 997;
        while size() < until && child.try_wait().unwrap().is_none() {
            std::thread::yield_now();
        }
        child.kill().unwrap();
        child.wait().unwrap();
    }
    let index = StoreIndex::read(folder.path()).unwrap();
    let report = verify(folder.path()).unwrap();
    let whole = index.len() as u64 * record.len() as u64;
    assert!(index.len() as u64 >= KILLS && report.duplicates + report.records == index.len());
    assert!(report.problems.len() as u64 <= KILLS, "{:?}", report.problems);
    // All else are first bytes of segments, and at most one torn record of each writer.
    let rest = index.bytes() - whole;
    assert!(rest <= KILLS * record.len() as u64 + 16 * index.segments.len() as u64, "{rest} bytes");
}
