//! Point sets to finalize: seeded, of every sort.

use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::Point;

/// A seeded random number generator (xorshift64*).
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    pub(super) fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(super) fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }
}

pub(super) struct Set {
    pub(super) name: &'static str,
    pub(super) dims: u8,
    pub(super) coordinates: Coordinates,
    pub(super) points: Vec<Point>,
}

pub(super) const GRID: Coordinates =
    Coordinates::I32 { scale: [0.01; 3], offset: [500_000.0, 4_000_000.0, 0.0] };

pub(super) fn set(name: &'static str, dims: u8, coordinates: Coordinates, points: Vec<Point>) -> Set {
    Set { name, dims, coordinates, points }
}

pub(super) fn integer_points(n: usize, seed: u64, extent: u64) -> Vec<Point> {
    let mut random = Random(seed);
    (0..n).map(|_| [0; 3].map(|_: u8| random.below(extent) as f64 - 1000.0)).collect()
}

/// Two thirds of the points are in a few small clusters; the others are spread over a wide area.
pub(super) fn clustered(n: usize, seed: u64) -> Vec<Point> {
    let mut random = Random(seed);
    let cluster = |random: &mut Random| {
        let center = random.below(3) as f64 * 1e8;
        [0; 3].map(|_: u8| center + random.below(300) as f64)
    };
    let anywhere = |random: &mut Random| [0; 3].map(|_: u8| random.below(1 << 30) as f64);
    (0..n).map(|i| if i % 3 > 0 { cluster(&mut random) } else { anywhere(&mut random) }).collect()
}

/// Strips flown back and forth, as in an aerial survey.
pub(super) fn swaths(n: usize) -> Vec<Point> {
    let mut random = Random(5);
    let along = |i: usize| if (i / 500).is_multiple_of(2) { i % 500 } else { 499 - i % 500 };
    (0..n)
        .map(|i| [along(i) as f64 * 20.0, (i / 500 * 1000) as f64 + random.below(1500) as f64, 7.0])
        .collect()
}

/// Points of numbers at the ends of f64, and of others far from these; -0.0 is one of them.
pub(super) fn extremes(n: usize, seed: u64) -> Vec<Point> {
    const NUMBERS: [f64; 12] =
        [0.0, 5e-324, 1e-310, f64::MIN_POSITIVE, 1e-300, 1e-17, 0.1, 1.0, 3.0, 1e10, 1e17, 1e300];
    let mut random = Random(seed);
    // Few numbers in one set, so that its box often ends at a tiny one.
    let chosen = [0; 4].map(|_: u8| NUMBERS[random.below(12) as usize]);
    let mut number = |_: u8| chosen[random.below(4) as usize] * [1.0, -1.0][random.below(2) as usize];
    (0..n).map(|_| [0; 3].map(&mut number)).collect()
}

pub(super) fn lattice(side: u32, step: f64) -> Vec<Point> {
    (0..side * side).map(|i| [f64::from(i % side) * step, f64::from(i / side) * step, 0.0]).collect()
}

pub(super) fn shuffled(mut points: Vec<Point>) -> Vec<Point> {
    let mut random = Random(77);
    for i in (1..points.len()).rev() {
        points.swap(i, random.below(i as u64 + 1) as usize);
    }
    points
}

pub(super) fn scaled(points: Vec<Point>, factor: f64) -> Vec<Point> {
    points.into_iter().map(|point| point.map(|value| value * factor)).collect()
}

pub(super) fn sets() -> Vec<Set> {
    let duplicates = integer_points(3000, 3, 6);
    let unit: Vec<Point> = {
        let mut random = Random(11);
        (0..2000).map(|_| [0; 3].map(|_: u8| random.unit() - 0.5)).collect()
    };
    vec![
        set("random", 2, GRID, integer_points(3000, 1, 100_000)),
        set("clustered", 2, GRID, clustered(3000, 2)),
        set("swaths", 2, GRID, swaths(4000)),
        set("swaths permuted", 2, GRID, shuffled(swaths(4000))),
        set("duplicates", 2, GRID, duplicates),
        set("lattice", 2, GRID, lattice(64, 16.0)),
        set("all equal", 2, GRID, vec![[12.0, -7.0, 3.0]; 1500]),
        set("one point", 2, GRID, vec![[12.0, -7.0, 3.0]]),
        set("on a line", 2, GRID, (0..2000).map(|i| [f64::from(i), 5.0, 0.0]).collect()),
        set("ends of i32", 2, GRID, vec![[f64::from(i32::MIN); 3], [f64::from(i32::MAX); 3], [0.0; 3]]),
        set("f64", 2, Coordinates::F64, unit.clone()),
        set("f64 huge", 2, Coordinates::F64, scaled(unit.clone(), 1e307)),
        set("f64 tiny", 2, Coordinates::F64, scaled(unit.clone(), 1e-320)),
        set("f64 all equal", 2, Coordinates::F64, vec![[0.1, 1e9, -1e-9]; 800]),
        set("space", 3, GRID, integer_points(3000, 4, 5000)),
        set("space clustered", 3, GRID, clustered(3000, 9)),
        set("space f64", 3, Coordinates::F64, unit),
    ]
}
