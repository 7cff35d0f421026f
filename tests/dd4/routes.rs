//! `dd4 --route`: the same diagram by another route, in builds with experiments.

#[cfg(feature = "experiments")]
#[test]
fn both_routes_find_the_same_cells() {
    for sample in ["0.3", "1"] {
        let arguments = ["--grid", "5x4x3x3", "--sample", sample];
        let [simplices, direct] = ["simplices", "direct"]
            .map(|route| super::diagram(&[&arguments[..], &["--route", route]].concat(), &[]));
        assert!(simplices == direct, "sample {sample}");
    }
}

#[cfg(not(feature = "experiments"))]
#[test]
fn a_build_without_experiments_says_how_to_get_them() {
    use crate::programs::{outcome, run};

    let (code, message) = outcome(&run("dd4", &["--grid", "2x2x2x2", "--route", "direct"], &[]));
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("--features experiments"), "{message}");
}
