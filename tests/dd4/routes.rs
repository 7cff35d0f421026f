//! `dd4 --route`: the same diagram by another route, in builds with experiments (`tests/experiments`).

use crate::programs::{outcome, run};

#[test]
fn a_build_without_experiments_says_how_to_get_them() {
    let (code, message) = outcome(&run("dd4", &["--grid", "2x2x2x2", "--route", "direct"], &[]));
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("--features experiments"), "{message}");
}
