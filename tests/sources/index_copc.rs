//! Partial reading of COPC files: what a box needs, or an error if the index is wrong.

use std::path::{Path, PathBuf};

use super::{assert_fails, decoded, flat, points_of, sample};
use crate::allocation::largest_during;
use crate::programs::Folder;
use spmesh_base::error::ErrorKind;
use spmesh_base::random::Random;
use spmesh_formats::source::{Filters, Input, SourceOptions};
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::{Coordinates, Crs};

const SAMPLE: &str = "simple_with_page.copc.laz";
/// Its records, and the places of its info record and its pages.
const POINTS: u64 = 1065;
const INFO: usize = 429;
const ROOT: [usize; 2] = [31_604, 1952];
const PAGE: [usize; 2] = [33_556, 160];

const INFINITE: f64 = f64::INFINITY;
const EVERYTHING: Bounds = Bounds { min: [-INFINITE; 3], max: [INFINITE; 3] };

/// Options of a pass that wants the points in `bounds`, and of one that may leave out others.
fn options(bounds: Bounds) -> [SourceOptions; 2] {
    let threads = std::num::NonZeroUsize::new(1);
    let filters = Filters { keep_withheld: true, ..Filters::default() };
    let whole = SourceOptions { bounds: Some(bounds), filters, threads, ..flat() };
    [whole.clone(), SourceOptions { reach: Some(bounds), ..whole }]
}

/// Corners and extent of a file.
fn extent(path: &Path) -> Bounds {
    let input = Input::open(&[path.to_path_buf()], &flat()).unwrap();
    let stored = input.description().stated_bounds.unwrap();
    let world = |corner| input.description().coordinates.to_world(corner);
    Bounds { min: world(stored.min), max: world(stored.max) }
}

/// A box with sides of about `part` of the extent.
fn random_box(random: &mut Random, extent: &Bounds, part: f64) -> Bounds {
    let mut found = EVERYTHING;
    for axis in 0..3 {
        let side = extent.max[axis] - extent.min[axis];
        let middle = extent.min[axis] + side * random.unit();
        let half = side * part * random.unit();
        if random.below(8) > 0 {
            found.min[axis] = middle - half;
        }
        if random.below(8) > 0 {
            found.max[axis] = middle + half;
        }
    }
    found
}

/// A file that is read once: its points as they are stored, and in the world.
struct Whole {
    path: PathBuf,
    stored: Vec<Point>,
    world: Vec<Point>,
    scale: [f64; 3],
}

impl Whole {
    fn new(name: &str) -> Whole {
        let path = sample(name);
        let [whole, _] = options(EVERYTHING);
        let stored = decoded(&path, &whole).unwrap().0;
        let input = Input::open(std::slice::from_ref(&path), &flat()).unwrap();
        let Coordinates::I32 { scale, offset } = input.description().coordinates else { panic!("a grid") };
        let world = |point: &Point| [0, 1, 2].map(|axis| point[axis] * scale[axis] + offset[axis]);
        Whole { path, world: stored.iter().map(world).collect(), stored, scale }
    }

    /// The points in a box, of which all sides belong to it, however coordinates are rounded.
    fn inside(&self, bounds: Bounds) -> Vec<Point> {
        let rounding = self.scale.map(|scale| 1e-6 * scale);
        let is_inside = |at: &Point| {
            (0..3).all(|axis| {
                bounds.min[axis] - rounding[axis] <= at[axis] && at[axis] <= bounds.max[axis] + rounding[axis]
            })
        };
        let pairs = self.stored.iter().zip(&self.world);
        pairs.filter(|(_, at)| is_inside(at)).map(|(stored, _)| *stored).collect()
    }

    /// Checks that partial reading gives the points in a box, and returns the number of records decoded.
    fn check(&self, bounds: Bounds) -> u64 {
        let [_, part] = options(bounds);
        let (found, records, notices) = decoded(&self.path, &part).unwrap();
        assert_eq!(found, self.inside(bounds), "{bounds:?}");
        assert!(records >= found.len() as u64 && notices.is_empty(), "{notices:?}");
        records
    }

    /// As [`Whole::check`], and that reading without the index does so, too.
    fn check_both(&self, bounds: Bounds) -> u64 {
        let [whole, _] = options(bounds);
        assert_eq!(decoded(&self.path, &whole).unwrap().0, self.inside(bounds), "{bounds:?}");
        self.check(bounds)
    }
}

