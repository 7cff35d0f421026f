//! Databases with code, and shapes that multiply what is made of them.

use super::cases::{Case, accepted, malformed};

/// Views and generated columns are code that SQLite runs; they were made with its shell.
pub fn databases() -> Vec<Case> {
    const LINES: &str = "spconstrain --lines IN.gpkg MESH -o OUT.spm";
    let steps = "far more steps";
    vec![
        malformed("a view without end", LINES, *include_bytes!("geopackages/endless-view.gpkg"), steps),
        malformed(
            "a view that joins a table with itself",
            LINES,
            *include_bytes!("geopackages/joined-view.gpkg"),
            steps,
        ),
        malformed(
            "a column that is generated",
            LINES,
            *include_bytes!("geopackages/generated-column.gpkg"),
            "\"level\" of \"paths\" is computed",
        ),
        accepted("a column whose name is no text", LINES, *include_bytes!("geopackages/name-no-text.gpkg")),
    ]
}

/// A lake that is far longer than the points are apart.
pub fn shores() -> Vec<Case> {
    let lake = r#"{"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates":
        [[[1, 1], [1e7, 1], [1e7, 8], [2, 6], [1, 1]]]}}"#;
    vec![accepted("a lake without end", "spfinalize --flatten IN.geojson POINTS -o OUT.spm", lake)]
}
