//! Division of a crowded cell.
//!
//! A finalization tree has a limited depth, so a cluster that is tiny compared to the box of all points lies
//! in one cell. Such a cell is cut in halves, and they in halves, as in a k-d tree, so that its points need
//! not be triangulated at once.

use super::residual::Residual;
use spmesh_stream::model::bounds::Region;

/// Cells of more points are divided.
pub(super) const CROWDED: usize = 1 << 18;

/// Pieces have at most this many points, if points can be told apart.
const PIECE_MAX: usize = 1 << 15;

/// Points from which the place of a cut is found.
const SAMPLE: usize = 1 << 10;

/// A crowded cell, divided: its pieces in their order, and how they are joined.
#[derive(Debug)]
pub(super) enum Division<const D: usize> {
    Piece { region: Region<D>, points: usize },
    Halves { region: Region<D>, halves: Box<[Division<D>; 2]> },
}

impl<const D: usize> Division<D> {
    /// Divides `region`, and puts the raw `points` in the order of its pieces. Within a piece, they keep the
    /// order of the stream.
    ///
    /// Cost: a pass over the points for each halving. Memory: 4 bytes per point.
    pub(super) fn of(points: &mut Residual<D>, region: Region<D>) -> Division<D> {
        debug_assert!(points.raw == points.len());
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        let row_len = points.row_len();
        let Residual { at, elevation, rows, .. } = points;
        Cloud { at, elevation, rows, row_len, order: &mut order }.divide(region)
    }
}

/// Points that are put in order, with their places in the stream.
struct Cloud<'a, const D: usize> {
    at: &'a mut [[f64; D]],
    /// As many, or none.
    elevation: &'a mut [f64],
    /// As many rows of so many bytes, or none.
    rows: &'a mut [u8],
    row_len: usize,
    order: &'a mut [u32],
}

impl<const D: usize> Cloud<'_, D> {
    fn divide(mut self, region: Region<D>) -> Division<D> {
        let points = self.at.len();
        let Some((axis, side, below)) = (if points > PIECE_MAX { self.halve() } else { None }) else {
            self.restore();
            return Division::Piece { region, points };
        };
        let (mut low, mut high) = (region, region);
        low.max[axis] = side;
        high.min[axis] = side;
        let [lower, upper] = self.split(below);
        let halves = [lower.divide(low), upper.divide(high)];
        Division::Halves { region, halves: Box::new(halves) }
    }

    /// Moves the points below some place on some axis to the front: the axis, the place, and their number.
    /// `None` if all points coincide.
    fn halve(&mut self) -> Option<(usize, f64, usize)> {
        let step = self.at.len().div_ceil(SAMPLE);
        let mut sample: Vec<[f64; D]> = self.at.iter().copied().step_by(step).collect();
        let (axis, side) = cut(&mut sample).or_else(|| cut(&mut self.at.to_vec()))?;
        Some((axis, side, self.partition(|at| at[axis] < side)))
    }

    /// Moves the points that are `below` to the front; their number.
    fn partition(&mut self, below: impl Fn(&[f64; D]) -> bool) -> usize {
        let (mut low, mut high) = (0, self.at.len());
        loop {
            while low < high && below(&self.at[low]) {
                low += 1;
            }
            while low < high && !below(&self.at[high - 1]) {
                high -= 1;
            }
            if low >= high {
                return low;
            }
            self.swap(low, high - 1);
        }
    }

    /// Restores the order of the stream.
    fn restore(&mut self) {
        let mut from: Vec<u32> = (0..self.order.len() as u32).collect();
        from.sort_unstable_by_key(|&i| self.order[i as usize]);
        for start in 0..from.len() {
            // Each cycle of the permutation is followed once; its entries then say that they are in place.
            let mut to = start;
            loop {
                let next = std::mem::replace(&mut from[to], to as u32) as usize;
                if next == start {
                    break;
                }
                self.swap(to, next);
                to = next;
            }
        }
    }

    fn swap(&mut self, i: usize, j: usize) {
        self.at.swap(i, j);
        self.order.swap(i, j);
        if !self.elevation.is_empty() {
            self.elevation.swap(i, j);
        }
        for byte in 0..self.row_len {
            self.rows.swap(i * self.row_len + byte, j * self.row_len + byte);
        }
    }

    fn split(&mut self, below: usize) -> [Cloud<'_, D>; 2] {
        let (at, upper_at) = self.at.split_at_mut(below);
        let (order, upper_order) = self.order.split_at_mut(below);
        let (elevation, upper) = self.elevation.split_at_mut(below.min(self.elevation.len()));
        let row_len = self.row_len;
        let (rows, upper_rows) = self.rows.split_at_mut(below * row_len);
        [
            Cloud { at, elevation, rows, row_len, order },
            Cloud { at: upper_at, elevation: upper, rows: upper_rows, row_len, order: upper_order },
        ]
    }
}

