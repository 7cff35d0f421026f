//! Lines in pipes: the same mesh by all ways.

use super::{audit, mesh, output};
use crate::programs::{Folder, sample};
use spmesh_core::random::Random;

const TILE: &str = "lareunion.laz";

/// Lines across the tile that cross each other, as text: some with elevations, some without.
fn lines(count: usize, seed: u64) -> Vec<String> {
    let info = String::from_utf8(output("spinfo", &["--json", "-"], &points(&[]))).unwrap();
    let info: serde_json::Value = serde_json::from_str(&info).unwrap();
    let bounds = |end: &str, axis: usize| info["bounds"][end][axis].as_f64().unwrap();
    let mut random = Random::new(seed);
    let mut place = |from: f64, to: f64| {
        let mut at = |axis: usize| {
            let [min, max] = [bounds("min", axis), bounds("max", axis)];
            min + (max - min) * (from + (to - from) * random.unit())
        };
        format!("{:.3} {:.3}", at(0), at(1))
    };
    (0..count)
        .map(|number| {
            let vertices: Vec<String> = (0..4).map(|_| place(0.1, 0.9)).collect();
            if number % 2 == 0 {
                vertices.iter().fold("line".to_string(), |line, at| format!("{line} {at} {}", 900 + number))
            } else {
                format!("soft {}", vertices.join(" "))
            }
        })
        .collect()
}

fn points(arguments: &[&str]) -> Vec<u8> {
    output("spfinalize", &[&[&sample(TILE)[..]], arguments].concat(), &[])
}

fn triangulated(points: &[u8]) -> Vec<u8> {
    output("spdelaunay2d", &[], points)
}

#[test]
fn vertices_among_the_points_give_the_same_mesh() {
    let folder = Folder::new();
    folder.file("lines.txt", lines(12, 1).join("\n"));
    let path = folder.path("lines.txt");
    let later = output("spconstrain", &["--lines", &path], &triangulated(&points(&[])));
    let before = output("spconstrain", &["--lines", &path], &triangulated(&points(&["--lines", &path])));
    audit(&later);
    audit(&before);
    let [later, before] = [later, before].map(|stream| mesh(&stream));
    assert!(later.constrained.len() > 100);
    assert_eq!(later.triangles, before.triangles);
    assert_eq!(later.constrained, before.constrained);
    assert_eq!(later.elevations, before.elevations);
}

#[test]
fn neither_the_order_of_lines_nor_their_directions_count() {
    let folder = Folder::new();
    let mut lines = lines(12, 2);
    let run = |lines: &[String]| {
        folder.file("lines.txt", lines.join("\n"));
        mesh(&output("spconstrain", &["--lines", &folder.path("lines.txt")], &triangulated(&points(&[]))))
    };
    let expected = run(&lines);
    lines.reverse();
    for line in &mut lines {
        let words: Vec<&str> = line.split(' ').collect();
        let size = if words[0] == "line" { 3 } else { 2 };
        let reversed: Vec<String> = words[1..].chunks(size).rev().map(|at| at.join(" ")).collect();
        *line = format!("{} {}", words[0], reversed.join(" "));
    }
    let found = run(&lines);
    assert_eq!(found.triangles, expected.triangles);
    assert_eq!(found.elevations, expected.elevations);
}

#[test]
fn tiles_and_levels_give_the_same_mesh() {
    let folder = Folder::new();
    folder.file("lines.txt", lines(10, 3).join("\n"));
    let path = folder.path("lines.txt");
    let points = points(&["--lines", &path, "--level", "3"]);
    let whole = output("spconstrain", &["--lines", &path], &triangulated(&points));
    let parts: Vec<String> = ["0/0", "1/0", "0/1", "1/1"]
        .iter()
        .map(|cell| {
            let name = format!("{}.spm", cell.replace('/', "-"));
            let partial = ["--partial", "--cell", &format!("1/{cell}")];
            folder.file(&name, output("spdelaunay2d", &partial, &points));
            folder.path(&name)
        })
        .collect();
    let parts: Vec<&str> = ["--merge"].into_iter().chain(parts.iter().map(|part| &part[..])).collect();
    let merged = output("spdelaunay2d", &parts, &[]);
    let merged = output("spconstrain", &["--lines", &path], &merged);
    audit(&merged);
    let [whole, merged] = [whole, merged].map(|stream| mesh(&stream));
    assert_eq!(whole.triangles, merged.triangles);
    assert_eq!(whole.elevations, merged.elevations);
}

#[test]
fn compressed_meshes_are_read_and_written() {
    let folder = Folder::new();
    folder.file("lines.txt", lines(4, 4).join("\n"));
    let path = folder.path("lines.txt");
    let points = points(&[]);
    let plain = output("spconstrain", &["--lines", &path], &triangulated(&points));
    let compressed = output("spdelaunay2d", &["--compress"], &points);
    let compressed = output("spconstrain", &["--compress", "--lines", &path], &compressed);
    assert!(compressed.len() < plain.len() / 2);
    assert_eq!(mesh(&compressed).triangles, mesh(&plain).triangles);
}

#[test]
fn the_surface_along_a_hard_line_is_the_line() {
    // Between points, and through points.
    along_line(0.0);
    along_line(0.5);
}

/// Checks the elevations of cells whose centres are on a line, among points that are moved from the corners of
/// cells.
fn along_line(moved: f64) {
    let folder = Folder::new();
    let point = |x: u32, y: u32| {
        let [east, north] = [x, y].map(|place| f64::from(place) + moved);
        format!("{east} {north} {}\n", x * y % 7)
    };
    let points: String = (0..40).flat_map(|x| (0..40).map(move |y| point(x, y))).collect();
    folder.file("points.txt", points);
    folder.file("lines.txt", "line 3.5 3.5 100 35.5 19.5 140\n");
    let [points, lines] = ["points.txt", "lines.txt"].map(|name| folder.path(name));
    let points = output("spfinalize", &[&points, "--lines", &lines], &[]);
    let mesh = output("spconstrain", &["--lines", &lines], &triangulated(&points));
    audit(&mesh);
    let raster = ["--step", "1", "--bounds", "0,0,40,40", "-o", "-", "--format", "asc"];
    let raster = String::from_utf8(output("spdem", &raster, &mesh)).unwrap();
    let rows: Vec<Vec<f64>> = raster
        .lines()
        .filter(|line| !line.starts_with(|first: char| first.is_ascii_alphabetic()))
        .map(|line| line.split_whitespace().map(|value| value.parse().unwrap()).collect())
        .collect();
    // Centres of cells are at halves, and the line passes through every second one.
    for step in 0..=16 {
        let (column, row) = (3 + 2 * step, 3 + step);
        let expected = 100.0 + 40.0 * step as f64 / 16.0;
        assert!((rows[39 - row][column] - expected).abs() < 1e-4, "{step}: {}", rows[39 - row][column]);
    }
}

#[test]
fn segments_that_leave_the_mesh_are_named() {
    let folder = Folder::new();
    folder.file("points.txt", "0 0 0\n100 0 0\n0 100 0\n100 100 5\n40 60 1\n");
    folder.file("lines.txt", "soft -50 50 150 50\nline 40 60 3 300 61 4\nline -10 -10 3 -20 -20 4\n");
    let points = output("spfinalize", &[&folder.path("points.txt")], &[]);
    let mesh = triangulated(&points);
    let run = crate::programs::run("spconstrain", &["--lines", &folder.path("lines.txt")], &mesh);
    let (code, message) = crate::programs::outcome(&run);
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("3 of 3 segments leave the mesh"), "{message}");
    audit(&run.stdout);
}
