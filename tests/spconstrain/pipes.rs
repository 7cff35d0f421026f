//! Lines in pipes: the same mesh by all ways.

use super::{audit, mesh, output};
use crate::programs::{Folder, sample};
use spmesh_base::random::Random;

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

/// Checks the elevations of cells whose centres are on a line, among points that are moved from the corners
/// of cells.
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

/// Elevations of points of a grid of 11 by 11 after lines, at 20 before. `unit` is the distance of points.
fn elevations(unit: &str, lines: &str, flags: [&[&str]; 2], places: &[[u32; 2]]) -> Vec<f64> {
    let folder = Folder::new();
    let unit: f64 = unit.parse().unwrap();
    let name = |[x, y]: [u32; 2]| format!("{} {}", f64::from(x) * unit, f64::from(y) * unit);
    let grid = (0..11).flat_map(|x| (0..11).map(move |y| [x, y]));
    folder.file("points.txt", grid.map(|place| name(place) + " 20\n").collect::<String>());
    folder.file("lines.txt", lines);
    let [points, lines] = ["points.txt", "lines.txt"].map(|name| folder.path(name));
    let both = [&["--lines", &lines], flags[1]].concat();
    let points = output("spfinalize", &[&[&points[..]], flags[0], &both].concat(), &[]);
    let mesh = output("spconstrain", &both, &triangulated(&points));
    audit(&mesh);
    let text = String::from_utf8(output("spconvert", &["--to", "text"], &mesh)).unwrap();
    let rows: Vec<[f64; 3]> = text
        .lines()
        .filter_map(|line| line.strip_prefix("v "))
        .map(|line| line.split(' ').take(3).map(|word| word.parse().unwrap()).collect::<Vec<f64>>())
        .map(|row| [row[0], row[1], row[2]])
        .collect();
    let z_of = |&[x, y]: &[u32; 2]| {
        let [x, y] = [x, y].map(|c| f64::from(c) * unit);
        let row = rows.iter().find(|row| (row[0] - x).abs() < 1e-9 && (row[1] - y).abs() < 1e-9);
        (row.unwrap_or_else(|| panic!("no vertex at {x} {y}: {text}"))[2] * 1e6).round() / 1e6
    };
    places.iter().map(z_of).collect()
}

#[test]
fn lines_without_elevations_leave_points_alone() {
    // Between crossings with hard lines, too, and up to an end without an elevation.
    let lines = "line 2 0 100 2 10 100\nline 8 0 300 8 10 300\nsoft 0 5 10 5\n";
    let on_soft = [[3, 5], [5, 5], [7, 5]];
    let lines_to_nan = "line 2 0 100 2 10 nan\nline 0 8 300 9 8 300\n";
    for scale in [&[][..], &["--scale", "0.1,0.1,0.1"]] {
        assert_eq!(elevations("1", lines, [scale, &[]], &on_soft), [20.0; 3]);
        assert_eq!(
            elevations("1", lines_to_nan, [scale, &[]], &[[2, 1], [2, 5], [2, 7], [4, 8]])[..3],
            [20.0; 3]
        );
    }
}

#[test]
fn points_on_lines_take_their_elevation_in_spite_of_rounding() {
    // Decimals that f64 does not represent.
    let lines = "line 0.1 0.1 100 0.7 0.4 160\nline 0.1 0.9 300 0.9 0.5 300\n";
    let places = [[3, 2], [5, 3], [3, 8], [5, 7], [7, 6], [4, 4]];
    let expected = [120.0, 140.0, 300.0, 300.0, 300.0, 20.0];
    for scale in [&[][..], &["--scale", "0.1,0.1,0.01"]] {
        assert_eq!(elevations("0.1", lines, [scale, &[]], &places), expected);
    }
    // Crossings and divided parts are rounded, and bend the line.
    let places = [[2, 2], [4, 3], [6, 4], [8, 5], [8, 6]];
    let expected = [100.0, 100.0, 100.0, 100.0, 20.0];
    let scale = &["--scale", "0.01,0.01,0.01"][..];
    for scale in [&[][..], scale] {
        let crossed = "line 0 1 100 10 6 100\nsoft 1 6 8 1\n";
        assert_eq!(elevations("1", crossed, [scale, &[]], &places), expected);
        for densify in ["0.7", "3"] {
            let line = "line 0 1 100 10 6 100\n";
            assert_eq!(elevations("1", line, [scale, &["--densify", densify]], &places), expected);
        }
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

#[test]
fn lines_end_at_the_border_of_the_mesh() {
    let folder = Folder::new();
    let points = "0 10 10\n100 0 0\n0 90 20\n110 100 5\n40 60 1\n60 30 7\n";
    folder.file("points.txt", points);
    // Into the mesh, across it, and along a row; the last one has elevations.
    folder.file("lines.txt", "soft 50 50 150 55\nsoft -50 21 150 37\nline 20 70 3 -80 70 103\n");
    let scale = ["--scale", "0.01,0.01,0.01"];
    for scale in [&[][..], &scale] {
        let points = output("spfinalize", &[scale, &[&folder.path("points.txt")]].concat(), &[]);
        let run = crate::programs::run(
            "spconstrain",
            &["--lines", &folder.path("lines.txt")],
            &triangulated(&points),
        );
        let (code, message) = crate::programs::outcome(&run);
        assert_eq!(code, Some(0), "{message}");
        assert!(message.contains("; 4 new vertices end them at its border"), "{message}");
        audit(&run.stdout);
        let edges = String::from_utf8(output("spconvert", &["--to", "geojson", "-"], &run.stdout)).unwrap();
        let edges: serde_json::Value = serde_json::from_str(&edges).unwrap();
        let mut lengths = [0.0; 3];
        for edge in edges["features"].as_array().unwrap() {
            let at = |end: usize, axis: usize| edge["geometry"]["coordinates"][end][axis].as_f64().unwrap();
            let line = edge["properties"]["line"].as_u64().unwrap();
            lengths[line as usize] += (at(1, 0) - at(0, 0)).hypot(at(1, 1) - at(0, 1));
        }
        // Up to where the lines cross the hull, whose right side is x = 100 + y / 10, and its left one x = 0.
        let [first, second] =
            [(50.0, 0.05, 50.0), (0.0, 0.08, 25.0)].map(|(x, slope, y): (f64, f64, f64)| {
                let right = (100.0 + (y - slope * x) / 10.0) / (1.0 - slope / 10.0);
                (right - x) * slope.hypot(1.0)
            });
        for (found, expected) in lengths.iter().zip([first, second, 20.0]) {
            assert!((found - expected).abs() < 0.03, "{lengths:?}, not {expected}");
        }
        let ends = places_of(&run.stdout);
        assert!(ends.contains(&[0.0, 70.0, 23.0]), "{ends:?}");
    }
}

/// The vertices of a mesh in world coordinates.
fn places_of(stream: &[u8]) -> Vec<[f64; 3]> {
    let text = String::from_utf8(output("spconvert", &["--to", "text"], stream)).unwrap();
    let rows = text.lines().filter_map(|line| line.strip_prefix("v "));
    let row = |row: &str| {
        let mut words = row.split(' ').map(|word| word.parse().unwrap());
        std::array::from_fn(|_| words.next().unwrap())
    };
    rows.map(row).collect()
}
