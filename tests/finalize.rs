//! Finalized point streams keep their promises, on any input and within any memory.

mod memory;
mod promises;
mod sets;
mod spool;
mod thin;

use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_pipeline::finalize::{Budget, InRegions, Leaves, Options, Order, Spooling, Stats, run};
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::{Coordinates, StreamReader};

use crate::programs::{outcome, run as run_tool, sample};
use memory::*;
use promises::*;
use sets::*;

fn options(leaves: Leaves, order: Order) -> Options {
    let budget = Budget::of_engine(64 << 20).expect("enough");
    Options {
        leaves,
        order,
        compress: false,
        thin: None,
        budget,
        temp_dir: None,
        spooling: Spooling::Auto,
        regions: InRegions::NEVER,
        weighted: None,
    }
}

fn collapsed(cell_points: u64) -> Leaves {
    Leaves::Collapsed { cell_points, level_max: None }
}

fn finalize(set: &Set, options: &Options) -> (Vec<u8>, Stats) {
    let mut stream = Vec::new();
    let stats = run(&Memory::new(set), options, &mut (), &mut stream)
        .unwrap_or_else(|error| panic!("{}: {error}", set.name));
    (stream, stats)
}

#[test]
fn every_promise_holds_on_every_set_at_every_level() {
    for set in sets() {
        for order in [Order::Chunked, Order::Preserved] {
            for level in [0, 1, 2, 3, 5, 8] {
                let options = options(Leaves::Level(level), order);
                let (stream, stats) = finalize(&set, &options);
                let decoded = check(&set, &options, &stream);
                assert_eq!(stats.level, level);
                assert_eq!(decoded.header.tree.map(|tree| tree.depth()), Some(level));
                assert_eq!(stats.occupied_cells + stats.empty_cells, decoded.tags.len() as u64);
            }
        }
    }
}

#[test]
fn every_promise_holds_for_numbers_at_the_ends_of_f64() {
    let least_negative = vec![[1e10, 1.0, 0.0], [-5e-324, 0.0, 0.0], [3.0, 4.0, 0.0]];
    let random = (1..200).map(|seed| extremes(seed as usize % 40 + 1, seed));
    for points in std::iter::once(least_negative).chain(random) {
        for dims in [2, 3] {
            let set = set("extremes", dims, Coordinates::F64, points.clone());
            for order in [Order::Chunked, Order::Preserved] {
                for leaves in [Leaves::Level(3), collapsed(1), collapsed(20)] {
                    let options = options(leaves, order);
                    check(&set, &options, &finalize(&set, &options).0);
                }
            }
        }
    }
}

#[test]
fn every_promise_holds_with_leaves_chosen_from_the_counts() {
    for set in sets() {
        for order in [Order::Chunked, Order::Preserved] {
            for cell_points in [1, 10, 300, 1_000_000] {
                let options = options(collapsed(cell_points), order);
                let (stream, stats) = finalize(&set, &options);
                check(&set, &options, &stream);
                assert!(cell_points < 1_000_000 || stats.occupied_cells == 1, "{}", set.name);
            }
        }
    }
}

#[test]
fn leaves_hold_at_most_cell_points_and_their_parents_hold_more() {
    // Sets with many equal points, or with many points in one cell of the deepest level, cannot be divided.
    let cannot_be_divided = ["all equal", "f64 all equal", "f64 tiny", "duplicates", "space clustered"];
    for set in sets().iter().filter(|set| !cannot_be_divided.contains(&set.name)) {
        let options = options(collapsed(100), Order::Chunked);
        let (stream, stats) = finalize(set, &options);
        assert!(stats.cell_points_max <= 100, "{}: {}", set.name, stats.cell_points_max);
        let decoded = decode(&stream);
        for (_, cell) in &decoded.tags {
            let siblings = 1u128 << set.dims;
            let len = (cell.codes.end - cell.codes.start) * siblings;
            let parent = cell.codes.start / len * len..cell.codes.start / len * len + len;
            let inside = decoded
                .tags
                .iter()
                .filter(|(_, other)| parent.start <= other.codes.start && other.codes.end <= parent.end);
            let points: usize = inside
                .map(|(_, other)| set.points.iter().filter(|point| other.contains(point)).count())
                .sum();
            assert!(points > 100 || decoded.tags.len() == 1, "{}: a parent of {points} points", set.name);
        }
    }
}

