//! Seeded sets of distinct points.

use std::collections::HashSet;

/// A small random number generator (SplitMix64); the seed determines the sequence on every platform.
pub struct Random(u64);

impl Random {
    /// The generator with this seed.
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    /// Next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform in low..=high, up to a negligible bias.
    pub fn integer(&mut self, low: i64, high: i64) -> i64 {
        low + (self.bits() % (high - low + 1) as u64) as i64
    }

    /// Random permutation of `items`.
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, (self.bits() % (i as u64 + 1)) as usize);
        }
    }
}

/// The points without duplicates, shuffled.
pub fn distinct(random: &mut Random, mut points: Vec<[i64; 2]>) -> Vec<[i64; 2]> {
    let mut seen = HashSet::new();
    points.retain(|p| seen.insert(*p));
    random.shuffle(&mut points);
    points
}

/// Integer points as `f64`.
pub fn as_floats(points: &[[i64; 2]]) -> Vec<[f64; 2]> {
    points.iter().map(|p| p.map(|c| c as f64)).collect()
}

/// Uniform random points in a square of the given side.
pub fn uniform(random: &mut Random, count: usize, side: i64) -> Vec<[i64; 2]> {
    let points = (0..count).map(|_| [random.integer(0, side), random.integer(0, side)]).collect();
    distinct(random, points)
}

/// Number of families in [`degenerate`].
pub const DEGENERATE_FAMILIES: usize = 10;

/// A degenerate set of about `count` points with coordinates below 2^30.
pub fn degenerate(random: &mut Random, family: usize, count: usize) -> Vec<[i64; 2]> {
    let n = count as i64;
    let side = (count as f64).sqrt() as i64;
    let points = match family {
        // A square grid.
        0 => (0..side * side).map(|i| [i % side * 7, i / side * 7]).collect(),
        // A skewed grid with many empty places.
        1 => (0..n)
            .map(|_| (random.integer(0, side), random.integer(0, side)))
            .map(|(i, j)| [3 * i + j, 5 * j - i])
            .collect(),
        // Lattice points of one circle, of concentric circles.
        2 => circle(5 * 13 * 17 * 29),
        3 => [25, 65, 325, 1105, 5525].iter().flat_map(|&r| circle(r)).take(count).collect(),
        // All on one line: axis-parallel, and slanted.
        4 => (0..n).map(|_| [random.integer(0, 4 * n), 17]).collect(),
        5 => (0..n).map(|_| random.integer(-n, 4 * n)).map(|t| [7 * t, -3 * t]).collect(),
        // Two parallel lines.
        6 => {
            (0..n).map(|_| (random.integer(0, n), random.integer(0, 1))).map(|(t, s)| [t, s * 1000]).collect()
        }
        // A line and one point aside.
        7 => (0..n).map(|t| [t * t % 4001, 0]).chain([[13, 1]]).collect(),
        // Clusters of neighbouring lattice points far from each other.
        8 => (0..n)
            .map(|_| (random.integer(0, 5), random.integer(0, 6), random.integer(0, 6)))
            .map(|(k, i, j)| [(k * k * 7919 % 101) * 10_000_000 + i, (k * 31 % 97) * 10_000_000 + j])
            .collect(),
        // The border of a square and its diagonals.
        _ => (0..n)
            .map(|t| (t % 6, t / 6))
            .map(|(k, t)| [[t, 0], [0, t], [t, n / 6], [n / 6, t], [t, t], [t, n / 6 - t]][k as usize])
            .collect(),
    };
    distinct(random, points)
}

/// All lattice points of the circle of radius `r` around the origin.
fn circle(r: i64) -> Vec<[i64; 2]> {
    (-r..=r)
        .flat_map(|x| {
            let y = ((r * r - x * x) as f64).sqrt().round() as i64;
            [[x, y], [x, -y]]
        })
        .filter(|[x, y]| x * x + y * y == r * r)
        .collect()
}
