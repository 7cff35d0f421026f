//! The Python of `scripts/torture` that disturbs programs and judges what they do.

use crate::vectors::run_python;

#[test]
fn planted_faults_of_a_program_are_reported() {
    let Some(output) = run_python("tests/torture/run.py", &[], &[]) else { return };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}
