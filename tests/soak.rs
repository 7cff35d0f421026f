//! The Python of `scripts/soak` that runs pipelines for hours and looks for leaks.

use crate::vectors::run_python;

#[test]
fn planted_faults_and_leaks_are_reported() {
    let Some(output) = run_python("tests/soak/run.py", &[], &[]) else { return };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}