#[test]
fn a_deepest_level_limits_leaves_chosen_from_the_counts() {
    let set = set("clustered", 2, GRID, clustered(3000, 2));
    let leaves = Leaves::Collapsed { cell_points: 10, level_max: Some(4) };
    let options = options(leaves, Order::Chunked);
    let (stream, stats) = finalize(&set, &options);
    check(&set, &options, &stream);
    assert_eq!(stats.level, 4);
}

#[test]
fn the_memory_budget_is_kept_and_does_not_show_in_the_result() {
    for name in ["random", "swaths permuted", "clustered", "space", "f64 huge", "all equal"] {
        let small = sets().into_iter().find(|set| set.name == name).expect("a set of this name");
        let points: Vec<Point> = (0..8).flat_map(|_| small.points.iter().copied()).collect();
        let set = Set { points: shuffled(points), ..small };
        for leaves in [Leaves::Level(0), Leaves::Level(2), Leaves::Level(3), collapsed(400)] {
            let plenty = options(leaves, Order::Chunked);
            let (expected, _) = finalize(&set, &plenty);
            for bytes in [64 << 10, 100 << 10] {
                let budget = Budget::of_engine(bytes).expect("the least");
                let (stream, stats) = finalize(&set, &Options { budget, ..plenty.clone() });
                assert!(stats.buffered_bytes_max <= bytes);
                assert!(stats.spilled_points > 0 && stats.spilled_bytes > 0, "{name} does not spill");
                // With little memory for counters the leaves may differ, but nothing else.
                let decoded = check(&set, &plenty, &stream);
                if codes(&decoded) == codes(&decode(&expected)) {
                    assert!(stream == expected, "{name}: spilling shows in the result");
                } else {
                    assert!(leaves == collapsed(400), "{name}: other leaves of {leaves:?}");
                }
            }
        }
    }
}

#[test]
fn crowded_cells_are_counted_again() {
    // A grid of counters that fits 64 KiB is too coarse for the clusters.
    let set = set("clustered", 2, GRID, clustered(6000, 21));
    let budget = Budget::of_engine(64 << 10).expect("the least");
    let options = Options { budget, ..options(collapsed(100), Order::Chunked) };
    let (stream, stats) = finalize(&set, &options);
    check(&set, &options, &stream);
    assert!(stats.passes.iter().any(|(name, _)| *name == "refine"), "{:?}", stats.passes);
    assert!(stats.cell_points_max <= 400, "{} points in a leaf", stats.cell_points_max);
}

#[test]
fn no_points_make_a_stream_without_bounds_and_tree() {
    for order in [Order::Chunked, Order::Preserved] {
        for stated_bounds in [None, Some(Bounds { min: [0.0; 3], max: [9.0; 3] })] {
            let mut input = Memory::new(&set("empty", 2, GRID, Vec::new()));
            input.description.stated_bounds = stated_bounds;
            let mut stream = Vec::new();
            run(&input, &options(Leaves::Level(3), order), &mut (), &mut stream).expect("works");
            let decoded = decode(&stream);
            assert_eq!((decoded.header.bounds, decoded.header.tree), (None, None));
            assert_eq!((decoded.header.points, decoded.header.chunked), (Some(0), false));
            assert!(decoded.points.is_empty() && decoded.tags.is_empty());
        }
    }
}

#[test]
fn extents_without_a_finite_cube_are_copied_without_tags() {
    let points = vec![[-1.7e308, 0.0, 0.0], [1.7e308, 1.0, 0.0], [3.0, 2.0, 1.0]];
    let set = set("endless", 2, Coordinates::F64, points);
    let mut notices = Notices::default();
    let mut stream = Vec::new();
    run(&Memory::new(&set), &options(collapsed(1), Order::Chunked), &mut notices, &mut stream)
        .expect("works");
    let decoded = decode(&stream);
    assert_eq!(decoded.points, set.points);
    assert!(decoded.header.tree.is_none() && !decoded.header.chunked && decoded.tags.is_empty());
    assert_eq!(notices.0.len(), 1);
}

