//! Partial reading by an index of LAStools: what a box needs, or everything and a notice.

use std::fs::File;
use std::path::Path;
use std::time::{Duration, SystemTime};

use super::las_file::LasFile;
use super::lax_writer::{Layout, appended, embedded, index};
use super::{assert_fails, decoded, flat};
use crate::programs::Folder;
use spmesh_base::error::ErrorKind;
use spmesh_base::random::Random;
use spmesh_formats::source::SourceOptions;
use spmesh_stream::model::bounds::{Bounds, Point};

const POINTS: usize = 6_000;
const CHUNK: u32 = 150;
/// Units: steps.
const SIDE: i32 = 100_000;
const OFFSET: [f64; 3] = [500_000.0, 6_000_000.0, 0.0];

/// Points in strips, as of a flight, every 7th in a corner.
fn file(format: u8) -> LasFile {
    let mut random = Random::new(3);
    let mut place = |i: usize| {
        let strip = (i * 8 / POINTS) as i32 * (SIDE / 8);
        let along = (i * 8 % POINTS) as f64 / POINTS as f64;
        let across = random.below(SIDE as u64 / 8) as i32;
        let [x, y] = [strip + across, (f64::from(SIDE) * along) as i32];
        if i.is_multiple_of(7) { [x / 8, y / 8, i as i32] } else { [x, y, i as i32] }
    };
    let positions: Vec<[i32; 3]> = (0..POINTS).map(&mut place).collect();
    LasFile { format, offset: OFFSET, ..LasFile::of(&positions) }
}

fn world(las: &LasFile) -> Vec<[f64; 2]> {
    let world =
        |position: [i32; 3], axis: usize| f64::from(position[axis]) * las.scale[axis] + las.offset[axis];
    las.records.iter().map(|record| [world(record.position, 0), world(record.position, 1)]).collect()
}

/// An index over the square of the points, and what its rounding to f32 leaves out.
fn index_of(las: &LasFile, layout: Layout) -> Vec<u8> {
    let (x, y) = (OFFSET[0] as f32, OFFSET[1] as f32);
    index(&world(las), [x - 24.0, y - 24.0], [x + 1000.0, y + 1000.0], layout)
}

const LAYOUTS: [Layout; 4] = [
    Layout { levels: 4, points_min: 0, gap: 1 },
    Layout { levels: 5, points_min: 200, gap: 20 },
    Layout { levels: 3, points_min: 100_000, gap: 1000 },
    Layout { levels: 0, points_min: 0, gap: 1 },
];

fn options(bounds: Bounds) -> [SourceOptions; 2] {
    let threads = std::num::NonZeroUsize::new(1);
    let whole = SourceOptions { bounds: Some(bounds), threads, ..flat() };
    [whole.clone(), SourceOptions { reach: Some(bounds), ..whole }]
}

/// A box of the world with sides of about `part` of the square, unbounded in z.
fn random_box(random: &mut Random, part: f64) -> Bounds {
    let mut found = Bounds { min: [f64::NEG_INFINITY; 3], max: [f64::INFINITY; 3] };
    for (axis, offset) in OFFSET.into_iter().enumerate().take(2) {
        let middle = offset + 1000.0 * random.unit();
        let half = 1000.0 * part * random.unit();
        (found.min[axis], found.max[axis]) = (middle - half, middle + half);
    }
    found
}

/// Checks that partial reading of a file of `las` gives the points in a box; returns the number of records
/// decoded, and notices.
fn check(path: &Path, las: &LasFile, bounds: Bounds) -> (u64, Vec<String>) {
    let [_, part] = options(bounds);
    let is_inside =
        |at: &[f64; 2]| (0..2).all(|axis| bounds.min[axis] <= at[axis] && at[axis] <= bounds.max[axis]);
    let pairs = las.records.iter().zip(world(las));
    let expected: Vec<Point> =
        pairs.filter(|(_, at)| is_inside(at)).map(|(record, _)| record.position.map(f64::from)).collect();
    let (found, records, notices) = decoded(path, &part).unwrap();
    assert_eq!(found, expected, "{bounds:?}");
    (records, notices)
}

/// As [`check`], and that reading without the index gives these points, too, of all records.
fn check_both(path: &Path, las: &LasFile, bounds: Bounds) -> (u64, Vec<String>) {
    let [whole, part] = options(bounds);
    let (expected, all, _) = decoded(path, &whole).unwrap();
    assert_eq!(decoded(path, &part).unwrap().0, expected, "{bounds:?}");
    assert_eq!(all, POINTS as u64);
    check(path, las, bounds)
}

#[test]
fn points_in_a_box_are_found_with_fewer_records() {
    let mut random = Random::new(4);
    for (format, layout) in [1, 6].into_iter().flat_map(|format| LAYOUTS.map(|layout| (format, layout))) {
        let las = file(format);
        let folder = Folder::new();
        let plain = folder.file("plain.las", las.bytes());
        let compressed = folder.file("compressed.laz", las.compressed(CHUNK));
        for name in ["plain.lax", "compressed.lax"] {
            folder.file(name, index_of(&las, layout));
        }
        let mut records = [0, 0];
        for round in 0..8 {
            let check = if round < 4 { check_both } else { check };
            let bounds = random_box(&mut random, [0.0, 0.01, 0.1, 0.4][round % 4]);
            for (path, records) in [&plain, &compressed].into_iter().zip(&mut records) {
                let (count, notices) = check(path, &las, bounds);
                assert!(notices.is_empty(), "{notices:?}");
                *records += count;
            }
        }
        let all = 8 * POINTS as u64;
        let expected = if layout.levels > 3 { all / 2 } else { all };
        assert!(records.iter().all(|&records| records <= expected), "{records:?} of {all}");
    }
}

