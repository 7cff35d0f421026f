//! Special configurations by flags: box splines on grids, corners, creases and linear elements.

use super::{counts, lines, output, plane, scattered, text, total};
use crate::programs::{Folder, outcome, run};

/// Knots on the integer grid, with third coordinates.
fn grid(columns: i64, rows: i64) -> Vec<u8> {
    let at = |site: i64| [site % columns, site / columns, 10 * (site % columns)];
    lines(&(0..columns * rows).map(at).collect::<Vec<_>>())
}

/// The output of `configgen`, after it has passed the audit.
fn audited(arguments: &[&str], input: &[u8]) -> Vec<u8> {
    let stream = output(arguments, input);
    let audit = run("spinfo", &["--audit", "-"], &stream);
    assert!(audit.status.success(), "{arguments:?}: {:?}", outcome(&audit));
    stream
}

/// The knots in the text twin of a stream.
fn knots(stream: &[u8]) -> Vec<Vec<f64>> {
    let numbers = |line: &str| line.split(' ').skip(1).map(|word| word.parse().unwrap()).collect();
    text(stream).lines().filter(|line| line.starts_with("v ")).map(numbers).collect()
}

fn functions(counts: &serde_json::Value) -> [u64; 5] {
    ["edges", "vertices", "tents", "creases", "faces"]
        .map(|kind| counts[format!("functions_{kind}")].as_u64().unwrap())
}

#[test]
fn squares_amid_squares_have_box_splines() {
    for split in ["zp", "zp:falling", "zp:upright", "zp:falling:upright"] {
        let arguments = ["--box", split, "--degree", "1"];
        let counted = counts(&arguments, &grid(8, 6));
        // Of 7 by 5 squares, 5 by 3 have no side on the border. No half function is left over: each vertical
        // or horizontal side of these belongs to two box splines.
        assert_eq!(functions(&counted)[4], 15, "{split}");
        assert_eq!(functions(&counted)[1..4], [0; 3], "{split}");
        // Pairs of knots on the diagonals of inner squares have null links.
        assert!(total(&counted, 1, "null_links") > 15, "{split}");
        for degree in ["1", "3"] {
            audited(&["--box", split, "--degree", degree], &grid(8, 6));
        }
    }
    let [rising, falling] = ["zp", "zp:falling"].map(|split| output(&["--box", split], &grid(5, 5)));
    assert_ne!(rising, falling);
}

#[test]
fn stored_grids_are_looked_at_in_their_units() {
    let input = grid(6, 6);
    let hundredths = run("spfinalize", &["--scale", "0.01,0.01,0.01", "-"], &input).stdout;
    let of = |input: &[u8]| functions(&counts(&["--box", "zp"], input));
    assert_eq!(of(&hundredths), of(&input));
}

#[test]
fn grids_that_meet_are_stitched() {
    let folder = Folder::new();
    let patches = folder.write("grids.txt", "# two\n0 0  1 0  0 1  6 5\n6 0, 1 1, 0 1, 6 5\n");
    // configgen does not read stdin.
    let counted = counts(&["--patches", &patches, "--degree", "2"], b"not a number");
    assert_eq!(counted["points"], 0);
    assert_eq!(counted["knots"], 2 * 7 * 6 - 6);
    assert_eq!(functions(&counted)[4], 2 * 4 * 3);
    let alone = knots(&audited(&["--patches", &patches, "--box", "zp:falling"], b""));
    assert_eq!(alone[1], [1.0, 0.0, 0.0]);
    let more = knots(&audited(&["--patches", &patches, "-"], b"3 9 1\n2 2 2\n4 -7 3\n"));
    assert_eq!((more.len(), &more[78], &more[79]), (80, &vec![3.0, 9.0, 0.0], &vec![4.0, -7.0, 0.0]));
}

