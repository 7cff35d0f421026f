//! `dd4 --memory`: the same bytes in less memory, by way of temporary files.

use std::fmt::Write;

use serde_json::Value;

use super::{diagram, proof};
use crate::programs::{outcome, run, sample};
use spmesh_reference::sets::Random;

#[test]
fn volumes_grids_and_lines_give_the_same_bytes() {
    let functional = sample("functional.nii");
    // Most of them need several stages.
    let cases: [(&str, &[&str]); 5] = [
        ("10.9M", &["--grid", "9x8x7x6"]),
        ("15M", &["--grid", "40x5x16x5", "--sample", "0.2", "--quantum", "1"]),
        ("17.5M", &[&functional, "--count", "4000", "--time-scale", "0.01"]),
        ("10M", &["--grid", "3x3x3x40", "--time-scale", "0.5", "--compress"]),
        ("9M", &["--grid", "2x2x2x2", "--threads", "1"]),
    ];
    for (memory, arguments) in cases {
        let whole = diagram(arguments, &[]);
        let bounded = diagram(&[arguments, &["--memory", memory]].concat(), &[]);
        assert!(bounded == whole, "{arguments:?}");
    }
}

/// 20,000 random points of a box that is eight times as long as wide: 70 MB as a whole.
#[test]
fn stages_need_less_memory() {
    let mut random = Random::new(20_261_126);
    let mut lines = String::new();
    for _ in 0..20_000 {
        let [x, y, z, t] = [20, 20, 23, 20].map(|bits| random.integer(0, 1 << bits));
        writeln!(lines, "{x} {y} {z} {t} {}", x % 100).unwrap();
    }
    let made = |arguments: &[&str]| {
        let output = run("dd4", &[&["-", "--stats=json"], arguments].concat(), lines.as_bytes());
        let (code, message) = outcome(&output);
        assert_eq!(code, Some(0), "{message}");
        // Notices may come before.
        let stats = message.lines().last().unwrap();
        (output.stdout, serde_json::from_str::<Value>(stats).unwrap())
    };
    let (whole, stats) = made(&[]);
    let (bounded, of_bounded) = made(&["--memory", "40M"]);
    assert!(bounded == whole);
    for counted in
        ["cells", "infinite_cells", "facets", "vertex_references", "cell_vertices_max", "output_bytes"]
    {
        assert_eq!(stats[counted], of_bounded[counted], "{counted}");
    }
    let peak = |stats: &Value| stats["peak_memory_bytes"].as_u64().unwrap();
    assert!(peak(&of_bounded) < 40 << 20 && peak(&stats) > 60 << 20, "{stats} {of_bounded}");
    assert_eq!(proof(&bounded)["vertices"], 20_000);
}

/// Most points of these grids are on the hull: stages alone would not fit.
#[test]
fn what_fits_at_once_is_never_refused() {
    try_memory(&[26, 30, 50]);
}

#[test]
#[ignore = "long: run with -- --ignored"]
fn what_fits_at_once_is_not_refused_in_other_memory() {
    try_memory(&[27, 33, 36, 42, 65, 80]);
}

fn try_memory(all: &[u32]) {
    let grids: [&[&str]; 3] =
        [&["--grid", "12x12x12x12"], &["--grid", "4x4x4x40"], &["--grid", "25x25x5x5", "--sample", "0.5"]];
    for grid in grids {
        for megabytes in all {
            let memory = format!("{megabytes}M");
            let output = run("dd4", &[grid, &["--memory", &memory, "-o", "/dev/null"]].concat(), &[]);
            let (code, message) = outcome(&output);
            assert_eq!(code, Some(0), "{grid:?} in {memory}: {message}");
        }
    }
}

#[test]
fn what_cannot_be_done_is_refused() {
    let cases: [(&[&str], i32, &str); 5] = [
        (&["--slice", "1"], 2, "cells alone"),
        (&["--triangulate", "canonical"], 2, "cells alone"),
        (&["--memory", "1M"], 5, "give --memory 9M or more"),
        (&["--temp-dir", "/no/such/folder"], 0, ""),
        (&["--temp-dir", "/no/such/folder", "--grid", "9x9x9x9"], 1, "/no/such/folder"),
    ];
    for (arguments, code, part) in cases {
        let grid: &[&str] = if arguments.contains(&"--grid") { &[] } else { &["--grid", "3x3x3x3"] };
        let memory: &[&str] = if arguments.contains(&"--memory") { &[] } else { &["--memory", "40M"] };
        let (found, message) = outcome(&run("dd4", &[arguments, grid, memory].concat(), &[]));
        assert_eq!(found, Some(code), "{arguments:?}: {message}");
        assert!(message.contains(part) && !message.contains("panicked"), "{arguments:?}: {message}");
    }
}
