//! Natural neighbour interpolation while triangles arrive.
//!
//! If the centre of a cell was a vertex, its Voronoi cell would take a part of the area of those of its
//! neighbours; the part of a neighbour is its weight (Sibson 1981). Half of the boundary of what a neighbour
//! loses is its own Voronoi cell: between the circumcentres of triangles whose circles have the centre
//! inside, and up to where the bisectors of the centre cut it. The other half is on the bisector of the two.
//! Seen from the point halfway between both, which is on that bisector, the area of the second half is zero.
//! So each edge of the mesh adds its own part to the weights of its ends, from its two triangles alone, in
//! any order: no cavity is ever built, and no triangle waits but for the neighbour at each of its edges.
//!
//! Where an edge bounds the triangles whose circles have the centre, its bisectors meet between the two
//! circumcentres, so no part is much greater than the weights. Sums are kept in two numbers each, so that
//! what the order of edges changes is far below the digits of a raster.

use std::collections::hash_map::Entry;

use bytemuck::{Pod, Zeroable};
use foldhash::{HashMap, HashMapExt};

use super::axis::Centers;
use super::circle::{Circle, centre};
use super::facet::place;
use super::tile_cache::TileCache;
use crate::accumulators::Accumulators;
use crate::files::{TilePlace, places};
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::{FiniteFloatPredicates, Point2};
use spmesh_formats::raster::{Grid, TILE};
use spmesh_stream::model::bounds::Point;
use std::path::Path;

/// A pair of triangles waits for the hull of the mesh, if its circles reach so many cells of the raster, and
/// the radius of one is so many times the longest edge of its triangle. In the corners of a raster outside of
/// the hull, circles of flat triangles would cover millions of cells without a value.
const WAITING_CELLS: f64 = 4096.0;
const WAITING_TIMES: f64 = 4.0;

/// A sum, and the rest that it does not show.
type Sum = [f64; 2];

/// What the edges so far add to a cell.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Weights {
    /// Of all neighbours.
    sum: Sum,
    /// The same times the elevations, counted from one of them.
    elevations: Sum,
}

const BLANK: Weights = Weights { sum: [0.0; 2], elevations: [0.0; 2] };

/// One side of an edge: the triangle on the left of the way from one end to the other.
#[derive(Debug, Clone, Copy)]
struct Side {
    ends: [Point; 2],
    /// The third corner of the triangle.
    apex: Point2,
    circle: Circle,
}

/// The weights of the natural neighbours of all cells.
///
/// Memory: the budget for cells, 32 bytes for each; 240 bytes for each edge whose other triangle has not
/// arrived, and 400 for each edge of triangles so flat that they wait for the end.
#[derive(Debug)]
pub(super) struct Natural {
    centers: Centers,
    cells: Accumulators<Weights>,
    /// By the ids of the ends, the lesser one first.
    open: HashMap<[u64; 2], Side>,
    waiting: Vec<[Side; 2]>,
    /// What [`WAITING_CELLS`] and [`WAITING_TIMES`] are here.
    wide: [f64; 2],
    /// Elevations are counted from this one, which the order of triangles must not decide.
    base: f64,
    predicates: FiniteFloatPredicates,
}

impl Natural {
    /// No triangle so far. Elevations are counted from `base`, which is best near them. `memory` is for cells.
    /// Units: bytes.
    pub(super) fn new(
        centers: Centers,
        grid: &Grid,
        base: f64,
        memory: u64,
        temp_dir: Option<&Path>,
    ) -> Result<Natural> {
        let cells = Accumulators::new(BLANK, grid, memory, temp_dir)?;
        Ok(Natural {
            centers,
            cells,
            open: HashMap::new(),
            waiting: Vec::new(),
            wide: [WAITING_CELLS, WAITING_TIMES],
            base,
            predicates: FiniteFloatPredicates::default(),
        })
    }

