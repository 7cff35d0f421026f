//! Tiles of space: merging separately triangulated parts of an input gives the mesh of one run over all of
//! it.

use spmesh_audit::{Audit, Given, PointSet, Standard};
use spmesh_base::error::Result;
use spmesh_pipeline::reduce::{Options, Part, Stats};
use spmesh_stream::model::bounds::{Point, Region};
use spmesh_stream::{Coordinates, Header, StreamReader};

use super::solids::{bits, expected, fits_a_grid, read_mesh, tetrahedralize};
use super::streams::{GRID, Tagging, stream_of};
use spmesh_reference::clouds::{FAMILIES, Family, mixture, of};
use spmesh_reference::sets::Random;

const INF: f64 = f64::INFINITY;

/// A part of the input, triangulated and audited, and the statistics of the run.
pub fn partial(input: &[u8], part: Part<3>, options: &Options<3>) -> (Vec<u8>, Stats) {
    let (bytes, stats) = run(input, part, options);
    assert_proven(&bytes, None);
    (bytes, stats)
}

fn run(input: &[u8], part: Part<3>, options: &Options<3>) -> (Vec<u8>, Stats) {
    tetrahedralize(input, &Options { part: Some(part), ..*options }).unwrap()
}

/// Runs the exact audit, which shares no code with the reduction, against `points` if they are given.
fn assert_proven(bytes: &[u8], points: Option<&[Point]>) {
    let mut reader = StreamReader::new(bytes, "part").unwrap();
    let coordinates = reader.header().coordinates;
    let given = points.map(|points| {
        let mut given = PointSet::new(coordinates, 3);
        given.extend(points);
        Given::All(given.finish(&coordinates).unwrap())
    });
    let mut audit = Audit::new(reader.header(), Standard::Canonical, given).unwrap();
    while let Some(event) = reader.next_event().unwrap() {
        audit.event(&event).unwrap();
    }
}

pub fn merge(parts: &[Vec<u8>], region: Option<Region<3>>) -> Result<(Vec<u8>, Stats)> {
    let readers = parts.iter().map(|part| StreamReader::new(&part[..], "part")).collect::<Result<_>>()?;
    spmesh_pipeline::reduce::merge_tetrahedra(
        readers,
        Vec::new(),
        &Options { part: region.map(Part::Region), ..Options::default() },
        |_| (),
    )
}

/// Cuts space into tiles, and merges them in one go or in stages.
struct Tiler<'a> {
    points: &'a [Point],
    input: &'a [u8],
    options: Options<3>,
    random: &'a mut Random,
    is_staged: bool,
}

impl Tiler<'_> {
    /// Partial meshes that cover `region`, cut `depth` times at random: at a point, or beyond all points.
    fn parts(&mut self, region: Region<3>, depth: usize) -> Vec<Vec<u8>> {
        let Some([lower, upper]) = (depth > 0).then(|| self.cut(region)).flatten() else {
            return vec![self.tile(region)];
        };
        let mut parts = self.parts(lower, depth - 1);
        parts.extend(self.parts(upper, depth - 1));
        if !self.is_staged {
            return parts;
        }
        self.random.shuffle(&mut parts);
        let (merged, stats) = merge(&parts, Some(region)).unwrap();
        assert_eq!(stats.points, self.inside(region).len() as u64);
        assert_proven(&merged, Some(&self.inside(region)));
        vec![merged]
    }

    fn cut(&mut self, region: Region<3>) -> Option<[Region<3>; 2]> {
        let axis = self.random.integer(0, 2) as usize;
        let beyond = if self.random.integer(0, 5) == 0 { 1e6 } else { 0.0 };
        let number = self.random.integer(0, self.points.len().max(1) as i64 - 1);
        let border = self.points.get(number as usize).map_or(0.0, |point| point[axis]) + beyond;
        let [mut lower, mut upper] = [region; 2];
        (lower.max[axis], upper.min[axis]) = (border, border);
        (lower.min[axis] < border && border < upper.max[axis]).then_some([lower, upper])
    }

    fn tile(&self, region: Region<3>) -> Vec<u8> {
        let (bytes, stats) = run(self.input, Part::Region(region), &self.options);
        let inside = self.inside(region);
        assert_proven(&bytes, Some(&inside));
        let (all, inside) = (self.points.len(), inside.len());
        assert_eq!((stats.points, stats.outside), (inside as u64, (all - inside) as u64));
        bytes
    }

    fn inside(&self, region: Region<3>) -> Vec<Point> {
        self.points.iter().copied().filter(|&point| region.contains(point)).collect()
    }
}

