//! What is refused, and how it is said.

use super::{audit, mesh, output};
use crate::programs::{
    Folder, assert_damage_leaves_no_file, assert_outcome, mesh_of_cloud, outcome, run, sample,
};
use rustix::fs::Mode;
use spmesh_stream::model::bounds::Bounds;
use spmesh_stream::{Coordinates, Header, Kind, write_triangles};

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
    let ring = r#"{"type":"Polygon","coordinates":[[[0,0],[50000,0],[50000,50000]]]}"#;
    let open = folder.write("open.geojson", ring);
    for (arguments, input, code, part) in [
        (&[][..], &mesh[..], 2, "nothing to do"),
        (&["--lines", &lines], &constrained, 2, "is constrained or cut already"),
        (&["--lines", &lines], &points, 2, "these are points: triangulate them with spdelaunay2d"),
        (&["--lines", &missing], &mesh, 1, "No such file"),
        (&["--lines", &bad], &mesh, 3, "line 1"),
        (&["--hull", &polygon], &mesh, 3, "expected polygons"),
        (&["--hull", &open], &mesh, 3, "starts at 0, 0 and ends at 50000, 50000: repeat its first position"),
        (&["--holes", &open], &mesh, 3, "open.geojson: feature 0"),
        (
            &["--lines", &lines, "--densify", "1e-300"],
            &mesh,
            3,
            "(parts of at most 1e-300: divide lines less)",
        ),
        (&["--kill", "nan"], &mesh, 2, "--kill"),
        (&["--kill", "0"], &mesh, 2, "--kill"),
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

#[test]
fn triangles_that_are_not_counterclockwise_are_refused() {
    let folder = Folder::new();
    let lines = folder.write("lines.txt", "line 1 1 0 3 2 0\n");
    let grid = Coordinates::I32 { scale: [1.0; 3], offset: [0.0; 3] };
    let points = [[0.0, 0.0, 1.0], [4.0, 0.0, 2.0], [4.0, 4.0, 3.0], [0.0, 4.0, 4.0], [2.0, 2.0, 5.0]];
    let bounds = Bounds::of_points(&points);
    for (triangles, message) in [
        (
            [[0, 1, 2], [0, 3, 2]],
            "corners [0.0, 0.0], [0.0, 4.0], [4.0, 4.0] (stored coordinates) is clockwise",
        ),
        ([[0, 1, 2], [0, 2, 4]], "corners [0.0, 0.0], [4.0, 4.0], [2.0, 2.0] (stored coordinates) is flat"),
    ] {
        let header = Header { bounds, ..Header::new(Kind::TriangleMesh, grid, 2, true) };
        let (mut mesh, at) = (Vec::new(), |vertex: u32| points[vertex as usize]);
        write_triangles(header, &triangles, points.len(), 0, at, &mut mesh).expect("a mesh");
        assert_outcome("spconstrain", &["--lines", &lines], &mesh, 3, message);
    }
}

#[test]
fn segments_of_meshes_without_triangles_are_no_edges() {
    let folder = Folder::new();
    let points: String = (0..30).map(|x| format!("{} 17 1\n", 3 * x)).collect();
    let lines = folder.write("lines.txt", "line 3 17 1 30 17 1\n");
    let points = output("spfinalize", &["-"], points.as_bytes());
    let triangles = output("spdelaunay2d", &[], &points);
    let run = run("spconstrain", &["--lines", &lines], &triangles);
    let (code, message) = outcome(&run);
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("1 of 1 segment leaves the mesh"), "{message}");
    audit(&run.stdout);
}

#[test]
fn hulls_beside_the_mesh_leave_nothing() {
    let folder = Folder::new();
    let ring = r#"{"type":"Polygon","coordinates":[[[-9,-9],[-8,-9],[-9,-8],[-9,-9]]]}"#;
    let hull = folder.write("hull.geojson", ring);
    let run = run("spconstrain", &["--hull", &hull], &mesh_of_cloud(300));
    let (code, message) = outcome(&run);
    assert!(code == Some(0) && message.contains("no triangles are left"), "{message}");
    audit(&run.stdout);
}

#[test]
fn greatest_lengths_remove_nothing() {
    let triangles = mesh_of_cloud(300);
    for length in ["1e308", "inf"] {
        let kept = output("spconstrain", &["--kill", length], &triangles);
        audit(&kept);
        assert_eq!(mesh(&kept).triangles, mesh(&triangles).triangles);
    }
}

#[test]
fn databases_in_pipes_are_refused() {
    let folder = Folder::new();
    let mesh = folder.write("mesh.spm", mesh_of_cloud(30));
    for (name, format) in [("lines.gpkg", "GeoPackage"), ("lines.shp", "Shapefile")] {
        let path = folder.path(&format!("pipe-{name}"));
        rustix::fs::mkfifoat(rustix::fs::CWD, &path, Mode::RUSR | Mode::WUSR).expect("a pipe");
        let bytes = std::fs::read(sample(name)).expect("a sample");
        let end = path.clone();
        let feeder = std::thread::spawn(move || drop(std::fs::write(end, bytes)));
        assert_outcome(
            "spconstrain",
            &["--lines", &path, &mesh],
            b"",
            2,
            &format!("a {format} is read from"),
        );
        feeder.join().expect("the feeder ends");
    }
}
