//! Wrong flags and damaged input.

use super::{mesh_of, scattered};
use crate::programs::{Folder, outcome, run, sample};
use crate::sources::las_file::{LasFile, geo_keys};

/// Runs the program with a ground and points in files; returns the exit code and the messages.
fn refused(folder: &Folder, arguments: &[&str]) -> (Option<i32>, String) {
    let found = outcome(&run("spheight", arguments, &[]));
    assert!(!found.1.contains("panicked"), "{found:?}");
    let left: Vec<String> = folder.names("").into_iter().filter(|name| name.starts_with("out")).collect();
    assert!(left.is_empty(), "{left:?}");
    found
}

#[test]
fn wrong_requests_are_refused_with_a_remedy() {
    let folder = Folder::new();
    let points = LasFile { projection: vec![geo_keys(2154)], ..scattered(50, 100, 1) };
    folder.file("ground.spm", mesh_of(&points.bytes()));
    folder.file("points.las", points.bytes());
    folder.file("other.las", LasFile { projection: vec![geo_keys(32631)], ..points.clone() }.bytes());
    folder.file("mesh.obj", "v 1 2 3\n");
    let stream = run("spfinalize", &["-q", "-"], &points.bytes());
    folder.file("points.spm", stream.stdout);
    let path = |name: &str| folder.path(name);
    let (ground, points, out) = (path("ground.spm"), path("points.las"), path("out.las"));
    for (arguments, part) in [
        (vec!["--ground", &ground, &points], "--output"),
        (vec!["--ground", &ground, "-o", &out], "no input"),
        (vec!["--ground", &ground, &points, &points, "-o", &out], "--out-dir"),
        (vec!["--ground", &ground, &points, &points, "--out-dir", &path("two")], "given twice"),
        (vec!["--ground", &ground, &points, "-o", &path("out.tif")], "this program writes .las"),
        (vec!["--ground", &ground, &points, "-o", &path("out.copc.laz")], "COPC files are not written"),
        (vec!["--ground", &ground, &points, "-o", &points], "replace the input"),
        (vec!["--ground", &ground, &points, "-o", &ground, "--format", "las"], "replace the input"),
        (vec!["--ground", &ground, &points, "--out-dir", &path("")], "replace the input"),
        (vec!["--ground", "-", "-", "-o", &out], "stdin can be one input only"),
        (vec!["--ground", &path("points.spm"), &points, "-o", &out], "triangulate them with spdelaunay2d"),
        (vec!["--ground", &ground, &path("other.las"), "-o", &out], "coordinate reference system"),
        (vec!["--ground", &ground, &points, "-o", &out, "--replace-z", "--outside", "no-data"], "nearest"),
        (vec!["--ground", &ground, &points, "-o", &out, "--name", ""], "--name"),
        (vec!["--ground", &ground, &points, "-o", "-", "--format", "las"], "pipe"),
    ] {
        let (code, message) = refused(&folder, &arguments);
        assert_eq!(code, Some(2), "{arguments:?}: {message}");
        assert!(message.contains(part), "{arguments:?}: {message}");
    }
    for (input, part) in [(path("mesh.obj"), "LAS"), (sample("truncated.las"), "truncated")] {
        let (code, message) = refused(&folder, &["--ground", &ground, &input, "-o", &out]);
        assert!(code == Some(3) && message.contains(part), "{message}");
    }
    let (code, message) = refused(&folder, &["--ground", &path("none"), &points, "-o", &out]);
    assert!(code == Some(1) && message.contains("none"), "{message}");
}

#[test]
fn a_field_is_not_written_twice() {
    let folder = Folder::new();
    let points = scattered(50, 100, 1);
    folder.file("ground.spm", mesh_of(&points.bytes()));
    folder.file("points.las", points.bytes());
    let (ground, first) = (folder.path("ground.spm"), folder.path("first.las"));
    let once = run("spheight", &["--ground", &ground, &folder.path("points.las"), "-o", &first], &[]);
    assert!(once.status.success());
    let out = folder.path("out.las");
    let (code, message) = refused(&folder, &["--ground", &ground, &first, "-o", &out]);
    assert!(code == Some(2) && message.contains("--name"), "{message}");
    let again = run("spheight", &["--ground", &ground, &first, "-o", &out, "--name", "again"], &[]);
    assert!(again.status.success(), "{:?}", outcome(&again));
}

