//! `--memory` with the worst inputs of programs: it is kept, or refused before much is taken.

use std::f64::consts::TAU;
use std::fs;
use std::path::Path;
use std::process::Command;

use spmesh_reference::sets::Random;

use crate::START_MAX;
use crate::las_file::{LasFile, Record};
use crate::measured::{Measured, tool};

/// A command, the memory that it may take, and a part of the message if it must refuse.
struct Run {
    name: &'static str,
    line: &'static str,
    /// Units: MiB.
    most: f64,
    refused: Option<&'static str>,
}

const fn kept(name: &'static str, line: &'static str, most: f64) -> Run {
    Run { name, line, most, refused: None }
}

const fn refused(name: &'static str, line: &'static str, most: f64, part: &'static str) -> Run {
    Run { name, line, most, refused: Some(part) }
}

/// What `--memory` of some programs stands beside: the program itself, and what is live of a mesh.
const BESIDE: f64 = START_MAX + 8.0;

/// A limit of the process is one of all; `spheight` has tables of its own size for the ground, and `dd4`
/// takes about as much as it may.
const RUNS: [Run; 38] = [
    kept("tags of a plane", "spdelaunay2d --memory 32M --threads 1 tags.spm", 32.0),
    kept("tags, on threads", "spdelaunay2d --memory 32M --threads 2 tags.spm", 32.0),
    kept("tags of space", "spdelaunay3d --memory 32M --threads 1 tags3.spm", 32.0),
    refused("a curve", "spdelaunay3d --memory 24M --threads 1 curve.spm", 24.0, "tetrahedra so far"),
    refused(
        "a curve, on threads",
        "spdelaunay3d --memory 26M --threads 2 curve.spm",
        26.0,
        "tetrahedra so far",
    ),
    kept("a curve with room", "spdelaunay3d --memory 64M --threads 2 curve.spm", 64.0),
    kept("points that wait", "spdelaunay2d --memory 24M --threads 1 order.spm", 24.0),
    kept("deep trees", "spdelaunay2d --memory 32M --threads 1 deep.spm", 32.0),
    refused(
        "polygons",
        "spfinalize --clip squares.wkt --memory 40M --threads 1 plane.txt",
        40.0,
        "of lines so far",
    ),
    refused(
        "a mask",
        "spdem --mask squares.wkt --memory 1M mesh.spm -o o.tif",
        1.0 + BESIDE,
        "of lines so far",
    ),
    refused(
        "parcels",
        "spdiff --level 3 --by squares.wkt --memory 1M mesh.spm",
        1.0 + BESIDE,
        "of lines so far",
    ),
    refused(
        "points at shores",
        "spfinalize --flatten lakes.geojson --shore-width 900 --memory 48M --threads 1 many.txt",
        48.0,
        "points at shores so far",
    ),
    refused(
        "points of water",
        "spfinalize --levels o.geojson --flatten sea.geojson --shore-width 0.1 --water-points 3 --memory 42M \
         --threads 1 water.las",
        42.0,
        "points at shores so far",
    ),
    kept(
        "points at shores with room",
        "spfinalize --flatten lakes.geojson --shore-width 900 --memory 160M --threads 1 many.txt",
        160.0,
    ),
    refused(
        "contour lines",
        "spdem --contours 0.003 --memory 1M mesh.spm -o o.geojson",
        1.0 + BESIDE,
        "open contour lines have",
    ),
    kept(
        "contour lines with room",
        "spdem --contours 0.2 --memory 16M --smooth mesh.spm -o o.geojson",
        16.0 + BESIDE,
    ),
    refused(
        "contour lines in any order",
        "spdem --contours 1 --memory 1M soup.spm -o o.geojson",
        1.0 + BESIDE,
        "not final so far",
    ),
    refused(
        "crossings",
        "spconstrain --lines grid.txt --memory 4M mesh.spm -o c.spm",
        4.0 + BESIDE,
        "crossings and",
    ),
    refused(
        "crossings of lines of points",
        "spfinalize --lines grid.txt --memory 40M --threads 1 plane.txt",
        40.0,
        "crossings and",
    ),
    refused(
        "new vertices in one part",
        "spconstrain --lines grid.txt --memory 88M mesh.spm -o c.spm",
        88.0 + BESIDE,
        "wait for others",
    ),
    refused(
        "lines through a pixel",
        "spconstrain --lines star.txt --memory 4M mesh.spm -o c.spm",
        4.0 + BESIDE,
        "wait for others",
    ),
    kept(
        "a mask with room",
        "spdem --mask squares.wkt --columns 2000 --memory 24M mesh.spm -o o.tif",
        24.0 + BESIDE,
    ),
    refused(
        "a mask of contour lines",
        "spdem --mask squares.wkt --contours 0.01 --memory 24M mesh.spm -o o.geojson",
        24.0 + BESIDE,
        "edges of polygons take",
    ),
    refused("leaves", "spfinalize --level 12 --memory 40M --threads 1 plane.txt", 40.0, "level 12"),
    refused("long edges", "spconstrain --kill 0.001 --memory 1M mesh.spm", 1.0 + BESIDE, "--kill"),
    refused("an outline", "spdem --concave 0.001 --memory 1M mesh.spm -o o.tif", 1.0 + BESIDE, "--concave"),
    kept("tiles", "spdem --columns 2000 --memory 1M mesh.spm -o o.tif", 1.0 + BESIDE),
    refused(
        "lines",
        "spconstrain --lines lines.txt --memory 1M mesh.spm -o c.spm",
        1.0 + BESIDE,
        "of lines so far",
    ),
    refused(
        "lines of points",
        "spfinalize --lines lines.txt --memory 40M --threads 1 plane.txt",
        40.0,
        "so far",
    ),
    refused(
        "triangles at lines",
        "spconstrain --lines zigzag.txt --memory 1M mesh.spm -o c.spm",
        1.0 + BESIDE,
        "wait for others",
    ),
    refused(
        "a mesh in any order, and lines",
        "spconstrain --lines line.txt --memory 1M soup.spm -o c.spm",
        1.0 + BESIDE,
        "not final so far",
    ),
    refused(
        "a mesh in any order",
        "spdem --step 10 --bounds 0,0,200,200 --memory 1M soup.spm -o o.tif",
        1.0 + BESIDE,
        "not final so far",
    ),
    refused(
        "a ground in any order",
        "spheight --ground soup.spm --memory 1M --threads 1 tile.laz -o h.laz",
        1.0 + 40.0 + BESIDE,
        "not final so far",
    ),
    refused(
        "sums of triangles",
        "spdem --sample mean --columns 2000 --memory 1M mesh.spm -o o.tif",
        1.0 + BESIDE,
        "the sums of a tile",
    ),
    refused(
        "sums of points",
        "spdem --points --kind mean --columns 2000 --memory 1M order.spm -o o.tif",
        1.0 + BESIDE,
        "the sums of a tile",
    ),
    refused(
        "a canopy",
        "spcanopy --ground ground.spm --step 0.1 --memory 64M --threads 1 tile.laz -o c.tif",
        BESIDE,
        "is too little",
    ),
    kept(
        "a canopy with room",
        "spcanopy --ground ground.spm --step 0.1 --memory 80M --threads 1 tile.laz -o c.tif",
        80.0,
    ),
    refused("cells of four dimensions", "dd4 --memory 16M curve4.txt", 20.0, "too many cells"),
];

