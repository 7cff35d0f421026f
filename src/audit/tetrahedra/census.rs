//! Counts the faults of a tetrahedral mesh, by exact and by plain floating-point arithmetic.
//!
//! It serves meshes made in rounded arithmetic, which are known to have faults: it tells how many there are,
//! and whether a check in rounded arithmetic would have found them.

use std::cmp::Ordering;

use super::Corner;
use super::faces::SeenFaces;
use super::hull::Hull;
use super::live::{EDGES, FACETS, edge};
use crate::Standard;
use crate::check::{Ledger, Violation};
use crate::exact::space::{float_in_sphere, float_orientation, in_raised_sphere, in_sphere, orientation};
use crate::facets::{Meeting, OpenFacets, increasing};
use crate::unused::Unused;
use crate::vertices::Vertices;
use spmesh_stream::{Event, Patch};

/// Counts the faults of a tetrahedral mesh: pass it every event, then call [`Census::counts`].
///
/// Domain: the events of a stream of tetrahedra from a [`spmesh_stream::StreamReader`], however wrong the
/// mesh is.
///
/// Memory: as for the audit, the edges and facets between live vertices, and 4 bytes per tetrahedron.
pub struct Census {
    vertices: Vertices<Use>,
    facets: OpenFacets<3, Beyond>,
    edges: SeenFaces<2>,
    /// Facets between two tetrahedra.
    closed: SeenFaces<3>,
    tetrahedra: Vec<[Judgement; 2]>,
    hull: Hull,
    unused: Unused<3>,
    facets_seen: u64,
    counts: Counts,
}

/// The counts of a census.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Counts {
    /// Vertices.
    pub vertices: u64,
    /// Vertices without a tetrahedron, where there are tetrahedra.
    pub unused: u64,
    /// Tetrahedra.
    pub tetrahedra: u64,
    /// Facets between two tetrahedra.
    pub interior_facets: u64,
    /// Facets of one tetrahedron only: the boundary.
    pub boundary_facets: u64,
    /// Times that a tetrahedron had a facet which two others had already, or another on the same side.
    pub crowded_facets: u64,
    /// Facets between cospherical points that are not those of the canonical tetrahedralization.
    pub not_canonical: u64,
    /// Edges of the boundary that are not between two of its facets.
    pub torn_edges: u64,
    /// Vertices - edges + facets - tetrahedra: 1 in a ball.
    pub euler: i64,
    /// Whether the boundary was proved to be convex, closed and to go around once, or all vertices to be in a
    /// plane.
    pub is_hull_proved: bool,
    /// Faults by exact arithmetic.
    pub exact: Faults,
    /// Faults by plain f64 arithmetic: signs of the same determinants of differences, rounded.
    pub float: Faults,
}

/// Faults that arithmetic finds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Faults {
    /// Negative tetrahedra.
    pub inverted: u64,
    /// Tetrahedra without a volume; nothing is inside or outside of their sphere.
    pub flat: u64,
    /// Tetrahedra with a vertex of a neighbour inside of their sphere.
    pub inside: u64,
    /// Other tetrahedra with a vertex of a neighbour on their sphere, which is no fault.
    pub on: u64,
    /// Concave edges of the boundary.
    pub concave: u64,
}

impl Counts {
    /// Whether there are no faults by exact arithmetic. The standard decides whether ties are faults.
    pub fn is_clean(&self, standard: Standard) -> bool {
        let Faults { inverted, flat, inside, on: _, concave } = self.exact;
        let faults = [inverted, flat, inside, concave, self.unused, self.crowded_facets, self.torn_edges];
        faults == [0; 7]
            && (self.not_canonical == 0 || standard == Standard::Delaunay)
            && (self.euler == 1 || self.tetrahedra == 0)
            && self.is_hull_proved
    }
}

/// How often a vertex is used.
#[derive(Debug, Clone, Copy, Default)]
struct Use {
    tetrahedra: u64,
    /// Open facets.
    open: u64,
}

/// Data of the tetrahedron at an open facet.
#[derive(Debug, Clone, Copy)]
struct Beyond {
    apex: Corner,
    index: usize,
}

/// The faults of a tetrahedron by one kind of arithmetic.
#[derive(Debug, Clone, Copy)]
struct Judgement {
    orientation: Ordering,
    /// `Greater` if a vertex of a neighbour was inside of the sphere, else `Equal` if one was on it.
    nearest: Ordering,
}

impl Judgement {
    /// Takes note of a neighbour, by the sign of the in-sphere determinant of a positive tetrahedron.
    fn see(&mut self, sign: Ordering) {
        let place = match self.orientation {
            Ordering::Greater => sign,
            Ordering::Less => sign.reverse(),
            Ordering::Equal => return,
        };
        self.nearest = self.nearest.max(place);
    }
}

/// Places of the two kinds of arithmetic.
const EXACT: usize = 0;
const FLOAT: usize = 1;

impl Default for Census {
    fn default() -> Self {
        Census::new()
    }
}

impl Census {
    /// An empty census.
    pub fn new() -> Self {
        Census {
            vertices: Vertices::default(),
            facets: OpenFacets::new(),
            edges: SeenFaces::default(),
            closed: SeenFaces::default(),
            tetrahedra: Vec::new(),
            hull: Hull::default(),
            unused: Unused::default(),
            facets_seen: 0,
            counts: Counts::default(),
        }
    }