/// Coordinates that can store the points.
fn coordinates_of(points: &[Point]) -> Coordinates {
    if fits_a_grid(points) { GRID } else { Coordinates::F64 }
}

/// Variants of a run: tags, threads, merging in stages, and triangulating every node.
type Run = (Tagging, usize, bool, bool);

const RUNS: [Run; 3] = [
    (Tagging::None, 1, false, true),
    (Tagging::Chunked(1), 3, true, true),
    (Tagging::Ragged, 2, true, false),
];

fn assert_tiles_merge(points: &[Point], depth: usize, run: Run, random: &mut Random, what: &str) {
    let (tagging, threads, is_staged, every_node) = run;
    let tetrahedra = expected(points);
    let mut distinct: Vec<_> = points.iter().map(|&point| bits(point)).collect();
    distinct.sort_unstable();
    distinct.dedup();
    let input = stream_of(3, points, coordinates_of(points), tagging, random);
    let options = Options { threads, every_node, ..Options::default() };
    let mut tiler = Tiler { points, input: &input, options, random, is_staged };
    let parts = tiler.parts(Region::EVERYTHING, depth);
    let (mesh, stats) = merge(&parts, None).unwrap();
    let (set, vertices) = read_mesh(&mesh);
    assert!(set == tetrahedra, "{what}, {tagging:?}: {} of {}", set.len(), tetrahedra.len());
    assert_eq!(vertices, distinct.len(), "{what}, {tagging:?}");
    assert_eq!((stats.points, stats.merged), (points.len() as u64, (points.len() - vertices) as u64));
    if points.len() < 60 && !tetrahedra.is_empty() {
        assert_proven(&mesh, Some(points));
    }
}

#[test]
fn no_family_depends_on_tiles() {
    for (number, family) in FAMILIES.into_iter().enumerate() {
        for count in [20, 90] {
            let mut random = Random::new((number * 1000 + count) as u64);
            let mut points = of(&mut random, family, count);
            // Some points are repeated.
            points.extend_from_within(..count.min(points.len()) / 9);
            random.shuffle(&mut points);
            for run in RUNS {
                assert_tiles_merge(&points, 3, run, &mut random, &format!("{family:?} of {count}"));
            }
        }
    }
}

#[test]
fn mixtures_in_tiles_equal_the_kernel() {
    for seed in 0..60 {
        let mut random = Random::new(8000 + seed);
        let points = mixture(&mut random, 10 + 4 * seed as usize);
        let run = RUNS[seed as usize % 3];
        assert_tiles_merge(&points, 4, run, &mut random, &format!("mixture {seed}"));
    }
}

#[test]
fn few_points_in_many_tiles_are_one_mesh() {
    let points: [Point; 6] =
        [[0.0; 3], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0, 0.0, 8.0], [2.0, 2.0, 2.0], [8.0, 8.0, 0.0]];
    for count in 0..=points.len() {
        for (seed, run) in (0..).zip(RUNS) {
            let what = format!("{count} points, cut {seed}");
            assert_tiles_merge(&points[..count], 4, run, &mut Random::new(seed), &what);
        }
    }
}

/// Halves, octants, and slabs of very different sizes.
fn grids(points: &[Point]) -> [[Vec<f64>; 3]; 3] {
    let at = |axis: usize, part: usize| {
        let mut values: Vec<f64> = points.iter().map(|point| point[axis]).collect();
        values.sort_unstable_by(f64::total_cmp);
        values[values.len() * part / 64]
    };
    let sides = |inner: &[f64]| {
        let mut sides = [&[-INF], inner, &[INF]].concat();
        sides.dedup();
        sides
    };
    [
        [sides(&[]), sides(&[at(1, 32)]), sides(&[])],
        [0, 1, 2].map(|axis| sides(&[at(axis, 32)])),
        [sides(&[at(0, 1), at(0, 3), at(0, 32)]), sides(&[]), sides(&[at(2, 60), at(2, 60) + 1e5])],
    ]
}