#[test]
fn points_in_a_box_are_found_with_fewer_records() {
    let mut random = Random::new(1);
    for (name, points) in [(SAMPLE, POINTS), ("autzen.copc.laz", 107)] {
        let whole = Whole::new(name);
        let extent = extent(&whole.path);
        assert_eq!(whole.stored.len() as u64, points);
        assert_eq!(whole.check(EVERYTHING), points);
        for part in [0.0, 0.02, 0.1, 0.5] {
            whole.check_both(random_box(&mut random, &extent, part));
            for _ in 1..20 {
                whole.check(random_box(&mut random, &extent, part));
            }
        }
    }
    // Boxes of a 16th of the area.
    let (whole, mut records) = (Whole::new(SAMPLE), 0);
    let Bounds { min, max } = extent(&whole.path);
    for place in 0..16 {
        let side = |axis: usize, number: u32| min[axis] + (max[axis] - min[axis]) * f64::from(number) / 4.0;
        let (x, y) = (place % 4, place / 4);
        let (mut low, mut high) = ([-INFINITE; 3], [INFINITE; 3]);
        (low[0], high[0], low[1], high[1]) = (side(0, x), side(0, x + 1), side(1, y), side(1, y + 1));
        records += whole.check(Bounds { min: low, max: high });
    }
    assert!(records < POINTS * 16 / 4, "{records}");
    let beside = Bounds { min: [max[0] + 1e5, -INFINITE, -INFINITE], max: [INFINITE; 3] };
    assert_eq!(whole.check_both(beside), 0);
}

/// Boxes with sides at borders of cubes, and boxes of one point.
#[test]
fn boxes_are_closed() {
    let whole = Whole::new(SAMPLE);
    let bytes = std::fs::read(&whole.path).unwrap();
    let number = |index: usize| f64::from_le_bytes(*bytes[INFO + 8 * index..].first_chunk().unwrap());
    let border = |axis: usize, eighths: u32| number(axis) + number(3) * (f64::from(eighths) / 4.0 - 1.0);
    for eighths in 0..=8 {
        for axis in 0..3 {
            let (mut lower, mut upper, mut side) = (EVERYTHING, EVERYTHING, EVERYTHING);
            lower.max[axis] = border(axis, eighths);
            upper.min[axis] = border(axis, eighths);
            (side.min[axis], side.max[axis]) = (border(axis, eighths), border(axis, eighths));
            whole.check(lower);
            whole.check(upper);
            whole.check_both(side);
        }
    }
    for &place in whole.world.iter().step_by(39) {
        let bounds = Bounds::of_point(place);
        assert!(!whole.inside(bounds).is_empty());
        whole.check(bounds);
    }
}

#[test]
fn the_file_of_a_batch_is_known_and_records_are_counted() {
    let paths = [sample(SAMPLE), sample("hextest.las"), sample("autzen.copc.laz")];
    let options = SourceOptions { crs: Some(Crs::Unknown), ..flat() };
    let input = Input::open(&paths, &options).unwrap();
    let mut reader = input.read().unwrap();
    let (mut batch, mut counts, mut before) = (Vec::new(), [0; 3], 0);
    loop {
        reader.next_batch(&mut batch).unwrap();
        if batch.is_empty() {
            break;
        }
        counts[reader.file()] += reader.records() - before;
        before = reader.records();
    }
    assert_eq!(counts, [POINTS, 8, 107]);
    let empty = Bounds { min: [0.0, f64::NAN, 0.0], max: [1.0; 3] };
    let result = Input::open(&paths, &SourceOptions { reach: Some(empty), ..flat() });
    assert_fails(result, ErrorKind::Usage, &["is empty"]);
}

/// What is wrong with a file must never show as missing points.
fn assert_sound(path: &Path, bounds: Bounds, what: &str) -> bool {
    let [whole, part] = options(bounds);
    let found = decoded(path, &part);
    let error = match found {
        Ok((found, _, _)) => {
            assert_eq!(found, decoded(path, &whole).unwrap().0, "{what}: {bounds:?}");
            return true;
        }
        Err(error) => error,
    };
    assert_eq!(error.kind(), ErrorKind::Malformed, "{what}: {error}");
    let message = error.to_string();
    assert!(message.contains("without the index") && message.contains("damaged.laz"), "{what}: {message}");
    false
}