/// The axis along which the points are spread most, and a place on it with points on both sides: about the
/// median. `None` if all points coincide.
fn cut<const D: usize>(points: &mut [[f64; D]]) -> Option<(usize, f64)> {
    let spread = |axis: usize| {
        let ends = |(min, max): (f64, f64), at: &[f64; D]| (min.min(at[axis]), max.max(at[axis]));
        let (min, max) = points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), ends);
        // Half of it, so that it does not overflow.
        (max / 2.0 - min / 2.0, axis, min)
    };
    let (_, axis, min) = (0..D).map(spread).max_by(|a, b| a.0.total_cmp(&b.0))?;
    let middle = points.len() / 2;
    let (_, median, _) = points.select_nth_unstable_by(middle, |p, q| p[axis].total_cmp(&q[axis]));
    if median[axis] > min {
        return Some((axis, median[axis]));
    }
    points.iter().map(|at| at[axis]).filter(|&place| place > min).reduce(f64::min).map(|next| (axis, next))
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_base::random::Random;

    fn pieces(division: &Division<2>, found: &mut Vec<(Region<2>, usize)>) {
        match division {
            Division::Piece { region, points } => found.push((*region, *points)),
            Division::Halves { halves, .. } => halves.iter().for_each(|half| pieces(half, found)),
        }
    }

    fn check(points: &[[f64; 3]], expected: impl Fn(usize) -> bool) {
        let mut raw = Residual::<2>::default();
        let rows: Vec<u8> = points.iter().flat_map(|point| (point[2] as u16).to_le_bytes()).collect();
        raw.extend_raw(points, &rows);
        let division = Division::of(&mut raw, Region::PLANE);
        let mut found = Vec::new();
        pieces(&division, &mut found);
        let mut next = 0;
        for (region, count) in found {
            assert!(expected(count), "{count} points");
            let piece: Vec<[f64; 3]> = (next..next + count).map(|i| raw.point(i)).collect();
            assert!(piece.iter().all(|&point| region.contains(point)));
            // Elevations are the places in the stream, and so are rows.
            assert!(piece.windows(2).all(|pair| pair[0][2] < pair[1][2]));
            assert!(piece.iter().zip(next..).all(|(point, i)| raw.row(i) == (point[2] as u16).to_le_bytes()));
            next += count;
        }
        assert_eq!(next, points.len());
    }

    #[test]
    fn pieces_hold_the_points_of_their_regions_in_their_order() {
        let mut random = Random::new(3);
        let count = 5 * PIECE_MAX;
        let mut draw = |size: u64| random.below(size) as f64;
        let clustered: Vec<[f64; 3]> =
            (0..count).map(|i| [draw(1 << 20) * draw(9).exp2(), draw(1 << 30), i as f64]).collect();
        check(&clustered, |points| (PIECE_MAX / 4..=PIECE_MAX).contains(&points));
        let line: Vec<[f64; 3]> = (0..count).map(|i| [7.0, draw(1 << 40), i as f64]).collect();
        check(&line, |points| points <= PIECE_MAX);
        // Half of all points, and more, at one place.
        let heap: Vec<[f64; 3]> =
            (0..count).map(|i| [0.0, f64::from(i % 3 == 0) * draw(99), i as f64]).collect();
        check(&heap, |_| true);
        check(&[[1.0, 2.0, 0.0]], |points| points == 1);
    }

    #[test]
    fn coinciding_points_are_one_piece() {
        let raw = vec![[1e300, -1e300, 0.0]; 2 * PIECE_MAX];
        let mut points = Residual::<2>::default();
        points.extend_raw(&raw, &[]);
        assert!(
            matches!(Division::of(&mut points, Region::PLANE), Division::Piece { points, .. } if points == raw.len())
        );
    }
}
