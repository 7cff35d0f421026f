//! What of a network a triangle meets.

use super::cells::{Cells, Item};
use super::circle::Circle;
use super::clip::STEPS_MAX;
use super::hull::KnownHull;
use super::leaving::Rings;
use crate::surface::is_counterclockwise;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::cell_tree::{CellBox, Grid};
use spmesh_delaunay::network::{Network, elevation_at};
use spmesh_delaunay::predicates::{FiniteFloatPredicates, Predicates2, Sign, lexicographic};
use spmesh_stream::model::points::Point2;
use std::cmp::Ordering;

/// Points that are not farther from a segment than so many steps of the grid of lines are on it: noding
/// moves its ends by up to half a step along each axis.
const NEAR: f64 = 0.75;

/// A network with its cells.
#[derive(Debug)]
pub(super) struct Lines<'n> {
    pub(super) network: &'n Network,
    /// The borders of areas among the segments.
    pub(super) rings: &'n Rings,
    /// Whether other segments may leave the mesh, and are to be clipped.
    is_clipped: bool,
    /// Such segments leave it beyond this.
    pub(super) hull: KnownHull,
    cells: Cells,
    /// Numbers of the lines that may be shores, in order.
    pub(super) shores: &'n [u32],
    /// The elevations of vertices of the network that are in the mesh; NaN of the others.
    found: Vec<f64>,
    predicates: FiniteFloatPredicates,
    /// For each vertex of the present patch, a distance within which nothing is.
    free: Vec<f64>,
    /// About the distance of vertices of the present patch.
    spacing: f64,
    /// Around the present patch, all vertices within twice this distance were found, and no segment leaves
    /// the mesh. In stored units.
    margin: f64,
    segments: Vec<u32>,
    vertices: Vec<u32>,
    /// Whether a segment may leave the mesh inside of the circle of the present triangle.
    is_near: bool,
}

/// How lines meet a triangle.
#[derive(Debug, Default)]
pub(super) struct Meeting {
    /// Segments that have more than points in common with the triangle.
    pub(super) segments: Vec<u32>,
    /// For each side, opposite to the corner of the same place, whether a segment crosses it.
    pub(super) is_crossed: [bool; 3],
    /// The segments that whole sides are on.
    pub(super) on: [Option<u32>; 3],
    /// Whether a segment crosses the interior.
    pub(super) is_divided: bool,
    /// Vertices of the network inside of the circle.
    pub(super) vertices: Vec<u32>,
    /// Whether the circle may contain the place where a segment leaves the mesh.
    pub(super) is_near: bool,
}

impl Meeting {
    /// Whether the triangle may not be one of the constrained triangulation.
    pub(super) fn changes(&self) -> bool {
        self.is_divided || self.is_hit()
    }

    /// Whether a vertex that the mesh does not have may be inside of the circle.
    pub(super) fn is_hit(&self) -> bool {
        self.is_near || !self.vertices.is_empty()
    }
}

