//! The points near the shores of lakes and rivers.
//!
//! A pass before all others collects them. Memory: 24 bytes for each point and each shore that it is near.

use std::collections::{BTreeMap, BTreeSet};

use super::batch::{PointBatch, read_ahead};
use super::passes::{Observer, Pass, Passes};
use crate::lines::project;
use crate::polygons::{Polygons, Side};
use spmesh_base::error::Result;
use spmesh_delaunay::cell_tree::{CellTree, Fineness, Item};
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::model::points::Point2;

/// Cells over the shores: so many in any case, for each edge, and at most.
const CELLS: f64 = 4096.0;
const CELLS_PER_EDGE: f64 = 4.0;
const CELLS_MAX: f64 = 4e6;

/// Edges in cells, for each edge, at most: with more, cells are larger.
const ENTRIES_PER_EDGE: usize = 64;

/// Mean distances between points that the width of shores is by default.
const WIDTH_DISTANCES: f64 = 4.0;

/// The box of the points and their number, which takes a pass; `None` without points.
///
/// # Errors
/// Those of the input.
pub(super) fn extent(input: &dyn Passes, observer: &mut dyn Observer) -> Result<Option<(Bounds, u64)>> {
    observer.pass(Pass::Spacing, input.description().stated_points);
    let (mut bounds, mut points): (Option<Bounds>, u64) = (None, 0);
    let prepare = |_: &PointBatch, (): &mut ()| Ok(());
    read_ahead(&mut *input.read()?, prepare, |batch, ()| {
        let own = Bounds::of_points(&batch.points);
        bounds = own.map(|own| bounds.map_or(own, |bounds| bounds.union(own))).or(bounds);
        points += batch.points.len() as u64;
        observer.done(points);
        Ok(())
    })?;
    Ok(bounds.map(|bounds| (bounds, points)))
}

/// The width of shores where none is given: four times the mean distance between points, which is the root of
/// the area of their box for each point. In stored units.
pub(super) fn shore_width((Bounds { min, max }, points): (Bounds, u64)) -> f64 {
    let [width, height] = [0, 1].map(|axis| max[axis] - min[axis]);
    let across = (width * height / points as f64).sqrt();
    // Points on a line have no area.
    WIDTH_DISTANCES * if across > 0.0 { across } else { width.max(height) / points as f64 }
}

/// Which of the polygons with these numbers have a point inside; takes a pass.
///
/// # Errors
/// Those of the input.
pub(super) fn with_points(
    edges: impl Iterator<Item = (u32, [Point2; 2])>,
    input: &dyn Passes,
    observer: &mut dyn Observer,
) -> Result<BTreeSet<u32>> {
    let mut found = BTreeSet::new();
    for_each_inside(edges, input, observer, |number, _| _ = found.insert(number))?;
    Ok(found)
}

/// The points inside of each of the polygons with these numbers that has some; takes a pass.
///
/// # Errors
/// Those of the input.
pub(super) fn collect_inside(
    edges: impl Iterator<Item = (u32, [Point2; 2])>,
    input: &dyn Passes,
    observer: &mut dyn Observer,
) -> Result<BTreeMap<u32, Vec<Point>>> {
    let mut found: BTreeMap<u32, Vec<Point>> = BTreeMap::new();
    for_each_inside(edges, input, observer, |number, point| found.entry(number).or_default().push(point))?;
    Ok(found)
}

/// Calls `found` with each point that is inside of a polygon, and the number of the polygon; takes a pass.
fn for_each_inside(
    edges: impl Iterator<Item = (u32, [Point2; 2])>,
    input: &dyn Passes,
    observer: &mut dyn Observer,
    mut found: impl FnMut(u32, Point),
) -> Result<()> {
    observer.pass(Pass::Shores, input.description().stated_points);
    let (polygons, mut done) = (Polygons::of_edges(edges), 0);
    let prepare = |batch: &PointBatch, inside: &mut Vec<(u32, Point)>| {
        inside.clear();
        for &point in &batch.points {
            polygons.for_each_around([point[0], point[1]], |number| inside.push((number, point)));
        }
        Ok(())
    };
    read_ahead(&mut *input.read()?, prepare, |batch, inside| {
        inside.iter().for_each(|&(number, point)| found(number, point));
        done += batch.points.len() as u64;
        observer.done(done);
        Ok(())
    })
}

/// Edges of shores, which are looked for near places.
#[derive(Debug)]
struct Edges {
    edges: Vec<(u32, [Point2; 2])>,
    width: f64,
    /// The edges near each cell.
    cells: CellTree,
}

