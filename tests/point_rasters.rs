//! `spdem --points`: statistics of the points in cells, against a table of all of them.

use std::collections::BTreeMap;

use spmesh_base::random::Random;

use crate::programs::{Folder, assert_outcome, outcome, run, sample};
use crate::sources::las_file::LasFile;

/// Steps of 0.1, cells of 2: 20 steps.
const SCALE: f64 = 0.1;
const STEPS: i32 = 20;

/// Files of points that are awkward: on borders of cells, in one place, far apart, few or none.
fn files() -> Vec<LasFile> {
    let mut random = Random::new(11);
    let mut places: Vec<Vec<[i32; 3]>> = (0..4).map(|count| vec![[7, -3, 5]; count]).collect();
    places.push((0..5000).map(|_| [0, 0, 0].map(|_: i32| random.below(2000) as i32 - 1000)).collect());
    places.push((0..900).map(|i| [i % 30 * STEPS, i / 30 * STEPS, i]).collect());
    places.push((0..50).map(|i| [i * STEPS, 0, -i * i]).collect());
    let mut files: Vec<LasFile> = places.iter().map(|places| of_steps(places)).collect();
    files.push(far_apart([2003, 1009]));
    files
}

fn of_steps(places: &[[i32; 3]]) -> LasFile {
    LasFile { scale: [SCALE; 3], ..LasFile::of(places) }
}

/// Points all over an area of about this many units, which is in many tiles.
fn far_apart([width, height]: [i32; 2]) -> LasFile {
    let places: Vec<_> = (0..300).map(|i| [i * 7919 % width * 10, i * 104_729 % height * 10, i]).collect();
    of_steps(&places)
}

/// An area of 25 million cells.
const WIDE: [i32; 2] = [10_007, 9_973];

fn stream_of(file: &LasFile) -> Vec<u8> {
    let points = run("spfinalize", &["-q", "--attributes", "intensity", "-"], &file.bytes());
    assert!(points.status.success(), "{:?}", outcome(&points));
    points.stdout
}

/// An ESRI grid: its header, and the values from the top; `None` for no data.
struct Grid {
    left: i32,
    bottom: i32,
    rows: usize,
    values: Vec<Vec<Option<f64>>>,
}

impl Grid {
    fn of(text: &[u8]) -> Grid {
        let text = std::str::from_utf8(text).unwrap();
        let mut head = BTreeMap::new();
        for line in text.lines().take(6) {
            let (name, value) = line.split_once(' ').unwrap();
            head.insert(name.to_string(), value.parse::<f64>().unwrap());
        }
        let missing = head["NODATA_value"];
        let number = |word: &str| word.parse::<f64>().ok().filter(|&value| value != missing);
        let values: Vec<Vec<_>> =
            text.lines().skip(6).map(|line| line.split(' ').map(number).collect()).collect();
        let cell = |name: &str| (head[name] / 2.0) as i32;
        Grid { left: cell("xllcorner"), bottom: cell("yllcorner"), rows: values.len(), values }
    }

    /// The value of the cell with these numbers, counted from 0, 0 in the world.
    fn at(&self, [x, y]: [i32; 2]) -> Option<f64> {
        let row = self.rows as i32 - 1 - (y - self.bottom);
        *self.values.get(usize::try_from(row).ok()?)?.get(usize::try_from(x - self.left).ok()?)?
    }

    fn known(&self) -> usize {
        self.values.iter().flatten().flatten().count()
    }
}