#[test]
fn stated_bounds_save_a_pass_and_are_not_believed() {
    let set = set("random", 2, GRID, integer_points(3000, 1, 100_000));
    let exact = Bounds::of_points(&set.points).expect("points");
    let wide = Bounds { min: exact.min.map(|x| x - 10.0), max: exact.max.map(|x| x + 10.0) };
    let tight = Bounds { min: exact.min.map(|x| x + 10.0), max: exact.max.map(|x| x - 70_000.0) };
    let huge = Bounds { min: [-2e9; 3], max: [2e9; 3] };
    for leaves in [Leaves::Level(4), collapsed(50)] {
        let is_fixed = leaves == Leaves::Level(4);
        for (stated, passes, notices) in
            [(exact, 2, 0), (wide, 2, 0), (tight, 3, 1), (huge, if is_fixed { 3 } else { 2 }, 0)]
        {
            let mut input = Memory::new(&set);
            input.description.stated_bounds = Some(stated);
            let (mut stream, mut heard) = (Vec::new(), Notices::default());
            let options = options(leaves, Order::Chunked);
            let stats = run(&input, &options, &mut heard, &mut stream).expect("works");
            check(&set, &options, &stream);
            assert_eq!((stats.passes.len(), heard.0.len()), (passes, notices), "{stated:?}");
        }
    }
}

#[test]
fn an_input_that_changes_between_passes_is_malformed() {
    let points = integer_points(3000, 1, 100_000);
    let fewer = points[1..].to_vec();
    let more = [&points[..], &[points[5]]].concat();
    let moved: Vec<Point> = points.iter().map(|&[x, y, z]| [x, 90_000.0 - y, z]).collect();
    let outside = [&points[1..], &[[1e9, 0.0, 0.0]]].concat();
    for changed in [fewer, more, moved, outside, Vec::new()] {
        for order in [Order::Chunked, Order::Preserved] {
            let mut input = Memory::new(&set("random", 2, GRID, points.clone()));
            input.changed = Some(changed.clone());
            input.name = Some("a.laz and 2 more".into());
            let mut stream = Vec::new();
            let result = run(&input, &options(Leaves::Level(4), order), &mut (), &mut stream);
            let error = result.expect_err("the third pass differs");
            assert_eq!(error.kind(), ErrorKind::Malformed);
            let message = error.to_string();
            assert!(message.starts_with("a.laz and 2 more: the input changed between"), "{message}");
            let mut reader = StreamReader::new(&stream[..], "partial").expect("a header");
            let end = std::iter::from_fn(|| reader.next_event().transpose()).find(Result::is_err);
            assert!(end.is_some(), "a stream that failed has no END");
        }
    }
}

#[test]
fn requests_that_cannot_be_met_are_refused() {
    let set = set("random", 2, GRID, integer_points(3000, 1, 100_000));
    let refused = |options: &Options| -> Error {
        run(&Memory::new(&set), options, &mut (), &mut Vec::new()).expect_err("refused")
    };
    let too_deep = options(Leaves::Level(32), Order::Chunked);
    assert_eq!(refused(&too_deep).kind(), ErrorKind::Usage);
    assert_eq!(refused(&options(collapsed(0), Order::Chunked)).kind(), ErrorKind::Usage);
    let budget = Budget::of_engine(64 << 10).expect("the least");
    let too_many_leaves = Options { budget, ..options(Leaves::Level(20), Order::Chunked) };
    assert_eq!(refused(&too_many_leaves).kind(), ErrorKind::Memory);
    assert_eq!(Budget::of_engine(1000).expect_err("too small").kind(), ErrorKind::Memory);
    assert_eq!(Budget::of_process(1 << 20, 1).expect_err("too small").kind(), ErrorKind::Memory);
    let temp_dir = Some("/nonexistent/folder".into());
    let nowhere = Options { budget, temp_dir, ..options(Leaves::Level(0), Order::Chunked) };
    let many = Set { points: integer_points(20_000, 1, 1000), ..set };
    let error = run(&Memory::new(&many), &nowhere, &mut (), &mut Vec::new()).expect_err("no folder");
    assert_eq!(error.kind(), ErrorKind::Io);
    assert!(error.to_string().contains("/nonexistent/folder"), "{error}");
}

/// Points as text, in an order without coherence, and more than the smallest memory holds.
fn incoherent_text() -> String {
    integer_points(40_000, 8, 1_000_000).iter().map(|[x, y, z]| format!("{x}.5 {y} {z}\n")).collect()
}

