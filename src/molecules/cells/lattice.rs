//! The lattice of a periodic box: a reduced basis, on a grid on which points and their images are exact.
//!
//! All vectors, and all points, are rounded to multiples of one power of two, 2^-52 of the extent of all
//! images that may be needed. Sums of them are then exact. So images of one point differ by vectors of the
//! lattice exactly, and what touches on one side of the box touches in the same way on the other.

use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::{FiniteFloatPredicates3, Point3, Predicates3, Sign};
use spmesh_delaunay::vector::{cross, dot};

/// A step of the reduction shortens the square of a length by at least this share: more is rounding.
const SHORTER: f64 = 1e-9;

/// Most steps of the reduction, which needs about the logarithm of the skew. A basis that is not reduced
/// would need more images, but is as right.
const STEPS_MAX: usize = 1000;

/// Fractional coordinates this close to the border of the box are decided exactly.
const EDGE: f64 = 1e-6;

/// Most boxes between a point and the box, along an axis.
const BOXES_MAX: f64 = 1e9;

/// A lattice in space.
#[derive(Debug, Clone)]
pub(crate) struct Lattice {
    /// A reduced, right-handed basis.
    vectors: [Point3; 3],
    /// The basis in terms of the stated vectors.
    of_stated: [[i64; 3]; 3],
    /// The rows of the inverse: fractional coordinates of a point are products with them.
    reciprocal: [Point3; 3],
    /// The step of the grid.
    unit: f64,
}

/// A point moved into the box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Wrapped {
    /// Within the box, which is half open: equal for all points that differ by vectors of the lattice.
    pub(crate) at: Point3,
    /// How far it was moved, in vectors of the reduced basis: the point was at `at` and these.
    pub(crate) boxes: [i64; 3],
}

impl Lattice {
    /// The lattice that three vectors span: those of a
    /// [`PeriodicBox`](spmesh_formats::molecules::PeriodicBox), in any unit.
    pub(crate) fn new(stated: [Point3; 3]) -> Lattice {
        let (vectors, of_stated) = reduce(stated);
        Lattice { vectors, of_stated, reciprocal: inverse(&vectors), unit: 0.0 }
    }

    /// Rounds the vectors to the grid for images up to `margins` beyond the box, in fractional coordinates.
    pub(crate) fn put_on_grid(&mut self, margins: Point3) {
        let lengths = self.vectors.map(|vector| dot(vector, vector).sqrt());
        let extent: f64 = lengths.iter().zip(margins).map(|(length, margin)| length * (2.0 + margin)).sum();
        self.unit = 2f64.powi(extent.log2().ceil() as i32 - 52);
        self.vectors = self.vectors.map(|vector| self.on_grid(vector));
        self.reciprocal = inverse(&self.vectors);
    }

    fn on_grid(&self, point: Point3) -> Point3 {
        point.map(|c| (c / self.unit).round() * self.unit)
    }

    /// The volume of the box.
    pub(crate) fn volume(&self) -> f64 {
        let [a, b, c] = self.vectors;
        dot(a, cross(b, c))
    }

    /// The vectors of the reduced basis.
    pub(crate) fn vectors(&self) -> [Point3; 3] {
        self.vectors
    }

    /// Fractional coordinates, rounded.
    pub(crate) fn fraction(&self, point: Point3) -> Point3 {
        self.reciprocal.map(|row| dot(row, point))
    }

    /// What a ball of this radius extends by, in fractional coordinates.
    pub(crate) fn extents(&self, radius: f64) -> Point3 {
        self.reciprocal.map(|row| radius * dot(row, row).sqrt())
    }

    /// An upper bound of the distance of a point in space from the nearest point of the lattice.
    ///
    /// Rounding along the orthogonalized basis (Babai 1986) finds a point within half of its diagonal, whose
    /// sides are not longer than those of the basis.
    pub(crate) fn covering_radius(&self) -> f64 {
        0.5 * self.vectors.iter().map(|&vector| dot(vector, vector)).sum::<f64>().sqrt()
    }

    /// A point plus multiples of the vectors: exact on the grid.
    pub(crate) fn shifted(&self, point: Point3, boxes: [i32; 3]) -> Point3 {
        let [i, j, k] = boxes.map(f64::from);
        let [a, b, c] = self.vectors;
        [0, 1, 2].map(|axis| point[axis] + (i * a[axis] + j * b[axis] + k * c[axis]))
    }

