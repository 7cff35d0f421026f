//! Linear interpolation in the triangle that contains the target.

use crate::delaunay2::Triangulation;
use crate::predicates::exact_integers::{integers, quotient};
use crate::predicates::forms::{Form, Orient2d};
use crate::predicates::{Point2, area, is_bounded};
use crate::simplex::weighted_sum;
use crate::walk::{Arrival, Walker};
use num_bigint::BigInt;

/// Interpolates linearly in each triangle.
#[derive(Debug)]
pub struct Linear<'m> {
    walker: Walker<'m, Triangulation, 2, 3>,
}

impl<'m> Linear<'m> {
    /// An interpolator of values at the vertices of `mesh`.
    pub fn new(mesh: &'m Triangulation) -> Linear<'m> {
        Linear { walker: Walker::new(mesh) }
    }

    /// The corners of a triangle that contains the target, with its barycentric coordinates. `None` outside
    /// of the hull, also if the target is not finite. Without triangles only vertices have weights.
    ///
    /// Each weight has a relative error below 3e-14: it is zero exactly where the target is on the opposite
    /// edge, and one at the corner. The target is the mean of the corners in these weights up to that error.
    ///
    /// Cost: a walk from the triangle of the last target, or from one of [`Triangulation::starts`].
    pub fn weights(&mut self, target: Point2) -> Option<[(u32, f64); 3]> {
        let mesh = self.walker.mesh;
        match self.walker.walk(target) {
            Some(Arrival::Inside(number, signs)) => {
                let number = self.walker.least(number, signs, target);
                let triangle = &mesh.triangles.triangles()[number as usize];
                let weights = barycentric(mesh.places(triangle), target);
                Some([0, 1, 2].map(|corner| (triangle.vertices[corner], weights[corner])))
            }
            Some(_) => None,
            None => mesh.vertex_on_line(target).map(|v| [(v, 1.0), (v, 0.0), (v, 0.0)]),
        }
    }

    /// The value at the target, for values at the input points; that at a vertex is exactly its own. `None`
    /// outside of the hull. Values of duplicates do not count.
    ///
    /// # Panics
    /// If there are fewer values than points.
    pub fn interpolate(&mut self, values: &[f64], target: Point2) -> Option<f64> {
        self.weights(target).map(|weights| weighted_sum(&weights, |v| values[v as usize]))
    }
}

/// Barycentric coordinates of a target in a closed counterclockwise triangle.
fn barycentric([a, b, c]: [Point2; 3], target: Point2) -> [f64; 3] {
    if [a, b, c, target].iter().all(is_bounded) {
        let areas = [area(b, c, target), area(c, a, target), area(a, b, target)];
        let total: f64 = areas.iter().sum();
        return areas.map(|area| area / total);
    }
    let [a, b, c, target] = integers([a, b, c, target]);
    let doubled_area = |p: &[BigInt; 2], q: &[BigInt; 2]| {
        let from_target = [p, q].map(|point| [0, 1].map(|axis| &point[axis] - &target[axis]));
        Orient2d::value(&from_target, |_| BigInt::ZERO)
    };
    let areas = [doubled_area(&b, &c), doubled_area(&c, &a), doubled_area(&a, &b)];
    let total = areas.iter().sum();
    areas.map(|area| quotient(&area, &total, 0))
}
