//! The Python of `scripts/bench` that calculates ratios and measures programs.

use crate::vectors::run_python;

#[test]
fn benchmarks_calculate_and_measure_as_they_say() {
    let Some(output) = run_python("tests/benchmark/run.py", &[], &[]) else { return };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}