    /// Tiles and bytes in the temporary file.
    pub(super) fn spilled(&self) -> [u64; 2] {
        [self.cells.spilled, self.cells.spill_len()]
    }

    /// Adds a counterclockwise triangle of vertices with ids, in stored coordinates and with elevations of
    /// the world.
    ///
    /// # Errors
    /// Malformed, if two triangles are on one side of an edge, or the mesh is not Delaunay there; those of
    /// temporary files.
    pub(super) fn add(&mut self, vertices: [&(u64, Point); 3]) -> Result<()> {
        let circle = Circle::around(vertices.map(|(_, corner)| *corner));
        for turn in 0..3 {
            let [from, to, apex] = [0, 1, 2].map(|more| vertices[(turn + more) % 3]);
            let side = Side { ends: [from.1, to.1], apex: place(apex.1), circle };
            let opposite = match self.open.entry([from.0.min(to.0), from.0.max(to.0)]) {
                Entry::Vacant(free) => {
                    free.insert(side);
                    continue;
                }
                Entry::Occupied(found) => found.remove(),
            };
            if opposite.ends[0] == side.ends[0] {
                return Err(Error::malformed("two triangles are on one side of an edge"));
            }
            if circle.has(opposite.apex, &mut self.predicates) {
                let [x, y] = opposite.apex;
                return Err(Error::malformed(format!(
                    "the mesh is not Delaunay at {x}, {y} (stored coordinates), and natural neighbours are those of Delaunay \
                     meshes: interpolate linearly, or triangulate its points again"
                )));
            }
            // So that numbers do not depend on which triangle came first.
            let pair =
                if place(side.ends[0]) < place(side.ends[1]) { [side, opposite] } else { [opposite, side] };
            let [most, times] = self.wide;
            let is_flat = |side: &Side| side.circle.radius > times * side.circle.longest;
            if pair.iter().any(is_flat) && self.cells_of(&pair) > most {
                self.waiting.push(pair);
            } else {
                self.pair(&pair[0], Some(&pair[1].circle), None)?;
            }
        }
        Ok(())
    }

    /// How many cells of the raster the box around the circles of a pair has.
    fn cells_of(&self, pair: &[Side; 2]) -> f64 {
        let circles = pair.each_ref().map(|side| Some(&side.circle));
        let [left, right] = extent(&circles, |circle| circle.centre[0], |circle| circle.radius);
        let [low, high] = extent(&circles, |circle| circle.centre[1], |circle| circle.radius);
        let (columns, rows) = (self.centers.columns.cells(left, right), self.centers.rows.cells(low, high));
        columns.len() as f64 * rows.len() as f64
    }

    /// Adds what the edges that wait, and those of the hull, give to cells inside of the hull.
    ///
    /// # Errors
    /// Those of temporary files.
    fn finish(&mut self) -> Result<()> {
        let hull: Vec<Side> = std::mem::take(&mut self.open).into_values().collect();
        let within = Rows::around(&hull, &self.centers);
        for pair in std::mem::take(&mut self.waiting) {
            self.pair(&pair[0], Some(&pair[1].circle), Some(&within))?;
        }
        hull.iter().try_for_each(|side| self.pair(side, None, Some(&within)))
    }

    /// Puts the values of all cells that have one into the tiles of `cache`, in place of the linear ones.
    ///
    /// # Errors
    /// Those of temporary files.
    pub(super) fn put(&mut self, cache: &mut TileCache) -> Result<()> {
        self.finish()?;
        for at in places(cache.tiles()) {
            let Some(cells) = self.cells.read(at)? else { continue };
            let Some(tile) = cache.tile(at)? else { continue };
            for (value, weights) in tile.values.iter_mut().zip(cells).filter(|(value, _)| !value.is_nan()) {
                let [sum, elevations] = [weights.sum, weights.elevations].map(|[sum, rest]| sum + rest);
                // None at a vertex, and none that is finite on the hull: the limit is the linear value.
                let mean = self.base + elevations / sum;
                if sum > 0.0 && mean.is_finite() {
                    *value = mean as f32;
                }
            }
        }
        Ok(())
    }