    /// Moves a point, rounded to the grid, into the box.
    ///
    /// # Errors
    /// Usage, if it is more than a billion boxes away.
    pub(crate) fn wrap(&self, point: Point3) -> Result<Wrapped> {
        let whole = self.fraction(point).map(f64::floor);
        if !whole.iter().all(|boxes| boxes.abs() <= BOXES_MAX) {
            let [x, y, z] = point;
            let message = format!("the point {x:e} {y:e} {z:e} is more than {BOXES_MAX:e} boxes away");
            return Err(Error::usage(message));
        }
        // In steps of the grid; beyond the box they need more than 64 bits.
        let steps = |p: Point3| p.map(|c| (c / self.unit).round() as i128);
        let (vectors, mut boxes) = (self.vectors.map(steps), whole.map(|boxes| boxes as i64));
        let mut at = steps(point);
        for (vector, &boxes) in vectors.iter().zip(&boxes) {
            (0..3).for_each(|axis| at[axis] -= vector[axis] * i128::from(boxes));
        }
        // Rounding puts a point beyond the border by one box at most.
        for _ in 0..4 {
            let place = at.map(|steps| steps as f64 * self.unit);
            let fraction = self.fraction(place);
            let Some(axis) = (0..3).find(|&axis| self.step(place, fraction[axis], axis) != 0) else { break };
            let step = self.step(place, fraction[axis], axis);
            boxes[axis] += step;
            (0..3).for_each(|i| at[i] -= vectors[axis][i] * i128::from(step));
        }
        Ok(Wrapped { at: at.map(|steps| steps as f64 * self.unit), boxes })
    }

    /// How many boxes a point near the box is beyond it along an axis.
    fn step(&self, place: Point3, fraction: f64, axis: usize) -> i64 {
        if (EDGE..1.0 - EDGE).contains(&fraction) {
            return 0;
        }
        if self.is_below(place, axis) {
            return -1;
        }
        let before: Point3 = std::array::from_fn(|i| place[i] - self.vectors[axis][i]);
        i64::from(!self.is_below(before, axis))
    }

    /// Whether a fractional coordinate is negative: exactly.
    fn is_below(&self, place: Point3, axis: usize) -> bool {
        let [b, c] = [1, 2].map(|next| self.vectors[(axis + next) % 3]);
        FiniteFloatPredicates3::default().orient3d([0.0; 3], b, c, place) == Sign::Negative
    }

    /// Multiples of the reduced basis in multiples of the stated vectors.
    pub(crate) fn in_stated(&self, boxes: [i64; 3]) -> [i64; 3] {
        let along = |axis: usize| (0..3).map(|k| boxes[k] * self.of_stated[k][axis]).sum();
        [along(0), along(1), along(2)]
    }
}

/// A basis of the lattice in which no vector can be shortened by adding or subtracting others once; and its
/// coefficients. It is right-handed.
///
/// Source: Semaev, "A 3-dimensional lattice reduction algorithm", 2001.
fn reduce(stated: [Point3; 3]) -> ([Point3; 3], [[i64; 3]; 3]) {
    let combined = |coefficients: [i64; 3]| -> Point3 {
        std::array::from_fn(|axis| (0..3).map(|k| coefficients[k] as f64 * stated[k][axis]).sum())
    };
    let mut basis = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    let square = |coefficients: [i64; 3]| dot(combined(coefficients), combined(coefficients));
    for _ in 0..STEPS_MAX {
        basis.sort_by(|&p, &q| square(p).total_cmp(&square(q)));
        let shorter = (0..3).rev().find_map(|k| {
            let others = [1, 2].map(|next| basis[(k + next) % 3]);
            let along = |other| (dot(combined(basis[k]), combined(other)) / square(other)).round() as i64;
            // Large skews go in one step.
            let projections = others.map(|other| -along(other));
            let near = (-1..=1).flat_map(|i| (-1..=1).map(move |j| [i, j]));
            let steps = [[projections[0], 0], [0, projections[1]]].into_iter().chain(near);
            let sums = steps.map(|[i, j]| {
                std::array::from_fn(|axis| basis[k][axis] + i * others[0][axis] + j * others[1][axis])
            });
            let found = sums.min_by(|&p, &q| square(p).total_cmp(&square(q)))?;
            (square(found) < (1.0 - SHORTER) * square(basis[k])).then_some((k, found))
        });
        let Some((k, found)) = shorter else { break };
        basis[k] = found;
    }
    let [a, b, c] = basis.map(combined);
    if dot(a, cross(b, c)) < 0.0 {
        basis[2] = basis[2].map(|coefficient| -coefficient);
    }
    (basis.map(combined), basis)
}

/// The rows of the inverse of a matrix with these columns.
fn inverse([a, b, c]: &[Point3; 3]) -> [Point3; 3] {
    let volume = dot(*a, cross(*b, *c));
    [cross(*b, *c), cross(*c, *a), cross(*a, *b)].map(|normal| normal.map(|n| n / volume))
}