impl<'n> Lines<'n> {
    pub(super) fn new(network: &'n Network, rings: &'n Rings, shores: &'n [u32]) -> Lines<'n> {
        Lines {
            network,
            rings,
            is_clipped: (0..network.segments.len() as u32).any(|segment| !rings.is_border(segment)),
            hull: KnownHull::new(STEPS_MAX * network.step),
            cells: Cells::new(network),
            shores,
            found: vec![f64::NAN; network.vertices.len()],
            predicates: FiniteFloatPredicates::default(),
            free: Vec::new(),
            spacing: 0.0,
            margin: 0.0,
            segments: Vec::new(),
            vertices: Vec::new(),
            is_near: false,
        }
    }

    /// Those of some segments, given in order, that are near a side, in order.
    pub(super) fn near_side(&self, side: [Point2; 2], of: &[u32]) -> Vec<u32> {
        let around = |grid: &Grid| CellBox::of(&side.map(|end| grid.local(end)));
        let mut segments = Vec::new();
        if !self.cells.is_free(around) {
            self.cells.for_each_in(
                |grid| (around(grid), |_: &CellBox| true),
                |item| match item {
                    Item::Segment(number) if of.binary_search(&number).is_ok() => segments.push(number),
                    _ => (),
                },
            );
        }
        segments.sort_unstable();
        segments.dedup();
        segments
    }

    /// Whether a triangle is held if its circle contains a place, for the sake of a segment that leaves the
    /// mesh.
    pub(super) fn holds(&self, place: Point2, segment: u32) -> bool {
        self.cells.has(place, segment)
    }

    /// Forgets the vertices of the patch before.
    pub(super) fn clear(&mut self) {
        self.free.clear();
    }

    /// Takes note of the next vertex of a patch. Returns whether a vertex or a segment may be at its place,
    /// up to roundings.
    pub(super) fn look(&mut self, place: Point2) -> bool {
        let free = self.cells.free_around(place, self.spacing);
        self.free.push(free);
        free <= NEAR * self.network.step
    }

    /// The vertex of the network at a place.
    pub(super) fn vertex_at(&self, place: Point2) -> Option<u32> {
        if self.cells.is_found(|grid| CellBox::of(&[grid.local(place)]), false) {
            return None;
        }
        self.cells.vertex_at(place, self.network)
    }

    /// The elevation at a place that is on a segment with elevations, up to the rounding of its ends. Where
    /// several segments meet, the lowest counts.
    pub(super) fn elevation_near(&self, place: Point2) -> Option<f64> {
        let (network, near) = (self.network, NEAR * self.network.step);
        let around = |grid: &Grid| {
            let (at, reach) = (grid.local(place), near * grid.scale);
            CellBox { min: at.map(|x| x - reach), max: at.map(|x| x + reach) }
        };
        if self.cells.is_free(around) {
            return None;
        }
        let mut lowest: Option<f64> = None;
        let mut visit = |number: u32| {
            let segment = &network.segments[number as usize];
            let Some(elevations) = network.elevations(segment) else { return };
            let foot = foot(network.places(segment), place, near).filter(|part| (0.0..=1.0).contains(part));
            if let Some(z) = foot.map(|part| elevation_at(part, elevations)) {
                lowest = Some(lowest.map_or(z, |lowest| lowest.min(z)));
            }
        };
        self.cells.for_each_in(
            |grid| (around(grid), |_: &CellBox| true),
            |item| match item {
                Item::Segment(number) => visit(number),
                Item::Vertex(_) => (),
            },
        );
        lowest
    }

    /// Takes note of the box of a patch: whether all vertices around it were found. `places` are those of its
    /// vertices, of which [`Lines::look`] has seen the first ones.
    pub(super) fn enter(&mut self, places: impl Iterator<Item = Point2> + Clone) {
        for place in places.clone().skip(self.free.len()) {
            self.look(place);
        }
        let mut bounds = CellBox::of(&[]);
        places.clone().for_each(|place| bounds.extend(place));
        if self.is_clipped {
            self.hull.extend(&bounds, places);
        }
        let [width, height] = [0, 1].map(|axis| bounds.max[axis] - bounds.min[axis]);
        self.margin = 0.0;
        let margin = 0.5 * width.max(height);
        let corners = [bounds.min.map(|x| x - margin), bounds.max.map(|x| x + margin)];
        let around = |grid: &Grid| CellBox::of(&corners.map(|corner| grid.local(corner)));
        self.spacing = (width * height / self.free.len() as f64).sqrt();
        let centre = [0, 1].map(|axis| 0.5 * (bounds.min[axis] + bounds.max[axis]));
        let may_leave =
            self.is_clipped && !self.hull.contains(centre, 0.5 * width.hypot(height) + 1.5 * margin);
        if margin.is_finite() && self.cells.is_found(around, may_leave) {
            self.margin = 0.49 * margin;
        }
    }

    /// Whether the circle of a triangle of a patch meets nothing, as far as that is seen at once. If so, its
    /// corners are counterclockwise.
    #[inline]
    pub(super) fn is_far(&self, vertices: [u32; 3], corners: [Point2; 3]) -> bool {
        let free = vertices.map(|vertex| self.free[vertex as usize]);
        is_circle_less(free[0].max(free[1]).max(free[2]), corners)
    }

    /// What meets a triangle; `None` if nothing does.
    ///
    /// # Errors
    /// Malformed, if its corners are not counterclockwise.
    pub(super) fn meeting(&mut self, corners: [Point2; 3]) -> Result<Option<Meeting>> {
        check_orientation(corners, &mut self.predicates)?;
        self.collect(corners);
        if self.segments.is_empty() && self.vertices.is_empty() && !self.is_near {
            return Ok(None);
        }
        let mut meeting = Meeting { is_near: self.is_near, ..Meeting::default() };
        for place in 0..self.segments.len() {
            self.meet(corners, self.segments[place], &mut meeting);
        }
        let [a, b, c] = corners;
        for &number in &self.vertices {
            let place = self.network.vertices[number as usize].place;
            let is_corner = corners.contains(&place);
            if !is_corner && self.predicates.incircle_perturbed(a, b, c, place) == Sign::Positive {
                meeting.vertices.push(number);
            }
        }
        let is_any = !meeting.segments.is_empty() || meeting.is_hit();
        Ok(is_any.then_some(meeting))
    }

    /// Gathers segments near a triangle, and vertices near its circle.
    #[inline]
    fn collect(&mut self, corners: [Point2; 3]) {
        let is_small = is_circle_less(self.margin, corners);
        let (segments, vertices, found) = (&mut self.segments, &mut self.vertices, &self.found);
        segments.clear();
        vertices.clear();
        self.is_near = false;
        if !self.cells.is_free(|grid| CellBox::of(&corners.map(|corner| grid.local(corner)))) {
            self.cells.for_each_in(
                |grid| {
                    let local = corners.map(|corner| grid.local(corner));
                    (CellBox::of(&local), move |bounds: &CellBox| may_meet(local, bounds))
                },
                |item| match item {
                    Item::Segment(number) => segments.push(number),
                    Item::Vertex(_) => (),
                },
            );
            segments.sort_unstable();
            segments.dedup();
        }
        if is_small {
            return;
        }
        let circle = Circle::of(corners);
        let may_leave = self.is_clipped && !circle.is_within(&self.hull);
        if !self.cells.is_found(|grid| circle.among(grid).bounds(), may_leave) {
            self.cells.for_each_in(
                |grid| {
                    let circle = circle.among(grid);
                    (circle.bounds(), move |bounds: &CellBox| circle.may_meet(bounds))
                },
                |item| match item {
                    Item::Vertex(number) if found[number as usize].is_nan() => vertices.push(number),
                    Item::Vertex(_) => (),
                    Item::Segment(number) => self.is_near |= may_leave && !self.rings.is_border(number),
                },
            );
        }
    }

    /// Whether a vertex of the network is in the mesh.
    pub(super) fn is_found(&self, vertex: u32) -> bool {
        !self.found[vertex as usize].is_nan()
    }

    /// The elevation of a vertex of the network, if it states one or is in the mesh.
    pub(super) fn elevation(&self, vertex: u32) -> Option<f64> {
        let z = self.found[vertex as usize];
        self.network.vertices[vertex as usize].z.or((!z.is_nan()).then_some(z))
    }

    /// Notes that a vertex of the network is a vertex of the mesh, and its elevation.
    pub(super) fn find(&mut self, vertex: u32, z: f64) {
        self.found[vertex as usize] = z;
        self.cells.find(vertex, self.network, &self.found);
    }

    /// Adds what a segment does to a triangle.
    fn meet(&mut self, corners: [Point2; 3], number: u32, meeting: &mut Meeting) {
        let [p, q] = self.network.places(&self.network.segments[number as usize]);
        if are_apart(&corners, &[p, q]) {
            return;
        }
        // Most segments near a triangle have an end in common with it.
        if let [Some(first), Some(second)] =
            [p, q].map(|end| corners.iter().position(|&corner| corner == end))
        {
            meeting.on[3 - first - second] = Some(number);
            meeting.segments.push(number);
            return;
        }
        let turns = corners.map(|corner| self.turn(p, q, corner));
        let is_beside = |sign| turns.iter().all(|&turn| turn == sign);
        if is_beside(Sign::Positive) || is_beside(Sign::Negative) {
            return;
        }
        let mut is_apart = turns.iter().all(|&turn| turn != Sign::Positive)
            || turns.iter().all(|&turn| turn != Sign::Negative);
        let mut is_crossed = [false; 3];
        let mut touches = false;
        for place in 0..3 {
            let [u, v] = [1, 2].map(|turn| corners[(place + turn) % 3]);
            let ends = [p, q].map(|end| self.turn(u, v, end));
            // Both ends are outside of this side, or on its line.
            is_apart |= ends.iter().all(|&end| end != Sign::Positive);
            let [u_turn, v_turn] = [1, 2].map(|turn| turns[(place + turn) % 3]);
            is_crossed[place] = u_turn != Sign::Zero && u_turn == v_turn.opposite() && {
                ends[0] != Sign::Zero && ends[0] == ends[1].opposite()
            };
            if u_turn == Sign::Zero && v_turn == Sign::Zero {
                touches |= overlap([u, v], [p, q]);
                if is_between(u, [p, q]) && is_between(v, [p, q]) {
                    meeting.on[place] = Some(number);
                }
            }
        }
        if !is_apart {
            meeting.is_divided = true;
            for (place, is_crossed) in is_crossed.into_iter().enumerate() {
                meeting.is_crossed[place] |= is_crossed;
            }
        }
        if touches || !is_apart {
            meeting.segments.push(number);
        }
    }

    /// The side of a line on which a place lies, known at once for the places that define the line.
    #[inline]
    fn turn(&mut self, p: Point2, q: Point2, place: Point2) -> Sign {
        if place == p || place == q { Sign::Zero } else { self.predicates.orient2d(p, q, place) }
    }

    /// Whether a place is in a triangle or on its border.
    pub(super) fn is_in(&mut self, corners: [Point2; 3], place: Point2) -> bool {
        let [a, b, c] = corners;
        [[a, b], [b, c], [c, a]].iter().all(|&[u, v]| self.predicates.orient2d(u, v, place) != Sign::Negative)
    }

    /// Whether a place is on a segment.
    pub(super) fn is_on(&mut self, number: u32, place: Point2) -> bool {
        let [p, q] = self.network.places(&self.network.segments[number as usize]);
        is_between(place, [p, q]) && self.predicates.orient2d(p, q, place) == Sign::Zero
    }

    /// Whether a place is on the way between two others.
    pub(super) fn is_between(&mut self, [p, q]: [Point2; 2], place: Point2) -> bool {
        let ends = if lexicographic(p, q).is_lt() { [p, q] } else { [q, p] };
        is_between(place, ends) && self.predicates.orient2d(p, q, place) == Sign::Zero
    }

    pub(super) fn predicates(&mut self) -> &mut FiniteFloatPredicates {
        &mut self.predicates
    }
}

/// Where the foot of a place is on the straight line through two others, as a part of the way between them,
/// if the place is not farther from it than `near`. `None` if the two are one place.
pub(super) fn foot([a, b]: [Point2; 2], place: Point2, near: f64) -> Option<f64> {
    let minus = |p: Point2| [p[0] - a[0], p[1] - a[1]];
    let (along, to) = (minus(b), minus(place));
    let square = along[0] * along[0] + along[1] * along[1];
    let across = along[0] * to[1] - along[1] * to[0];
    let is_near = square > 0.0 && across * across <= near * near * square;
    is_near.then(|| (along[0] * to[0] + along[1] * to[1]) / square)
}

/// Whether a triangle is counterclockwise, and the diameter of its circle less than a length. Its square is
/// the product of the squares of the sides over that of twice the area.
#[inline]
fn is_circle_less(length: f64, [a, b, c]: [Point2; 3]) -> bool {
    let [u, v] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1]]);
    let w = [u[0] - v[0], u[1] - v[1]];
    let [uu, vv, ww] = [u, v, w].map(|p| p[0] * p[0] + p[1] * p[1]);
    let twice_area = u[0] * v[1] - u[1] * v[0];
    let reach = length * twice_area;
    // Rounding errors of the area matter in flat triangles only, which are not small.
    uu * vv * ww < reach * reach && twice_area > 0.0 && twice_area * twice_area > 1e-12 * uu * vv
}

