//! Points, targets and heights: the same in each run.

use crate::random::Random;

const SEED: u64 = 1;
const TARGETS: usize = 200_000;
const RASTER_SIDE: usize = 1000;
const NATURAL_TARGETS: usize = 100_000;
const INSERTED: usize = 10_000;

/// What the points are like. There is about one in each unit square.
#[derive(Clone, Copy, PartialEq)]
pub enum Kind {
    /// Random points in a square, in random order.
    Uniform,
    /// A grid, row by row, each point moved by up to 0.4.
    Rows,
    /// All integer points in a square, in random order.
    Lattice,
    /// Random integer points, with repetitions.
    Repeated,
}

impl Kind {
    /// The kind of this name on the command line.
    pub fn named(name: &str) -> Option<Kind> {
        [Kind::Uniform, Kind::Rows, Kind::Lattice, Kind::Repeated]
            .into_iter()
            .find(|kind| kind.name() == name)
    }

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Uniform => "uniform",
            Kind::Rows => "rows",
            Kind::Lattice => "lattice",
            Kind::Repeated => "repeated",
        }
    }
}

/// What each library is given.
pub struct Inputs {
    /// What the points are like.
    pub kind: Kind,
    /// The side of the square of the points.
    pub side: f64,
    /// Points with heights.
    pub points: Vec<[f64; 3]>,
    /// Random targets within the square, some of them outside of the hull.
    pub random: Vec<[f64; 2]>,
    /// Centres of a raster over the square, row by row.
    pub raster: Vec<[f64; 2]>,
    /// The random targets of natural neighbours.
    pub natural: Vec<[f64; 2]>,
    /// Random points to be inserted.
    pub inserted: Vec<[f64; 3]>,
}

impl Inputs {
    /// About `count` points of a kind, and the targets.
    pub fn new(kind: Kind, count: usize) -> Inputs {
        let (side, points) = points(kind, count);
        let mut random = Random(SEED + 1);
        let mut place = || [side * random.unit(), side * random.unit()];
        let targets: Vec<[f64; 2]> = (0..TARGETS).map(|_| place()).collect();
        let inserted = (0..INSERTED).map(|_| with_height(place(), side)).collect();
        let centre = |number: usize| (number as f64 + 0.5) * side / RASTER_SIDE as f64;
        let raster = (0..RASTER_SIDE * RASTER_SIDE)
            .map(|number| [centre(number % RASTER_SIDE), centre(number / RASTER_SIDE)])
            .collect();
        Inputs {
            kind,
            side,
            points,
            natural: targets[..NATURAL_TARGETS].to_vec(),
            random: targets,
            raster,
            inserted,
        }
    }
}

/// The side of the square, and the points in it.
pub fn points(kind: Kind, count: usize) -> (f64, Vec<[f64; 3]>) {
    let columns = (count as f64).sqrt().floor() as usize;
    let mut random = Random(SEED);
    let numbers: Vec<u32> = match kind {
        Kind::Uniform | Kind::Rows => (0..(columns * columns) as u32).collect(),
        Kind::Lattice => random.permutation(columns * columns),
        Kind::Repeated => (0..count).map(|_| random.below(columns * columns) as u32).collect(),
    };
    // The last column of the grid is at the side of the square.
    let side = (columns - 1) as f64;
    let mut moved = || 0.8 * random.unit() - 0.4;
    let points = numbers.into_iter().map(|number| {
        let node = [number as usize % columns, number as usize / columns].map(|c| c as f64);
        let place = match kind {
            Kind::Uniform => [0, 1].map(|_| (moved() + 0.4) / 0.8 * side),
            Kind::Rows => node.map(|c| c + moved()),
            Kind::Lattice | Kind::Repeated => node,
        };
        with_height(place, side)
    });
    (side, points.collect())
}

/// A height that is linear nowhere, between 0 and 2.
fn with_height([x, y]: [f64; 2], side: f64) -> [f64; 3] {
    let [u, v] = [x / side, y / side];
    [x, y, u * u + u * v]
}
