//! Start triangulations: triangulated spheres of the plane and the faraway point, with flips and insertion.

use super::knots::Knots;
use super::lift::Lift;
use super::plane::Plane;
use foldhash::HashMap;
use spmesh_base::error::{Error, Result};
use spmesh_base::random::Random;
use spmesh_delaunay::delaunay2::{Kernel, Triangles};
use spmesh_delaunay::predicates::FiniteFloatPredicates;
use spmesh_stream::model::configurations::{Claim, Configurations, FARAWAY};

/// A corner of a triangle, and the half-edge opposite to it: three times the number of the triangle, plus the
/// place of the corner.
pub(super) type Corner = u32;

/// A triangulation of the convex hull of all knots; every knot is a vertex.
#[derive(Debug, Clone)]
pub struct Start {
    pub(super) triangles: Vec<[u32; 3]>,
    /// For each half-edge, the opposite half-edge.
    pub(super) neighbours: Vec<[Corner; 3]>,
    pub(super) claim: Claim,
}

/// The canonical Delaunay triangulation; of several knots at one place, only the first is a vertex.
fn kernel_mesh(knots: &Knots) -> Result<Triangles> {
    let mut mesh = Triangles::default();
    Kernel::new().triangulate(knots.points(), &mut mesh).map_err(Error::of_computation)?;
    if mesh.triangles().is_empty() { Err(Knots::collinear()) } else { Ok(mesh) }
}

/// The triangles of a mesh, followed by the infinite ones at the edges of the hull.
fn triangles_of(mesh: &Triangles) -> Vec<[u32; 3]> {
    let mut triangles = Vec::with_capacity(mesh.triangles().len() + mesh.hull.len());
    triangles.extend(mesh.triangles().iter().map(|triangle| triangle.vertices));
    let ends = mesh.hull.iter().cycle().skip(1);
    triangles.extend(mesh.hull.iter().zip(ends).map(|(&a, &b)| [b, a, FARAWAY]));
    triangles
}

/// For each half-edge of [`triangles_of`], the opposite half-edge.
fn neighbours_of(mesh: &Triangles) -> Vec<[Corner; 3]> {
    let (finite, infinite) = (mesh.triangles().len() as u32, mesh.hull.len() as u32);
    let outside: HashMap<u32, u32> = mesh.hull.iter().copied().zip(finite..).collect();
    let mut neighbours = Vec::with_capacity((finite + infinite) as usize);
    neighbours.extend(mesh.triangles().iter().map(|triangle| {
        [0, 1, 2].map(|i| match triangle.neighbour(i) {
            Some(neighbour) => 3 * neighbour.triangle + neighbour.corner,
            None => 3 * outside[&triangle.vertices[(i + 1) % 3]] + 2,
        })
    }));
    let around = |place: u32| 3 * (finite + place % infinite);
    neighbours.extend((0..infinite).map(|place| [around(place + infinite - 1) + 1, around(place + 1), 0]));
    for t in 0..finite {
        for (i, neighbour) in
            (0..).zip(neighbours[t as usize]).filter(|&(_, neighbour)| neighbour / 3 >= finite)
        {
            neighbours[neighbour as usize / 3][2] = 3 * t + i;
        }
    }
    neighbours
}

/// The border of the convex hull, counterclockwise, with all knots on it; of several knots at one place, only
/// the first.
pub(super) fn hull(knots: &Knots) -> Result<Vec<u32>> {
    Ok(kernel_mesh(knots)?.hull)
}

/// The Delaunay triangulation of `knots` as configurations of degree 0. If no two knots coincide, it is
/// computed without a [`Start`].
///
/// Cost: little more than the kernel's.
///
/// # Errors
/// Knots on one line.
pub fn delaunay(knots: &Knots) -> Result<Configurations> {
    if knots.has_copies() {
        return Ok(Start::delaunay(knots)?.configurations());
    }
    Ok(Configurations::of_triangles(Claim::Delaunay, triangles_of(&kernel_mesh(knots)?)))
}

impl Start {
    /// The canonical Delaunay triangulation; copies of knots are vertices, too.
    ///
    /// # Errors
    /// Knots on one line.
    pub fn delaunay(knots: &Knots) -> Result<Start> {
        let mesh = kernel_mesh(knots)?;
        let (triangles, neighbours) = (triangles_of(&mesh), neighbours_of(&mesh));
        drop(mesh);
        let mut start = Start { triangles, neighbours, claim: Claim::Delaunay };
        if knots.has_copies() {
            start.insert_copies(knots);
        }
        Ok(start)
    }