#[test]
fn grids_that_overlap_are_refused() {
    let folder = Folder::new();
    let cases = [
        ("0 0 1 0 0 1 4 4\n2 0 1 0 0 1 4 4\n", "patches 0 and 1 overlap at (3, "),
        ("0 0 1 0 0 1 4 4\n0 0 1 0 0 1 4 4\n", "patches 0 and 1 overlap at ("),
        ("0 0 1 0 0 1 4 4\n4 4 -1 0 0 -1 4 4\n", "overlap"),
        ("0 0 1 0 0 1 4 4\n0.5 0.25 1 0 0 1 2 2\n", "patch 1: the side of a cell from ("),
    ];
    for (number, (text, part)) in cases.iter().enumerate() {
        let patches = folder.write(&format!("{number}.txt"), text);
        let (code, message) = outcome(&run("configgen", &["--patches", &patches], b""));
        assert_eq!(code, Some(2), "{text}: {message}");
        assert!(message.contains(part) && message.contains("may touch"), "{text}: {message}");
    }
}

/// Areas of the triangles of a mesh stream.
fn areas(mesh: &[u8]) -> Vec<f64> {
    let area = |t: &Vec<Vec<f64>>| {
        let (p, q) = ([t[1][0] - t[0][0], t[1][1] - t[0][1]], [t[2][0] - t[0][0], t[2][1] - t[0][1]]);
        (p[0] * q[1] - p[1] * q[0]).abs() / 2.0
    };
    plane(mesh).iter().map(area).collect()
}

#[test]
fn centroids_of_repeated_knots_are_no_flat_triangles() {
    let borders: [&[&str]; 3] =
        [&["--pull-apart", "all"], &["--boundary", "clamped"], &["--boundary", "pulled-apart"]];
    for border in borders {
        for degree in ["0", "1", "2"] {
            let arguments = [&["--centroids", "--degree", degree], border].concat();
            let mesh = output(&arguments, &grid(5, 4));
            let areas = areas(&mesh);
            assert!(areas.iter().all(|&area| area > 1e-3), "{arguments:?}");
            // The triangles form one polygon: an inner edge has two of them, an edge on the border one.
            let mut edges = std::collections::HashMap::new();
            for corners in plane(&mesh) {
                for (p, q) in [(0, 1), (1, 2), (0, 2)] {
                    let bits = |at: &[f64]| [at[0].to_bits(), at[1].to_bits()];
                    *edges.entry([bits(&corners[p]), bits(&corners[q])]).or_insert(0) += 1;
                }
            }
            assert!(edges.values().all(|&count| count <= 2), "{arguments:?}");
            let area: f64 = areas.iter().sum();
            let is_whole = degree == "0" || degree == "1" && border[1] != "clamped";
            assert!(!is_whole || (area - 12.0).abs() < 1e-9, "{arguments:?}: {area}");
        }
    }
}

#[test]
fn corners_and_linear_elements_pull_knots_apart() {
    let folder = Folder::new();
    let features = folder.write("sharp.txt", "corner 14\nlinear 21,22\n");
    let stream = audited(&["--features", &features], &grid(7, 6));
    let all = knots(&stream);
    assert_eq!(all.len(), 45);
    for (copy, id) in [(42, 14), (43, 21), (44, 22)] {
        assert_eq!(all[copy], all[id]);
    }
    let counted = counts(&["--features", &features], &grid(7, 6));
    let [_, vertices, tents, creases, faces] = functions(&counted);
    assert_eq!((vertices, creases, faces), (3, 0, 0));
    assert!(tents > 10, "{tents}");
}

#[test]
fn smooth_creases_have_knots_amid_their_edges() {
    let folder = Folder::new();
    let features = folder.write("crease.txt", "smooth-crease 16 17 25\n");
    let stored = run("spfinalize", &["--scale", "1,1,1", "-"], &grid(8, 6)).stdout;
    for input in [grid(8, 6), stored] {
        let all = knots(&audited(&["--features", &features, "--degree", "2"], &input));
        assert_eq!(all.len(), 50);
        assert_eq!(all[48..], [[0.5, 2.0, 5.0], [1.0, 2.5, 10.0]]);
        let counted = counts(&["--features", &features, "--rule", "data"], &input);
        assert_eq!(functions(&counted)[3], 2);
    }
}