/// Checks that a triangle is strictly counterclockwise: in-circle tests presume it.
fn check_orientation(corners: [Point2; 3], predicates: &mut FiniteFloatPredicates) -> Result<()> {
    if is_counterclockwise(corners, predicates)? {
        return Ok(());
    }
    let [a, b, c] = corners;
    let message = format!("the triangle with corners {a:?}, {b:?}, {c:?} (stored coordinates) is flat");
    Err(Error::malformed(message))
}

/// Whether the boxes of some places have nothing in common.
#[inline]
fn are_apart(these: &[Point2], those: &[Point2]) -> bool {
    (0..2).any(|axis| {
        let least = |places: &[Point2]| places.iter().fold(f64::INFINITY, |x, place| x.min(place[axis]));
        let most = |places: &[Point2]| places.iter().fold(f64::NEG_INFINITY, |x, place| x.max(place[axis]));
        most(these) < least(those) || most(those) < least(these)
    })
}

/// Whether a place on the line of a segment, whose first end is the lesser one, is on the segment.
fn is_between(place: Point2, [p, q]: [Point2; 2]) -> bool {
    lexicographic(p, place) != Ordering::Greater && lexicographic(place, q) != Ordering::Greater
}

/// Whether two parts of one line have more than a point in common.
fn overlap(side: [Point2; 2], [p, q]: [Point2; 2]) -> bool {
    let [low, high] =
        if lexicographic(side[0], side[1]) == Ordering::Less { side } else { [side[1], side[0]] };
    lexicographic(low, q) == Ordering::Less && lexicographic(p, high) == Ordering::Less
}

/// Whether a triangle may meet a box: no side has the whole box outside.
fn may_meet(corners: [Point2; 3], bounds: &CellBox) -> bool {
    (0..3).all(|from| {
        let [u, v] = [corners[from], corners[(from + 1) % 3]];
        let [along, up] = [v[0] - u[0], v[1] - u[1]];
        // The corner of the box that is farthest to the left of the side, seen from the nearer end.
        let u = if u[0].abs() + u[1].abs() <= v[0].abs() + v[1].abs() { u } else { v };
        let x = if up > 0.0 { bounds.min[0] } else { bounds.max[0] };
        let y = if along > 0.0 { bounds.max[1] } else { bounds.min[1] };
        let side = along * (y - u[1]) - up * (x - u[0]);
        let size = along.abs() * (y - u[1]).abs() + up.abs() * (x - u[0]).abs();
        side >= -1e-6 * (1.0 + size)
    })
}