/// The inputs, each made by a program.
const INPUTS: [&str; 9] = [
    "spfinalize --level 11 plane.txt -o tags.spm",
    "spfinalize --octree --level 7 plane.txt -o tags3.spm",
    "spfinalize --octree curve.txt -o curve.spm",
    "spfinalize --preserve --level 8 many.txt -o order.spm",
    "spfinalize --cell-points 1 nested.txt -o deep.spm",
    "spdelaunay2d order.spm -o mesh.spm",
    "spconvert soup.obj -o soup.spm",
    "spfinalize tile.laz -o tile.spm",
    "spdelaunay2d tile.spm -o ground.spm",
];

/// Lines of numbers.
fn text<const D: usize>(count: usize, mut point: impl FnMut(usize) -> [f64; D]) -> String {
    (0..count).map(|i| point(i).map(|x| x.to_string()).join(" ") + "\n").collect()
}

/// Writes what [`INPUTS`] are made of.
fn write_points(folder: &Path) {
    let mut random = Random::new(1);
    let mut unit = || random.unit();
    let write = |name: &str, text: String| fs::write(folder.join(name), text).expect("a folder");
    write("plane.txt", text(6_000, |_| [1e3 * unit(), 1e3 * unit(), 1e3 * unit()]));
    write("many.txt", text(20_000, |_| [1e3 * unit(), 1e3 * unit(), unit()]));
    write("nested.txt", text(3_000, |_| [0; 3].map(|_: i32| (-20.0 * unit()).exp2())));
    let at = |i: usize| i as f64 / 3_000.0;
    write(
        "curve.txt",
        text(3_000, |i| [(20.0 * TAU * at(i)).cos(), (20.0 * TAU * at(i)).sin(), 10.0 * at(i)]),
    );
    write("curve4.txt", text(500, |i| [1, 2, 3, 4].map(|power| (i as f64 / 500.0).powi(power))));
    let line = |count: usize, steps: usize| {
        let at = |i: usize| {
            format!(" {} {}", 1e3 * (i as f64 / count as f64), 1e3 * (i % steps) as f64 / steps as f64)
        };
        "soft".to_string() + &(0..count).map(|i| at(i) + "\n").collect::<String>()
    };
    write("lines.txt", line(20_000, 7));
    write("zigzag.txt", line(2_000, 2));
    write("line.txt", line(2, 2));
    let grid = |i: usize| format!("soft {i} -1 {i} 600\nsoft -1 {i} 600 {i}\n");
    write("grid.txt", (0..600).map(grid).collect());
    // All pass between the same places, where none ends.
    let star = |i: usize| format!("soft {} {i} {} {}\n", -1_000 - i as i64, 3_000 + i, 1_000 - i as i64);
    write("star.txt", (0..1_000).map(star).collect());
    write("soup.obj", soup());
    let tile = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/lareunion.laz");
    fs::copy(tile, folder.join("tile.laz")).expect("a sample");
    let square = |_| {
        let [x, y] = [1e3 * unit(), 1e3 * unit()];
        let [u, v] = [x + 1.0, y + 1.0];
        format!("POLYGON(({x} {y},{u} {y},{u} {v},{x} {v},{x} {y}))\n")
    };
    write("squares.wkt", (0..30_000).map(square).collect());
    let lakes: Vec<String> = (0..20).map(|i| lake([490.0 + f64::from(i), 500.0], 0.5)).collect();
    write("lakes.geojson", layer(&lakes));
    write("sea.geojson", layer(&[lake([0.0, 0.0], 1e3)]));
    let record =
        |i: i32| Record { position: [i % 1000 * 99, i / 1000 * 99, 7], class: 9, ..Record::default() };
    let water = LasFile { records: (0..72_000).map(record).collect(), ..LasFile::of(&[]) };
    fs::write(folder.join("water.las"), water.bytes()).expect("a folder");
}

