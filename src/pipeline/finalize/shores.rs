//! The points near the shores of lakes and rivers.
//!
//! A pass before all others collects them, as many as [`Room`] allows.

use std::collections::{BTreeMap, BTreeSet};

use super::batch::{PointBatch, read_ahead};
use super::passes::{Observer, Pass, Passes};
use crate::lines::{Levels, Water, project};
use crate::polygons::{Polygons, Side};
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_delaunay::cell_tree::{CellTree, Fineness, Item};
use spmesh_delaunay::network::Network;
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

/// Bytes of a point that is kept for a shore, with room for more of them.
const KEPT_BYTES: u64 = 2 * size_of::<Point>() as u64;

/// A shore and the number of a point of a batch.
type Pair = (u32, u32);

/// Bytes of a pair in a batch, in all batches, with room for more of them.
const WAITING_BYTES: u64 = 3 * 2 * size_of::<Pair>() as u64;

/// What memory has room for: points that say levels, each once for each shore that it counts for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Room {
    /// Points that may still be kept, and at first.
    left: u64,
    most: u64,
    /// Pairs that a batch may have.
    waiting_max: usize,
}

impl Room {
    /// Room in so many bytes.
    pub(super) fn within(bytes: u64) -> Room {
        let waiting = bytes / 4;
        let most = (bytes - waiting) / KEPT_BYTES;
        Room { left: most, most, waiting_max: (waiting / WAITING_BYTES) as usize }
    }

    /// Makes room for one more point.
    fn take(&mut self) -> Result<()> {
        self.left = self.left.checked_sub(1).ok_or_else(|| full(self.most + 1, self.most))?;
        Ok(())
    }
}

fn full(found: u64, most: u64) -> Error {
    let message = format!(
        "{found} points at shores so far, counted once for each shore, and --memory has room for {most}: raise it, \
         lower --shore-width, or state levels"
    );
    Error::new(ErrorKind::Memory, message)
}

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
/// Those of the input; memory, if points are in more polygons than there is `room` for.
pub(super) fn with_points(
    edges: impl Iterator<Item = (u32, [Point2; 2])>,
    input: &dyn Passes,
    room: Room,
    observer: &mut dyn Observer,
) -> Result<BTreeSet<u32>> {
    let mut found = BTreeSet::new();
    let polygons = Polygons::of_edges(edges);
    let around = |place, near: &mut Vec<u32>| polygons.for_each_around(place, |number| near.push(number));
    for_each_pair(around, input, room.waiting_max, observer, |number, _| {
        found.insert(number);
        Ok(())
    })?;
    Ok(found)
}

/// The points inside of each of the polygons with these numbers that has some; takes a pass.
///
/// # Errors
/// Those of the input; memory, if there are more than there is `room` for.
pub(super) fn collect_inside(
    edges: impl Iterator<Item = (u32, [Point2; 2])>,
    input: &dyn Passes,
    room: &mut Room,
    observer: &mut dyn Observer,
) -> Result<BTreeMap<u32, Vec<Point>>> {
    let polygons = Polygons::of_edges(edges);
    let around = |place, near: &mut Vec<u32>| polygons.for_each_around(place, |number| near.push(number));
    collect(around, input, room, observer)
}

/// The points that count for each of some shores, in the order of the input; takes a pass.
fn collect(
    find: impl Fn(Point2, &mut Vec<u32>) + Send + Sync,
    input: &dyn Passes,
    room: &mut Room,
    observer: &mut dyn Observer,
) -> Result<BTreeMap<u32, Vec<Point>>> {
    let mut found: BTreeMap<u32, Vec<Point>> = BTreeMap::new();
    for_each_pair(find, input, room.waiting_max, observer, |number, point| {
        found.entry(number).or_default().push(point);
        room.take()
    })?;
    Ok(found)
}