    /// Adds what an edge gives to the cells in the circle of the triangle on its left, or of the other one.
    /// On the hull there is none.
    fn pair(&mut self, side: &Side, other: Option<&Circle>, within: Option<&Rows>) -> Result<()> {
        let circles = [Some(&side.circle), other];
        let [low, high] = extent(&circles, |circle| circle.centre[1], |circle| circle.radius);
        for row in self.centers.rows.cells(low, high) {
            let y = self.centers.rows.at(row);
            let [left, right] = extent(&circles, |circle| circle.centre[0], |circle| circle.half(y));
            let limits = within.map_or([f64::NEG_INFINITY, f64::INFINITY], |rows| rows.of(row));
            let columns = self.centers.columns.cells(left.max(limits[0]), right.min(limits[1]));
            for column in columns {
                self.cell(side, other, [column, row], [self.centers.columns.at(column), y])?;
            }
        }
        Ok(())
    }

    /// Adds what an edge gives to a cell with its centre at `target`.
    #[inline]
    fn cell(
        &mut self,
        Side { ends, circle, .. }: &Side,
        other: Option<&Circle>,
        [column, row]: [u32; 2],
        target: Point2,
    ) -> Result<()> {
        let predicates = &mut self.predicates;
        let is_in =
            [circle.has(target, predicates), other.is_some_and(|other| other.has(target, predicates))];
        if is_in == [false; 2] {
            return Ok(());
        }
        let [a, b] = ends.map(|end| [end[0] - target[0], end[1] - target[1]]);
        // Where the bisectors meet, if the edge bounds the triangles whose circles have the target.
        let meet = || centre(a, b);
        let from = if is_in[1] { other.map_or_else(meet, |other| other.from(target)) } else { meet() };
        let to = if is_in[0] { circle.from(target) } else { meet() };
        let parts = [part(a, from, to), part(b, to, from)];
        let tile: TilePlace = [column as usize / TILE, row as usize / TILE];
        let index = row as usize % TILE * TILE + column as usize % TILE;
        let weights = self.cells.cell(tile, index)?;
        for (part, end) in parts.into_iter().zip(ends) {
            add(&mut weights.sum, part);
            add(&mut weights.elevations, part * (end[2] - self.base));
        }
        Ok(())
    }
}

/// The area on the left of a way between two places, seen from halfway to the end of an edge: half of its
/// part of the weight. All places are as seen from the target.
#[inline]
fn part(end: Point2, from: Point2, to: Point2) -> f64 {
    let [from, to] = [from, to].map(|place| [place[0] - 0.5 * end[0], place[1] - 0.5 * end[1]]);
    from[0] * to[1] - from[1] * to[0]
}

/// Adds a number to a sum without loss (Knuth).
#[inline]
fn add([sum, rest]: &mut Sum, number: f64) {
    let next = *sum + number;
    let of_number = next - *sum;
    *rest += (*sum - (next - of_number)) + (number - of_number);
    *sum = next;
}

/// The interval that intervals around the centres of circles span.
#[inline]
fn extent(
    circles: &[Option<&Circle>; 2],
    centre: impl Fn(&Circle) -> f64,
    half: impl Fn(&Circle) -> f64,
) -> [f64; 2] {
    let of_circles = circles.iter().flatten().map(|circle| (centre(circle), half(circle)));
    of_circles.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], (centre, half)| {
        [low.min(centre - half), high.max(centre + half)]
    })
}

/// Where the rows of a raster are inside of the hull.
struct Rows(Vec<[f64; 2]>);