/// A square lake without a level, from its lower left corner.
fn lake([x, y]: [f64; 2], side: f64) -> String {
    let [u, v] = [x + side, y + side];
    format!(
        r#"{{"type":"Feature","properties":{{}},"geometry":{{"type":"Polygon","coordinates":[[[{x},{y}],[{u},{y}],[{u},{v}],[{x},{v}],[{x},{y}]]]}}}}"#
    )
}

fn layer(features: &[String]) -> String {
    format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, features.join(","))
}

/// A mesh of which no vertex is final before its end: the format does not say which are.
fn soup() -> String {
    const SIDE: usize = 200;
    let vertex = |i: usize| format!("v {} {} {}\n", i % SIDE, i / SIDE, i % 7);
    let faces = |i: usize| {
        let a = 1 + i / (SIDE - 1) * SIDE + i % (SIDE - 1);
        let (b, c, d) = (a + 1, a + SIDE, a + SIDE + 1);
        format!("f {a} {b} {d}\nf {a} {d} {c}\n")
    };
    (0..SIDE * SIDE).map(vertex).chain((0..(SIDE - 1) * (SIDE - 1)).map(faces)).collect()
}

/// The command of a line, in a folder.
fn command(line: &str, folder: &Path) -> Command {
    let mut words = line.split(' ');
    let mut command = tool(words.next().expect("a program"));
    command.current_dir(folder).arg("-q").args(words);
    command
}

#[test]
fn budgets_are_kept_or_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    write_points(folder.path());
    for line in INPUTS {
        let made = Measured::of(&mut command(line, folder.path()));
        assert_eq!(made.code, Some(0), "{line}: {}", made.message);
    }
    let mut faults = Vec::new();
    for Run { name, line, most, refused } in RUNS {
        let found = Measured::of(&mut command(line, folder.path()));
        let mebibytes = found.megabytes * 1e6 / f64::from(1 << 20);
        let outcome = format!("{name}: code {:?}, {mebibytes:.1} MiB, {}", found.code, found.message.trim());
        println!("{outcome}");
        let is_right = found.code == Some(if refused.is_some() { 5 } else { 0 });
        let is_said = refused.is_none_or(|part| found.message.contains(part));
        if !is_right || !is_said || mebibytes > most {
            faults.push(outcome);
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