fn expected(kind: &str, values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    match kind {
        "count" => count,
        "density" => count / 4.0,
        "min" => least,
        "max" => greatest,
        "range" => greatest - least,
        "mean" => mean,
        _ => (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt(),
    }
}

#[test]
fn cells_hold_statistics_of_their_points() {
    check_statistics(files());
}

/// Cells of millions, most of them empty.
#[test]
#[ignore = "long: run with -- --ignored"]
fn cells_of_wide_areas_hold_statistics_of_their_points() {
    check_statistics(vec![far_apart(WIDE)]);
}

fn check_statistics(files: Vec<LasFile>) {
    for mut file in files {
        let mut random = Random::new(3);
        file.records.iter_mut().for_each(|record| record.intensity = random.below(60_000) as u16);
        let stream = stream_of(&file);
        let mut cells: BTreeMap<[i32; 2], Vec<[f64; 2]>> = BTreeMap::new();
        for record in &file.records {
            let [x, y, z] = record.position;
            let values = [f64::from(z) * SCALE, f64::from(record.intensity)];
            cells.entry([x.div_euclid(STEPS), y.div_euclid(STEPS)]).or_default().push(values);
        }
        for kind in ["count", "density", "min", "max", "range", "mean", "std"] {
            for (which, attribute) in [&[][..], &["--attribute", "intensity"]].into_iter().enumerate() {
                let flags = ["-q", "--points", "--kind", kind, "--step", "2", "--format", "asc"];
                let arguments = [&flags[..], attribute].concat();
                let output = run("spdem", &arguments, &stream);
                if file.records.is_empty() {
                    assert_eq!(output.status.code(), Some(2), "{:?}", outcome(&output));
                    continue;
                }
                assert!(output.status.success(), "{:?}", outcome(&output));
                let grid = Grid::of(&output.stdout);
                for (&cell, values) in &cells {
                    let values: Vec<f64> = values.iter().map(|value| value[which]).collect();
                    let (found, expected) = (grid.at(cell).unwrap(), expected(kind, &values));
                    let is_near = (found - expected).abs() <= 1e-6 * expected.abs().max(1.0);
                    assert!(is_near, "{kind} {cell:?}: {found}, expected {expected}");
                }
                let all = grid.values.iter().map(Vec::len).sum();
                let numbers = matches!(kind, "count" | "density");
                assert_eq!(grid.known(), if numbers { all } else { cells.len() }, "{kind}");
            }
        }
    }
}

/// Cells that wait on the disk, points in another order, and formats hold the same.
#[test]
fn order_and_memory_do_not_matter() {
    let folder = Folder::new();
    let mut file = far_apart(WIDE);
    let stream = stream_of(&file);
    file.records.reverse();
    let preserved = run("spfinalize", &["-q", "--preserve", "-"], &file.bytes()).stdout;
    for kind in ["mean", "std", "count"] {
        let grid = |stream: &[u8], name: &str, flags: &[&str]| {
            let path = folder.path(name);
            let arguments = [&["--points", "--kind", kind, "--step", "5", "-o", &path], flags].concat();
            let output = run("spdem", &arguments, stream);
            assert!(output.status.success(), "{:?}", outcome(&output));
            (std::fs::read(path).unwrap(), output.stderr)
        };
        for name in ["a.asc", "a.tif"] {
            let whole = grid(&stream, name, &["-q"]).0;
            let (tight, stats) = grid(&stream, name, &["-q", "--memory", "64M", "--stats=json"]);
            assert!(
                whole == tight && !String::from_utf8(stats).unwrap().contains("\"spilled\":0"),
                "{kind} {name}"
            );
            assert!(whole == grid(&preserved, name, &["-q"]).0, "{kind} {name}");
        }
    }
}

/// Floating-point coordinates, a part of the points, and nothing at all.
#[test]
fn parts_and_other_points_have_statistics() {
    let text = "0.25 0.25 1e6\n0.75 0.25 1000001.5\n1.5 0.5 -3\n9 9 1\n";
    let points = run("spfinalize", &["-q", "-"], text.as_bytes()).stdout;
    let flags = [
        "--points",
        "--kind",
        "mean",
        "--step",
        "1",
        "--bounds",
        "0,0,2,1",
        "--format",
        "asc",
        "--stats=json",
    ];
    let output = run("spdem", &flags, &points);
    let grid = Grid::of(&output.stdout);
    assert_eq!(grid.values, [[Some(1_000_000.75), Some(-3.0)]]);
    assert!(String::from_utf8(output.stderr).unwrap().contains("\"outside\":1"));
    let none = run("spfinalize", &["-q", "-"], b"# nothing\n").stdout;
    let output = run("spdem", &[&flags[..], &["-q"]].concat(), &none);
    assert!(output.status.success(), "{:?}", outcome(&output));
    assert_eq!(Grid::of(&output.stdout).values, [[None, None]]);
    let count = ["-q", "--points", "--step", "1", "--bounds", "0,0,2,1", "--format", "asc"];
    assert_eq!(Grid::of(&run("spdem", &count, &none).stdout).values, [[Some(0.0), Some(0.0)]]);
}

#[test]
fn wrong_requests_are_refused() {
    let points = stream_of(&LasFile::of(&[[0, 0, 0], [9, 9, 9]]));
    let mesh = run("spdelaunay2d", &["-q"], &points).stdout;
    let flat = run("spfinalize", &["-q", "-"], b"0 0\n1 1\n").stdout;
    for (arguments, input, code, part) in [
        (&["--points", "--kind", "slope"][..], &points, 2, "triangulate"),
        (&["--kind", "mean"], &mesh, 2, "add --points"),
        (&["--points"], &mesh, 2, "expected points"),
        (&["--points", "--kind", "max"], &flat, 2, "no elevation"),
        (&["--points", "--attribute", "colour"], &points, 2, "colour"),
        (&["--points", "--kill", "3"], &points, 2, "cannot be used with"),
        (&["--points", "--kind", "count", "--step", "1e-9"], &points, 2, "take larger cells"),
    ] {
        assert_outcome("spdem", arguments, input, code, part);
    }
    assert_outcome("spdem", &["--points"], &points[..points.len() / 2], 3, "stdin");
    // A file of another kind.
    let las = std::fs::read(sample("point10.las")).unwrap();
    assert_outcome("spdem", &["--points"], &las, 3, "");
}
