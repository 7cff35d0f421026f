//! The output of the tools for streams of four dimensions.

use serde_json::{Value, json};

use super::four::empty;
use crate::programs::{outcome, run};
use crate::vectors::vector;
use spmesh_stream::Kind;

#[test]
fn spinfo_reports_them() {
    let output = run("spinfo", &["-"], &vector("cells4-split"));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{text}");
    let expected = [
        "stdin: cells in 4 dimensions",
        "  coordinates  4D with a value, f64",
        "  bounds       (0, 0, 0, 0) to (1, 1, 1, 1) (found, not stated)",
        "  points       6",
        "  merged       1",
        "  vertices     5",
        "  values       2 known",
        "  finite       1 cells, 1 of them simplices",
        "  infinite     5 cells",
        "  largest      5 vertices, 5 neighbours of a cell",
    ];
    for line in expected {
        assert!(text.lines().any(|found| found == line), "{line} in {text}");
    }
    assert!(!text.contains("chunked") && !text.contains("patches"), "{text}");
}

#[test]
fn spinfo_reports_them_as_json() {
    let report = |name: &str| -> Value {
        let output = run("spinfo", &["--json", "-"], &vector(name));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let cells = report("cells4-simplex");
    assert_eq!(cells["dims"], 4);
    assert_eq!(cells["bounds"], json!({"min": [0.0, 0.0, 0.0, 0.0], "max": [1.0, 1.0, 1.0, 1.0]}));
    assert_eq!((&cells["counts"]["vertices"], &cells["counts"]["cells4"]), (&json!(5), &json!(6)));
    let figures = json!({
        "values_known": 0, "finite_cells": 1, "infinite_cells": 5, "finite_simplices": 1,
        "cell_vertices_max": 5, "cell_neighbours_max": 5,
    });
    assert_eq!(cells["four_dimensions"], figures);
    assert_eq!(report("simplices4")["counts"]["simplices"], 2);
    assert_eq!(report("points4-values")["four_dimensions"]["values_known"], 2);
    assert_eq!(report("points-i32-3d")["four_dimensions"], Value::Null);
}

#[test]
fn tools_of_fewer_dimensions_refuse_them() {
    for kind in [Kind::Points4, Kind::Cells4, Kind::Simplices4] {
        for arguments in [
            &["spfinalize", "-"][..],
            &["spfinalize", "--octree", "-"],
            &["spdelaunay2d", "-"],
            &["spdelaunay2d", "--merge", "-"],
            &["tess3", "-"],
            &["spconvert", "--to", "vtu", "-"],
            &["spinfo", "--audit", "--points", "-", "-"],
            &["spinfo", "--audit", "--count-violations", "-"],
        ] {
            let (code, message) = outcome(&run(arguments[0], &arguments[1..], &empty(kind)));
            assert_eq!(code, Some(2), "{arguments:?}: {message}");
            assert!(message.contains(kind.name()), "{arguments:?}: {message}");
        }
    }
}
