//! Gradients at vertices, estimated from values there.

use crate::delaunay2::Triangulation;

impl Triangulation {
    /// For each point the gradient at it of the function with these values at the points: the plane through
    /// its value that fits those of its neighbours best, each weighted with the inverse square of its
    /// distance. So the slopes along all edges count alike. Exact for linear functions, up to rounding.
    ///
    /// A duplicate has the gradient of its vertex. Without triangles all are zero. If all edges at a vertex
    /// have one direction up to rounding, the gradient is along it.
    ///
    /// Cost: O(1) for each edge.
    ///
    /// # Panics
    /// If there are fewer values than points.
    pub fn gradients(&self, values: &[f64]) -> Vec<[f64; 2]> {
        let mut gradients: Vec<[f64; 2]> =
            (0..self.points.len() as u32).map(|v| self.gradient(v, values)).collect();
        for &[duplicate, vertex] in &self.triangles.duplicates {
            gradients[duplicate as usize] = gradients[vertex as usize];
        }
        gradients
    }

    fn gradient(&self, v: u32, values: &[f64]) -> [f64; 2] {
        let (at, value) = (self.points[v as usize], values[v as usize]);
        let mut fit = PlaneFit::default();
        for w in self.star(v) {
            let p = self.points[w as usize];
            let way = [p[0] - at[0], p[1] - at[1]];
            let distance = way[0].hypot(way[1]);
            let slope = (values[w as usize] - value) / distance;
            fit.add([way[0] / distance, way[1] / distance, slope]);
        }
        fit.gradient()
    }
}

/// Least squares in two unknowns, by rotations (Givens): the rows of an upper triangular matrix, the
/// right-hand side last. The squares of normal equations would lose half of the digits in flat stars.
#[derive(Default)]
struct PlaneFit {
    rows: [[f64; 3]; 2],
    count: u32,
}

impl PlaneFit {
    /// Adds a unit vector and the slope along it.
    fn add(&mut self, mut row: [f64; 3]) {
        self.count += 1;
        for (pivot, kept) in self.rows.iter_mut().enumerate() {
            let radius = kept[pivot].hypot(row[pivot]);
            if radius == 0.0 {
                continue;
            }
            let (cosine, sine) = (kept[pivot] / radius, row[pivot] / radius);
            for (k, r) in kept.iter_mut().zip(&mut row) {
                (*k, *r) = (cosine * *k + sine * *r, cosine * *r - sine * *k);
            }
        }
    }

    fn gradient(&self) -> [f64; 2] {
        let [[a, b, c], [_, d, e]] = self.rows;
        // Each vector is off by a few roundings, and each rotation by a few more: a second pivot below tells
        // nothing of the second direction.
        let noise = 8.0 * f64::EPSILON * f64::from(self.count);
        if d.abs() > noise {
            let y = e / d;
            // The first pivot is not near zero, as that of vectors along the second axis: it is if all are.
            if a.abs() > noise { [(c - b * y) / a, y] } else { [0.0, y] }
        } else {
            let square = a * a + b * b;
            if square == 0.0 { [0.0; 2] } else { [c * a / square, c * b / square] }
        }
    }
}
