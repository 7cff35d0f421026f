//! Products of a diagram: simplices, values, slices, surfaces.

use std::os::fd::OwnedFd;
use std::process::Stdio;

use rustix::fs::{Mode, OFlags};
use rustix::pty::{self, OpenptFlags};
use serde_json::Value;

use super::{as_text, diagram, proof};
use crate::programs::{Folder, outcome, run, tool};

/// A grid of 3 sites along each axis with a linear value.
fn linear() -> String {
    let site = |i: i32| [i % 3, i / 3 % 3, i / 9 % 3, i / 27];
    let line = |[x, y, z, t]: [i32; 4]| format!("{x} {y} {z} {t} {}\n", 2 * x - y + 4 * t);
    (0..81).map(site).map(line).collect()
}

/// Two ends of a pseudo-terminal; the second one is the terminal.
fn terminal() -> [OwnedFd; 2] {
    let near = pty::openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    pty::grantpt(&near).unwrap();
    pty::unlockpt(&near).unwrap();
    let name = pty::ptsname(&near, Vec::new()).unwrap();
    let far = rustix::fs::open(name, OFlags::RDWR | OFlags::NOCTTY, Mode::empty()).unwrap();
    [near, far]
}

#[test]
fn simplices_pass_the_audit_and_damaged_ones_do_not() {
    let stream = diagram(&["--grid", "3x2x2x2", "--triangulate", "canonical"], &[]);
    let found = proof(&stream);
    assert_eq!(
        (&found["vertices"], &found["cells"], &found["simplices"]),
        (&24.into(), &48.into(), &48.into())
    );
    let text = String::from_utf8(as_text(&stream)).unwrap();
    assert!(text.contains(&format!("producer \"dd4 {}\"", env!("CARGO_PKG_VERSION"))), "{text}");
    assert!(text.contains("#spmesh points 24"), "{text}");
    let simplex = text.lines().find(|line| line.starts_with("s4 ")).unwrap();
    let without = text.replacen(&format!("{simplex}\n"), "", 1).replace("simplices 48", "simplices 47");
    let moved = text.replacen("v4 0 0 0 0\n", "v4 -1 0 0 0\n", 1);
    for (damaged, check) in [(without, "boundary"), (moved, "delaunay")] {
        let stream = run("spconvert", &["--to", "spm"], damaged.as_bytes());
        assert!(stream.status.success(), "{:?}", outcome(&stream));
        for standard in ["--audit", "--audit=delaunay"] {
            let output = run("spinfo", &[standard, "--json", "-"], &stream.stdout);
            let (code, message) = outcome(&output);
            assert_eq!(code, Some(4), "{message}");
            assert!(message.contains(&format!("stdin: {check} check failed")), "{message}");
            let report: Value = serde_json::from_slice(&output.stdout).unwrap();
            assert_eq!(report["kind"], "simplices in 4 dimensions");
            assert_eq!(report["audit"]["violation"]["check"], check);
        }
    }
}

#[test]
fn sites_of_a_file_get_values() {
    let folder = Folder::new();
    let sites = folder.write("sites.txt", "x y z t\n# a comment\n0.5 1.5 0.25 1\n2 2 2 2\n\n-1 0 0 0\n");
    let valued = folder.write("valued.txt", "2 0 0 0.5 nan\n");
    let input = linear();
    let values = folder.path("values.tsv");
    let arguments = ["--at", "1,1,1,1", "--at-file", &sites, "-o", &values, "-"];
    let (code, message) = outcome(&run("dd4", &arguments, input.as_bytes()));
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("1 of 4 sites is outside"), "{message}");
    let expected =
        "x\ty\tz\tt\tvalue\n1\t1\t1\t1\t5\n0.5\t1.5\t0.25\t1\t3.5\n2\t2\t2\t2\t10\n-1\t0\t0\t0\tnan\n";
    assert_eq!(std::fs::read_to_string(&values).unwrap(), expected);
    let points = folder.write("points.txt", &input);
    let output = run("dd4", &["--at-file", "-", &points], b"1 1 1 0.5\n");
    assert_eq!(output.stdout, b"x\ty\tz\tt\tvalue\n1\t1\t1\t0.5\t3\n");
    let output = run("dd4", &["--at-file", &valued, &points], &[]);
    assert_eq!(output.stdout, b"x\ty\tz\tt\tvalue\n2\t0\t0\t0.5\t6\n");
}

