//! Whether a node is worth triangulating, estimated from a sample of its points.
//!
//! In space, points on a surface have tetrahedra whose balls are as large as the object that the surface
//! bounds (thesis 5.4). If the cell is smaller, no tetrahedron is final, and the time to triangulate it is
//! lost.

use super::bulk::Bulk;
use super::node::Rules;
use super::residual::Residual;
use spmesh_core::error::Result;
use spmesh_core::random::Random;
use spmesh_geometry::predicates::PredicateCounts;
use spmesh_model::bounds::{Point, Region};

/// Points of a sample.
const SAMPLE_POINTS: usize = 2048;

/// Nodes of fewer points are passed up: too many of their points are near the sides, and a sample would cost
/// too much.
const POINTS_MIN: usize = 50_000;

/// Largest fraction of the sample that a node worth triangulating may leave. A sample of random points in a
/// cube leaves 59 %, one of points on a surface nearly all.
const SHARE_MAX: f64 = 0.85;

/// Triangulates samples of the points of nodes.
pub(super) struct Sample<B, const D: usize> {
    rules: Rules,
    bulk: B,
    points: Residual<D>,
    is_left: Vec<bool>,
}

impl<B: Bulk<D>, const D: usize> Sample<B, D> {
    pub(super) fn new(rules: Rules) -> Self {
        Sample { rules, bulk: B::default(), points: Residual::default(), is_left: Vec::new() }
    }

    /// Whether triangulating `points` would leave most of them, because other points may lie outside of
    /// `region`.
    ///
    /// The sample holds raw points only. If most points come from nodes below, those nodes were worth
    /// triangulating, and the answer is `false` without a sample. The answer depends on the points and their
    /// order alone.
    ///
    /// # Errors
    /// As the kernel's.
    pub(super) fn leaves_most(&mut self, points: &Residual<D>, region: &Region<D>) -> Result<bool> {
        let is_sampled = B::MAY_LEAVE_MOST && !self.rules.every_node && *region != Region::EVERYTHING;
        if !is_sampled || 2 * points.raw < points.len() {
            return Ok(false);
        }
        if points.len() < POINTS_MIN {
            return Ok(true);
        }
        self.draw(points);
        self.bulk.triangulate(&self.points)?;
        let left = self.count_left(region) as f64;
        let vertices = self.points.len() - self.bulk.duplicates().len();
        Ok(left > SHARE_MAX * vertices as f64)
    }

    /// Decisions of the predicates so far.
    pub(super) fn counts(&self) -> &PredicateCounts {
        self.bulk.counts()
    }

    /// Draws points at random: every k-th point of a grid could lie in one plane.
    fn draw(&mut self, points: &Residual<D>) {
        let mut random = Random::new(points.raw as u64);
        let choose = |_| points.point(random.below(points.raw as u64) as usize);
        let sample: Vec<Point> = (0..SAMPLE_POINTS).map(choose).collect();
        self.points.clear();
        self.points.extend_raw(&sample);
    }

    /// Number of vertices that are on the hull or in simplices that are not final.
    fn count_left(&mut self, region: &Region<D>) -> usize {
        let (bulk, is_left) = (&self.bulk, &mut self.is_left);
        let balls = B::balls(self.rules.coordinates(), *region);
        is_left.clear();
        is_left.resize(self.points.len(), false);
        bulk.hull_vertices().for_each(|v| is_left[v as usize] = true);
        for simplex in 0..bulk.len() as u32 {
            if !bulk.is_inside(simplex, &self.points, &balls) {
                bulk.corners(simplex).as_ref().iter().for_each(|&v| is_left[v as usize] = true);
            }
        }
        is_left.iter().filter(|&&left| left).count()
    }
}

#[cfg(test)]
mod tests {
    use super::super::duplicates::Duplicates;
    use super::super::space::Space;
    use super::*;
    use spmesh_stream::{Coordinates, Header, Kind};

    fn leaves_most(points: &[Point], region: Region<3>, every_node: bool) -> bool {
        let header = Header::new(Kind::TetrahedralMesh, Coordinates::F64, 3, false);
        let mut rules = Rules::new(&header, Duplicates::First, false);
        rules.every_node = every_node;
        let mut raw = Residual::<3>::default();
        raw.extend_raw(points);
        Sample::<Space, 3>::new(rules).leaves_most(&raw, &region).unwrap()
    }

    /// Random points of the unit cube, each moved by `place`.
    fn cube(count: usize, place: impl Fn(Point) -> Point) -> Vec<Point> {
        let mut random = Random::new(5);
        let mut unit = || random.bits() as f64 / u64::MAX as f64;
        (0..count).map(|_| place([unit(), unit(), unit()])).collect()
    }

    #[test]
    fn samples_tell_surfaces_from_volumes() {
        let unit = Region { min: [0.0; 3], max: [1.0; 3] };
        let volume = cube(POINTS_MIN, |point| point);
        let grid = cube(POINTS_MIN, |point| point.map(|x| (64.0 * x).floor() / 64.0));
        let sheet = cube(POINTS_MIN, |[x, y, z]| [x, y, 0.4 + 0.1 * (x * x + y) + 0.001 * z]);
        let plane = cube(POINTS_MIN, |[x, y, _]| [x, y, 0.5]);
        for (points, expected) in [(&volume, false), (&grid, false), (&sheet, true), (&plane, true)] {
            assert_eq!(leaves_most(points, unit, false), expected);
            assert!(!leaves_most(points, unit, true), "every node is triangulated if that is wanted");
            assert!(!leaves_most(points, Region::EVERYTHING, false), "where all is final, nothing is left");
        }
        assert!(leaves_most(&volume[1..], unit, false), "too few points");
    }
}