impl Edges {
    /// Edges with the numbers of their polygons, up to `width` away, in stored units.
    fn new(edges: Vec<(u32, [Point2; 2])>, width: f64) -> Edges {
        // A margin for rounding.
        let fineness = Fineness {
            items_per_cell: 1.0 / CELLS_PER_EDGE,
            cells: [CELLS, CELLS_MAX],
            entries: [ENTRIES_PER_EDGE, 1 << 16],
            crowd: 64,
            reach: width * (1.0 + 1e-9),
            is_whole: false,
        };
        let cells =
            CellTree::new(edges.len() as u32, |edge| Item::Segment(edges[edge as usize].1), &fineness);
        Edges { edges, width, cells }
    }

    /// The numbers of edges of which some are near a place.
    fn listed(&self, place: Point2) -> &[u32] {
        self.cells.leaf(place).map_or(&[], |(tree, cell)| tree.list(cell))
    }

    /// The place on an edge that is nearest to a place, from 0 to 1, and the square of its distance; `None` if
    /// it is not near.
    fn nearest(&self, edge: u32, place: Point2) -> Option<(f64, f64)> {
        let found = project(self.edges[edge as usize].1, place);
        (found.1 <= self.width * self.width).then_some(found)
    }
}

/// Shores, and the points that count for them: those at most a width away, and neither in water nor on a
/// shore.
#[derive(Debug)]
pub(super) struct Shores {
    edges: Edges,
    water: Polygons,
    polygons: usize,
}

impl Shores {
    /// The shores of polygons whose edges are given with their numbers; points are collected for those that
    /// `needed` says. `width` is in stored units.
    pub(super) fn new(edges: Vec<(u32, [Point2; 2])>, needed: &[bool], width: f64) -> Shores {
        let water = Polygons::of_edges(edges.iter().copied());
        let is_needed = |(number, _): &(u32, _)| needed[*number as usize];
        let edges = Edges::new(edges.into_iter().filter(is_needed).collect(), width);
        Shores { edges, water, polygons: needed.len() }
    }

    /// The numbers of the polygons near whose shores a place is, each once.
    fn near(&self, place: Point2, found: &mut Vec<u32>) {
        found.clear();
        for &edge in self.edges.listed(place) {
            let (polygon, _) = self.edges.edges[edge as usize];
            if found.last() != Some(&polygon) && self.edges.nearest(edge, place).is_some() {
                found.push(polygon);
            }
        }
        if !found.is_empty() && self.water.side(place) != Side::Outside {
            found.clear();
        }
    }

    /// The points of an input near each shore, in the order of the polygons and of the input.
    ///
    /// # Errors
    /// Those of the input.
    pub(super) fn collect(&self, input: &dyn Passes, observer: &mut dyn Observer) -> Result<Vec<Vec<Point>>> {
        observer.pass(Pass::Shores, input.description().stated_points);
        let (mut shores, mut done) = (vec![Vec::new(); self.polygons], 0);
        let prepare = |batch: &PointBatch, near: &mut Vec<(u32, Point)>| {
            near.clear();
            let mut found = Vec::new();
            for &point in &batch.points {
                self.near([point[0], point[1]], &mut found);
                near.extend(found.iter().map(|&polygon| (polygon, point)));
            }
            Ok(())
        };
        read_ahead(&mut *input.read()?, prepare, |batch, near| {
            near.iter().for_each(|&(polygon, point)| shores[polygon as usize].push(point));
            done += batch.points.len() as u64;
            observer.done(done);
            Ok(())
        })?;
        Ok(shores)
    }
}

/// Bytes of an edge with its levels and its cells.
const RAISE_BYTES: u64 = 400;

/// Shores with their levels, to which points near them are raised.
#[derive(Debug)]
pub(super) struct Raise {
    edges: Edges,
    /// The elevations at the ends of each edge.
    levels: Vec<[f64; 2]>,
    coordinates: Coordinates,
}

impl Raise {
    /// The same edges as of [`Shores::new`], with the elevations at their ends.
    pub(super) fn new(
        edges: Vec<(u32, [Point2; 2])>,
        levels: Vec<[f64; 2]>,
        width: f64,
        coordinates: Coordinates,
    ) -> Raise {
        Raise { edges: Edges::new(edges, width), levels, coordinates }
    }

    /// Number of edges, and the bytes that they take.
    pub(super) fn size(&self) -> (usize, u64) {
        (self.levels.len(), RAISE_BYTES * self.levels.len() as u64)
    }

    /// The elevation of the water at the place of a shore that is nearest to a place, if it is near enough.
    /// Of equally near edges the first counts: so the elevation follows from the shores alone.
    pub(super) fn level(&self, place: Point2) -> Option<f64> {
        let near = |&edge: &u32| Some((edge, self.edges.nearest(edge, place)?));
        let near = self.edges.listed(place).iter().filter_map(near);
        let (edge, (along, _)) =
            near.min_by(|(a, (_, to_a)), (b, (_, to_b))| to_a.total_cmp(to_b).then(a.cmp(b)))?;
        let [from, to] = self.levels[edge as usize];
        Some(self.coordinates.rounded(from + (to - from) * along))
    }
}
