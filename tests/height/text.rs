//! Lines of text, and streams, with heights.

use std::collections::HashMap;

use spmesh_stream::{Event, StreamReader};

use super::{Parts, heights_in, mesh_of, scattered};
use crate::programs::{Folder, outcome, run};

/// Runs the program on a text, in a folder with a ground; returns the lines that it writes.
fn lines(folder: &Folder, text: &str, flags: &[&str]) -> String {
    let (input, out) = (folder.write("points.txt", text), folder.path("out.txt"));
    let ground = folder.path("ground.spm");
    let arguments = [&["--ground", &ground, &input, "-o", &out], flags].concat();
    let found = outcome(&run("spheight", &arguments, &[]));
    assert_eq!(found.0, Some(0), "{found:?}");
    std::fs::read_to_string(out).unwrap()
}

/// Heights of text equal those of a LAS file of the same points, but for rounding.
#[test]
fn heights_are_those_of_las_files() {
    let folder = Folder::new();
    let (ground, points) = (scattered(300, 1000, 4), scattered(500, 1100, 5));
    let expected = Parts::of(&heights_in(&folder, &mesh_of(&ground.bytes()), &points.bytes(), "h.las", &[]));
    let world = |[x, y, z]: [i32; 3]| [x, y, z].map(|stored| f64::from(stored) * 0.01);
    let text: String =
        expected.points().into_iter().map(world).map(|[x, y, z]| format!("{x:.2},{y:.2},{z:.2}\n")).collect();
    let found = lines(&folder, &text, &[]);
    let mut without = 0;
    for ((before, after), height) in text.lines().zip(found.lines()).zip(expected.heights()) {
        let (kept, found) = after.rsplit_once(',').unwrap();
        assert_eq!(kept, before);
        let found: f64 = found.parse().unwrap();
        without += u32::from(found.is_nan());
        assert_eq!(found.is_nan(), height == i32::MIN, "{after}");
        assert!(found.is_nan() || (found - 0.01 * f64::from(height)).abs() < 0.0056, "{after}: {height}");
    }
    assert!(without > 0 && found.lines().count() == 500);
}

/// A stream gets one more attribute of the same heights.
#[test]
fn heights_of_streams_are_those_of_text() {
    let folder = Folder::new();
    let (ground, points) = (scattered(300, 1000, 4), scattered(500, 1100, 5));
    let expected = Parts::of(&heights_in(&folder, &mesh_of(&ground.bytes()), &points.bytes(), "h.las", &[]));
    let expected: HashMap<[i32; 3], i32> = expected.points().into_iter().zip(expected.heights()).collect();
    let stream = folder.write("points.spm", run("spfinalize", &["-q", "-"], &points.bytes()).stdout);
    let (ground, out) = (folder.path("ground.spm"), folder.path("heights.spm"));
    let done = run("spheight", &["--ground", &ground, &stream, "-o", &out], &[]);
    assert!(done.status.success(), "{:?}", outcome(&done));
    let bytes = std::fs::read(&out).unwrap();
    let mut reader = StreamReader::new(&bytes[..], "heights").unwrap();
    let attribute = reader.header().attributes.iter().next().unwrap().clone();
    assert_eq!(attribute.name, "HeightAboveGround");
    let [mut found, mut without] = [0, 0];
    while let Some(event) = reader.next_event().unwrap() {
        let Event::Points(points) = event else { continue };
        for (point, row) in points.iter().zip(reader.rows().chunks_exact(8)) {
            let height = expected[&point.map(|value| value as i32)];
            let stored = attribute.value(row);
            assert_eq!(stored.is_none(), height == i32::MIN);
            assert!(stored.is_none_or(|value| (value - 0.01 * f64::from(height)).abs() < 0.0051));
            without += u32::from(stored.is_none());
            found += 1;
        }
    }
    assert!(found == 500 && without > 0);
    let (code, message) =
        outcome(&run("spheight", &["--ground", &ground, &stream, "-o", &out, "--replace-z"], &[]));
    assert!(code == Some(2) && message.contains("--replace-z"), "{message}");
}

#[test]
fn all_else_in_a_text_stays() {
    let folder = Folder::new();
    // A plane at 10.
    folder.write("plane.xyz", "0 0 10\n9 0 10\n0 9 10\n9 9 10\n");
    let stream = run("spfinalize", &["-q", &folder.path("plane.xyz")], &[]);
    folder.file("ground.spm", run("spdelaunay2d", &["-q"], &stream.stdout).stdout);
    for (text, flags, expected) in [
        ("1 1 12.5\n", &[][..], "1 1 12.5 2.500\n"),
        (
            "x;y;z;c\r\n1;1;9;tree\r\n99;1;9;\r\n",
            &[],
            "x;y;z;c;HeightAboveGround\r\n1;1;9;tree;-1.000\r\n99;1;9;;NaN\r\n",
        ),
        (
            "# id\tx\ty\tz\n7\t1\t1\t10.12345\n",
            &["--name", "up"],
            "# id\tx\ty\tz\tup\n7\t1\t1\t10.12345\t0.12345\n",
        ),
        ("// note\n\n 1 1 10 # oak \n2 2 10", &[], "// note\n\n 1 1 10 0.000 # oak \n2 2 10 0.000"),
        ("title, x\n1,2,5,5\n", &["--skip-lines", "1", "--columns", "3,4,2"], "title, x\n1,2,5,5,-8.000\n"),
    ] {
        assert_eq!(lines(&folder, text, flags), expected, "{text:?}");
    }
    let (ground, out) = (folder.path("ground.spm"), folder.path("out.txt"));
    std::fs::remove_file(&out).unwrap();
    for (text, flags, code, part) in [
        ("1 1 1\n", &["--replace-z"][..], 2, "leave out --replace-z"),
        ("1 1 1\n", &["--format", "laz"], 2, "text stays text"),
        ("1 1\n", &[], 2, "no elevation"),
        ("1 1 1\n2 nan 3\n", &[], 3, "line 2"),
        ("1 1 1\n2 3\n", &[], 3, "line 2"),
        ("1 1 1\n", &["--crs", "EPSG:none"], 2, "EPSG"),
    ] {
        let input = folder.write("points.txt", text);
        let arguments = [&["--ground", &ground, &input, "-o", &out], flags].concat();
        let (found, message) = outcome(&run("spheight", &arguments, &[]));
        assert!(found == Some(code) && message.contains(part), "{text:?}: {message}");
        assert!(!std::path::Path::new(&out).exists());
    }
}
