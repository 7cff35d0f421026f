//! The canonical triangulation by definition: every triangle above whose plane all other lifted points lie.

use num_bigint::BigInt;

/// Indices of the counterclockwise triangles, each starting with its smallest index, in increasing order.
///
/// The perturbation is carried out in integers: with `n` points and a base greater than all coefficients, the
/// lift of the point of rank `r` is `(x² + y²) base^n + base^r`.
///
/// Domain: distinct points with coordinates below 1000 in magnitude.
pub fn canonical_triangulation(points: &[[i32; 2]]) -> Vec<[usize; 3]> {
    let base = BigInt::from(1u64 << 26);
    let mut ranks: Vec<usize> = (0..points.len()).collect();
    ranks.sort_by_key(|&i| points[i]);
    let mut lifts = vec![BigInt::ZERO; points.len()];
    for (rank, &i) in ranks.iter().enumerate() {
        let [x, y] = points[i].map(i64::from);
        lifts[i] = BigInt::from(x * x + y * y) * base.pow(points.len() as u32) + base.pow(rank as u32);
    }
    let lifted = |i: usize| (points[i].map(i64::from), &lifts[i]);
    let mut triangles = Vec::new();
    for a in 0..points.len() {
        for b in a + 1..points.len() {
            for c in (a + 1..points.len()).filter(|&c| c != b) {
                let is_left = orient(points[a], points[b], points[c]) > 0;
                let mut others = (0..points.len()).filter(|d| ![a, b, c].contains(d));
                if is_left && others.all(|d| lies_above([a, b, c].map(lifted), lifted(d))) {
                    triangles.push([a, b, c]);
                }
            }
        }
    }
    triangles
}

pub fn orient(a: [i32; 2], b: [i32; 2], c: [i32; 2]) -> i64 {
    let [ax, ay, bx, by, cx, cy] = [a[0], a[1], b[0], b[1], c[0], c[1]].map(i64::from);
    (ax - cx) * (by - cy) - (ay - cy) * (bx - cx)
}

type Lifted<'a> = ([i64; 2], &'a BigInt);

/// Whether the lifted `d` lies above the plane of the three lifted points.
fn lies_above(triangle: [Lifted; 3], d: Lifted) -> bool {
    let [a, b, c] = triangle.map(|(p, lift)| (p[0] - d.0[0], p[1] - d.0[1], lift - d.1));
    let minor = |p: &(i64, i64, BigInt), q: &(i64, i64, BigInt)| p.0 * q.1 - p.1 * q.0;
    a.2.clone() * minor(&b, &c) + b.2.clone() * minor(&c, &a) + c.2.clone() * minor(&a, &b) < BigInt::ZERO
}

/// A small random number generator with the same sequence on every machine (xorshift64*).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// A number below `end`.
    pub fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        ((self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) % end as u64) as usize
    }

    /// `len` distinct points of a square grid of `side * side`.
    pub fn distinct_points(&mut self, len: usize, side: usize) -> Vec<[i32; 2]> {
        let mut points: Vec<[i32; 2]> = Vec::new();
        while points.len() < len {
            let point = [self.below(side) as i32, self.below(side) as i32];
            if !points.contains(&point) {
                points.push(point);
            }
        }
        points
    }
}
