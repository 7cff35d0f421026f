//! The command `spinfo`: exit codes, text and JSON.

use std::process::Output;

use serde_json::Value;
use spmesh_stream::{Crs, Header, Kind, StreamWriter};

use super::solid::{self, Solid, cubic};
use super::{Mesh, grid, point};
use crate::vectors::load;

fn spinfo(arguments: &[&str], input: &[u8]) -> Output {
    crate::programs::run("spinfo", arguments, input)
}

fn square(triangles: &[[usize; 3]]) -> Vec<u8> {
    Mesh::new(&[[0, 0], [10, 0], [10, 10], [0, 10]], triangles).stream()
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn text_names_what_is_there() {
    let output = spinfo(&["--audit"], &square(&[[0, 1, 3], [1, 2, 3]]));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{text}");
    for line in
        ["stdin: triangle mesh", "triangles    2", "width        4 live", "audit passed", "canonical    ok"]
    {
        assert!(text.contains(line), "{line:?} in\n{text}");
    }
    assert!(output.stderr.is_empty());
}

#[test]
fn json_is_one_object() {
    let output = spinfo(&["--json", "--audit", "-"], &square(&[[0, 1, 3], [1, 2, 3]]));
    let object = json(&output);
    assert_eq!(object["kind"], "triangle mesh");
    assert_eq!(object["crs"], Value::Null);
    assert_eq!(object["counts"]["points"], 4);
    assert_eq!(object["counts"]["triangles"], 2);
    assert_eq!(object["counts"]["vertices"], 4);
    assert_eq!(object["counts"]["cells"], 0);
    assert_eq!(object["bounds"]["min"][0], 1000.0);
    assert_eq!(object["audit"]["ok"], true);
}

#[test]
fn tetrahedra_have_their_words() {
    let mut mesh = Solid::canonical(&cubic(2));
    mesh.labels = (1..=8).collect();
    let text = String::from_utf8(spinfo(&["--audit"], &mesh.stream()).stdout).unwrap();
    for line in [
        "stdin: tetrahedral mesh",
        "tetrahedra   6",
        "labels       8",
        "open facets",
        "facets       ok",
        "labels       ok",
    ] {
        assert!(text.contains(line), "{line:?} in\n{text}");
    }
    assert!(!text.contains("triangles"), "{text}");
    let object = json(&spinfo(&["--audit", "--json"], &mesh.stream()));
    assert_eq!(object["counts"]["tetrahedra"], 6);
    assert_eq!(object["counts"]["labels"], 8);
    assert_eq!(object["audit"]["ok"], true);
    assert!(object["audit"]["open_facets_max"].is_number());
    mesh.tetrahedra.pop();
    let output = spinfo(&["--audit"], &mesh.stream());
    assert_eq!(output.status.code(), Some(4));
    assert!(String::from_utf8_lossy(&output.stderr).contains(" check failed: "));
}

#[test]
fn points_in_space_are_compared_in_all_coordinates() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("points.spm");
    let mut points = cubic(2);
    let mesh = Solid::canonical(&points);
    for (is_equal, status) in [(true, 0), (false, 4)] {
        if !is_equal {
            points[3][2] += 1;
        }
        let header = Header::new(Kind::Points, solid::grid(), 3, false);
        let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
        writer.points(&points.iter().map(solid::position).collect::<Vec<_>>()).unwrap();
        std::fs::write(&path, writer.end(0, 0).unwrap()).unwrap();
        let output = spinfo(&["--audit", "--points", path.to_str().unwrap()], &mesh.stream());
        assert_eq!(output.status.code(), Some(status), "{}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn violation_exits_with_4_and_says_where() {
    let stream = square(&[[0, 1, 2], [0, 2, 3]]);
    let output = spinfo(&["--audit", "--json"], &stream);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(4), "{message}");
    assert!(message.starts_with("spinfo: stdin: block 0 at byte "), "{message}");
    assert!(message.contains("edge 0 to 2"), "{message}");
    let audit = &json(&output)["audit"];
    assert_eq!(audit["ok"], false);
    assert_eq!(audit["violation"]["check"], "canonical");
    assert_eq!(audit["violation"]["vertices"][1]["id"], 2);
    assert_eq!(spinfo(&["--audit=delaunay"], &stream).status.code(), Some(0));
    assert_eq!(spinfo(&[], &stream).status.code(), Some(0));
}

/// What breaks a rule of the stream is malformed, whoever finds it, and what is too new is not judged.
#[test]
fn rules_of_the_stream_exit_with_3_or_6_and_not_with_4() {
    for vector in load("fail", "err") {
        let output = spinfo(&["--audit"], &vector.bytes);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        // An earlier block may break a claim. Some kinds have no audit, or none of their first block.
        let is_earlier = message.contains(" check failed: ") && !message.contains(&vector.expected);
        let expected = Some(if is_earlier { 4 } else { i32::from(vector.exit_code) });
        let reasons = ["claims nothing that takes a proof", "proves nothing alone"];
        let is_unproved =
            output.status.code() == Some(2) && reasons.iter().any(|reason| message.contains(reason));
        assert!(is_unproved || output.status.code() == expected, "{}: {message}", vector.name);
        let found_late = ["finalized", "referenced after", "final already", "that is final"];
        assert!(
            !is_earlier || !found_late.iter().any(|what| vector.expected.contains(what)),
            "{}",
            vector.name
        );
    }
}

#[test]
fn truncated_stream_exits_with_3() {
    let stream = square(&[[0, 1, 3], [1, 2, 3]]);
    for len in [0, 7, 100, stream.len() - 1] {
        let output = spinfo(&["--audit"], &stream[..len]);
        assert_eq!(output.status.code(), Some(3));
        assert!(output.stdout.is_empty());
    }
}

#[test]
fn points_of_another_file_are_compared() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("points.spm");
    let header =
        Header { crs: Crs::Wkt("LOCAL_CS[\"here\"]".into()), ..Header::new(Kind::Points, grid(), 2, false) };
    let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
    writer.points(&[[0, 0], [10, 0], [10, 10], [0, 10], [10, 0], [5, 4]].map(|p| point(&p))).unwrap();
    std::fs::write(&path, writer.end(0, 0).unwrap()).unwrap();
    let path = path.to_str().unwrap();
    let output = spinfo(&["--audit", "--points", path], &square(&[[0, 1, 3], [1, 2, 3]]));
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(4), "{message}");
    assert!(message.contains("point at (1000.05, 2000.04)"), "{message}");
    assert_eq!(json(&spinfo(&["--json", path], &[]))["crs"]["name"], "here");
    assert_eq!(spinfo(&["--points", path], &[]).status.code(), Some(2));
    assert_eq!(spinfo(&["--audit", "--points", path, path], &[]).status.code(), Some(2));
}

#[test]
fn help_shows_examples() {
    let output = spinfo(&["--help"], &[]);
    assert!(output.status.success());
    assert!(String::from_utf8(output.stdout).unwrap().contains("spinfo --audit"));
    assert!(spinfo(&["--version"], &[]).status.success());
}
