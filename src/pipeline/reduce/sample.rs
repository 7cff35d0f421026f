//! Whether a node is worth triangulating, estimated from a sample of its points.
//!
//! In space, points on a surface have tetrahedra whose balls are as large as the object that the surface
//! bounds (thesis 5.4), and in the plane, points on a curve have triangles whose circles are as large as the
//! curve bends. If the cell is smaller, no simplex is final, and the time to triangulate it is lost.
//!
//! Random points show the shape of the whole node, neighbours the size of its simplices: those of two close
//! rows are far smaller than simplices of random points of the rows. A node is passed up only if both samples
//! say so.

use super::bulk::Bulk;
use super::residual::Residual;
use super::rules::Rules;
use super::shape::{are_on_surface, fill_their_box};
use spmesh_base::error::Result;
use spmesh_base::random::Random;
use spmesh_delaunay::predicates::PredicateCounts;
use spmesh_stream::model::bounds::Region;

/// Most points of a sample.
const SAMPLE_POINTS: usize = 2048;

/// Points of a first look, which shows whether a sample is needed.
const LOOK_POINTS: usize = 256;

/// A sample is at most one of so many points.
const SAMPLED_ONE_OF: usize = 8;

/// Largest fraction of the sample that a node worth triangulating may leave. A sample of random points in a
/// cube leaves 59 %, one of points on a surface nearly all.
const SHARE_MAX: f64 = 0.85;

/// Largest fraction that it may leave of the inner half of a sample of neighbours. It is strict, because the
/// points around the sample are missing: they could make more simplices active.
const NEAR_SHARE_MAX: f64 = 0.02;

/// Points of a sample of points on a surface, and the smallest fraction that it leaves if they wait for the
/// root.
const SURFACE_POINTS: usize = 4096;
const SURFACE_SHARE_MIN: f64 = 0.3;

/// Triangulates samples of the points of nodes.
pub(super) struct Sample<B, const D: usize> {
    rules: Rules<D>,
    bulk: B,
    points: Residual<D>,
    is_left: Vec<bool>,
}

impl<B: Bulk<D>, const D: usize> Sample<B, D> {
    pub(super) fn new(rules: Rules<D>) -> Self {
        Sample { rules, bulk: B::default(), points: Residual::default(), is_left: Vec::new() }
    }

    /// Allows samples so many bytes beyond those of each point.
    pub(super) fn allow(&mut self, bytes: u64) {
        self.bulk.allow(bytes);
    }

    /// Whether triangulating `points` would leave most of them, because other points may lie outside of
    /// `region`.
    ///
    /// Points of surfaces are left by one node after the other, about half of them each time. A node of few
    /// such points passes them up, too, if there is memory for all at the root, and so does a node of most
    /// points.
    ///
    /// The sample holds raw points only. If most points come from nodes below, those nodes were worth
    /// triangulating, and the answer is `false` without a sample. The answer depends on the points and their
    /// order alone.
    pub(super) fn leaves_most(&mut self, points: &Residual<D>, region: &Region<D>) -> Result<bool> {
        if self.rules.every_node || *region == Region::EVERYTHING {
            return Ok(false);
        }
        if points.has_hardly_grown() {
            return Ok(true);
        }
        if 2 * points.raw < points.len() {
            return Ok(false);
        }
        if points.len() < B::SAMPLED_MIN {
            return Ok(B::PASSES_FEW);
        }
        if self.holds_most(points) {
            return Ok(true);
        }
        // In space, a thick surface fills its box, too.
        if D == 2 {
            self.draw(points, LOOK_POINTS);
            if fill_their_box(&self.points.at) {
                return Ok(false);
            }
        }
        let may_wait = self.may_wait(points);
        if may_wait && has_sides_along_all_axes(region) {
            return Ok(true);
        }
        self.draw(points, if may_wait { SURFACE_POINTS } else { SAMPLE_POINTS });
        let share = self.share_left(region, self.points.len())?;
        if share <= SHARE_MAX {
            return Ok(may_wait && share >= SURFACE_SHARE_MIN);
        }
        // Points drawn from two close rows have simplices far larger than those of neighbours in the rows.
        self.draw_near(points, SAMPLE_POINTS);
        Ok(self.share_left(region, self.points.len() / 2)? > NEAR_SHARE_MAX)
    }

    /// Whether these are most points of the input, which no node has triangulated yet. The root triangulates
    /// them with all threads.
    fn holds_most(&self, points: &Residual<D>) -> bool {
        let are_most = |all| 2 * points.raw as u64 > all;
        B::SURFACE_MAX > 0 && self.rules.holds_surfaces && self.rules.points.is_some_and(are_most)
    }

    /// Whether the points lie on a surface, and may wait for the root.
    fn may_wait(&self, points: &Residual<D>) -> bool {
        let are_few = points.len() < B::SURFACE_MAX && points.raw >= B::SAMPLED_MIN;
        self.rules.holds_surfaces && are_few && are_on_surface(&points.at[..points.raw])
    }