#[test]
fn the_tool_writes_a_whole_file_and_nothing_when_the_disk_is_full() {
    let folder = tempfile::tempdir().expect("a folder");
    let (input, output) = (folder.path().join("points.xyz"), folder.path().join("points.spm"));
    std::fs::write(&input, incoherent_text()).expect("written");
    let run = |limit: &str| {
        // With the signal ignored, a write beyond the limit fails as on a full disk.
        let script = format!("trap '' XFSZ; {limit} exec \"$0\" \"$@\"");
        let mut command = std::process::Command::new("sh");
        command.args(["-c", &script, env!("CARGO_BIN_EXE_spfinalize")]).arg(&input);
        command.arg("-o").arg(&output).arg("--temp-dir").arg(folder.path());
        command.args(["--threads", "1", "--memory", &Budget::process_min(1).to_string()]);
        command.output().expect("sh runs")
    };
    let full = run("ulimit -f 64;");
    let message = String::from_utf8_lossy(&full.stderr).into_owned();
    assert_eq!(full.status.code(), Some(1), "{message}");
    assert!(message.contains("temporary file in") && message.contains("too large"), "{message}");
    assert_eq!(std::fs::read_dir(folder.path()).expect("the folder").count(), 1, "nothing is left behind");
    let done = run("");
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    assert!(String::from_utf8_lossy(&done.stderr).contains("waited in a temporary file"));
    let decoded = decode(&std::fs::read(&output).expect("the output"));
    assert_eq!(decoded.points.len(), 40_000);
}

#[test]
fn threads_show_neither_in_the_result_nor_beyond_the_budget() {
    let tile = sample("lareunion.laz");
    let reference = run_tool("spfinalize", &["--threads", "1", &tile], &[]).stdout;
    assert_eq!(decode(&reference).points.len(), 59_712);
    for threads in [2, 7] {
        let stream = run_tool("spfinalize", &["--threads", &threads.to_string(), &tile], &[]).stdout;
        assert!(stream == reference, "{threads} threads");
        assert!(Budget::process_min(threads) > Budget::process_min(threads - 1));
        let memory = Budget::process_min(threads - 1).to_string();
        let arguments = ["--threads", &threads.to_string(), "--memory", &memory, &tile];
        let (code, message) = outcome(&run_tool("spfinalize", &arguments, &[]));
        assert_eq!(code, Some(5), "{message}");
        assert!(message.contains(&format!("with {threads} threads")), "{message}");
    }
}

#[test]
fn the_tool_tells_its_figures_to_people() {
    let output = run_tool("spfinalize", &["--stats", "-"], b"1 2 3\n4 5 6\n");
    let figures = String::from_utf8(output.stderr).expect("text");
    assert!(figures.contains("time of pass count  ") && !figures.contains('"'), "{figures}");
}

#[test]
fn the_tool_tells_its_figures_to_machines() {
    let folder = tempfile::tempdir().expect("a folder");
    let input = folder.path().join("points.xyz");
    std::fs::write(&input, "1 2 3\n4 5 6\n1 5 6\n").expect("written");
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_spfinalize"))
        .args(["--stats", "json", "--quiet", "--level", "1"])
        .arg(&input)
        .output()
        .expect("runs");
    assert_eq!(output.status.code(), Some(0));
    let figures: serde_json::Value = serde_json::from_slice(&output.stderr).expect("one JSON object");
    assert_eq!(figures["points"], 3);
    assert_eq!(figures["cells"]["occupied"], 3);
    assert_eq!(decode(&output.stdout).points.len(), 3);
}

#[test]
fn fill_values_are_told() {
    let text = "0 0 1\n1 0 2\n0 1 -9999\n1 1 3\n2 2 -9999\n";
    let told = |arguments: &[&str], text: &str| {
        let (code, message) = outcome(&run_tool("spfinalize", arguments, text.as_bytes()));
        assert_eq!(code, Some(0), "{message}");
        message
    };
    let expected =
        "2 points have z = -9999, far from all others (1 to 3): if that stands for no value, drop them";
    for arguments in
        [&["-"][..], &["--scale", "0.01,0.01,0.01", "-"], &["--level", "3", "-"], &["--octree", "-"]]
    {
        assert!(told(arguments, text).contains(expected), "{arguments:?}");
    }
    let great = told(&["-"], &format!("{text}3 3 9.96921e+36\n"));
    assert!(great.contains("2 points have z = -9999, 1 point has z = 9.96921e36, far"), "{great}");
    for (arguments, text) in
        [(&["--keep-z", "1,3", "-"][..], text), (&["-q", "-"], text), (&["-"], "0 0\n1 -9999\n")]
    {
        assert!(!told(arguments, text).contains("far from"), "{arguments:?}");
    }
}