#[test]
fn damage_to_the_index_loses_no_points_in_silence() {
    let whole = std::fs::read(sample(SAMPLE)).unwrap();
    let folder = Folder::new();
    let extent = extent(&sample(SAMPLE));
    let mut random = Random::new(2);
    let (mut readable, mut refused) = (0, 0);
    let places = (INFO..INFO + 56).chain(ROOT[0]..ROOT[0] + ROOT[1]).chain(PAGE[0]..PAGE[0] + PAGE[1]);
    // Every third byte: all fields of entries and all bits come up.
    for at in places.step_by(3) {
        for change in [1 << random.below(8), 0xff] {
            let mut damaged = whole.clone();
            damaged[at] ^= change;
            let path = folder.file("damaged.laz", &damaged);
            let bounds = random_box(&mut random, &extent, 0.3);
            let mut is_read = false;
            let largest = largest_during(|| {
                is_read = assert_sound(&path, bounds, &format!("byte {at} ^ {change}"));
            });
            assert!(largest <= 65 << 20, "a request of {largest} bytes");
            *if is_read { &mut readable } else { &mut refused } += 1;
        }
    }
    // The key of a page, spacing and numbers of empty nodes do not matter.
    assert!(refused > 20 * readable, "{readable} read, {refused} refused");
}

/// Reads the sample with a change, in a box around the whole.
fn read_changed(change: impl FnOnce(&mut Vec<u8>)) -> spmesh_base::error::Result<u64> {
    let mut bytes = std::fs::read(sample(SAMPLE)).unwrap();
    change(&mut bytes);
    let folder = Folder::new();
    let [_, part] = options(EVERYTHING);
    decoded(&folder.file("damaged.laz", bytes), &part).map(|(_, records, _)| records)
}

#[test]
fn errors_of_an_index_name_the_place_and_the_remedy() {
    let fails = |change: &dyn Fn(&mut Vec<u8>), parts: &[&str]| {
        let parts = [&["damaged.laz", "write the file again as LAZ without the index"], parts].concat();
        assert_fails(read_changed(change), ErrorKind::Malformed, &parts);
    };
    let entry = |number: usize| ROOT[0] + 32 * number;
    // Nodes that exchange their points.
    fails(
        &|bytes| (0..16).for_each(|i| bytes.swap(entry(5) + i, entry(40) + i)),
        &["record", "lies outside"],
    );
    // A page without its last entry.
    fails(
        &|bytes| bytes[INFO + 48..INFO + 56].copy_from_slice(&1920u64.to_le_bytes()),
        &["no node has the points", "records"],
    );
    let key = [0u32; 4].map(u32::to_le_bytes);
    fails(
        &|bytes| bytes[entry(9)..entry(9) + 16].copy_from_slice(key.as_flattened()),
        &["0-0-0-0 is there twice"],
    );
    fails(&|bytes| bytes[entry(9) + 28] += 1, &["points in", "has no such chunk"]);
    fails(&|bytes| bytes[entry(9) + 28..entry(9) + 32].fill(0), &["no node has the points", "records"]);
    fails(&|bytes| bytes[INFO + 24..INFO + 32].fill(0), &["half a side of 0", "COPC record at byte 429"]);
    fails(&|bytes| bytes[INFO + 40..INFO + 48].fill(0xff), &["beyond the end of the file"]);
    // Also where no box is wanted: a job of a plan may want one.
    let mut cut = std::fs::read(sample(SAMPLE)).unwrap();
    let first = cut.len() as u64 - ROOT[1] as u64;
    for (first, is_there) in [(first, true), (first + 1, false), (u64::MAX, false)] {
        cut[INFO + 40..INFO + 48].copy_from_slice(&first.to_le_bytes());
        match is_there {
            true => assert_eq!(points_of(&cut).unwrap().len() as u64, POINTS),
            false => assert_fails(points_of(&cut), ErrorKind::Malformed, &["beyond the end of the file"]),
        }
    }
    // Without its record, the file is an ordinary LAZ file, read as a whole.
    assert_eq!(read_changed(|bytes| bytes[377] = b'C').unwrap(), POINTS);
}