    /// The fraction of the first points of the sample that the node would leave.
    fn share_left(&mut self, region: &Region<D>, count: usize) -> Result<f64> {
        self.bulk.triangulate(&self.points, self.rules.weights)?;
        self.find_left(region);
        for &[point, _] in self.bulk.duplicates().iter() {
            self.is_left[point as usize] = false;
        }
        let merged = self.bulk.duplicates().iter().filter(|pair| (pair[0] as usize) < count).count();
        let left = self.is_left[..count].iter().filter(|&&left| left).count();
        self.bulk.shrink(self.points.len());
        // Of points that are all merged none is left.
        Ok(left as f64 / (count - merged).max(1) as f64)
    }

    /// Decisions of the predicates so far.
    pub(super) fn counts(&self) -> &PredicateCounts {
        self.bulk.counts()
    }

    /// Draws at most so many points at random: every k-th point of a grid could lie in one plane.
    fn draw(&mut self, points: &Residual<D>, most: usize) {
        let mut random = Random::new(points.raw as u64);
        let count = most.min(points.raw / SAMPLED_ONE_OF);
        self.take(points, (0..count).map(|_| random.below(points.raw as u64) as usize));
    }

    /// Draws one point at random, and the points nearest to it, in the order of their distances.
    fn draw_near(&mut self, points: &Residual<D>, most: usize) {
        let centre = points.at[Random::new(points.raw as u64).below(points.raw as u64) as usize];
        let square = |i: u32| -> f64 {
            let at = points.at[i as usize];
            (0..D).map(|axis| (at[axis] - centre[axis]) * (at[axis] - centre[axis])).sum()
        };
        let mut near: Vec<(f64, u32)> = (0..points.raw as u32).map(|i| (square(i), i)).collect();
        let count = most.min(points.raw / SAMPLED_ONE_OF);
        near.select_nth_unstable_by(count, |p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1)));
        near.truncate(count);
        near.sort_unstable_by(|p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1)));
        self.take(points, near.iter().map(|&(_, i)| i as usize));
    }

    /// Takes these points as the sample, with their rows if weights are in them.
    fn take(&mut self, points: &Residual<D>, chosen: impl Iterator<Item = usize>) {
        self.points.clear();
        for index in chosen {
            let row = if self.rules.weights.is_some() { points.row(index) } else { &[] };
            self.points.extend_raw(&[points.point(index)], row);
        }
    }

    /// Finds the vertices that are on the hull or in simplices that are not final.
    fn find_left(&mut self, region: &Region<D>) {
        let (bulk, is_left) = (&self.bulk, &mut self.is_left);
        let balls = B::balls(self.rules.coordinates(), *region, self.rules.weights);
        is_left.clear();
        is_left.resize(self.points.len(), false);
        if bulk.len() == 0 && !self.rules.sides.coincide() {
            bulk.hull_vertices().for_each(|v| is_left[v as usize] = true);
        }
        for corners in bulk.hull_facets().map(|facet| bulk.wall(facet)) {
            if !self.rules.sides.hold(corners.iter().map(|&v| self.points.at[v as usize])) {
                corners.iter().for_each(|&v| is_left[v as usize] = true);
            }
        }
        for simplex in 0..bulk.len() as u32 {
            if !bulk.is_inside(simplex, &self.points, &balls) {
                bulk.corners(simplex).as_ref().iter().for_each(|&v| is_left[v as usize] = true);
            }
        }
    }
}

/// Whether other points may lie outside of the region along every axis.
fn has_sides_along_all_axes<const D: usize>(region: &Region<D>) -> bool {
    (0..D).all(|axis| region.min[axis].is_finite() || region.max[axis].is_finite())
}

#[cfg(test)]
mod tests {
    use super::super::duplicates::Duplicates;
    use super::super::plane::Plane;
    use super::super::sides::Sides;
    use super::super::space::Space;
    use super::*;
    use spmesh_stream::model::bounds::{Bounds, Point};
    use spmesh_stream::{Coordinates, Header, Kind};

    const SAMPLED_MIN_OF_SPACE: usize = <Space as Bulk<3>>::SAMPLED_MIN;

    fn leaves_most(points: &[Point], region: Region<3>, every_node: bool) -> bool {
        passes(points, region, |rules| rules.every_node = every_node)
    }

