//! Messages: nothing in them that a terminal obeys, and nothing that only programmers of Rust can read.

use serde_json::Value;
use spmesh_stream::{Coordinates, Crs, Header, Kind, StreamWriter};

use crate::programs::{Folder, outcome, run};

/// A name or a text with control characters: ESC, BEL, DEL, CSI (C1), a change of direction, a line end.
const HOSTILE: &str = "a\u{1b}[31m\u{7}\u{7f}\u{9b}2J\u{202e}\nspinfo: fine";

/// The same as messages show it.
const SHOWN: &str = "a\\u{1b}[31m\\u{7}\\u{7f}\\u{9b}2J\\u{202e}\\nspinfo: fine";

/// What a terminal obeys, line ends left out.
fn is_obeyed(char: char) -> bool {
    char != '\n' && (char.is_control() || char == '\u{202e}')
}

#[test]
fn names_are_escaped() {
    let folder = Folder::new();
    let missing = folder.path(HOSTILE);
    let cases: [(&str, &[&str]); 13] = [
        ("spfinalize", &[&missing]),
        ("spfinalize", &["--lof", &missing]),
        ("spdelaunay2d", &[&missing]),
        ("spdelaunay3d", &[&missing]),
        ("spdem", &[&missing]),
        ("spview", &[&missing]),
        ("tess3", &[&missing]),
        ("dd4", &[&missing]),
        ("configgen", &[&missing]),
        ("splinefit", &["fit", &missing]),
        ("spinfo", &[&missing]),
        ("spconvert", &["--to", "text", &missing]),
        ("spfinalize", &["-o", &folder.path(&format!("missing/{HOSTILE}")), "-"]),
    ];
    for (name, arguments) in cases {
        let (code, message) = outcome(&run(name, arguments, &[]));
        assert_eq!(code, Some(1), "{name}: {message}");
        assert!(message.contains(SHOWN) && message.lines().count() == 1, "{name}: {message}");
        assert!(!message.contains(is_obeyed), "{name}: {message}");
    }
    // Arguments in messages about usage, and the names of files in notices and in sweeps.
    let (code, message) = outcome(&run("spdem", &["--step", HOSTILE], &[]));
    assert!(code == Some(2) && !message.contains(is_obeyed), "{message}");
    let file = folder.write(HOSTILE, "1 2\n");
    let out = folder.path("out");
    for arguments in [&["--out-dir", &out, &file][..], &["--out-dir", &out, "--stats", &file]] {
        let (code, message) = outcome(&run("tess3", arguments, &[]));
        assert!(code == Some(1) && message.contains(SHOWN) && !message.contains(is_obeyed), "{message}");
    }
    let (code, message) = outcome(&run("spinfo", &[&file], HOSTILE.as_bytes()));
    assert!(code == Some(3) && message.contains(SHOWN) && !message.contains(is_obeyed), "{message}");
}

#[test]
fn texts_of_headers_are_escaped() {
    let folder = Folder::new();
    let wkt = format!("PROJCS[\"{HOSTILE}\"]");
    let header = Header {
        producer: HOSTILE.into(),
        crs: Crs::Wkt(wkt.clone()),
        ..Header::new(Kind::TriangleMesh, Coordinates::F64, 2, true)
    };
    let mesh = folder.write(HOSTILE, StreamWriter::new(Vec::new(), header).unwrap().end(0, 0).unwrap());
    let text = String::from_utf8(run("spinfo", &[&mesh], &[]).stdout).unwrap();
    assert!(text.matches(SHOWN).count() >= 3 && !text.contains(is_obeyed), "{text}");
    assert!(!text.lines().any(|line| line.starts_with("spinfo")), "{text}");
    let json = String::from_utf8(run("spinfo", &["--json", &mesh], &[]).stdout).unwrap();
    assert!(!json.contains(is_obeyed), "{json}");
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!((json["producer"].as_str(), json["crs"]["wkt"].as_str()), (Some(HOSTILE), Some(&wkt[..])));
    let contours = ["--contours", "1", &mesh, "-o", "/dev/null"];
    let (code, message) = outcome(&run("spdem", &contours, &[]));
    assert!(code == Some(0) && !message.contains(is_obeyed), "{message}");
}

/// Texts from inputs are quoted where they are wrong.
#[test]
fn pieces_of_inputs_are_escaped() {
    let cases: [(&str, &[&str], &[u8]); 5] = [
        ("spfinalize", &["-"], b"1 2 3\n4 \x1b[31m 6\n"),
        ("spfinalize", &["-"], b"1 2 3\n4 \xc2\x9b2J\xff 6\n"),
        ("dd4", &["-"], b"1 2 3 4\n4 \x07 6 7\n"),
        ("configgen", &["--patches", "-"], b"0 0 1 0 0 1 8 \x1bc\n"),
        ("splinefit", &["fit", "no", "--features", "-"], b"{\"type\": \"Feature\\u001b[31m\"}"),
    ];
    for (name, arguments, input) in cases {
        let (code, message) = outcome(&run(name, arguments, input));
        assert_eq!(code, Some(3), "{name}: {message}");
        assert!(!message.contains(is_obeyed), "{name}: {message}");
    }
}

#[test]
fn messages_hold_no_rust() {
    let folder = Folder::new();
    let mesh = folder.write("mesh.txt", "#spmesh text 1\n");
    let vtk = "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"1\"><Points><DataArray \
               NumberOfComponents=\"3\" format=\"ascii\">0 0 0</DataArray></Points></Piece></PolyData></VTKFile>";
    let cases: [(&str, &[&str], &[u8], &str); 3] = [
        ("spfinalize", &["-"], vtk.as_bytes(), "type \"\" is none of numbers"),
        ("dd4", &["--grid", "9x9"], &[], "9x9"),
        ("spinfo", &[&mesh], &[], "mesh.txt"),
    ];
    for (name, arguments, input, part) in cases {
        let (code, message) = outcome(&run(name, arguments, input));
        assert!(code.is_some_and(|code| code > 0), "{name}: {message}");
        assert!(message.contains(part), "{name}: {message}");
        for word in ["Some(", "None", "Error {", "Os {", "Bounds {", "Region {"] {
            assert!(!message.contains(word), "{name}: {message}");
        }
    }
}

/// Of points that coincide, the first one stays: a notice says how many others have another elevation.
#[test]
fn elevations_that_depend_on_the_order_are_counted() {
    let mesh = |points: &str, flags: &[&str]| {
        let stream = run("spfinalize", &["-"], points.as_bytes()).stdout;
        outcome(&run("spdelaunay2d", flags, &stream))
    };
    let corners = "0 0 1\n10 0 1\n0 10 1\n5 5 1\n";
    for (others, expected) in
        [("5 5 9\n", "1 point coincides"), ("5 5 9\n5 5 1\n0 0 2\n", "2 points coincide")]
    {
        let (code, message) = mesh(&format!("{corners}{others}"), &[]);
        assert!(code == Some(0) && message.contains(expected), "{message}");
        assert!(message.contains("--duplicates lowest, highest or mean"), "{message}");
        let lowest = mesh(&format!("{corners}{others}"), &["--duplicates", "lowest"]);
        assert_eq!(lowest, (Some(0), String::new()));
    }
    assert_eq!(mesh(&format!("{corners}5 5 1\n"), &[]), (Some(0), String::new()));
}
