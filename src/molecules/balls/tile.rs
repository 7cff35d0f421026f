//! The cells of the balls of one tile.

use super::dual::orthocentre;
use super::face::{Face, Pair, Side};
use super::tiles::Members;
use super::{Balls, Cell, Contact};
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay3::{EDGES, Kernel, Ring, Tetrahedralization, Tetrahedron};
use spmesh_delaunay::predicates::{Extent, Point3};
use spmesh_delaunay::vector::{difference, dot};
use std::borrow::Cow;
use std::convert::Infallible;
use std::f64::consts::PI;

/// Corners of a large tetrahedron, in directions from the middle of the balls.
const OUTPOSTS: [[f64; 3]; 4] = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];

/// What a tile has of the result.
pub(super) struct Part {
    /// The cells of the core.
    pub(super) cells: Vec<Cell>,
    /// Contacts whose lesser ball is in the core, in any order.
    pub(super) contacts: Vec<Contact>,
}

/// Square of the height of a centre over a plane below which it counts as in the plane, in four times the
/// square of its radius.
const PINCHED: f64 = 4e-14;

/// Share of its disk below which a face is taken as empty.
const NOISE: f64 = 1e-12;

/// The tetrahedralization of a tile.
///
/// Four points far away are added, the *outposts*: then no ball is on the hull, so that all cells are
/// bounded, and few balls or balls in a plane are no special case. Outposts take nothing of the balls, as
/// their own weight is zero.
pub(super) struct Tile<'t> {
    members: &'t Members,
    mesh: Tetrahedralization,
    /// For each vertex of the mesh the place of its ball among the members; outposts are the last.
    places: Vec<u32>,
    /// For each vertex the radius of its ball; 0 for outposts.
    radii: Vec<f64>,
    /// For each tetrahedron its orthocentre.
    centres: Vec<Point3>,
    /// For each vertex: a corner of its cell in the diagram is outside of the ball, so that part of the
    /// sphere may be exposed.
    may_be_exposed: Vec<bool>,
}

/// What `make` makes of all balls as one tile; the default if there are none.
pub(super) fn with_all<T: Default>(balls: Balls<'_>, make: impl FnOnce(&Tile<'_>) -> Result<T>) -> Result<T> {
    if balls.centres.is_empty() {
        return Ok(T::default());
    }
    make(&Tile::new(balls, &Members::all(balls))?)
}

impl<'t> Tile<'t> {
    /// Number of vertices, of which outposts are no balls.
    pub(super) fn vertices(&self) -> u32 {
        self.places.len() as u32
    }

