//! `dd4 --route`: the same diagram by another route.

use super::diagram;

#[test]
fn both_routes_find_the_same_cells() {
    for sample in ["0.3", "1"] {
        let arguments = ["--grid", "5x4x3x3", "--sample", sample];
        let [simplices, direct] = ["simplices", "direct"]
            .map(|route| diagram(&[&arguments[..], &["--route", route]].concat(), &[]));
        assert!(simplices == direct, "sample {sample}");
    }
}