#[test]
fn sites_that_cannot_be_read_are_named() {
    let folder = Folder::new();
    let points = folder.write("points.txt", linear());
    let [empty, damaged] = [("empty.txt", ""), ("damaged.txt", "0 0 0 0\n0 0 zero 0\n")]
        .map(|(name, text)| folder.write(name, text));
    for (sites, input, code, part) in [
        (&empty[..], &points[..], 3, "empty.txt"),
        (&damaged, &points, 3, "damaged.txt: line 2"),
        ("no/such/sites", &points, 1, "no/such/sites"),
        ("-", "-", 2, "cannot both come from stdin"),
    ] {
        let (found, message) = outcome(&run("dd4", &["--at-file", sites, input], &[]));
        assert_eq!(found, Some(code), "{message}");
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn slices_and_surfaces_are_written_as_their_names_say() {
    let folder = Folder::new();
    let points = folder.write("points.txt", linear());
    let surface = ["--isosurface", "4.5"];
    for (name, flags, start, part) in [
        ("a.vtu", &[][..], "<?xml", "Name=\"value\""),
        ("a.mesh", &[], "MeshVersionFormatted", "\nTetrahedra\n"),
        ("a", &[], "<?xml", "Name=\"value\""),
        ("b.ply", &surface, "ply\n", "element face"),
        ("b.obj", &surface, "#", "\nf "),
        ("b.vtu", &surface, "<?xml", "</VTKFile>"),
        ("b.mesh", &surface, "MeshVersionFormatted", "\nTriangles\n"),
        ("b", &surface, "ply\n", "element face"),
    ] {
        let path = folder.path(name);
        let arguments = [&["--slice", "0.5", "-o", &path, &points], flags].concat();
        let (code, message) = outcome(&run("dd4", &arguments, &[]));
        assert_eq!(code, Some(0), "{name}: {message}");
        let bytes = std::fs::read(&path).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        assert!(text.starts_with(start) && text.contains(part), "{name}: {text}");
        assert_eq!(message.contains("hold no values"), name == "a.mesh", "{message}");
    }
}

#[test]
fn what_cannot_be_made_is_said_before_the_work() {
    let folder = Folder::new();
    let points = folder.write("points.txt", linear());
    for (name, flags, part) in [
        ("a.ply", &["--slice", "0.5"][..], "a slice cannot be written as ply"),
        ("a.spm", &["--slice", "0.5", "--isosurface", "1"], "a surface cannot be written as spm"),
        ("a.vtu", &[], "use --slice"),
        ("a.obj", &["--triangulate", "canonical"], "use --slice"),
        ("a.vtu", &["--slice", "2.5"], "points.txt: no slice at time 2.5: the points are from 0 to 2"),
        ("a.vtu", &["--slice", "-1"], "points.txt: no slice at time -1"),
        ("a.vtu", &["--slice", "4.5", "--quantum", "0.5"], "the points are from 0 to 4"),
        ("a.spm", &["--quantum", "-1"], "not a number above 0"),
        ("a.spm", &["--sample", "-0.5"], "not a share above 0"),
    ] {
        let path = folder.path(name);
        let arguments = [&["-o", &path, &points], flags].concat();
        let (code, message) = outcome(&run("dd4", &arguments, &[]));
        assert_eq!(code, Some(2), "{flags:?}: {message}");
        assert!(message.contains(part), "{flags:?}: {message}");
        assert_eq!(folder.names(""), ["points.txt"]);
    }
    let (code, message) = outcome(&run("dd4", &["--grid", "2x2x2x2", "--at", "0,0,0,0"], &[]));
    assert_eq!(
        (code, &message[..]),
        (Some(2), "dd4: grid 2x2x2x2: the points have no values to interpolate: give x y z t value\n")
    );
}

#[test]
fn terminals_get_no_binary_data_and_give_no_points() {
    for (flags, code) in [
        (&[][..], 2),
        (&["--triangulate", "canonical"], 2),
        (&["--slice", "0.5"], 2),
        (&["--slice", "0.5", "--isosurface", "1"], 2),
        (&["--at", "1,1,1,1"], 0),
    ] {
        let folder = Folder::new();
        let points = folder.write("points.txt", linear());
        let [_near, far] = terminal();
        let child = tool("dd4").args([flags, &[&points[..]]].concat()).stdout(Stdio::from(far)).spawn();
        let (found, message) = outcome(&child.unwrap().wait_with_output().unwrap());
        assert_eq!(found, Some(code), "{flags:?}: {message}");
        assert_eq!(message.contains("refusing to write binary data to a terminal"), code == 2, "{message}");
    }
    let [_near, far] = terminal();
    let child = tool("dd4").arg("-").stdin(Stdio::from(far)).spawn();
    let (code, message) = outcome(&child.unwrap().wait_with_output().unwrap());
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("stdin is a terminal"), "{message}");
}
