//! Hostile inputs of at most 16 kB: no program takes more than 64 MB beyond its start, or longer than a
//! second, whatever sizes they state, however deep they are, and however much they expand.
//! `configgen` is the exception: data that expands 100-fold may be as many copies of a knot.
//!
//! This is a program of its own, because the peak of a child process is never less than what its parent had.

mod bombs;
mod budgets;
mod cases;
mod code;
mod headers;
#[path = "../sources/las_file.rs"]
#[allow(dead_code, reason = "other test programs use more of it")]
mod las_file;
mod measured;
mod nested;

use cases::Case;
use measured::{Measured, slowness, tool};

/// Most bytes of an input.
const INPUT_MAX: usize = 16 << 10;

/// Most memory beyond the start of a program. Units: MB.
const MEMORY_MAX: f64 = 64.0;

/// What programs take at their start, at most. The measurement counts what this process has, too. Units: MB.
const START_MAX: f64 = 12.0;

/// Most processor time on an idle machine. Units: seconds. In a release, a case takes a second at most;
/// programs of tests are slower.
const SECONDS_MAX: f64 = 5.0;

/// Runs the cases, and says what is wrong with all of them.
fn check(cases: Vec<Case>) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut faults = Vec::new();
    for case in cases {
        assert!(case.bytes.len() <= INPUT_MAX, "{}: {} bytes", case.name, case.bytes.len());
        let start = Measured::of(tool(&case.words()[0]).arg("--version")).megabytes.min(START_MAX);
        let found = case.run(folder.path());
        let (memory, seconds) = (found.megabytes - start, found.seconds);
        let outcome = format!(
            "{}: code {:?}, {memory:.1} MB, {seconds:.2} s, {}",
            case.name,
            found.code,
            found.message.trim().chars().take(200).collect::<String>()
        );
        println!("{outcome}");
        let is_right = found.code == Some(case.code) && found.message.contains(case.part);
        let is_slow = seconds > SECONDS_MAX && seconds > SECONDS_MAX * slowness();
        if !is_right || memory > case.memory_max || is_slow {
            faults.push(outcome);
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn what_expands_stays_in_bounds() {
    check(bombs::streamed());
}

/// Programs that hold atoms or lines refuse data that expands as records which differ do not, and take what
/// is left.
#[test]
fn what_is_held_is_plausible() {
    check(bombs::held());
    check(bombs::shared());
}

#[test]
fn headers_may_state_anything() {
    check(headers::points());
    check(headers::meshes());
    check(headers::volumes());
}

#[test]
fn what_is_nested_stays_in_bounds() {
    check(nested::cases());
}

#[test]
fn what_multiplies_stays_in_bounds() {
    check(nested::products());
}

#[test]
fn what_is_code_stays_in_bounds() {
    check(code::databases());
    check(code::shores());
}

/// The measurement sees memory and time that are really used.
#[test]
fn a_greedy_program_is_seen() {
    let text =
        r#"i=0; while [ $i -lt 200000 ]; do i=$((i+1)); done; x=$(head -c 90000000 /dev/zero | tr '\0' a)"#;
    let mut greedy = std::process::Command::new("sh");
    greedy.args(["-c", text]);
    let found = Measured::of(&mut greedy);
    assert!(found.megabytes > 64.0 && found.seconds > 0.02, "{found:?}");
}