    /// The triangulation with no lifted knot below it (a regular triangulation): projective configurations of
    /// degree 0.
    ///
    /// # Errors
    /// Knots on one line; values that do not fit the knots; a lift that is not strictly convex at some knot.
    pub fn lifted(knots: &Knots, lift: &Lift) -> Result<Start> {
        lift.check(knots)?;
        let mut start = Start::delaunay(knots)?;
        let mut predicates = FiniteFloatPredicates::default();
        let mut plane = Plane::new(knots, Some(lift), &mut predicates);
        let mut waiting: Vec<Corner> = (0..3 * start.triangles.len() as u32).collect();
        // Each flip lowers the lifted surface, so this ends.
        while let Some(corner) = waiting.pop() {
            let Some([v, a, w, b]) = start.quadrilateral(corner) else { continue };
            if !plane.is_inside([v, a, b], w) {
                continue;
            }
            let reflex = [(a, plane.is_left(v, a, w)), (b, plane.is_left(w, b, v))];
            if let Some((hidden, _)) = reflex.into_iter().find(|(_, is_convex)| !is_convex) {
                let message =
                    "the lift is not convex there: the knot would be no vertex; lower it or raise its weight";
                return Err(Error::usage(message).at(format!("knot {hidden}")));
            }
            start.flip(corner);
            let (t, u) = (corner / 3, start.neighbours[corner as usize / 3].map(|c| c / 3));
            waiting.extend([3 * t, 3 * t + 1, 3 * t + 2]);
            waiting.extend(u.into_iter().flat_map(|t| [3 * t, 3 * t + 1, 3 * t + 2]));
        }
        start.claim = Claim::Lifted;
        Ok(start)
    }

    /// Any triangulation of all knots, counterclockwise.
    ///
    /// # Errors
    /// An unknown knot, a triangle that is flat or clockwise, an edge with two triangles on one side, a
    /// border other than the border of the convex hull, a knot that is not a vertex.
    pub fn of_triangles(knots: &Knots, triangles: &[[u32; 3]]) -> Result<Start> {
        super::start_check::check(knots, triangles)?;
        let border = super::start_check::border(triangles)?;
        let mut all = Vec::with_capacity(triangles.len() + border.len());
        all.extend_from_slice(triangles);
        all.extend(border.iter().map(|&[a, b]| [b, a, FARAWAY]));
        Ok(Start { neighbours: join(&all)?, triangles: all, claim: Claim::Any })
    }

    /// The same triangulation, without the claim to be Delaunay or lifted: [`super::Rule::Delaunay`] then
    /// looks for constrained Delaunay triangulations of links, and links of knots that are pulled apart are
    /// triangulated as in figure 8.7 of the thesis.
    #[must_use]
    pub fn generalised(mut self) -> Start {
        self.claim = Claim::Any;
        self
    }

    /// The configurations of degree 0.
    pub fn configurations(&self) -> Configurations {
        Configurations::of_triangles(self.claim, self.triangles.clone())
    }

    /// Flips random edges until `count` are flipped, in at most `64 * count` trials. Returns the number of
    /// flips.
    pub fn flip_random(&mut self, knots: &Knots, count: usize, seed: u64) -> usize {
        let mut predicates = FiniteFloatPredicates::default();
        let mut plane = Plane::new(knots, None, &mut predicates);
        let mut random = Random::new(seed);
        let (mut flips, corners) = (0, 3 * self.triangles.len() as u64);
        for _ in 0..count.saturating_mul(64) {
            if flips == count {
                break;
            }
            let corner = random.below(corners) as Corner;
            if self.can_flip(&mut plane, corner) && self.keeps_places(&mut plane, corner) {
                self.flip(corner);
                flips += 1;
            }
        }
        flips
    }

    /// Flips edges while the other diagonal is nearer to the direction `degrees`, counterclockwise from the x
    /// axis. Returns the number of flips.
    pub fn flip_aligned(&mut self, knots: &Knots, degrees: f64) -> usize {
        let mut predicates = FiniteFloatPredicates::default();
        let mut plane = Plane::new(knots, None, &mut predicates);
        let mut flips = 0;
        let mut waiting: Vec<Corner> = (0..3 * self.triangles.len() as u32).rev().collect();
        // Each flip reduces the deviation of an edge, so this ends.
        while let Some(corner) = waiting.pop() {
            let Some([v, a, w, b]) = self.quadrilateral(corner) else { continue };
            let [now, then] = [[a, b], [v, w]].map(|edge| deviation(knots, edge, degrees));
            let is_better = then < now && self.can_flip(&mut plane, corner);
            if is_better && self.keeps_places(&mut plane, corner) {
                let neighbour = self.neighbours[corner as usize / 3][corner as usize % 3] / 3;
                self.flip(corner);
                flips += 1;
                waiting
                    .extend([corner / 3, neighbour].into_iter().flat_map(|t| [3 * t, 3 * t + 1, 3 * t + 2]));
            }
        }
        flips
    }

    /// The corners of the two triangles at the edge opposite to a corner, counterclockwise from that corner;
    /// `None` if one of the triangles is infinite.
    pub(super) fn quadrilateral(&self, corner: Corner) -> Option<[u32; 4]> {
        let all = self.around(corner).corners;
        (!all.contains(&FARAWAY)).then_some(all)
    }

