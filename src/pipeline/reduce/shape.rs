//! On what points lie, by how many are in the cells of a grid over their box.

/// Points per cell of the grid over their box.
const POINTS_PER_CELL: usize = 4;

/// Points that lie in more than this fraction of the cells are on no curve in the plane, on no surface in
/// space.
const FILLED_BY_AREAS: f64 = 0.25;
const FILLED_BY_VOLUMES: f64 = 0.375;

/// Points lie on a surface if pairs of them in the same cell are fewer than so many times as many as in cells
/// of half the width. On a smooth surface they are 4 times as many, in a volume 8 times, however its density
/// varies.
const FEWER_PAIRS: f64 = 5.3;

/// Whether points in the plane lie on an area.
pub(super) fn fill_their_box<const D: usize>(points: &[[f64; D]]) -> bool {
    CellCounts::of(points, per_axis::<D>(points.len())).filled() > FILLED_BY_AREAS
}

/// Whether points in space lie on a surface, seen at the size of cells with few points.
pub(crate) fn are_on_surface<const D: usize>(points: &[[f64; D]]) -> bool {
    let fine = CellCounts::of(points, 2 * per_axis::<D>(points.len()));
    let coarse = fine.halved();
    coarse.filled() <= FILLED_BY_VOLUMES && coarse.pairs() < FEWER_PAIRS * fine.pairs()
}

/// Cells per axis of a grid over the box of so many points.
fn per_axis<const D: usize>(points: usize) -> usize {
    ((points / POINTS_PER_CELL) as f64).powf(1.0 / D as f64).floor() as usize
}

/// The points in each cell of a grid over their box.
struct CellCounts<const D: usize> {
    per_axis: usize,
    counts: Vec<u32>,
}

impl<const D: usize> CellCounts<D> {
    fn of(points: &[[f64; D]], per_axis: usize) -> Self {
        let (mut min, mut max) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
        for point in points {
            min = std::array::from_fn(|axis| min[axis].min(point[axis]));
            max = std::array::from_fn(|axis| max[axis].max(point[axis]));
        }
        let scale: [f64; D] = std::array::from_fn(|axis| per_axis as f64 / (max[axis] - min[axis]));
        let mut counts = vec![0; per_axis.pow(D as u32)];
        for point in points {
            // Casts saturate, so that a flat box, whose scale is infinite, is fine, too.
            let cell = (0..D).fold(0, |cell, axis| {
                let at = ((point[axis] - min[axis]) * scale[axis]).min(per_axis as f64 - 1.0);
                cell * per_axis + at as usize
            });
            counts[cell] += 1;
        }
        CellCounts { per_axis, counts }
    }

    /// The same points in cells twice as wide. Domain: an even number of cells per axis.
    fn halved(&self) -> Self {
        let per_axis = self.per_axis / 2;
        let mut counts = vec![0; per_axis.pow(D as u32)];
        for (fine, &count) in self.counts.iter().enumerate() {
            let (mut cell, mut rest, mut stride) = (0, fine, 1);
            for _ in 0..D {
                cell += rest % self.per_axis / 2 * stride;
                rest /= self.per_axis;
                stride *= per_axis;
            }
            counts[cell] += count;
        }
        CellCounts { per_axis, counts }
    }

    /// The fraction of cells with points.
    fn filled(&self) -> f64 {
        let filled = self.counts.iter().filter(|&&count| count > 0).count();
        filled as f64 / self.counts.len() as f64
    }

    /// Twice the number of pairs of points in the same cell.
    fn pairs(&self) -> f64 {
        self.counts.iter().map(|&count| f64::from(count) * (f64::from(count) - 1.0)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_base::random::Random;

    fn points(place: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<[f64; 3]> {
        let mut random = Random::new(7);
        let mut unit = || random.bits() as f64 / u64::MAX as f64;
        (0..60_000).map(|_| place([unit(), unit(), unit()])).collect()
    }

    #[test]
    fn pairs_tell_surfaces_from_volumes() {
        let sphere = |[x, y, _]: [f64; 3]| {
            let (angle, z) = (std::f64::consts::TAU * x, 2.0 * y - 1.0);
            let radius = (1.0 - z * z).sqrt();
            [radius * angle.cos(), radius * angle.sin(), z]
        };
        let dense_below = |[x, y, _]: [f64; 3]| [x, y * y * y, 0.3 * x * x];
        let plane = |[x, y, _]: [f64; 3]| [x, y, 0.5];
        let curve = |[x, _, _]: [f64; 3]| [x, x * x, x * x * x];
        let place = |_: [f64; 3]| [0.1; 3];
        for (name, points) in [
            ("a sphere", points(sphere)),
            ("a surface of varying density", points(dense_below)),
            ("a plane", points(plane)),
            ("a curve", points(curve)),
            ("one place", points(place)),
        ] {
            assert!(are_on_surface(&points), "{name}");
        }
        let clusters = |point: [f64; 3]| point.map(|x| (4.0 * x).floor() + 0.3 * (4.0 * x).fract());
        let decay = |point: [f64; 3]| point.map(|x| x * x * x);
        let grid = |point: [f64; 3]| point.map(|x| (64.0 * x).floor());
        let decay_of_grid = |point: [f64; 3]| decay(point).map(|x| (512.0 * x).floor());
        for (name, points) in [
            ("a cube", points(|point| point)),
            ("clusters", points(clusters)),
            ("a volume of varying density", points(decay)),
            ("a grid", points(grid)),
            ("a grid of varying density", points(decay_of_grid)),
        ] {
            assert!(!are_on_surface(&points), "{name}");
        }
    }

    #[test]
    fn wide_cells_hold_what_their_parts_do() {
        let points = points(|[x, y, z]| [x, 0.1 * y * x, z]);
        let (fine, coarse) = (CellCounts::of(&points, 12), CellCounts::of(&points, 6));
        assert_eq!(fine.halved().counts, coarse.counts);
        assert_eq!(coarse.counts.iter().sum::<u32>(), 60_000);
    }
}
