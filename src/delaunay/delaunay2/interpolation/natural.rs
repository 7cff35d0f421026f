//! Interpolation by natural neighbours.

use super::cavity::Cavity;
use super::exact_areas;
use super::stolen_areas::StolenAreas;
use crate::delaunay2::Triangulation;
use crate::points::is_finite;
use crate::predicates::{Point2, Sign, is_bounded};
use crate::simplex::weighted_sum;
use crate::walk::{Arrival, Walker};

/// Weights of natural neighbours: Sibson's coordinates.
///
/// If a target was inserted, its Voronoi cell would take a part of the area of the cells of its neighbours;
/// the weight of a neighbour is its part of what they lose. Weights are continuous in the target, and smooth
/// but at the vertices; the target is the mean of its neighbours in these weights.
///
/// Source: Sibson, "A brief description of natural neighbour interpolation", 1981. On the hull, where the
/// area is infinite, the weights are their limit: linear between the two ends of the edge.
#[derive(Debug)]
pub struct NaturalNeighbours<'m> {
    walker: Walker<'m, Triangulation, 2, 3>,
    cavity: Cavity,
    areas: StolenAreas,
    weights: Vec<(u32, f64)>,
}

impl<'m> NaturalNeighbours<'m> {
    /// The natural neighbours in `mesh`.
    pub fn new(mesh: &'m Triangulation) -> NaturalNeighbours<'m> {
        NaturalNeighbours {
            walker: Walker::new(mesh),
            cavity: Cavity::default(),
            areas: StolenAreas::default(),
            weights: Vec::new(),
        }
    }

    /// The natural neighbours of the target with their weights, counterclockwise, the one of least index
    /// first. `None` outside of the hull, also if the target is not finite. A target at a vertex has that one
    /// neighbour alone. Without triangles only vertices have weights.
    ///
    /// Each weight is at least zero and off by less than 1e-12, whatever the coordinates; their sum is 1 up
    /// to rounding. So the mean of the neighbours in these weights is the target up to 1e-12 times the sum of
    /// their distances from it. The weights do not depend on the targets before.
    ///
    /// Cost: a walk from the triangle of the last target or from one of [`Triangulation::starts`], and the
    /// triangles whose circles contain the target, about four. Plain arithmetic with a bound of its error;
    /// integers of arbitrary size where that does not suffice, most of all in flat triangles at the hull.
    pub fn weights(&mut self, target: Point2) -> Option<&[(u32, f64)]> {
        self.weights.clear();
        match self.walker.walk(target) {
            Some(Arrival::Inside(number, signs)) => self.weigh(target, number, signs),
            Some(_) => return None,
            None => self.weights.push((self.walker.mesh.vertex_on_line(target)?, 1.0)),
        }
        Some(&self.weights)
    }

    /// The value at the target, for values at the input points: exact at vertices, and for linear functions
    /// up to rounding. `None` outside of the hull. Values of duplicates do not count.
    ///
    /// # Panics
    /// If there are fewer values than points.
    pub fn interpolate(&mut self, values: &[f64], target: Point2) -> Option<f64> {
        self.weights(target).map(|weights| weighted_sum(weights, |v| values[v as usize]))
    }

    /// The value at the target of a function that is smooth at the vertices, too, where it has these values
    /// and gradients, such as those of [`Triangulation::gradients`]. `None` outside of the hull.
    ///
    /// With exact gradients it is exact, up to rounding, for sums of a linear function and a multiple of x^2
    /// + y^2.
    ///
    /// Source: Sibson 1981; the formula is that of Flötotto, "A coordinate system associated to a point cloud
    /// issued from a manifold", 2003, as in CGAL's `sibson_c1_interpolation`.
    ///
    /// # Panics
    /// If there are fewer values or gradients than points.
    pub fn interpolate_smoothly(
        &mut self,
        values: &[f64],
        gradients: &[[f64; 2]],
        target: Point2,
    ) -> Option<f64> {
        let points = self.walker.mesh.points();
        let weights = self.weights(target)?;
        if let &[(vertex, _)] = weights {
            return Some(values[vertex as usize]);
        }
        // With the distances d: sums of w / d, of w d, of w d^2, and of w / d times the linear functions.
        let [mut inverse, mut first, mut second, mut planes] = [0.0; 4];
        for &(vertex, weight) in weights.iter().filter(|(_, weight)| *weight != 0.0) {
            let v = vertex as usize;
            let way = [target[0] - points[v][0], target[1] - points[v][1]];
            let distance = way[0].hypot(way[1]);
            let plane = values[v] + gradients[v][0] * way[0] + gradients[v][1] * way[1];
            inverse += weight / distance;
            first += weight * distance;
            second += weight * distance * distance;
            planes += weight / distance * plane;
        }
        let (of_values, of_planes) = (first / inverse, second);
        let value = weighted_sum(weights, |v| values[v as usize]);
        Some((of_values * value + of_planes * planes / inverse) / (of_values + of_planes))
    }

    /// Fills the weights of a target in a closed triangle.
    fn weigh(&mut self, target: Point2, number: u32, signs: [Sign; 3]) {
        let mesh = self.walker.mesh;
        let triangle = &mesh.triangles.triangles()[number as usize];
        if let Some(corner) = corner_at(signs) {
            self.weights.push((triangle.vertices[corner], 1.0));
            return;
        }
        if let Some(side) = (0..3).find(|&i| signs[i] == Sign::Zero && triangle.neighbour(i).is_none()) {
            let [a, b] = [1, 2].map(|turn| triangle.vertices[(side + turn) % 3]);
            let [a, b] = [a.min(b), a.max(b)];
            let part = part_of_edge(mesh.points[a as usize], mesh.points[b as usize], target);
            self.weights.extend([(a, 1.0 - part), (b, part)]);
            return;
        }
        self.cavity.find(mesh, number, target, &mut self.walker.predicates);
        // Plain arithmetic neither overflows nor underflows then.
        let mut corners = self.cavity.border.iter().map(|edge| mesh.points[edge.ends[0] as usize]);
        let is_good = is_bounded(&target)
            && corners.all(|corner| is_bounded(&corner))
            && self.areas.write(&mesh.points, &self.cavity, target, &mut self.weights);
        if !is_good {
            exact_areas::write(&mesh.points, &self.cavity, target, &mut self.weights);
        }
    }
}

/// Which part of the way from a to b the target on it is, off by four roundings.
fn part_of_edge(a: Point2, b: Point2, target: Point2) -> f64 {
    let whole = [0, 1].map(|axis| b[axis] - a[axis]);
    if is_finite(&whole) {
        // Of numbers so small that a difference has no digit more it is exact.
        let axis = usize::from(whole[1].abs() > whole[0].abs());
        return (target[axis] - a[axis]) / whole[axis];
    }
    let half = [0, 1].map(|axis| 0.5 * b[axis] - 0.5 * a[axis]);
    let axis = usize::from(half[1].abs() > half[0].abs());
    (0.5 * target[axis] - 0.5 * a[axis]) / half[axis]
}

/// The corner at which the target lies, if it lies at one: the other two signs are zero.
fn corner_at(signs: [Sign; 3]) -> Option<usize> {
    (0..3).find(|&corner| signs[(corner + 1) % 3] == Sign::Zero && signs[(corner + 2) % 3] == Sign::Zero)
}
