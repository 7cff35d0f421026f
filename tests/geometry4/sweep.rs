//! Sweeps of the 4D engine give the cells of the whole diagram, whatever the room.

use spmesh_base::error::{ErrorKind, Result};
use spmesh_spacetime::diagram4::{CellSink, Room, diagram, sweep};
use spmesh_stream::model::cells4::{Cell4, Cells4, Point4};
use std::num::NonZeroUsize;

use spmesh_reference::sets::Random;
use spmesh_reference::sets4::{families, floats, grid, random_points};

const SEED: u64 = 20_261_126;

/// The cells of a sweep in memory.
#[derive(Default)]
struct Collected(Vec<(bool, Vec<u32>, Vec<u32>)>);

impl CellSink for Collected {
    fn clear(&mut self) {
        self.0.clear();
    }

    fn cell(&mut self, number: u32, cell: Cell4) -> Result<()> {
        assert_eq!(number as usize, self.0.len());
        self.0.push((cell.is_infinite, cell.vertices.to_vec(), cell.neighbours.to_vec()));
        Ok(())
    }

    fn neighbour(&mut self, number: u32, first: u32, neighbour: u32) -> Result<()> {
        let (is_infinite, vertices, neighbours) = &mut self.0[number as usize];
        assert_eq!((*is_infinite, vertices[0]), (false, first));
        neighbours.push(neighbour);
        Ok(())
    }
}

impl Collected {
    /// The cells in canonical order.
    fn canonical(self) -> Cells4 {
        let Collected(all) = self;
        let mut order: Vec<usize> = (0..all.len()).collect();
        order.sort_by_key(|&number| (all[number].0, &all[number].1));
        let mut places = vec![0; all.len()];
        (0..).zip(&order).for_each(|(place, &number)| places[number] = place);
        let mut cells = Cells4::default();
        for (is_infinite, vertices, neighbours) in order.iter().map(|&number| &all[number]) {
            let mut neighbours: Vec<u32> = neighbours.iter().map(|&other| places[other as usize]).collect();
            neighbours.sort_unstable();
            cells.push(Cell4 { is_infinite: *is_infinite, vertices, neighbours: &neighbours });
        }
        cells
    }
}

/// Asserts that sweeps find the diagram, or fail as it does, with `stages` times less room than all points
/// need. Returns whether there is a diagram.
fn assert_same(points: &[Point4], stages: &[usize], threads: usize, what: &str) -> bool {
    let threads = NonZeroUsize::new(threads).unwrap();
    let expected = diagram(points.to_vec(), None);
    for &stages in stages {
        let room = Room { points: points.len().div_ceil(stages), bytes: usize::MAX };
        let mut collected = Collected::default();
        let found = sweep(points.to_vec(), None, room, threads, &mut collected);
        match (&expected, found) {
            (Ok((expected, _)), Ok((found, _))) => {
                assert_eq!((&found.points, found.merged), (&expected.points, expected.merged), "{what}");
                assert!(collected.canonical() == expected.cells, "{what}, {stages} stages: {points:?}");
            }
            (Err(expected), Err(found)) => assert_eq!(expected.to_string(), found.to_string(), "{what}"),
            (expected, found) => panic!("{what}: {:?}, {:?}", expected.is_ok(), found.is_ok()),
        }
    }
    expected.is_ok()
}

const STAGES: [usize; 8] = [1, 2, 3, 4, 5, 6, 7, 8];

#[test]
fn small_sets_of_every_kind() {
    let mut random = Random::new(SEED);
    let (mut found, mut sets) = (0, 0);
    for _ in 0..3 {
        for set in families(&mut random) {
            let points = floats(&set);
            for scale in [1.0, 5e-324, 2f64.powi(500), 2f64.powi(40) + 1.0] {
                let scaled: Vec<Point4> = points.iter().map(|point| point.map(|x| x * scale)).collect();
                found += usize::from(assert_same(&scaled, &STAGES, 1, "a family"));
                sets += 1;
            }
        }
    }
    assert!(found * 2 > sets, "{found} of {sets}");
}

/// Every stage is full of cells of many simplices, and walls have up to eight vertices.
#[test]
fn parts_of_grids() {
    let mut random = Random::new(SEED + 1);
    for counts in [[5, 4, 3, 6], [3, 3, 3, 12], [4, 9, 4, 3], [2, 2, 2, 20], [6, 6, 5, 5]] {
        let mut points = floats(&grid(counts));
        random.shuffle(&mut points);
        for part in [100, 80, 40, 20, 10] {
            points.truncate(points.len() * part / 100);
            assert_same(&points, &STAGES, 2, &format!("{part} % of {counts:?}"));
        }
    }
}

