//! The order in which points are inserted (thesis 3.4.1): levels of common low bits, and a curve within each level.

use super::random::mix;
use super::{Curve, Options};
use crate::delaunay3::Vertex;
use crate::predicates::{Point3, lexicographic};

/// Low bits that levels look at.
const LEVELS: u32 = 8;

/// Bits of each coordinate that make the place on a curve.
const KEY_BITS: u32 = 21;

/// The distinct points in the order of insertion, and the others with those that they equal.
pub(super) fn fill(points: &[Point3], options: &Options) -> (Vec<Vertex>, Vec<[u32; 2]>) {
    let mut keyed = keys(points, options);
    let point = |item: &(u64, u32)| points[item.1 as usize];
    keyed.sort_unstable_by(|a, b| {
        a.0.cmp(&b.0).then_with(|| lexicographic(point(a), point(b))).then(a.1.cmp(&b.1))
    });
    if options.bit_levels {
        let levels = levels(points);
        keyed.sort_by_key(|item| std::cmp::Reverse(levels[item.1 as usize]));
    }
    let mut duplicates = Vec::new();
    let mut vertices: Vec<Vertex> = Vec::with_capacity(points.len());
    for (_, index) in keyed {
        let at = points[index as usize];
        match vertices.last() {
            Some(last) if last.at == at => duplicates.push([index, last.index]),
            _ => vertices.push(Vertex::new(at, index)),
        }
    }
    (vertices, duplicates)
}

/// Place on the curve, and index, of each point: equal places for equal points.
fn keys(points: &[Point3], options: &Options) -> Vec<(u64, u32)> {
    let mut lower = [f64::INFINITY; 3];
    let mut upper = [f64::NEG_INFINITY; 3];
    for point in points {
        lower = [0, 1, 2].map(|i| lower[i].min(point[i]));
        upper = [0, 1, 2].map(|i| upper[i].max(point[i]));
    }
    let side = (0..3).map(|i| upper[i] - lower[i]).fold(f64::MIN_POSITIVE, f64::max);
    // Rows must be as wide as points are apart; the other curves may be as fine as they like.
    let bits = match options.curve {
        Curve::RowMajor => (points.len().max(1).ilog2() / 3).clamp(1, KEY_BITS),
        _ => KEY_BITS,
    };
    let cells = f64::from(1u32 << bits);
    let place = |point: &Point3| {
        let cell = [0, 1, 2].map(|i| (((point[i] - lower[i]) / side * cells) as u64).min((1 << bits) - 1));
        let [x, y, z] = cell;
        match options.curve {
            Curve::Hilbert => hilbert(cell),
            Curve::Morton => interleave(cell),
            Curve::Gray => gray_rank(interleave(cell)),
            Curve::RowMajor => (z << bits | y) << bits | x,
            // Zero is added because it has two signs.
            Curve::Random => point.iter().fold(options.seed, |bits, x| mix(bits ^ (x + 0.0).to_bits())),
        }
    };
    points.iter().map(place).zip(0..).collect()
}

/// Bits of x, y, z by turns, the highest first.
fn interleave(cell: [u64; 3]) -> u64 {
    (0..KEY_BITS).rev().fold(0, |key, bit| cell.iter().fold(key, |key, c| key << 1 | c >> bit & 1))
}

/// Place of a word in the reflected binary code.
fn gray_rank(word: u64) -> u64 {
    [1, 2, 4, 8, 16, 32].into_iter().fold(word, |rank, shift| rank ^ rank >> shift)
}

/// Place on a Hilbert curve (Skilling 2004).
fn hilbert(mut cell: [u64; 3]) -> u64 {
    for bit in (1..KEY_BITS).rev() {
        let below = (1 << bit) - 1;
        for i in 0..3 {
            if cell[i] >> bit & 1 == 1 {
                cell[0] ^= below;
            } else {
                let swapped = (cell[0] ^ cell[i]) & below;
                cell[0] ^= swapped;
                cell[i] ^= swapped;
            }
        }
    }
    gray_rank(interleave(cell))
}

/// How many low bits, up to [`LEVELS`], each point has in common with most: of each coordinate, the bit that most have,
/// then the next bit that most of those have, and so on; the least of the three coordinates counts.
fn levels(points: &[Point3]) -> Vec<u8> {
    let exponent = lowest_bit(points);
    let suffix = |x: f64| suffix_of(x, exponent);
    let mut histograms = [[0u32; 1 << LEVELS]; 3];
    for point in points {
        (0..3).for_each(|i| histograms[i][suffix(point[i]) as usize] += 1);
    }
    let common = histograms.map(|histogram| common_suffix(&histogram));
    let of_suffix = |suffix: u8, common: u8| (suffix ^ common).trailing_zeros().min(LEVELS) as u8;
    points
        .iter()
        .map(|point| (0..3).map(|i| of_suffix(suffix(point[i]), common[i])).min().unwrap_or_default())
        .collect()
}

/// The suffix that is most common one bit after the other.
fn common_suffix(histogram: &[u32; 1 << LEVELS]) -> u8 {
    (0..LEVELS).fold(0, |common, bit| {
        let mask = (2 << bit) - 1;
        let count = |wanted: u8| -> u64 {
            let members = histogram.iter().enumerate().filter(|(suffix, _)| suffix & mask == wanted as usize);
            members.map(|(_, &count)| u64::from(count)).sum()
        };
        let with_bit = common | 1 << bit;
        if count(with_bit) > count(common) { with_bit } else { common }
    })
}

/// Exponent of the lowest bit that is set in any coordinate: all are integers times that power of two.
fn lowest_bit(points: &[Point3]) -> i32 {
    let of = |x: f64| {
        let bits = x.to_bits();
        let exponent = (bits >> 52 & 0x7ff) as i32;
        let mantissa = bits & ((1 << 52) - 1) | u64::from(exponent > 0) << 52;
        (mantissa != 0).then(|| exponent.max(1) - 1075 + mantissa.trailing_zeros() as i32)
    };
    points.iter().flatten().filter_map(|&x| of(x)).min().unwrap_or_default()
}

/// The low bits of a multiple of a power of two, as a two's complement.
fn suffix_of(x: f64, exponent: i32) -> u8 {
    let bits = x.to_bits();
    let of_x = (bits >> 52 & 0x7ff) as i32;
    let mantissa = bits & ((1 << 52) - 1) | u64::from(of_x > 0) << 52;
    let shift = of_x.max(1) - 1075 - exponent;
    let magnitude = match shift {
        -63..=-1 => mantissa >> -shift,
        0..=63 => mantissa << shift,
        _ => 0,
    };
    (if x < 0.0 { magnitude.wrapping_neg() } else { magnitude }) as u8
}
