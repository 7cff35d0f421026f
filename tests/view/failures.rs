//! Wrong usage, streams that cannot be drawn in the plane, damaged input, and outputs that cannot be written.

use super::{grid, mesh_of, output};
use crate::programs::{
    Folder, assert_damage_leaves_no_file, assert_outcome, assert_silent_without_reader, cloud, skip,
};

fn check(cases: &[(&[&str], &[u8], i32, &str)]) {
    cases
        .iter()
        .for_each(|(arguments, input, code, part)| assert_outcome("spview", arguments, input, *code, part));
}

#[test]
fn each_failure_has_its_exit_code() {
    let mesh = mesh_of(&grid(8));
    let null = ["-o", "/dev/null"];
    let with = |arguments: &[&'static str]| -> Vec<&'static str> { [arguments, &null].concat() };
    check(&[
        (&["no/such/file"], b"", 1, "no/such/file"),
        (&null, b"", 3, "stdin: header at byte 0: the input is empty"),
        (&null, b"1 2 3\n4 5 6\n", 3, "not those of a spmesh stream"),
        (&with(&["--width", "1000000"]), &mesh, 2, "320..=8192"),
        (&with(&["--width", "0"]), &mesh, 2, "320..=8192"),
        (&with(&["--bounds", "3,0,1,1"]), &mesh, 2, "bounds 3,0,1,1 are empty"),
        (&with(&["--light", "0,inf"]), &mesh, 2, "two angles"),
        (&with(&["--middle", "nan"]), &mesh, 2, "takes an elevation"),
        (&with(&["--range", "3,3"]), &mesh, 2, "the least elevation and the greatest"),
        (&with(&["--vector", "--raster"]), &mesh, 2, "cannot be used with"),
        (&with(&["--at", "1.5"]), &mesh, 2, "neither a part"),
        (&with(&["--at", "-1"]), &mesh, 2, "-1"),
        (&with(&["--at", "0.5"]), &mesh, 2, "give a number, or a file instead of a pipe"),
        (&with(&["--snapshot", "100"]), &mesh, 2, "every=1000000"),
        (&with(&["--snapshot", "every=0"]), &mesh, 2, "every=1000000"),
        (&with(&["--snapshot", "every=9"]), &mesh, 2, "a name with one %d or %04d"),
        (&["--snapshot", "every=9"], &mesh, 2, "give their names"),
        (&["--snapshot", "every=9", "-o", "a%04d-%d.png"], &mesh, 2, "a name with one %d"),
        (&["--snapshot", "every=9", "-o", "a%4d.png"], &mesh, 2, "a name with one %d"),
        (&["--tee"], &mesh, 2, "give the picture a name"),
        (&with(&["--order", "2"]), &mesh, 2, "--order and --set are for configurations"),
        (&with(&["--oblique", "--bounds", "0,0,1,1"]), &mesh, 2, "leave out --oblique"),
        (&["-o", "/no/such/folder/x.png"], &mesh, 1, "/no/such/folder"),
    ]);
}

#[test]
fn what_cannot_be_seen_from_above_is_refused() {
    let points = output("spfinalize", &["-"], cloud(200).as_bytes());
    let flat = mesh_of("0 0\n5 0\n0 5\n");
    let space = output("spfinalize", &["--octree", "-"], cloud(60).as_bytes());
    let tetrahedra = output("spdelaunay3d", &[], &space);
    let hypercube: String =
        (0..16).map(|i| format!("{} {} {} {}\n", i & 1, i >> 1 & 1, i >> 2 & 1, i >> 3 & 1)).collect();
    let four = output("dd4", &["-"], hypercube.as_bytes());
    let knots = output("configgen", &["--degree", "1", "-"], grid(4).as_bytes());
    let null: &[&str] = &["-o", "/dev/null"];
    let with = |arguments: &[&'static str]| [arguments, null].concat();
    check(&[
        (null, &tetrahedra, 2, "hides itself if seen from above"),
        (null, &four, 2, "cannot be seen from above"),
        (&with(&["--fill", "relief"]), &flat, 2, "no elevation"),
        (&with(&["--oblique"]), &flat, 2, "no elevation"),
        (&with(&["--fill", "hillshade"]), &points, 2, "points are no surface"),
        (&with(&["--oblique"]), &points, 2, "points are no surface"),
        (&with(&["--at", "5"]), &knots, 2, "configurations are drawn whole"),
        (&with(&["--set", "1,99"]), &knots, 2, "there is no knot 99"),
        (&with(&["--order", "7"]), &knots, 2, "the stream has degrees 0, 1"),
        (null, &flat, 0, ""),
    ]);
}

#[test]
fn long_pipes_that_do_not_say_where_they_are_need_bounds() {
    let folder = Folder::new();
    let ply = output("spconvert", &["--to", "ply"], &mesh_of(&cloud(11_000)));
    let unbounded = output("spconvert", &["--to", "spm"], &ply);
    let file = folder.write("mesh.spm", &unbounded);
    check(&[
        (&["-o", "/dev/null"], &unbounded, 2, "give --bounds, or a file instead of a pipe"),
        (&["-o", "/dev/null", "--bounds", "0,0,100000,100000"], &unbounded, 0, ""),
        (&["-o", "/dev/null", &file], b"", 0, ""),
    ]);
}

#[test]
fn damaged_streams_leave_no_file() {
    assert_damage_leaves_no_file("spview", &[], ["old.png", "new.svg"], &mesh_of(&grid(12)));
}

#[test]
fn closed_pipes_are_silent_and_full_disks_are_not() {
    // More data than a pipe holds.
    let (folder, mesh) = (Folder::new(), mesh_of(&grid(180)));
    let name = folder.write("mesh.spm", &mesh);
    assert_silent_without_reader("spview", &["-q", "--vector", &name]);
    assert_silent_without_reader("spview", &["-q", "--tee", "-o", "/dev/null", &name]);
    if !std::path::Path::new("/dev/full").exists() {
        skip("there is no /dev/full");
        return;
    }
    check(&[
        (&["-o", "/dev/full"], &mesh, 1, "No space left on device"),
        (&["--format", "png", "-o", "/dev/full"], &mesh, 1, "No space left on device"),
    ]);
}