#[test]
fn random_points_of_every_size() {
    let mut random = Random::new(SEED + 2);
    for side in [4, 10, 26, 170, 1 << 20, 1 << 40] {
        for count in [0, 1, 4, 5, 6, 20, 100, 600] {
            let points = floats(&random_points(&mut random, count, side));
            let is_found = assert_same(&points, &STAGES, 2, &format!("{count} below {side}"));
            assert!(is_found || count < 20);
        }
    }
    let uniform: Vec<Point4> = (0..200).map(|_| [(); 4].map(|()| random.unit())).collect();
    for (scale, offset) in [(1.0, 0.0), (1e-200, 0.0), (1e150, 0.0), (1e-310, 0.0), (1e-3, 1e6), (1e308, 0.0)]
    {
        let points: Vec<Point4> = uniform.iter().map(|point| point.map(|x| offset + x * scale)).collect();
        assert!(assert_same(&points, &STAGES, 1, &format!("uniform, times {scale}")));
    }
}

/// Repeated points, points on lines, on spheres, in hyperplanes, and far apart.
#[test]
fn sets_of_bad_position() {
    let mut random = Random::new(SEED + 3);
    let integers = random_points(&mut random, 300, 12);
    let mut sets = vec![];
    let doubled: Vec<Point4> = floats(&[&integers[..], &integers[..200]].concat());
    sets.push(("doubled", doubled));
    let on_line = |i: i64| [3 * i, i, -i, 2 * i];
    sets.push(("a line and points", floats(&[(0..80).map(on_line).collect(), integers.clone()].concat())));
    let layers: Vec<_> = integers.iter().map(|&[x, y, z, t]| [40 * (x % 3), y, z, t]).collect();
    sets.push(("three hyperplanes", floats(&layers)));
    let flat_first = integers.iter().map(|&[x, y, z, t]| [if x < 8 { 0 } else { x * 30 }, y, z, t]);
    sets.push(("most in one hyperplane", floats(&flat_first.collect::<Vec<_>>())));
    let square = |point: &Point4| point.iter().map(|x| (x - 5.0) * (x - 5.0)).sum::<f64>();
    let sphere: Vec<Point4> = floats(&grid([11; 4])).into_iter().filter(|p| square(p) == 20.0).collect();
    let shells: Vec<Point4> =
        floats(&grid([11; 4])).into_iter().filter(|p| [20.0, 8.0].contains(&square(p))).collect();
    assert!(sphere.len() > 100 && shells.len() > 150);
    sets.push(("a sphere", sphere.clone()));
    sets.push(("two shells", shells));
    let moved = sphere.iter().map(|&[x, y, z, t]| [x + 4.0, y, z, t]);
    sets.push(("two spheres", sphere.iter().copied().chain(moved).collect()));
    let clusters = |i: i64| integers.iter().map(move |&[x, y, z, t]| [x + 1_000_000 * i, y, z + 50 * i, t]);
    sets.push(("clusters", floats(&(0..4).flat_map(clusters).collect::<Vec<_>>())));
    let curve = |i: i32| {
        let x = f64::from(i);
        [x, x * x, x * x * x, x * x * x * x]
    };
    sets.push(("a curve", (0..40).map(curve).collect()));
    for (what, points) in sets {
        assert!(assert_same(&points, &STAGES, 2, what), "{what}");
    }
}

/// Too little room makes stages smaller, and is an error in the end.
#[test]
fn room_is_kept() {
    let mut random = Random::new(SEED + 4);
    let points = floats(&random_points(&mut random, 3000, 1 << 20));
    let (expected, _) = diagram(points.clone(), None).unwrap();
    let sweep_within = |bytes: usize| {
        let mut collected = Collected::default();
        let room = Room { points: usize::MAX, bytes };
        let swept = sweep(points.clone(), None, room, NonZeroUsize::MIN, &mut collected);
        swept.map(|_| collected.canonical())
    };
    for megabytes in [12, 9, 7] {
        assert!(sweep_within(megabytes << 20).unwrap() == expected.cells);
    }
    let error = sweep_within(100_000).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Memory, "{error}");
}