impl Rows {
    /// The interval of each row between edges of the hull, and a little more.
    fn around(hull: &[Side], centers: &Centers) -> Rows {
        let mut rows = vec![[f64::INFINITY, f64::NEG_INFINITY]; centers.rows.count as usize];
        for [a, b] in hull.iter().map(|side| side.ends) {
            let [low, high] = [a[1].min(b[1]), a[1].max(b[1])];
            for row in centers.rows.cells(low, high) {
                let along = if low < high { (centers.rows.at(row) - a[1]) / (b[1] - a[1]) } else { 0.0 };
                let x = a[0] + (b[0] - a[0]) * along;
                let margin = f64::EPSILON * 8.0 * (a[0].abs() + b[0].abs());
                let ends = if low < high { [x, x] } else { [a[0].min(b[0]), a[0].max(b[0])] };
                let own = &mut rows[row as usize];
                *own = [own[0].min(ends[0] - margin), own[1].max(ends[1] + margin)];
            }
        }
        Rows(rows)
    }

    fn of(&self, row: u32) -> [f64; 2] {
        self.0[row as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_base::random::Random;
    use spmesh_delaunay::delaunay2::triangulate;
    use spmesh_delaunay::predicates::{Predicates2, Sign};
    use spmesh_stream::Coordinates;

    /// The part of a polygon that is nearer to one place than to another.
    fn nearer(polygon: &[Point2], to: Point2, than: Point2) -> Vec<Point2> {
        let [u, v] = [than[0] - to[0], than[1] - to[1]];
        let [x, y] = [0, 1].map(|axis| 0.5 * (than[axis] + to[axis]));
        let away = |place: Point2| (place[0] - x) * u + (place[1] - y) * v;
        let mut kept = Vec::new();
        for (index, &from) in polygon.iter().enumerate() {
            let next = polygon[(index + 1) % polygon.len()];
            let [start, end] = [away(from), away(next)];
            if start <= 0.0 {
                kept.push(from);
            }
            if (start < 0.0) != (end < 0.0) && start != 0.0 && end != 0.0 {
                let along = start / (start - end);
                kept.push([0, 1].map(|axis| from[axis] + (next[axis] - from[axis]) * along));
            }
        }
        kept
    }

    fn size(polygon: &[Point2]) -> f64 {
        let Some(&first) = polygon.first() else { return 0.0 };
        let at = |place: Point2| [place[0] - first[0], place[1] - first[1]];
        polygon
            .windows(2)
            .map(|ends| [at(ends[0]), at(ends[1])])
            .map(|[a, b]| 0.5 * (a[0] * b[1] - a[1] * b[0]))
            .sum()
    }

    /// The value at a place inside of the hull by definition: what its Voronoi cell takes of those of the
    /// points. `None` if this cell is so large that numbers of the definition are not good.
    fn expected(points: &[Point], target: Point2, far: f64) -> Option<f64> {
        let everything = [[-far, -far], [far, -far], [far, far], [-far, far]].to_vec();
        let cell = points.iter().fold(everything, |cell, point| nearer(&cell, target, place(*point)));
        if cell.iter().flatten().any(|at| at.abs() >= far) {
            return None;
        }
        let taken = |point: &Point| {
            let others = points.iter().filter(|other| place(**other) != place(*point));
            size(&others.fold(cell.clone(), |part, other| nearer(&part, place(*point), place(*other))))
        };
        let weights: Vec<f64> = points.iter().map(taken).collect();
        let sum = weights.iter().zip(points).map(|(weight, point)| weight * point[2]).sum::<f64>();
        Some(sum / weights.iter().sum::<f64>())
    }

    /// Whether a place is strictly inside of the hull.
    fn is_inside(points: &[Point2], triangles: &[[u32; 3]], target: Point2) -> bool {
        let edges = || triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let hull = edges().filter(|&[a, b]| !edges().any(|other| other == [b, a]));
        let mut predicates = FiniteFloatPredicates::default();
        hull.map(|edge| edge.map(|end| points[end as usize]))
            .all(|[a, b]| predicates.orient2d(a, b, target) == Sign::Positive)
    }

    /// The greatest error of the values of cells with such a step, and their number.
    fn error(random: &mut Random, points: &[Point], grid: Grid) -> (f64, usize) {
        let places: Vec<Point2> = points.iter().map(|point| place(*point)).collect();
        let mesh = triangulate(&places).unwrap();
        let mut triangles: Vec<[u32; 3]> = mesh.simplices().collect();
        for index in (1..triangles.len()).rev() {
            triangles.swap(index, random.below(index as u64 + 1) as usize);
        }
        let centers = Centers::new(grid, &Coordinates::F64, 1.0);
        let mut natural = Natural::new(centers, &grid, 500.0, 1 << 24, None).unwrap();
        // All pairs wait for the hull, or only those that would without a test.
        if random.below(2) == 0 {
            natural.wide = [0.0, 0.0];
        }
        for triangle in &triangles {
            let vertices = triangle.map(|vertex| (u64::from(vertex), points[vertex as usize]));
            natural.add(vertices.each_ref()).unwrap();
        }
        natural.finish().unwrap();
        let (mut worst, mut count) = (0.0f64, 0);
        for (column, row) in (0..grid.columns).flat_map(|column| (0..grid.rows).map(move |row| (column, row)))
        {
            let target = [centers.columns.at(column), centers.rows.at(row)];
            if !is_inside(&places, &triangles, target) {
                continue;
            }
            let found = natural.value([column, row]).unwrap();
            let far = 1000.0 * f64::from(grid.columns.max(grid.rows)) * grid.step;
            // At a vertex there are no weights.
            if let (Some(found), Some(expected)) = (found, expected(points, target, far)) {
                worst = worst.max((found - expected).abs());
                count += 1;
            }
        }
        (worst, count)
    }

    impl Natural {
        /// The value of a cell; `None` without weights.
        fn value(&mut self, [column, row]: [u32; 2]) -> Result<Option<f64>> {
            let cell = self.cells.cell([0, 0], row as usize * TILE + column as usize)?;
            let [sum, elevations] = [cell.sum, cell.elevations].map(|[sum, rest]| sum + rest);
            Ok((sum > 0.0).then_some(self.base + elevations / sum))
        }
    }

    /// Compares values of so many sets of points, at most so many cells along each side of their box.
    fn compare(rounds: usize, side: u32) -> usize {
        let mut random = Random::new(11);
        let mut cells = 0;
        for round in 0..rounds {
            // Few places: grids, cocircular and collinear points; or many; or wide and flat sets.
            let [wide, high] = [[5, 5], [1000, 1000], [900, 12], [40, 7], [6, 6]][round % 5];
            let number = 4 + random.below(24);
            let place_of = |random: &mut Random| [wide, high, 1000].map(|most| random.below(most) as f64);
            let mut points: Vec<Point> = (0..number).map(|_| place_of(&mut random)).collect();
            points.sort_by(|a, b| a.partial_cmp(b).unwrap());
            points.dedup_by_key(|point| place(*point).map(f64::to_bits));
            let even = wide.min(high) as f64 / 8.0 * 1.03;
            let step = if round % 10 < 5 { even } else { 0.5 };
            let [columns, rows] = [wide, high].map(|most| ((most as f64 / step) as u32 + 1).min(side));
            let grid = Grid { left: -0.75, top: high as f64 + 0.25, step, columns, rows };
            let (worst, count) = error(&mut random, &points, grid);
            assert!(worst < 1e-9 * 1000.0, "round {round}: {worst:e}");
            cells += count;
        }
        cells
    }

    #[test]
    fn values_are_those_of_the_definition() {
        let cells = compare(60, 12);
        assert!(cells > 1000, "{cells}");
    }

    #[test]
    #[ignore = "long: run with -- --ignored"]
    fn values_of_many_sets_are_those_of_the_definition() {
        let cells = compare(1200, 40);
        assert!(cells > 50_000, "{cells}");
    }
}