    fn passes(points: &[Point], region: Region<3>, change: impl FnOnce(&mut Rules<3>)) -> bool {
        let header = Header::new(Kind::TetrahedralMesh, Coordinates::F64, 3, false);
        let mut rules = Rules::<3>::new(&header, Duplicates::First, false);
        change(&mut rules);
        let mut raw = Residual::<3>::default();
        raw.extend_raw(points, &[]);
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
        let volume = cube(SAMPLED_MIN_OF_SPACE, |point| point);
        let grid = cube(SAMPLED_MIN_OF_SPACE, |point| point.map(|x| (64.0 * x).floor() / 64.0));
        let sheet = cube(SAMPLED_MIN_OF_SPACE, |[x, y, z]| [x, y, 0.4 + 0.1 * (x * x + y) + 0.001 * z]);
        let plane = cube(SAMPLED_MIN_OF_SPACE, |[x, y, _]| [x, y, 0.5]);
        for (points, expected) in [(&volume, false), (&grid, false), (&sheet, true), (&plane, true)] {
            assert_eq!(leaves_most(points, unit, false), expected);
            assert!(!leaves_most(points, unit, true), "every node is triangulated if that is wanted");
            assert!(!leaves_most(points, Region::EVERYTHING, false), "where all is final, nothing is left");
        }
        assert!(leaves_most(&volume[1..], unit, false), "too few points");
    }

    #[test]
    fn points_on_surfaces_wait_if_there_is_memory() {
        let passes = |points: &[Point], region, holds_surfaces| {
            passes(points, region, |rules| rules.holds_surfaces = holds_surfaces)
        };
        let unit = Region { min: [0.0; 3], max: [1.0; 3] };
        let sheets = |[x, y, z]: Point| {
            let wave = 0.4 * (7.0 * x).sin() * (9.0 * y).sin();
            [x, y, ((4.0 * z).floor() + 0.5 + wave) / 4.0]
        };
        let surface = cube(SAMPLED_MIN_OF_SPACE, sheets);
        assert!(passes(&surface, unit, true));
        assert!(!passes(&surface, unit, false), "no memory");
        let open = Region { min: [0.0, f64::NEG_INFINITY, f64::NEG_INFINITY], max: [f64::INFINITY; 3] };
        assert!(!passes(&surface, open, true), "only points near one side are left");
        // Most of the box is empty, but points share cells as in a volume.
        let clusters = cube(SAMPLED_MIN_OF_SPACE, |point| {
            point.map(|x| ((4.0 * x).floor() + 0.5 + 0.4 * ((4.0 * x).fract() - 0.5)) / 4.0)
        });
        for volume in [&cube(SAMPLED_MIN_OF_SPACE, |point| point), &clusters] {
            assert!(!passes(volume, unit, true));
        }
        let many = cube(<Space as Bulk<3>>::SURFACE_MAX, sheets);
        assert!(passes(&many[1..], unit, true) && !passes(&many, unit, true), "too many to wait");
    }

    #[test]
    fn most_points_of_the_input_wait_if_there_is_memory() {
        let unit = Region { min: [0.0; 3], max: [1.0; 3] };
        let volume = cube(SAMPLED_MIN_OF_SPACE, |point| point);
        let half = volume.len() as u64;
        for (all, holds, expected) in
            [(2 * half - 1, true, true), (2 * half, true, false), (half, false, false)]
        {
            let found = passes(&volume, unit, |rules| {
                (rules.points, rules.holds_surfaces) = (Some(all), holds);
            });
            assert_eq!(found, expected, "{half} of {all}");
        }
    }

    #[test]
    fn samples_tell_curves_from_areas() {
        let header = Header::new(Kind::TriangleMesh, Coordinates::F64, 2, false);
        let cell = Region { min: [0.0; 2], max: [1.0; 2] };
        let leaves_most = |points: &[Point], sides: Sides<2>| {
            let mut rules = Rules::new(&header, Duplicates::First, false);
            rules.sides = sides;
            let mut raw = Residual::<2>::default();
            raw.extend_raw(points, &[]);
            Sample::<Plane, 2>::new(rules).leaves_most(&raw, &cell).unwrap()
        };
        let count = 4 * <Plane as Bulk<2>>::SAMPLED_MIN;
        let area = cube(count, |point| point);
        let curve = cube(count, |[x, _, _]| [x, 0.5 + 0.4 * x * x, 0.0]);
        let band = cube(count, |[x, y, _]| [x, 0.5 + 0.01 * y, 0.0]);
        let strip = cube(count, |[x, y, _]| [x, if y < 0.5 { 0.25 } else { 0.75 }, 0.0]);
        for (points, expected) in [(&area, false), (&curve, true), (&band, false), (&strip, true)] {
            assert_eq!(leaves_most(points, Sides::UNKNOWN), expected);
        }
        let bounds = Bounds { min: [0.0, 0.25, 0.0], max: [9.0, 0.75, 0.0] };
        assert!(!leaves_most(&strip, Sides::of(bounds)), "nothing lies beyond the rows");
        // Random points of rows this close have circles far larger than the cell, neighbours small ones.
        let place = |i: usize| [(i / 2) as f64 / count as f64, 0.25 + 1e-6 * (i % 2) as f64, 0.0];
        let rows: Vec<Point> = (0..count).map(place).collect();
        let bounds = Bounds { min: [0.0, 0.25, 0.0], max: [9.0, 0.25 + 1e-6, 0.0] };
        assert!(!leaves_most(&rows, Sides::of(bounds)), "neighbours are in small circles");
        assert!(!leaves_most(&curve[..100], Sides::UNKNOWN), "too few points to look");
    }
}