    /// The two triangles at the edge opposite to a corner, with their corners and neighbours.
    pub(super) fn around(&self, corner: Corner) -> Around {
        let neighbour = self.neighbours[corner as usize / 3][corner as usize % 3];
        // The vertices and the neighbours of a triangle, starting from one of its corners.
        let seen = |from: Corner| {
            let (triangle, place) = (from as usize / 3, from as usize % 3);
            let places = [place, (place + 1) % 3, (place + 2) % 3];
            (places.map(|i| self.triangles[triangle][i]), places.map(|i| self.neighbours[triangle][i]))
        };
        let ([v, a, b], [_, bv, va]) = seen(corner);
        let ([w, ..], [_, aw, wb]) = seen(neighbour);
        Around { triangles: [corner / 3, neighbour / 3], corners: [v, a, w, b], neighbours: [va, aw, wb, bv] }
    }

    /// Whether the edge opposite to a corner can be flipped.
    pub(super) fn can_flip(&self, plane: &mut Plane<FiniteFloatPredicates>, corner: Corner) -> bool {
        self.quadrilateral(corner)
            .is_some_and(|[v, a, w, b]| plane.is_left(v, a, w) && plane.is_left(w, b, v))
    }

    /// Whether a flip keeps the stars of coinciding knots as splines need them: edges without length stay,
    /// and no triangle becomes flat unless it has an edge without length.
    fn keeps_places(&self, plane: &mut Plane<FiniteFloatPredicates>, corner: Corner) -> bool {
        let knots = plane.knots;
        let Some([v, a, w, b]) = self.quadrilateral(corner).filter(|_| knots.has_copies()) else {
            return true;
        };
        let mut is_fit = |[p, q, r]: [u32; 3]| {
            let at = [p, q, r].map(|id| knots.at(id));
            at[0] == at[1] || at[1] == at[2] || at[2] == at[0] || !plane.is_flat(p, q, r)
        };
        knots.at(a) != knots.at(b) && is_fit([v, a, w]) && is_fit([w, b, v])
    }

    /// Replaces the edge opposite to a corner by the other diagonal.
    pub(super) fn flip(&mut self, corner: Corner) {
        let Around { triangles: [t, u], corners: [v, a, w, b], neighbours: [va, aw, wb, bv] } =
            self.around(corner);
        self.triangles[t as usize] = [v, a, w];
        self.triangles[u as usize] = [w, b, v];
        for (here, there) in
            [(3 * t, aw), (3 * t + 1, 3 * u + 1), (3 * t + 2, va), (3 * u, bv), (3 * u + 2, wb)]
        {
            self.set_neighbour(here, there);
        }
        self.claim = Claim::Any;
    }

    pub(super) fn set_neighbour(&mut self, here: Corner, there: Corner) {
        self.neighbours[here as usize / 3][here as usize % 3] = there;
        self.neighbours[there as usize / 3][there as usize % 3] = here;
    }
}

/// Two triangles that share an edge.
pub(super) struct Around {
    pub(super) triangles: [u32; 2],
    /// Counterclockwise, starting from a corner that is not on the shared edge.
    pub(super) corners: [u32; 4],
    /// Half-edges across the sides of the quadrilateral, starting from that corner.
    pub(super) neighbours: [Corner; 4],
}

/// How far an edge is from a direction: the sine of the angle, and zero for an edge without length.
pub(super) fn deviation(knots: &Knots, [a, b]: [u32; 2], degrees: f64) -> f64 {
    let (p, q) = (knots.at(a), knots.at(b));
    let [x, y] = [q[0] - p[0], q[1] - p[1]];
    let (sin, cos) = degrees.to_radians().sin_cos();
    let length = x.hypot(y);
    if length > 0.0 { ((x * sin - y * cos) / length).abs() } else { 0.0 }
}

/// For each half-edge, the opposite half-edge.
fn join(triangles: &[[u32; 3]]) -> Result<Vec<[Corner; 3]>> {
    let mut edges: Vec<(u32, u32, Corner)> = Vec::with_capacity(3 * triangles.len());
    for (t, triangle) in (0..).zip(triangles) {
        for i in 0..3 {
            let (a, b) = (triangle[(i + 1) % 3], triangle[(i + 2) % 3]);
            edges.push((a.min(b), a.max(b), 3 * t + i as u32));
        }
    }
    edges.sort_unstable();
    let mut neighbours = vec![[0; 3]; triangles.len()];
    for pair in edges.chunks(2) {
        let &[(a, b, here), (c, d, there)] = pair else { return Err(unmatched(pair[0])) };
        if (a, b) != (c, d) {
            return Err(unmatched(pair[0]));
        }
        neighbours[here as usize / 3][here as usize % 3] = there;
        neighbours[there as usize / 3][there as usize % 3] = here;
    }
    Ok(neighbours)
}

fn unmatched((a, b, _): (u32, u32, Corner)) -> Error {
    Error::malformed("the edge does not have a triangle on each side")
        .at(format!("edge of knots {a} and {b}"))
}
