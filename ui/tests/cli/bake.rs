//! Bakes from the command line.

use super::{Bench, assert_keys, number, stderr};

const SETTINGS: &str = "--size 48x36 --samples 1 --bounces 0 --json";

#[test]
fn shards_that_are_merged_are_the_whole_bake_and_a_tour_reads_it() {
    let bench = Bench::new();
    let bake = |store: &str| bench.json(&format!("bake room.obj {SETTINGS} --store {store}"));
    let parts = ["a --shard 0/2", "b --shard 1/2"].map(bake);
    let traced: f64 = parts.iter().map(|part| number(part, "/traced")).sum();
    assert_keys(
        &parts[0],
        &[
            "planned",
            "already_stored",
            "traced",
            "store_bytes",
            "secs",
            "coverage_percent",
            "estimated_error_percent",
        ],
    );
    let merged = bench.json("store merge all a b --json");
    assert_eq!(number(&merged, "/stores/0/references"), traced);
    let whole = bake("all");
    assert_eq!([number(&whole, "/planned"), number(&whole, "/already_stored")], [traced; 2]);
    assert_eq!(number(&whole, "/traced"), 0.0);
    assert!(number(&whole, "/coverage_percent") > 80.0, "{whole}");
    let tour = bench
        .json("tour room.obj --size 48x36 --samples 1 --bounces 0 --frames 3 --json --out t --store all");
    assert!(number(&tour, "/references_from_store") > 0.0);
    // A path needs no floor.
    let along = bake("path --placement path --path walks.json#short");
    assert!(number(&along, "/planned") > 0.0, "{along}");
}

#[test]
fn what_cannot_be_baked_is_refused() {
    let bench = Bench::new();
    std::fs::write(bench.path("file"), "no folder").unwrap();
    for (flags, code, words) in [
        ("", 2, "--store DIR"),
        ("--store off", 2, "--store DIR"),
        ("--store s --shard 5/4", 2, "I must be from 0 to 4"),
        ("--store s --shard 0/0", 2, "write I/N"),
        ("--store s --mode full", 2, "'exact' and 'fast'"),
        ("--store s --placement nowhere", 2, "possible values: greedy, grid, path"),
        ("--store s --path walks.json#short", 2, "--placement path"),
        ("--store s --seconds 1 --hours 1", 2, "cannot be used with"),
        ("--store s --seconds 0", 2, "seconds"),
        ("--store file", 1, "cannot write to the store"),
        ("--store s --seconds 0.001", 1, "nothing was baked"),
    ] {
        let output = bench.run(&format!("bake room.obj --size 48x36 --samples 1 --bounces 0 {flags}"));
        let errors = stderr(&output);
        assert_eq!(output.status.code(), Some(code), "{flags}: {errors}");
        assert!(errors.contains(words) && output.stdout.is_empty(), "{flags}: {errors}");
    }
}
