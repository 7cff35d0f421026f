//! A convex part of the plane over which the difference of two surfaces is linear.

use super::Real;
use super::sum::Sum;
use spmesh_delaunay::predicates::Pair;

/// Two triangles have at most six corners in common; each of three cuts adds one.
const CORNERS_MAX: usize = 10;

const ZERO: Real = Pair(0.0, 0.0);

/// Where the difference is known. Units: steps of the grid, from an origin nearby.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner {
    pub(super) place: [Real; 2],
    /// The second surface minus the first. Its sign is exact.
    pub(super) rise: Real,
}

/// A convex polygon, counterclockwise.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    corners: [Corner; CORNERS_MAX],
    len: usize,
}

/// Figures of a piece: twice areas, and six times volumes, which have no divisions in them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Figures<T> {
    /// Volume and area where the second surface is lower.
    pub(super) cut: [T; 2],
    /// Volume and area where it is higher.
    pub(super) fill: [T; 2],
    /// Area where both are the same.
    pub(super) level: T,
}

/// Figures that were added up.
pub(super) type Totals = Figures<Sum>;

impl Default for Totals {
    fn default() -> Totals {
        Figures { cut: [Sum::default(); 2], fill: [Sum::default(); 2], level: Sum::default() }
    }
}

impl Totals {
    /// Adds figures, or subtracts them.
    #[inline]
    pub(super) fn add(&mut self, figures: &Figures<Real>, is_added: bool) {
        let signed = |term: Real| if is_added { term } else { -term };
        // Most pieces are on one side alone.
        if figures.cut[1] != ZERO {
            (0..2).for_each(|i| self.cut[i].add(signed(figures.cut[i])));
        }
        if figures.fill[1] != ZERO {
            (0..2).for_each(|i| self.fill[i].add(signed(figures.fill[i])));
        }
        if figures.level != ZERO {
            self.level.add(signed(figures.level));
        }
    }

    /// Adds other totals.
    pub(super) fn merge(&mut self, other: &Totals) {
        (0..2).for_each(|i| self.cut[i].merge(&other.cut[i]));
        (0..2).for_each(|i| self.fill[i].merge(&other.fill[i]));
        self.level.merge(&other.level);
    }
}

impl<T> Figures<T> {
    /// The same for surfaces in the other order.
    pub(super) fn swapped(self) -> Self {
        Figures { cut: self.fill, fill: self.cut, level: self.level }
    }
}

impl Default for Piece {
    fn default() -> Piece {
        Piece { corners: [Corner { place: [ZERO; 2], rise: ZERO }; CORNERS_MAX], len: 0 }
    }
}

impl Piece {
    /// Adds a corner.
    #[inline]
    pub(super) fn push(&mut self, corner: Corner) {
        self.corners[self.len] = corner;
        self.len += 1;
    }

    pub(super) fn corners(&self) -> &[Corner] {
        &self.corners[..self.len]
    }

    /// The volumes and areas on both sides.
    #[inline]
    pub(super) fn figures(&self) -> Figures<Real> {
        let rises = self.corners().iter().map(|corner| corner.rise.0);
        let (is_cut, is_filled) =
            rises.fold((false, false), |(low, high), rise| (low || rise < 0.0, high || rise > 0.0));
        let mut figures = Figures { cut: [ZERO; 2], fill: [ZERO; 2], level: ZERO };
        match (is_cut, is_filled) {
            (false, false) => figures.level = self.integral()[1],
            (false, true) => figures.fill = self.integral(),
            (true, false) => figures.cut = self.integral(),
            (true, true) => {
                figures.fill = self.part(|corner| corner.rise, true).integral();
                figures.cut = self.part(|corner| -corner.rise, true).integral();
            }
        }
        figures.cut[0] = -figures.cut[0];
        figures
    }

    /// Six times the integral of the difference, and twice the area: a fan of triangles.
    #[inline]
    fn integral(&self) -> [Real; 2] {
        let (mut volume, mut area) = (ZERO, ZERO);
        let [first, rest @ ..] = self.corners() else { return [ZERO; 2] };
        let from = |corner: &Corner| [0, 1].map(|axis| corner.place[axis] - first.place[axis]);
        for pair in rest.windows(2) {
            let [[px, py], [qx, qy]] = [from(&pair[0]), from(&pair[1])];
            let twice = px * qy - py * qx;
            volume = volume + twice * (first.rise + pair[0].rise + pair[1].rise);
            area = area + twice;
        }
        [volume, area]
    }

    /// The part where a linear function is not negative. `is_rise`: the function is the difference, which is
    /// exactly zero where the piece is cut.
    #[inline]
    pub(super) fn part(&self, function: impl Fn(&Corner) -> Real, is_rise: bool) -> Piece {
        let mut part = Piece::default();
        let Some(mut from) = self.corners().last() else { return part };
        let mut before = function(from);
        for to in self.corners() {
            let value = function(to);
            if before.0 * value.0 < 0.0 {
                part.push(between(from, to, before, value, is_rise));
            }
            if value.0 >= 0.0 {
                part.push(*to);
            }
            (from, before) = (to, value);
        }
        part
    }
}

/// Where a function is zero between two corners. Both directions of the edge give the same place.
#[inline]
fn between(from: &Corner, to: &Corner, before: Real, value: Real, is_rise: bool) -> Corner {
    let (from, to, before, value) =
        if before.0 < 0.0 { (from, to, -before, value) } else { (to, from, -value, before) };
    let share = before / (before + value);
    let along = |p: Real, q: Real| p + (q - p) * share;
    Corner {
        place: [0, 1].map(|axis| along(from.place[axis], to.place[axis])),
        rise: if is_rise { ZERO } else { along(from.rise, to.rise) },
    }
}
