//! Selections without points: the rule of docs/README.md, program by program.

use crate::programs::{Folder, assert_outcome, outcome, run, sample};

/// Streams of no points, whose input tells of elevations, or does not; in the plane, and in space.
fn streams() -> Vec<Vec<u8>> {
    let las = sample("point10.las");
    let of = |arguments: &[&str], input: &[u8]| {
        let output = run("spfinalize", arguments, input);
        let (code, message) = outcome(&output);
        assert!(code == Some(0) && message.contains("no points"), "{arguments:?}: {message}");
        output.stdout
    };
    vec![
        of(&["--keep-class", "31", &las], &[]),
        of(&["--bounds", "0,0,1,1", &las], &[]),
        of(&["-"], b"# nothing\n"),
        of(&["--octree", "--keep-class", "31", &las], &[]),
    ]
}

/// Programs that pass data on write an empty result, with a notice, and succeed.
#[test]
fn nothing_in_is_nothing_out() {
    let folder = Folder::new();
    let [ply, page] = ["a.ply", "a.svg"].map(|name| folder.path(name));
    for (at, points) in streams().iter().enumerate() {
        let mesher = if at == 3 { "spdelaunay3d" } else { "spdelaunay2d" };
        let mesh = run(mesher, &[], points);
        let (code, message) = outcome(&mesh);
        assert!(code == Some(0) && message.contains("0 points"), "{message}");
        for stream in [points, &mesh.stdout] {
            assert_outcome("spinfo", &["-"], stream, 0, "");
            assert_outcome("spinfo", &["--audit", "-"], stream, 0, "");
            assert_outcome("spconvert", &["-", "-o", &ply], stream, 0, "");
            if at < 3 {
                assert_outcome("spview", &["-", "-o", &page], stream, 0, "");
            }
        }
    }
}

/// A raster needs to know its cells; then none of them has data.
#[test]
fn rasters_of_nothing_have_no_data() {
    let folder = Folder::new();
    let like = folder.path("like.tif");
    let some = run("spfinalize", &["-q", &sample("point10.las")], &[]).stdout;
    let some = run("spdelaunay2d", &["-q"], &some).stdout;
    assert_outcome("spdem", &["--columns", "3", "-o", &like], &some, 0, "");
    for points in &streams()[..3] {
        let mesh = run("spdelaunay2d", &["-q"], points).stdout;
        for kind in ["elevation", "slope", "aspect", "hillshade"] {
            let with = |cells: &[&'static str]| [cells, &["-q", "--kind", kind, "--format", "asc"]].concat();
            let output = run("spdem", &with(&["--step", "1", "--bounds", "0,0,2,1"]), &mesh);
            assert!(output.status.success(), "{:?}", outcome(&output));
            let text = String::from_utf8(output.stdout).unwrap();
            let nothing = if kind == "hillshade" { "0 0" } else { "-9999 -9999" };
            assert!(text.ends_with(&format!("\n{nothing}\n")), "{kind}: {text}");
            let like = ["-q", "--kind", kind, "--format", "asc", "--like", &like];
            assert_outcome("spdem", &like, &mesh, 0, "");
            assert_outcome(
                "spdem",
                &with(&["--step", "1"]),
                &mesh,
                2,
                "there are no points, so cells have no place: give --bounds",
            );
        }
        let lines = run("spdem", &["--contours", "1"], &mesh);
        let (code, message) = outcome(&lines);
        assert!(code == Some(0) && message.contains("no lines"), "{message}");
        assert!(String::from_utf8(lines.stdout).unwrap().contains("\"features\":[\n]"));
        assert_outcome("spdem", &["--points", "--kind", "max", "--step", "1"], points, 2, "give --bounds");
        let bounds = ["--points", "--kind", "max", "--step", "1", "--bounds", "0,0,2,1", "--format", "asc"];
        assert_outcome("spdem", &bounds, points, 0, "2 of 2 without data");
    }
}

/// What cannot be computed of nothing is refused.
#[test]
fn fits_and_molecules_need_points() {
    let folder = Folder::new();
    let stream = folder.file("points.spm", &streams()[0]);
    let stream = stream.to_str().unwrap();
    let out = folder.path("out.spm");
    assert_outcome("configgen", &["--degree", "1", stream, "-o", &out], &[], 2, "0");
    assert_outcome("splinefit", &["fit", "--tol", "1", stream, "-o", &out], &[], 2, "no observations");
    assert_outcome("tess3", &["--chain", "Q", &sample("1aki.pdb"), "-o", &out], &[], 2, "");
    assert_eq!(folder.names(""), ["points.spm"]);
}
