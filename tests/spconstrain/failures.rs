//! What is refused, and how it is said.

use super::output;
use crate::programs::{Folder, assert_damage_leaves_no_file, assert_outcome, mesh_of_cloud};

#[test]
fn wrong_uses_are_said() {
    let folder = Folder::new();
    folder.file("lines.txt", "line 1 1 0 50000 50000 9\n");
    folder.file("bad.txt", "line 1 1 nan 5 inf 2\n");
    folder.file("polygon.geojson", r#"{"type":"LineString","coordinates":[[0,0],[9,9]]}"#);
    let [lines, bad, polygon] = ["lines.txt", "bad.txt", "polygon.geojson"].map(|name| folder.path(name));
    let mesh = mesh_of_cloud(300);
    let constrained = output("spconstrain", &["--lines", &lines], &mesh);
    let points = output("spfinalize", &["-"], b"0 0 0\n1 0 0\n0 1 0\n");
    let missing = folder.path("none.txt");
    for (arguments, input, code, part) in [
        (&[][..], &mesh[..], 2, "nothing to do"),
        (&["--lines", &lines], &constrained, 2, "has lines already"),
        (&["--lines", &lines], &points, 2, "these are points: triangulate them with spdelaunay2d"),
        (&["--lines", &missing], &mesh, 1, "No such file"),
        (&["--lines", &bad], &mesh, 3, "line 1"),
        (&["--hull", &polygon], &mesh, 3, "expected polygons"),
        (&["--kill", "-1"], &mesh, 2, "--kill"),
        (&["--lines", "-"], &mesh, 2, "stdin can be one input only"),
        (&["--lines", &lines, "-o", &lines], &mesh, 2, "would replace"),
    ] {
        assert_outcome("spconstrain", arguments, input, code, part);
    }
}

#[test]
fn damaged_meshes_leave_no_file() {
    let folder = Folder::new();
    folder.file("lines.txt", "line 1 1 0 50000 50000 9\n");
    let lines = folder.path("lines.txt");
    let mesh = mesh_of_cloud(300);
    assert_damage_leaves_no_file("spconstrain", &["--lines", &lines], ["new.spm", "old.spm"], &mesh);
}
