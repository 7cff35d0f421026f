//! Pipes, meshes as starts, and files of other programs.

use super::{counts, lines, output, plane, scattered, total, triangles};
use crate::programs::{outcome, run, sample};

/// The mesh of points, made by spfinalize and spdelaunay2d.
fn mesh(input: &[u8]) -> Vec<u8> {
    let points = run("spfinalize", &["-"], input);
    assert!(points.status.success(), "{:?}", outcome(&points));
    let mesh = run("spdelaunay2d", &[], &points.stdout);
    assert!(mesh.status.success(), "{:?}", outcome(&mesh));
    mesh.stdout
}

/// The stream of a mesh in OBJ text.
fn mesh_of_obj(text: &str) -> Vec<u8> {
    let mesh = run("spconvert", &["--from", "obj", "--to", "spm"], text.as_bytes());
    assert!(mesh.status.success(), "{:?}", outcome(&mesh));
    mesh.stdout
}

const KITE: &str = "v 0 0 0\nv 8 0 0\nv 9 9 0\nv 0 8 0\n";

#[test]
fn a_delaunay_mesh_is_as_good_as_its_points() {
    let input = lines(&scattered(11, 200));
    let mesh = mesh(&input);
    for arguments in [&["--degree", "2"][..], &["--degree", "1", "--boundary", "clamped"]] {
        let [of_points, of_mesh] =
            [&input, &mesh].map(|input| triangles(&output(&[&["--centroids"], arguments].concat(), input)));
        assert_eq!(of_points, of_mesh, "{arguments:?}");
    }
    assert_eq!(counts(&[], &mesh)["own_start"], 0);
    let twin = run("spconvert", &["--to", "text"], &mesh).stdout;
    let arguments = ["--centroids", "--degree", "1"];
    assert!(output(&arguments, &twin) == output(&arguments, &mesh), "the text twin");
}

#[test]
fn the_start_of_degree_0_comes_back() {
    let mesh = mesh(&lines(&scattered(12, 20_000)));
    let back = output(&["--centroids", "--degree", "0"], &mesh);
    assert!(plane(&back) == plane(&mesh));
    let audit = run("spinfo", &["--audit", "-"], &back);
    assert!(audit.status.success(), "{:?}", outcome(&audit));
}

#[test]
fn any_other_mesh_is_the_start() {
    let delaunay = mesh_of_obj(&format!("{KITE}f 1 2 4\nf 2 3 4\n"));
    let other = mesh_of_obj(&format!("{KITE}f 1 2 3\nf 1 3 4\n"));
    let of = |mesh: &[u8]| {
        let stats = counts(&["--degree", "1"], mesh);
        (stats["own_start"].as_u64().unwrap(), total(&stats, 0, "configurations"))
    };
    // One of the two diagonals is Delaunay.
    assert_eq!([of(&delaunay), of(&other)], [(0, 2), (1, 2)]);
    let back = output(&["--centroids", "--degree", "0"], &other);
    assert_eq!(plane(&back), plane(&other));
    assert_ne!(plane(&back), plane(&delaunay));
    let (code, message) = outcome(&run("configgen", &["--boundary", "clamped", "--centroids"], &other));
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("stdin: a mesh that is not the Delaunay triangulation"), "{message}");
}

#[test]
fn meshes_that_do_not_fill_their_hull_are_refused() {
    for (faces, part) in [
        ("f 1 2 3\n", "no triangle has this knot"),
        ("f 2 1 3\nf 1 3 4\n", "flat or clockwise"),
        ("v 4 1 0\nf 1 5 4\nf 5 2 3\nf 5 3 4\n", "the border is not convex"),
    ] {
        let (code, message) =
            outcome(&run("configgen", &["--centroids"], &mesh_of_obj(&format!("{KITE}{faces}"))));
        assert_eq!(code, Some(3), "{faces}: {message}");
        assert!(message.contains("stdin: ") && message.contains(part), "{faces}: {message}");
    }
}

#[test]
fn files_of_lidar_are_read_as_one_input() {
    let stats = counts(&["--degree", "1", &sample("lareunion.laz")], &[]);
    let points = stats["points"].as_u64().unwrap();
    assert!(points > 1000, "{points}");
    let [once, twice] =
        [&[sample("point10.las")][..], &[sample("point10.las"), sample("point10.las")]].map(|files| {
            let files = files.iter().map(String::as_str);
            counts(&["--degree", "0"].into_iter().chain(files).collect::<Vec<_>>(), &[])
        });
    let [of_one, of_two] = [&once, &twice].map(|counts| counts["points"].as_u64().unwrap());
    assert_eq!(of_two, 2 * of_one);
    assert_eq!(twice["repeated"].as_u64().unwrap(), of_one + once["repeated"].as_u64().unwrap());
    let csv = counts(&["--degree", "1"], b"name,y,x\na,1,2\nb,5,2\nc,3,9\nd,4,4\n");
    assert_eq!((total(&csv, 0, "configurations"), &csv["points"]), (3, &4.into()));
}

#[test]
fn statistics_are_text_too() {
    let arguments = ["--centroids", "--stats", "-o", "/dev/null", "-"];
    let (code, message) = outcome(&run("configgen", &arguments, &lines(&scattered(3, 50))));
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("links, bounded") && message.contains("without area"), "{message}");
    assert!(message.lines().all(|line| line.len() <= 60), "{message}");
}

#[test]
fn the_audit_passes_what_every_rule_makes() {
    let flat = lines(&scattered(4, 120));
    let grid: Vec<[i64; 2]> = (0..80).map(|site| [site % 9, site / 9]).collect();
    let ties = lines(&grid);
    let rules = ["delaunay", "min-weight", "ear", "fan", "random", "aligned:30"];
    let borders: [&[&str]; 3] = [&[], &["--boundary", "clamped"], &["--boundary", "pulled-apart"]];
    for (number, rule) in rules.iter().enumerate() {
        for input in [&flat, &ties] {
            let flip: &[&str] = if number % 2 == 1 { &["--flip", "random:20:3"] } else { &[] };
            let arguments = [&["--degree", "3", "--rule", rule], flip, borders[number % 3]].concat();
            let audit = run("spinfo", &["--audit", "-"], &output(&arguments, input));
            let (code, message) = outcome(&audit);
            assert_eq!(code, Some(0), "{arguments:?}: {message}");
        }
    }
}
