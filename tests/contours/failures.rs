//! Wrong usage, streams that are not meshes in the plane, damaged input, and outputs that cannot be written.

use crate::programs::{
    Folder, assert_damage_leaves_no_file, assert_outcome, assert_silent_without_reader, cloud, mesh_of_cloud,
    run, skip,
};

fn mesh() -> Vec<u8> {
    mesh_of_cloud(3_000)
}

fn check(arguments: &[&str], input: &[u8], code: i32, part: &str) {
    assert_outcome("spdem", arguments, input, code, part);
}

#[test]
fn each_failure_has_its_exit_code() {
    let mesh = mesh();
    let lines = |more: &[&'static str], code: i32, part: &str| {
        check(&[&["--contours", "5", "-o", "/dev/null"], more].concat(), &mesh, code, part);
    };
    lines(&[], 0, "levels");
    for flags in [
        ["--step", "1"],
        ["--columns", "9"],
        ["--rows", "9"],
        ["--bounds", "0,0,9,9"],
        ["--kind", "slope"],
        ["--light", "0,90"],
        ["--temp-dir", "/tmp"],
        ["--fill", "3"],
        ["--no-data", "0"],
        ["--like", "x.tif"],
    ] {
        lines(&flags, 2, "cannot be used with");
    }
    lines(&["--cog"], 2, "cannot be used with");
    lines(&["--memory", "1G"], 0, "levels");
    lines(&["--memory", "1K"], 5, "open contour lines have");
    lines(&["--memory", "1G", "--concave", "5000"], 0, "levels");
    lines(&["--concave", "-1"], 2, "--concave takes a length above zero");
    lines(&["--min-length", "0"], 2, "--min-length takes a length above zero");
    lines(&["--index", "0"], 2, "0 is not in 1..");
    lines(&["--mask", "no/such/file"], 1, "no/such/file");
    check(&["--smooth", "-o", "/dev/null"], &mesh, 2, "--contours");
    lines(&["--format", "tif"], 2, "write them to NAME.geojson");
    lines(&["--contour-base", "nan"], 2, "must be finite");
    lines(&["--contour-points", "1"], 2, "1 is not in 2..");
    lines(&["--kill", "0"], 2, "a length above zero");
    lines(&["--kill", "1"], 0, "no lines: elevations are from 0 to 96");
    for (interval, part) in [
        ("0", "above zero"),
        ("-5", "above zero"),
        ("nan", "above zero"),
        ("inf", "above zero"),
        ("1e-30", "cannot be told apart"),
        ("1e-5", "levels pass through one triangle"),
        ("five", "invalid float"),
    ] {
        check(&["--contours", interval, "-o", "/dev/null"], &mesh, 2, part);
    }
    check(&["--contour-base", "5", "-o", "/dev/null"], &mesh, 2, "--contours");
    check(&["--contours", "5", "-o", "lines.tif"], &mesh, 2, "write them to NAME.geojson");
    check(&["--step", "100", "-o", "lines.geojson"], &mesh, 2, "add --contours");
    check(&["--step", "100", "--format", "geojson"], &mesh, 2, "add --contours");
    check(&["--contours", "5", "-o", "/no/such/folder/x.geojson"], &mesh, 1, "/no/such/folder");
    check(&["--contours", "5", "no/such/file"], b"", 1, "no/such/file");
}

#[test]
fn other_streams_are_refused() {
    let points = run("spfinalize", &["-"], cloud(500).as_bytes()).stdout;
    let flat = run("spfinalize", &["-"], b"0 0\n5 0\n0 5\n").stdout;
    let flat = run("spdelaunay2d", &[], &flat).stdout;
    let line = run("spfinalize", &["-"], b"0 0 1\n1 1 1\n").stdout;
    let line = run("spdelaunay2d", &[], &line).stdout;
    let lines: &[&str] = &["--contours", "5", "-o", "/dev/null"];
    check(lines, &points, 2, "triangulate them with spdelaunay2d");
    check(lines, &flat, 2, "no elevation");
    check(lines, b"1 2 3\n", 3, "not those of a spmesh stream");
    check(lines, &line, 0, "no lines: there are no triangles");
    let output = run("spdem", &["--contours", "5", "-q"], &line);
    assert_eq!(
        String::from_utf8(output.stdout).unwrap(),
        "{\"type\":\"FeatureCollection\",\"features\":[\n]}\n"
    );
}

#[test]
fn damaged_streams_leave_no_file() {
    assert_damage_leaves_no_file("spdem", &["--contours", "10"], ["old.geojson", "new.ndjson"], &mesh());
}

#[test]
fn closed_pipes_are_silent_and_full_disks_are_not() {
    let (folder, mesh) = (Folder::new(), mesh());
    let name = folder.write("mesh.spm", &mesh);
    assert_silent_without_reader("spdem", &["-q", "--contours", "1", &name]);
    if !std::path::Path::new("/dev/full").exists() {
        skip("there is no /dev/full");
        return;
    }
    for format in ["geojson", "geojsonl"] {
        let arguments = ["--contours", "5", "--format", format, "-o", "/dev/full"];
        check(&arguments, &mesh, 1, "No space left on device");
    }
}