    /// Triangulates the members.
    pub(super) fn new(balls: Balls<'t>, members: &'t Members) -> Result<Tile<'t>> {
        let all = || members.core.iter().chain(&members.around).map(|&ball| ball as usize);
        let mut points: Vec<Point3> = all().map(|ball| balls.centres[ball]).collect();
        let mut weights: Vec<f64> = all().map(|ball| balls.radii[ball] * balls.radii[ball]).collect();
        let radius = all().map(|ball| balls.radii[ball]).fold(0.0, f64::max);
        points.extend(outposts(&points, radius));
        weights.extend([0.0; 4]);
        let mut mesh = Tetrahedralization::default();
        Kernel::new()
            .triangulate_weighted(Cow::Owned(points), &weights, &mut mesh)
            .map_err(Error::of_computation)?;
        let places = mesh.vertices().iter().map(|vertex| vertex.index).collect();
        let (radii, centres, may_be_exposed) = Default::default();
        let mut tile = Tile { members, mesh, places, radii, centres, may_be_exposed };
        let radius = |v| tile.ball(v).map_or(0.0, |ball: u32| balls.radii[ball as usize]);
        tile.radii = (0..tile.places.len() as u32).map(radius).collect();
        tile.swell_pinched();
        tile.find_centres();
        Ok(tile)
    }

    /// Makes balls larger, by a hundred millionth, whose centre lies in the planes of two faces or next to
    /// them. There heights and offsets both vanish, and solid angles depend on their ratio, of which rounding
    /// leaves nothing.
    fn swell_pinched(&mut self) {
        let mut planes: Vec<Option<u32>> = vec![None; self.radii.len()];
        let mut is_pinched = vec![false; self.radii.len()];
        for tetrahedron in self.mesh.tetrahedra() {
            for ([i, j], _) in EDGES {
                let [p, q] = [tetrahedron.vertices[i], tetrahedron.vertices[j]];
                let between = difference(self.point(p), self.point(q));
                let square = dot(between, between);
                for [own, other] in [[p, q], [q, p]] {
                    let [r, s] = [own, other].map(|v| self.radii[v as usize]);
                    // Twice the product of height and distance.
                    let height = square + (r - s) * (r + s);
                    if height * height <= PINCHED * r * r * square {
                        let plane = *planes[own as usize].get_or_insert(other);
                        is_pinched[own as usize] |= plane != other;
                    }
                }
            }
        }
        for (radius, is_pinched) in self.radii.iter_mut().zip(is_pinched) {
            *radius *= if is_pinched { 1.0 + 1e-8 } else { 1.0 };
        }
    }

    fn find_centres(&mut self) {
        let mut may_be_exposed = vec![false; self.places.len()];
        let mut centres = Vec::with_capacity(self.mesh.tetrahedra().len());
        for tetrahedron in self.mesh.tetrahedra() {
            let points = tetrahedron.vertices.map(|v| self.point(v));
            let weights = tetrahedron.vertices.map(|v| self.radius(v).powi(2));
            let (centre, power) = orthocentre(points, weights);
            // Rounding may mark a ball that is not exposed; this costs time only.
            if power > -1e-6 * weights[0] {
                tetrahedron.vertices.iter().for_each(|&v| may_be_exposed[v as usize] = true);
            }
            centres.push([0, 1, 2].map(|axis| points[0][axis] + centre[axis]));
        }
        (self.centres, self.may_be_exposed) = (centres, may_be_exposed);
    }

    pub(super) fn point(&self, vertex: u32) -> Point3 {
        self.mesh.vertices()[vertex as usize].at
    }

    /// The ball of a vertex; `None` for an outpost.
    pub(super) fn ball(&self, vertex: u32) -> Option<u32> {
        let place = self.places[vertex as usize] as usize;
        let Members { core, around } = self.members;
        core.get(place).or_else(|| around.get(place - core.len())).copied()
    }

    pub(super) fn radius(&self, vertex: u32) -> f64 {
        self.radii[vertex as usize]
    }

    pub(super) fn tetrahedra(&self) -> &[Tetrahedron] {
        self.mesh.tetrahedra()
    }

    /// The orthocentre of a tetrahedron.
    pub(super) fn centre(&self, t: usize) -> Point3 {
        self.centres[t]
    }

    /// The power distance of the orthocentre of a tetrahedron from its balls.
    pub(super) fn power(&self, t: usize) -> f64 {
        let apex = self.tetrahedra()[t].vertices[0];
        let to_centre = difference(self.centre(t), self.point(apex));
        dot(to_centre, to_centre) - self.radius(apex).powi(2)
    }

    /// Calls `visit` with the ends of each edge whose balls share a face, even one without area.
    pub(super) fn for_each_face(
        &self,
        is_wanted: impl Fn([u32; 2]) -> bool,
        mut visit: impl FnMut([u32; 2]),
    ) {
        let Ok(()) = self.mesh.for_each_edge(is_wanted, |ring| -> std::result::Result<(), Infallible> {
            if ring.ends.iter().all(|&v| self.ball(v).is_some()) {
                let pair = Pair::new(ring.ends.map(|v| self.point(v)), ring.ends.map(|v| self.radius(v)));
                let mut touches = false;
                let area = self.face(ring, &pair, |side| touches |= pair.touches(side)).area;
                if pair.has_disk() && (touches || area > NOISE * pair.disk()) {
                    visit(ring.ends);
                }
            }
            Ok(())
        });
    }

    /// Calls `visit` with the surroundings of each edge between two balls.
    pub(super) fn for_each_pair(&self, mut visit: impl FnMut(&Ring, &Pair)) {
        let is_wanted = |ends: [u32; 2]| ends.iter().all(|&v| self.ball(v).is_some());
        let Ok(()) = self.mesh.for_each_edge(is_wanted, |ring| -> std::result::Result<(), Infallible> {
            visit(ring, &Pair::new(ring.ends.map(|v| self.point(v)), ring.ends.map(|v| self.radius(v))));
            Ok(())
        });
    }

    /// Whether rounding alone may have made the area of a face.
    pub(super) fn is_noise(&self, contact: &Contact, pair: &Pair) -> bool {
        contact.area <= NOISE * pair.disk()
    }

    /// The place of a ball in the core; `None` for others.
    pub(super) fn place_in_core(&self, vertex: u32) -> Option<usize> {
        Some(self.places[vertex as usize] as usize).filter(|&place| place < self.members.core.len())
    }

    fn is_core(&self, vertex: u32) -> bool {
        self.place_in_core(vertex).is_some()
    }

    /// The cells of the core, and their contacts with greater balls; `see` gets the ends of each face at the
    /// core, and the face.
    pub(super) fn measure(
        &self,
        contacts_above: Option<f64>,
        mut see: impl FnMut([u32; 2], &Pair, &Face),
    ) -> Part {
        let mut cells = vec![Cell::default(); self.members.core.len()];
        // Solid angles of what is exposed.
        let mut angles = vec![0.0; self.places.len()];
        let mut is_outside = vec![false; self.places.len()];
        let mut contacts = Vec::new();
        let wanted = |ends: [u32; 2]| ends.iter().any(|&v| self.is_core(v));
        let Ok(()) = self.mesh.for_each_edge(wanted, |ring| -> std::result::Result<(), Infallible> {
            let [Some(first), Some(second)] = ring.ends.map(|v| self.ball(v)) else { return Ok(()) };
            let pair = Pair::new(ring.ends.map(|v| self.point(v)), ring.ends.map(|v| self.radius(v)));
            for (&v, height) in ring.ends.iter().zip(pair.heights) {
                is_outside[v as usize] |= height < 0.0;
            }
            if !pair.has_disk() {
                return Ok(());
            }
            let face = self.face(ring, &pair, |_| ());
            see(ring.ends, &pair, &face);
            for ((&v, height), angle) in ring.ends.iter().zip(pair.heights).zip(face.angles) {
                if self.is_core(v) {
                    cells[self.places[v as usize] as usize].volume += height * face.area / 3.0;
                    angles[v as usize] -= angle;
                }
            }
            // Where faces are empty, rounding leaves something.
            let least = contacts_above.map(|least| least.max(NOISE * pair.disk()));
            let ends = if first < second { ring.ends } else { [ring.ends[1], ring.ends[0]] };
            if least.is_some_and(|least| face.area > least) && self.is_core(ends[0]) {
                contacts.push(Contact { balls: [first.min(second), first.max(second)], area: face.area });
            }
            Ok(())
        });
        for v in (0..self.places.len() as u32).filter(|&v| self.is_core(v)) {
            let radius = self.radius(v);
            let i = v as usize;
            if self.may_be_exposed[i] {
                let angle = if is_outside[i] { angles[i] } else { angles[i] + 4.0 * PI };
                let cell = &mut cells[self.places[i] as usize];
                cell.area = angle.max(0.0) * radius * radius;
                cell.volume += cell.area * radius / 3.0;
            }
        }
        cells.iter_mut().for_each(|cell| cell.volume = cell.volume.max(0.0));
        contacts.shrink_to_fit();
        Part { cells, contacts }
    }

    /// The face at an edge whose ends are balls; `see` gets each side of its polygon.
    #[inline(always)]
    pub(super) fn face(&self, ring: &Ring, pair: &Pair, mut see: impl FnMut(Side)) -> Face {
        let [first, second] = ring.ends;
        let origin = self.point(first);
        let weight = self.radius(first).powi(2);
        let with_angles = self.may_be_exposed[first as usize] || self.may_be_exposed[second as usize];
        let mut face = Face::default();
        let relative = |t: u32| difference(self.centres[t as usize], origin);
        let last = ring.tetrahedra.len() - 1;
        let mut from = relative(ring.tetrahedra[last]);
        for (&t, &third) in ring.tetrahedra.iter().zip(&ring.link) {
            let to = relative(t);
            let heavier = self.radius(third).powi(2) - weight;
            if let Some(side) = pair.side(difference(self.point(third), origin), heavier, [from, to]) {
                see(side);
                pair.add(side, with_angles, &mut face);
            }
            from = to;
        }
        face
    }
}

/// Points so far away that no ball of the tile is on the hull, on the grid of the coordinates.
fn outposts(points: &[Point3], radius: f64) -> [Point3; 4] {
    let extent = Extent::of(points);
    let side = extent.max_difference().max(radius);
    // Twice would do; with four times the side even corners of the diagram outside are far from all balls.
    let distance = (4.0 * (side + radius)).ceil().max(1.0);
    OUTPOSTS.map(|direction| {
        [0, 1, 2].map(|axis| {
            ((extent.lower[axis] + extent.upper[axis]) / 2.0).round() + direction[axis] * distance
        })
    })
}