/// Heights that need more than 32 bits.
#[test]
fn heights_may_not_overflow() {
    let folder = Folder::new();
    let ground = LasFile { scale: [1.0; 3], ..LasFile::of(&[[0, 0, 0], [9, 0, 0], [0, 9, 0]]) };
    let points = LasFile { scale: [1.0, 1.0, 0.001], offset: [0.0, 0.0, 3e6], ..LasFile::of(&[[1, 1, 5]]) };
    folder.file("ground.spm", mesh_of(&ground.bytes()));
    folder.file("points.las", points.bytes());
    let (ground, points) = (folder.path("ground.spm"), folder.path("points.las"));
    let (code, message) = refused(&folder, &["--ground", &ground, &points, "-o", &folder.path("out.las")]);
    assert!(code == Some(2) && message.contains("record 0") && message.contains("32 bits"), "{message}");
}

/// Coordinates that are no finite numbers in the world, or in steps of the ground. Each program refuses the
/// former.
#[test]
fn coordinates_may_not_overflow() {
    let folder = Folder::new();
    let points = LasFile::of(&[[0, 0, 0], [9, 0, 0], [0, i32::MAX, 0], [1, 1, 5]]);
    folder.file("ground.spm", mesh_of(&points.bytes()));
    let fine = LasFile { scale: [1e-307; 3], ..points.clone() };
    folder.file("fine.spm", mesh_of(&fine.bytes()));
    folder.file("points.las", points.bytes());
    let (ground, out, raster) = (folder.path("ground.spm"), folder.path("out.las"), folder.path("out.tif"));
    for (scale, offset) in [([1e300, 1e300, 1.0], 0.0), ([0.01, 0.01, 8e292], 0.0), ([1e292; 3], -1.797e308)]
    {
        let far = LasFile { scale, offset: [offset; 3], ..points.clone() };
        folder.file("far.las", far.bytes());
        let far = folder.path("far.las");
        let heights = refused(&folder, &["--ground", &ground, &far, "-o", &out]);
        let flags = ["--ground", &ground, &far, "--step", "1", "-o", &raster];
        let canopy = outcome(&run("spcanopy", &flags, &[]));
        let stream = outcome(&run("spfinalize", &[&far], &[]));
        for (code, message) in [heights, canopy, stream] {
            assert!(code == Some(2) && message.contains("beyond numbers of 64 bits"), "{message}");
            assert!(message.len() < 300, "{message}");
        }
    }
    let (fine, points) = (folder.path("fine.spm"), folder.path("points.las"));
    let (code, message) = refused(&folder, &["--ground", &fine, &points, "-o", &out]);
    assert!(code == Some(2) && message.contains("too great or too small"), "{message}");
}

/// Every cut of a ground and of points, and bits that are flipped.
#[test]
fn damage_is_an_error_and_leaves_no_file() {
    let folder = Folder::new();
    let points = scattered(3000, 1000, 1);
    let mesh = mesh_of(&points.bytes());
    let laz = points.compressed(500);
    folder.file("ground.spm", &mesh);
    folder.file("points.laz", &laz);
    let (ground, damaged) = (folder.path("ground.spm"), folder.path("damaged"));
    let (input, out) = (folder.path("points.laz"), folder.path("out.laz"));
    for part in 0..12 {
        folder.file("damaged", &mesh[..mesh.len() * part / 12]);
        let (code, message) = refused(&folder, &["--ground", &damaged, &input, "-o", &out]);
        assert_eq!(code, Some(3), "{message}");
        folder.file("damaged", &laz[..laz.len() * part / 12]);
        let (code, message) = refused(&folder, &["--ground", &ground, &damaged, "-o", &out]);
        assert_eq!(code, Some(3), "{message}");
    }
    let mut random = spmesh_base::random::Random::new(5);
    for _ in 0..60 {
        let mut flipped = laz.clone();
        // The header, and the records before the points.
        let at = random.below(500) as usize;
        flipped[at] ^= 1 << random.below(8);
        folder.file("damaged", &flipped);
        let found = outcome(&run("spheight", &["--ground", &ground, &damaged, "-o", &out], &[]));
        assert!(matches!(found.0, Some(0..=3)) && !found.1.contains("panicked"), "byte {at}: {found:?}");
    }
}