/// Calls `found` with each point and the number of each shore that it counts for, which `find` enters; takes
/// a pass.
fn for_each_pair(
    find: impl Fn(Point2, &mut Vec<u32>) + Send + Sync,
    input: &dyn Passes,
    waiting_max: usize,
    observer: &mut dyn Observer,
    mut found: impl FnMut(u32, Point) -> Result<()>,
) -> Result<()> {
    observer.pass(Pass::Shores, input.description().stated_points);
    let mut done = 0;
    let prepare = |batch: &PointBatch, pairs: &mut Vec<Pair>| {
        pairs.clear();
        let mut near = Vec::new();
        for (point, index) in batch.points.iter().zip(0..) {
            near.clear();
            find([point[0], point[1]], &mut near);
            pairs.extend(near.iter().map(|&number| (number, index)));
            if pairs.len() > waiting_max {
                return Err(full(pairs.len() as u64, waiting_max as u64));
            }
        }
        Ok(())
    };
    read_ahead(&mut *input.read()?, prepare, |batch, pairs| {
        pairs.iter().try_for_each(|&(number, index)| found(number, batch.points[index as usize]))?;
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

    /// The place on an edge that is nearest to a place, from 0 to 1, and the square of its distance; `None`
    /// if it is not near.
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
}

impl Shores {
    /// The shores of polygons whose edges are given with their numbers; points are collected for those that
    /// `needed` says. `width` is in stored units.
    pub(super) fn new(edges: Vec<(u32, [Point2; 2])>, needed: &[bool], width: f64) -> Shores {
        let water = Polygons::of_edges(edges.iter().copied());
        let is_needed = |(number, _): &(u32, _)| needed[*number as usize];
        let edges = Edges::new(edges.into_iter().filter(is_needed).collect(), width);
        Shores { edges, water }
    }

    /// Number of edges of all polygons, and the bytes that they and those of shores take.
    pub(super) fn size(&self) -> (usize, u64) {
        let (edges, bytes) = self.water.size();
        (edges, bytes + SHORE_BYTES * self.edges.edges.len() as u64)
    }

    /// The numbers of the polygons near whose shores a place is, each once, behind those found before.
    fn near(&self, place: Point2, found: &mut Vec<u32>) {
        let before = found.len();
        for &edge in self.edges.listed(place) {
            let (polygon, _) = self.edges.edges[edge as usize];
            if found[before..].last() != Some(&polygon) && self.edges.nearest(edge, place).is_some() {
                found.push(polygon);
            }
        }
        if found.len() > before && self.water.side(place) != Side::Outside {
            found.truncate(before);
        }
    }

    /// The points of an input near each shore that has some, in the order of the input.
    ///
    /// # Errors
    /// Those of the input; memory, if there are more than there is `room` for.
    pub(super) fn collect(
        &self,
        input: &dyn Passes,
        room: &mut Room,
        observer: &mut dyn Observer,
    ) -> Result<BTreeMap<u32, Vec<Point>>> {
        collect(|place, found| self.near(place, found), input, room, observer)
    }
}

/// Bytes of an edge with its levels and its cells.
pub(super) const SHORE_BYTES: u64 = 400;

/// Shores with their levels, to which points near them are raised.
#[derive(Debug)]
pub(super) struct Raise {
    edges: Edges,
    /// The elevations at the ends of each edge.
    levels: Vec<[f64; 2]>,
    coordinates: Coordinates,
}

impl Raise {
    /// The shores of all water, with the elevations of their vertices. `width` is in stored units.
    pub(super) fn of(
        network: &Network,
        water: &Water,
        levels: &Levels,
        width: f64,
        coordinates: Coordinates,
    ) -> Raise {
        let segments = water.polygons.iter().flat_map(|polygon| &polygon.segments);
        let level = |vertex: u32| levels.elevations.get(&vertex).copied().unwrap_or(f64::NEG_INFINITY);
        let levels = segments.map(|&segment| network.segments[segment as usize].ends.map(level)).collect();
        Raise { edges: Edges::new(water.edges(network), width), levels, coordinates }
    }

    /// Number of edges, and the bytes that they take.
    pub(super) fn size(&self) -> (usize, u64) {
        (self.levels.len(), SHORE_BYTES * self.levels.len() as u64)
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
