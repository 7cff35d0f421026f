//! A surface and horizontal planes.
//!
//! A triangle is cut at the levels between its lowest and its highest corner. Its volume up to any other
//! level is the level times its area minus a constant, and such sums are made for all levels at once.

use num_bigint::BigInt;

use super::Real;
use super::Volumes;
use super::grid::LEVEL_BITS;
use super::overlap::{Triangle, Vertex};
use super::piece::{Corner, Piece, Totals};
use super::regions::Near;
use super::sum::Sum;
use spmesh_delaunay::predicates::Pair;

/// 2^-20.
const LEVEL_UNIT: Real = Pair(1.0 / (1u64 << LEVEL_BITS) as f64, 0.0);

/// Twice areas, and these times the sum of elevations of the corners.
#[derive(Debug, Clone, Copy, Default)]
struct Plain {
    area: Sum,
    weighted: Sum,
}

/// What triangles add to the volumes of levels.
#[derive(Debug, Clone)]
pub(super) struct Table {
    cut: Vec<Totals>,
    /// Triangles below all levels from one on, and those above all levels before one.
    below: Vec<Plain>,
    above: Vec<Plain>,
}

impl Table {
    /// Bytes of a level.
    pub(super) const LEVEL_LEN: u64 = (size_of::<Totals>() + 2 * size_of::<Plain>()) as u64;

    pub(super) fn new(levels: usize) -> Table {
        let plain = vec![Plain::default(); levels + 1];
        Table { cut: vec![Totals::default(); levels], below: plain.clone(), above: plain }
    }

    /// Adds a triangle with elevations in units of levels.
    pub(super) fn add(&mut self, triangle: &Triangle, levels: &[i64]) {
        let [lowest, highest] = range(triangle);
        let first = levels.partition_point(|&level| level < lowest);
        let behind = levels.partition_point(|&level| level <= highest);
        let [a, b, c] = triangle.map(|corner| [0, 1].map(|axis| corner[axis] - triangle[0][axis]));
        debug_assert_eq!(a, [0; 2]);
        let twice = i128::from(b[0]) * i128::from(c[1]) - i128::from(b[1]) * i128::from(c[0]);
        let sum: i128 = triangle.iter().map(|corner| i128::from(corner[2])).sum();
        let area = Real::from(twice);
        let weighted = area * (Real::from(sum) * LEVEL_UNIT);
        for plain in [&mut self.below[behind], &mut self.above[first]] {
            plain.area.add(area);
            plain.weighted.add(weighted);
        }
        for (totals, &level) in self.cut[first..behind].iter_mut().zip(&levels[first..behind]) {
            totals.add(&piece(triangle, level).figures(), true);
        }
    }

    /// Adds the part of a triangle in a polygon, level by level.
    pub(super) fn add_near(tables: &mut [Table], triangle: &Triangle, levels: &[i64], near: &Near) {
        for (at, &level) in levels.iter().enumerate() {
            near.divide(&piece(triangle, level), &triangle[0], |number, figures, is_added| {
                tables[number].cut[at].add(figures, is_added);
            });
        }
    }

    pub(super) fn merge(&mut self, other: &Table) {
        self.cut.iter_mut().zip(&other.cut).for_each(|(own, other)| own.merge(other));
        for (own, other) in [(&mut self.below, &other.below), (&mut self.above, &other.above)] {
            for (own, other) in own.iter_mut().zip(other) {
                own.area.merge(&other.area);
                own.weighted.merge(&other.weighted);
            }
        }
    }

    /// The volumes of each level.
    pub(super) fn volumes(&self, levels: &[i64]) -> Vec<Volumes> {
        let mut volumes: Vec<Volumes> = self.cut.iter().map(Volumes::of).collect();
        // Six times the volume is twice the area times three heights.
        let rise = |level: i64, [area, weighted]: &[BigInt; 2]| ((area * 3 * level) >> LEVEL_BITS) - weighted;
        let add = |sums: &mut [BigInt; 2], plain: &Plain| {
            sums[0] += plain.area.units();
            sums[1] += plain.weighted.units();
        };
        let [mut below, mut above] = [(); 2].map(|()| [BigInt::ZERO, BigInt::ZERO]);
        for (at, &level) in levels.iter().enumerate() {
            add(&mut below, &self.below[at]);
            volumes[at].fill += rise(level, &below);
            volumes[at].fill_area += &below[0];
        }
        for (at, &level) in levels.iter().enumerate().rev() {
            add(&mut above, &self.above[at + 1]);
            volumes[at].cut -= rise(level, &above);
            volumes[at].cut_area += &above[0];
        }
        volumes
    }
}

fn range(triangle: &Triangle) -> [i64; 2] {
    let [a, b, c] = triangle.map(|corner| corner[2]);
    [a.min(b).min(c), a.max(b).max(c)]
}

/// The triangle, with the heights of a level above it.
fn piece(triangle: &Triangle, level: i64) -> Piece {
    let mut piece = Piece::default();
    let [x, y, _] = triangle[0];
    for corner in triangle {
        let place = [corner[0] - x, corner[1] - y].map(|value| Pair(value as f64, 0.0));
        let rise = Real::from(i128::from(level) - i128::from(corner[2])) * LEVEL_UNIT;
        piece.push(Corner { place, rise });
    }
    piece
}

/// A vertex with its elevation in units of levels, above a plane.
pub(super) fn raised([x, y, z]: Vertex, plane: i64) -> Vertex {
    [x, y, (z << LEVEL_BITS) - plane]
}
