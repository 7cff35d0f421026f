//! Programs with `--compress` write what they write without it, and all programs read it.

use crate::programs::{Folder, assert_outcome, cloud, outcome, run};

/// The standard output of a program that succeeds.
fn made(program: &str, arguments: &[&str], input: &[u8]) -> Vec<u8> {
    let output = run(program, arguments, input);
    assert!(output.status.success(), "{program} {arguments:?}: {:?}", outcome(&output));
    output.stdout
}

/// A program with its input and arguments, with and without `--compress`: both streams. Checks that they are
/// the same when expanded, and that the compressed one is smaller.
fn both(program: &str, arguments: &[&str], input: &[u8]) -> [Vec<u8>; 2] {
    let plain = made(program, arguments, input);
    let compressed = made(program, &[arguments, &["--compress"]].concat(), input);
    assert!(compressed.len() < plain.len(), "{program} {arguments:?}: {}", compressed.len());
    for to in ["spm", "text"] {
        let convert = |stream: &[u8]| made("spconvert", &["--to", to, "-"], stream);
        assert!(convert(&plain) == convert(&compressed), "{program} {arguments:?} to {to}");
    }
    [plain, compressed]
}

#[test]
fn points_and_meshes_are_those_of_plain_pipes() {
    for (dims, finalize, triangulate) in
        [(2, &["--scale", "1,1,1"][..], "spdelaunay2d"), (3, &["--octree"], "spdelaunay3d")]
    {
        let arguments = [finalize, &["--cell-points", "2000", "-"]].concat();
        let points = both("spfinalize", &arguments, cloud(20_000).as_bytes());
        let [mesh, compressed] = both(triangulate, &["--threads", "1"], &points[0]);
        for threads in ["1", "3"] {
            assert!(made(triangulate, &["--threads", threads], &points[1]) == mesh, "{dims} dimensions");
            let again = made(triangulate, &["--threads", threads, "--compress"], &points[1]);
            assert!(again == compressed, "{dims} dimensions on {threads} threads");
        }
        assert!(made("spconvert", &["--to", "spm"], &compressed) == mesh, "blocks keep their borders");
        assert!(made("spconvert", &["--to", "spm", "--compress"], &mesh) == compressed);
        let audit = made("spinfo", &["--audit"], &compressed);
        assert!(
            String::from_utf8_lossy(&audit).contains("compressed"),
            "{}",
            String::from_utf8_lossy(&audit)
        );
    }
}

#[test]
fn parts_are_merged_compressed() {
    let points = made("spfinalize", &["--cell-points", "2000", "-"], cloud(10_000).as_bytes());
    let folder = Folder::new();
    let mut parts = Vec::new();
    for (name, region) in [("west", "-inf,-inf,50000,inf"), ("east", "50000,-inf,inf,inf")] {
        let [_, part] = both("spdelaunay2d", &["--partial", "--region", region], &points);
        parts.push(folder.write(name, part));
    }
    both("spdelaunay2d", &["--merge", &parts[0], &parts[1]], &[]);
}

#[test]
fn other_streams_are_those_of_plain_pipes() {
    let lines = cloud(400);
    both("tess3", &["-"], lines.as_bytes());
    both("configgen", &["--degree", "2", "-"], lines.as_bytes());
    both("configgen", &["--degree", "1", "--centroids", "-"], lines.as_bytes());
    let [spline, small] = both("splinefit", &["fit", "--step", "20000", "-"], lines.as_bytes());
    both("splinefit", &["mesh", "-"], &small);
    let eval =
        |spline: &[u8]| made("splinefit", &["eval", "--step", "9000", "--format", "text", "-"], spline);
    assert!(eval(&spline) == eval(&small));
    let four: String =
        (0..60).map(|i| format!("{} {} {} {}\n", i * 37 % 61, i * 7 % 59, i * 23 % 53, i)).collect();
    both("dd4", &["-"], four.as_bytes());
    both("dd4", &["--triangulate", "canonical", "-"], four.as_bytes());
    both("spconvert", &["--from", "points", "--to", "spm", "-"], lines.as_bytes());
}

#[test]
fn all_readers_take_compressed_meshes() {
    let points = made("spfinalize", &["--compress", "--scale", "1,1,1", "-"], cloud(3_000).as_bytes());
    let [mesh, compressed] = both("spdelaunay2d", &[], &points);
    for (program, arguments) in [
        ("spdem", &["--step", "500", "--format", "asc", "-"][..]),
        ("spdem", &["--contours", "10", "-"]),
        ("spview", &["-"]),
        ("spconvert", &["--to", "obj", "-"]),
    ] {
        assert!(made(program, arguments, &mesh) == made(program, arguments, &compressed), "{program}");
    }
    let info = |stream: &[u8]| -> serde_json::Value {
        serde_json::from_slice(&made("spinfo", &["--json"], stream)).unwrap()
    };
    let [plain, small] = [&mesh, &compressed].map(|stream| info(stream));
    assert_eq!((&plain["compressed"], &small["compressed"]), (&false.into(), &true.into()));
    assert_eq!(plain["counts"], small["counts"]);
    assert_eq!(small["plain_bytes"], mesh.len());
    assert_eq!(small["bytes"], compressed.len());
}

#[test]
fn other_outputs_than_streams_are_refused() {
    let words = "--compress is for streams";
    assert_outcome("tess3", &["--compress", "--table", "-"], cloud(9).as_bytes(), 2, words);
    assert_outcome("spconvert", &["--compress", "--to", "text", "-"], b"", 2, words);
    assert_outcome("dd4", &["--compress", "--slice", "1", "-"], b"", 2, words);
    assert_outcome("splinefit", &["mesh", "--compress", "--svg", "-"], b"", 2, words);
}