#[test]
fn streams_have_the_functions() {
    let of = |arguments: &[&str]| {
        let text = text(&output(arguments, &grid(6, 5)));
        let lines = |start: &str| text.lines().filter(|line| line.starts_with(start)).count() as u64;
        ["edge", "vertex", "tent", "crease", "face"].map(|kind| lines(&format!("function {kind} ")))
    };
    for arguments in [&["--box", "zp"][..], &["--boundary", "pulled-apart"], &["--pull-apart", "7,8"]] {
        let counted = functions(&counts(arguments, &grid(6, 5)));
        assert_eq!(of(arguments), counted, "{arguments:?}");
        assert!(counted[0] > 10, "{counted:?}");
    }
    // All knots on the border and all edges between them have a tent.
    assert_eq!(of(&["--boundary", "pulled-apart"])[1], 18);
    assert_eq!((of(&[]), of(&["--boundary", "pulled-apart", "--degree", "0"])), ([0; 5], [0; 5]));
}

#[test]
fn features_go_together_with_borders() {
    let folder = Folder::new();
    let features = folder.write("crease.txt", "crease 5 9\n");
    let arguments = ["--features", &features, "--boundary", "clamped"];
    let all = knots(&audited(&arguments, &grid(4, 4)));
    assert_eq!(all.len(), 16 + 4 + 2);
}

#[test]
fn what_cannot_be_is_refused() {
    let folder = Folder::new();
    let file = |text: &str| folder.write(&format!("{}.txt", text.len()), text);
    let cases = [
        ("crease 0 2\n", "crease 0: segment from knot 0 to knot 2: knot 1 is on it"),
        (
            "crease 0 4\nlinear 1 3 2\n",
            "linear element 0: segment from knot 1 to knot 3: it crosses the one from knot 0 to knot 4",
        ),
        ("corner 9\n", "corners: unknown knot 9: there are 9"),
        ("crease 1 99\n", "crease 0: unknown knot 99: there are 9"),
        ("crease 1 1\n", "no length"),
        ("crease 1\n", "two at least"),
        ("smooth-crease 0 1\n", "on the border"),
        ("crease 1 x\n", ".txt: line 1: found \"x\""),
    ];
    for (text, part) in cases {
        let (code, message) = outcome(&run("configgen", &["--features", &file(text)], &grid(3, 3)));
        assert!(code == Some(2) || code == Some(3), "{text}: {message}");
        assert!(message.contains(part) && !message.contains("panicked"), "{text}: {message}");
    }
}

#[test]
fn flags_that_exclude_each_other_are_usage_errors() {
    let folder = Folder::new();
    let [features, patches] =
        [("f", "corner 1\n"), ("p", "0 0 1 0 0 1 3 3\n")].map(|(name, text)| folder.write(name, text));
    let [features, patches] = [&features[..], &patches];
    let cases: [(&[&str], &str); 11] = [
        (&["--box", "zp", "--features", features], "cannot be used with"),
        (&["--patches", patches, "--features", features], "cannot be used with"),
        (&["--box", "bezier"], "expected zp"),
        (&["--box", "zp", "--flip", "random:3"], "--flip would undo"),
        (&["--features", features, "--rule", "lifted:heights"], "a triangulation of their own"),
        (&["--patches", patches, "--boundary", "clamped"], "no knots of the input"),
        (&["--patches", patches, "--rule", "data"], "have no values"),
        (&["--patches", patches, "--degree", "14"], "degree 14 needs at least 17 knots, there are 16"),
        (&["--features", "-"], "cannot both come from stdin"),
        (&["--features", "/no/such/file"], "/no/such/file"),
        (&["--box", "zp", "--degree", "7"], "degree 7 needs"),
    ];
    for (arguments, part) in cases {
        let (code, message) = outcome(&run("configgen", arguments, &grid(3, 3)));
        assert!(code == Some(2) || (code == Some(1) && part == "/no/such/file"), "{arguments:?}: {message}");
        assert!(message.contains(part), "{arguments:?}: {message}");
    }
    let half = lines(&scattered(3, 20));
    let (code, message) = outcome(&run("configgen", &["--box", "zp"], &half));
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("stdin: no four knots"), "{message}");
}