    /// Adds the next event.
    ///
    /// # Errors
    /// If a vertex is used after its finalization, when its position is no longer known.
    pub fn event(&mut self, event: &Event) -> Result<(), Violation> {
        match event {
            Event::Patch(patch) => self.patch(patch),
            Event::End(_) => {
                self.end();
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// The counts; complete after the END block.
    pub fn counts(&self) -> &Counts {
        &self.counts
    }

    fn patch(&mut self, patch: &Patch) -> Result<(), Violation> {
        self.vertices.enter(patch, &mut Ledger::default())?;
        for tetrahedron in patch.tetrahedra() {
            self.tetrahedron(tetrahedron.map(|local| local as usize));
        }
        let (hull, unused) = (&mut self.hull, &mut self.unused);
        self.vertices.leave(patch, |vertex| {
            if vertex.star.open > 0 {
                hull.add(Corner::of(vertex));
            } else if vertex.star.tetrahedra == 0 {
                unused.add(Corner::of(vertex));
            }
            Ok(())
        })?;
        self.edges.sweep(|id| self.vertices.live(id).is_some());
        self.closed.sweep(|id| self.vertices.live(id).is_some());
        Ok(())
    }

    fn tetrahedron(&mut self, locals: [usize; 4]) {
        let corners = locals.map(|local| Corner::of(&self.vertices.local[local]));
        let [a, b, c, d] = corners.map(|corner| corner.at);
        let orientations = [orientation(a, b, c, d).sign, float_orientation(a, b, c, d)];
        let index = self.tetrahedra.len();
        self.tetrahedra
            .push(orientations.map(|orientation| Judgement { orientation, nearest: Ordering::Less }));
        for side in 0..4 {
            self.side(&corners, &locals, side, index);
        }
        for [i, j] in EDGES {
            self.edges.add(edge(corners[i].id, corners[j].id));
        }
        locals.iter().for_each(|&local| self.vertices.local[local].star.tetrahedra += 1);
    }

    /// Meets the facet opposite to a corner with its twin.
    fn side(&mut self, corners: &[Corner; 4], locals: &[usize; 4], side: usize, index: usize) {
        let facet = FACETS[side];
        let ids = facet.map(|i| corners[i].id);
        match self.facets.meet(ids, Beyond { apex: corners[side], index }) {
            Meeting::Open => {
                facet.iter().for_each(|&i| self.vertices.local[locals[i]].star.open += 1);
                let is_crowded = self.closed.contains(increasing(ids).0);
                self.counts.crowded_facets += u64::from(is_crowded);
                self.facets_seen += u64::from(!is_crowded);
            }
            Meeting::Twin(beyond) => {
                facet.iter().for_each(|&i| self.vertices.local[locals[i]].star.open -= 1);
                self.closed.add(increasing(ids).0);
                self.counts.interior_facets += 1;
                self.neighbours(corners, side, index, beyond);
            }
            Meeting::Twice(_) => self.counts.crowded_facets += 1,
        }
    }

    /// Two tetrahedra on a facet: where is the apex of each with respect to the sphere of the other?
    ///
    /// Exchanging the two apexes changes the sign of the determinant, and so does the other direction of the
    /// facet.
    fn neighbours(&mut self, corners: &[Corner; 4], side: usize, index: usize, beyond: Beyond) {
        let [a, b, c, d] = corners.map(|corner| corner.at);
        let (apex, opposite) = (corners[side].at, beyond.apex.at);
        let [p, q, r] = FACETS[side].map(|i| corners[i].at);
        let exact = in_sphere(a, b, c, d, opposite).sign;
        let here = float_in_sphere(a, b, c, d, opposite);
        let there = float_in_sphere(p, q, r, opposite, apex);
        self.tetrahedra[index][EXACT].see(exact);
        self.tetrahedra[index][FLOAT].see(here);
        self.tetrahedra[beyond.index][EXACT].see(exact);
        self.tetrahedra[beyond.index][FLOAT].see(there);
        let is_tie = exact == Ordering::Equal && self.tetrahedra[index][EXACT].orientation.is_gt();
        let is_wrong = is_tie && in_raised_sphere(a, b, c, d, opposite).is_gt();
        self.counts.not_canonical += u64::from(is_wrong);
    }

    fn end(&mut self) {
        let open = || self.facets.iter().map(|(facet, beyond)| (facet, beyond.apex));
        let faults = self.hull.count(open());
        let counts = &mut self.counts;
        counts.vertices = self.vertices.seen();
        counts.tetrahedra = self.tetrahedra.len() as u64;
        counts.boundary_facets = self.facets.len() as u64;
        counts.torn_edges = faults.torn;
        counts.exact = Faults { concave: faults.concave, ..count(&self.tetrahedra, EXACT) };
        counts.float = Faults { concave: faults.concave_in_float, ..count(&self.tetrahedra, FLOAT) };
        let [vertices, edges, facets, tetrahedra] =
            [counts.vertices, self.edges.seen(), self.facets_seen, counts.tetrahedra]
                .map(|count| count as i64);
        counts.euler = vertices - edges + facets - tetrahedra;
        let ledger = &mut Ledger::default();
        counts.is_hull_proved = if self.tetrahedra.is_empty() {
            self.unused.check_plane(ledger).is_ok()
        } else {
            counts.unused = self.unused.len();
            self.hull.check(open(), ledger).is_ok()
        };
    }
}

/// The faults of all tetrahedra that one kind of arithmetic finds.
fn count(tetrahedra: &[[Judgement; 2]], kind: usize) -> Faults {
    let mut faults = Faults::default();
    for judgement in tetrahedra.iter().map(|judgements| judgements[kind]) {
        faults.inverted += u64::from(judgement.orientation.is_lt());
        faults.flat += u64::from(judgement.orientation.is_eq());
        faults.inside += u64::from(judgement.nearest.is_gt());
        faults.on += u64::from(judgement.nearest.is_eq());
    }
    faults
}
