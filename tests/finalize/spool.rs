//! Spooling points for later passes does not change the result, and a run that can do without a spool does
//! not fail with it.

use std::process::{Command, Output};

use spmesh_base::error::ErrorKind;
use spmesh_pipeline::finalize::{Options, Order, Spooling, run};

use super::*;

fn spooled(spooling: Spooling, leaves: Leaves) -> Options {
    Options { spooling, ..options(leaves, Order::Chunked) }
}

#[test]
fn spools_save_passes_over_the_input_and_do_not_show_in_the_result() {
    for set in sets() {
        for is_costly in [false, true] {
            let result = |spooling| {
                let input = Memory { is_costly, ..Memory::new(&set) };
                let mut stream = Vec::new();
                let stats =
                    run(&input, &spooled(spooling, collapsed(100)), &mut (), &mut stream).expect("works");
                (stream, stats, input.passes.get())
            };
            let (expected, never, _) = result(Spooling::Never);
            assert_eq!((never.spooled_points, never.spooled_bytes), (0, 0));
            let (stream, always, passes) = result(Spooling::Always);
            assert!(stream == expected, "{}: spooling shows in the result", set.name);
            assert_eq!((passes, always.spooled_points), (1, set.points.len() as u64), "{}", set.name);
            assert_eq!(always.passes.len(), never.passes.len());
            let (stream, _, passes) = result(Spooling::Auto);
            assert!(stream == expected, "{}: spooling shows in the result", set.name);
            assert!(is_costly || passes == never.passes.len() as u32, "{}", set.name);
        }
    }
}

#[test]
fn automatic_spools_do_without_where_there_is_no_folder() {
    let set = set("random", 2, GRID, integer_points(3000, 1, 100_000));
    let temp_dir = Some("/nonexistent/folder".into());
    let mut notices = Notices::default();
    let mut stream = Vec::new();
    let input = Memory { is_costly: true, ..Memory::new(&set) };
    let auto = Options { temp_dir: temp_dir.clone(), ..spooled(Spooling::Auto, collapsed(100)) };
    run(&input, &auto, &mut notices, &mut stream).expect("works without");
    assert!(
        notices.0[0].contains("/nonexistent/folder") && notices.0[0].contains("again"),
        "{:?}",
        notices.0
    );
    assert!(stream == finalize(&set, &spooled(Spooling::Never, collapsed(100))).0);
    let always = Options { temp_dir, ..spooled(Spooling::Always, collapsed(100)) };
    let error = run(&input, &always, &mut (), &mut Vec::new()).expect_err("no folder");
    assert_eq!(error.kind(), ErrorKind::Io);
    assert!(error.to_string().contains("/nonexistent/folder"), "{error}");
}

/// Runs the tool with files that cannot grow beyond `blocks` of 512 bytes, as on a full disk.
fn run_limited(arguments: &[&str], blocks: &str) -> Output {
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\" | cat");
    let script = format!("set -o pipefail; {script}");
    let mut command = Command::new("bash");
    command.args(["-c", &script, env!("CARGO_BIN_EXE_spfinalize")]).args(arguments);
    command.output().expect("bash runs")
}

#[test]
fn a_full_disk_fails_a_spool_that_must_be_and_no_other() {
    let tile = sample("lareunion.laz");
    let folder = tempfile::tempdir().expect("a folder");
    let name = folder.path().to_str().expect("a name in UTF-8");
    let reference = run_tool("spfinalize", &["--spool", "never", &tile], &[]).stdout;
    let arguments = |rule| ["--temp-dir", name, "--spool", rule, tile.as_str()];
    for rule in ["auto", "always"] {
        let done = run_tool("spfinalize", &arguments(rule), &[]);
        assert!(done.status.success() && done.stdout == reference, "{rule}: {:?}", outcome(&done));
    }
    let auto = run_limited(&arguments("auto"), "16");
    let (code, message) = outcome(&auto);
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("decoding the input again"), "{message}");
    assert!(auto.stdout == reference);
    let (code, message) = outcome(&run_limited(&arguments("always"), "16"));
    assert_eq!(code, Some(1), "{message}");
    assert!(message.contains(name) && message.contains("keeping decoded points"), "{message}");
    assert_eq!(std::fs::read_dir(folder.path()).expect("the folder").count(), 0, "nothing is left behind");
}

#[test]
fn figures_tell_what_was_spooled() {
    let tile = sample("lareunion.laz");
    for (rule, points) in [("always", 59_712), ("never", 0)] {
        let arguments = ["--stats", "json", "--quiet", "--spool", rule, &tile];
        let output = run_tool("spfinalize", &arguments, &[]);
        let figures: serde_json::Value = serde_json::from_slice(&output.stderr).expect("one JSON object");
        assert_eq!(figures["spooled"]["points"], points);
        assert!(figures["spooled"]["bytes"].as_u64() >= Some(12 * points));
    }
}