#[test]
fn an_index_in_the_file_is_used() {
    let las = file(6);
    let index = index_of(&las, LAYOUTS[0]);
    let mut random = Random::new(5);
    let folder = Folder::new();
    let files = [
        embedded(las.bytes(), &index),
        embedded(las.compressed(CHUNK), &index),
        appended(las.compressed(CHUNK), &index),
        // Other files have the same places.
        appended(file(1).compressed(CHUNK), &index_of(&file(1), LAYOUTS[1])),
    ];
    for content in files {
        let path = folder.file("tile.laz", content);
        for _ in 0..10 {
            let (records, notices) = check(&path, &las, random_box(&mut random, 0.05));
            assert!(records < POINTS as u64 && notices.is_empty(), "{records}, {notices:?}");
        }
    }
}

/// A change of the bytes of an index, and what the notice says of it.
type Change = (&'static str, Box<dyn Fn(&mut Vec<u8>)>);

/// Changes of an index after which it does not fit the file.
fn changes() -> Vec<Change> {
    vec![
        ("cut off", Box::new(|bytes| bytes.truncate(bytes.len() - 1))),
        ("1 bytes follow", Box::new(|bytes| bytes.push(0))),
        // The levels of the tree.
        ("cell", Box::new(|bytes| bytes[24] = 1)),
        ("quadtree of 16 levels", Box::new(|bytes| bytes[24] = 16)),
        // The last record of the last interval.
        (
            "points in",
            Box::new(|bytes| {
                let at = bytes.len() - 4;
                bytes[at..].fill(0xff);
            }),
        ),
    ]
}

#[test]
fn an_index_that_does_not_fit_is_left_out() {
    let las = file(1);
    let whole = index_of(&las, LAYOUTS[0]);
    let folder = Folder::new();
    let mut random = Random::new(6);
    let refused = |path: &Path, random: &mut Random, what: &str| {
        let (records, notices) = check(path, &las, random_box(random, 0.05));
        assert_eq!(records, POINTS as u64, "{what}");
        let is_named = |notice: &String| notice.contains(what) && notice.contains("tile.lax is left out");
        assert!(notices.iter().any(is_named), "{what}: {notices:?}");
    };
    for content in [las.bytes(), las.compressed(CHUNK)] {
        let path = folder.file("tile.laz", content);
        for (what, change) in changes() {
            let mut index = whole.clone();
            change(&mut index);
            folder.file("tile.lax", index);
            refused(&path, &mut random, what);
        }
        // Points that are not in the file, and points that the index does not know.
        for count in [POINTS + 1, POINTS - 1] {
            let mut other = las.clone();
            other.records.resize(count, other.records[0]);
            folder.file("tile.lax", index_of(&other, LAYOUTS[0]));
            refused(&path, &mut random, "ranges of records, the file has 6000 points");
        }
        // The same points in another order, and points of another place.
        let mut other = las.clone();
        other.records.reverse();
        folder.file("tile.lax", index_of(&other, LAYOUTS[0]));
        refused(&path, &mut random, "is not in the cells that should have it");
        let elsewhere: Vec<_> = world(&las).into_iter().map(|[x, y]| [x + 5000.0, y]).collect();
        let (x, y) = (OFFSET[0] as f32 + 5000.0, OFFSET[1] as f32);
        folder.file("tile.lax", index(&elsewhere, [x, y], [x + 1024.0, y + 1024.0], LAYOUTS[0]));
        refused(&path, &mut random, "of another place");
        let current = folder.file("tile.lax", &whole);
        let past = SystemTime::now() - Duration::from_secs(1000);
        File::options().write(true).open(current).unwrap().set_modified(past).unwrap();
        refused(&path, &mut random, "older than the file");
        // Without any change it is used.
        folder.file("tile.lax", &whole);
        assert!(check(&path, &las, random_box(&mut random, 0.05)).0 < POINTS as u64);
    }
}

#[test]
fn damage_to_an_index_loses_no_points() {
    let las = file(1);
    let whole = index_of(&las, LAYOUTS[2]);
    let folder = Folder::new();
    let path = folder.file("tile.las", las.bytes());
    let mut random = Random::new(7);
    let mut refused = 0;
    for at in (0..whole.len()).step_by(3) {
        let mut damaged = whole.clone();
        damaged[at] ^= 1 << random.below(8);
        folder.file("tile.lax", damaged);
        refused += usize::from(!check(&path, &las, random_box(&mut random, 0.1)).1.is_empty());
    }
    assert!(refused > whole.len() / 6, "{refused} of {}", whole.len() / 3);
}

#[test]
fn records_keep_their_numbers() {
    let mut las = file(1);
    let far = las.records.len() - 100;
    las.records[far].position[2] = 1 << 30;
    let folder = Folder::new();
    let [x, y] = world(&las)[far];
    let reach = Some(Bounds { min: [x, y, f64::NEG_INFINITY], max: [x, y, f64::INFINITY] });
    for (name, content) in [("tile.las", las.bytes()), ("tile.laz", las.compressed(CHUNK))] {
        let path = folder.file(name, content);
        folder.file("tile.lax", index_of(&las, LAYOUTS[0]));
        let grid = Some(([0.001; 3], OFFSET));
        let options = SourceOptions { reach, grid, ..flat() };
        let named = format!("record {far}: ");
        assert_fails(decoded(&path, &options), ErrorKind::Usage, &["beyond 32 bits", &named]);
        assert!(decoded(&path, &SourceOptions { reach, ..flat() }).unwrap().1 < POINTS as u64);
    }
}