#[test]
fn tiles_of_larger_sets_merge_to_the_same_set() {
    for family in [Family::Uniform, Family::Cubic, Family::RoundedSphere, Family::Cluster] {
        let mut random = Random::new(family as u64);
        let points = of(&mut random, family, 900);
        let tetrahedra = expected(&points);
        let input = stream_of(3, &points, coordinates_of(&points), Tagging::Chunked(2), &mut random);
        for (number, [x, y, z]) in grids(&points).into_iter().enumerate() {
            let options = Options { threads: 2, every_node: number == 1, ..Options::default() };
            let mut parts = Vec::new();
            for (x, y, z) in product(&x, &y, &z) {
                let region = Region { min: [x[0], y[0], z[0]], max: [x[1], y[1], z[1]] };
                parts.push(partial(&input, Part::Region(region), &options).0);
            }
            let (mesh, _) = merge(&parts, None).unwrap();
            assert!(read_mesh(&mesh).0 == tetrahedra, "{family:?}, grid {number}");
        }
    }
}

/// All tiles between the borders.
fn product<'a>(
    x: &'a [f64],
    y: &'a [f64],
    z: &'a [f64],
) -> impl Iterator<Item = (&'a [f64], &'a [f64], &'a [f64])> {
    let pairs = move |x| y.windows(2).map(move |y| (x, y));
    x.windows(2).flat_map(pairs).flat_map(move |(x, y)| z.windows(2).map(move |z| (x, y, z)))
}

#[test]
fn cells_of_the_octree_are_tiles_too() {
    let mut random = Random::new(77);
    let points = of(&mut random, Family::Integers, 500);
    let input = stream_of(3, &points, GRID, Tagging::Chunked(3), &mut random);
    let options = Options { threads: 1, ..Options::default() };
    let cells = (0..8).map(|i| Part::Cell { level: 1, at: [i & 1, i >> 1 & 1, i >> 2] });
    let parts: Vec<Vec<u8>> = cells.map(|cell| partial(&input, cell, &options).0).collect();
    let (mesh, stats) = merge(&parts, None).unwrap();
    assert!(read_mesh(&mesh).0 == expected(&points));
    assert_eq!(stats.points, points.len() as u64);
    for (level, at) in [(1, [0, 0, 2]), (9, [0; 3])] {
        let part = Some(Part::Cell { level, at });
        let error = tetrahedralize(&input, &Options { part, ..options }).unwrap_err();
        assert!(error.to_string().contains("there is no cell"), "{error}");
    }
}

/// Most tetrahedra are final in their tile, and the points that wait lie near the border.
#[test]
fn a_tile_finishes_what_lies_inside() {
    let mut random = Random::new(5);
    let points = of(&mut random, Family::Uniform, 5_000);
    let input = stream_of(3, &points, Coordinates::F64, Tagging::Chunked(1), &mut random);
    let region = Region { min: [-INF; 3], max: [0.5, INF, INF] };
    let (bytes, stats) = partial(&input, Part::Region(region), &Options { threads: 2, ..Options::default() });
    assert!(stats.residual < stats.points / 2, "{} of {} points wait", stats.residual, stats.points);
    assert!(stats.simplices > 2 * stats.points, "{} tetrahedra are final", stats.simplices);
    let everything = Part::Region(Region::EVERYTHING);
    let (all, stats) = partial(&input, everything, &Options { threads: 1, ..Options::default() });
    assert!(stats.residual > 3 && stats.residual < stats.points / 4, "the hull waits: {}", stats.residual);
    assert!(read_mesh(&merge(&[all], None).unwrap().0).0 == expected(&points));
    let header: Header = StreamReader::new(&bytes[..], "part").unwrap().header().clone();
    assert_eq!(header.region, Some(region));
}
