//! Replays files that once broke something, or might: each must give a scene, a report or a
//! message.
//!
//! `tests/data/corpus/NAME/` holds the seeds of the entry point NAME, also for the fuzzers.

use crate::entry_points::{ALL, check};
use afterimage::import::{ImportOptions, load};
use std::path::{Path, PathBuf};

fn seeds(name: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/corpus").join(name);
    let entries = std::fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut seeds: Vec<PathBuf> = entries.map(|e| e.unwrap().path()).collect();
    seeds.sort();
    seeds
}

#[test]
fn the_corpus_breaks_no_entry_point() {
    for (name, run) in ALL {
        let seeds = seeds(name);
        assert!(!seeds.is_empty(), "no seed for {name}");
        for seed in seeds {
            let bytes = std::fs::read(&seed).unwrap();
            let outcome = std::panic::catch_unwind(|| run(&bytes));
            assert!(outcome.is_ok(), "{}", seed.display());
        }
    }
}

/// Each seed is also tried cut short at several places, and with a damaged byte.
#[test]
fn cut_and_damaged_seeds_break_no_entry_point() {
    for (name, run) in ALL {
        for seed in seeds(name) {
            let bytes = std::fs::read(&seed).unwrap();
            for part in 0..16 {
                run(&bytes[..bytes.len() * part / 16]);
                let mut damaged = bytes.clone();
                if let Some(byte) = damaged.get_mut(bytes.len() * part / 16) {
                    *byte ^= 0x55;
                }
                run(&damaged);
            }
        }
    }
}

/// Any file can have any name when it is dropped on the window.
#[test]
fn any_seed_may_have_any_extension() {
    let folder = tempfile::tempdir().unwrap();
    for (name, _) in ALL {
        for seed in seeds(name) {
            for extension in afterimage::import::extensions() {
                let path = folder.path().join(format!("scene.{extension}"));
                std::fs::copy(&seed, &path).unwrap();
                check(load(&path, &ImportOptions::default(), &|_, _| true));
            }
        }
    }
}
