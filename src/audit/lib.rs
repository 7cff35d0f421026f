//! Proves the claims of a stream, block by block, in memory proportional to the width of the stream and its
//! boundary.
//!
//! The audit shares nothing with the code that makes meshes: it has its own exact arithmetic and its own view
//! of vertices, edges, facets and cells. Only the reader of the container is shared.
//!
//! # Why the checks of a whole mesh are enough
//! (Of a triangle mesh; [`tetrahedra`] has the argument for tetrahedral meshes.)
//!
//! The audit sees each triangle once and forgets what is finalized. It never compares distant triangles, and
//! need not. Let every triangle be strictly counterclockwise; let every directed edge meet its twin except
//! the edges of one cycle, around a convex polygon, once; let every vertex have a triangle.
//!
//! *The triangles tile the polygon.* The boundaries of the triangles, added up as chains, cancel along every
//! pair of twins, which leaves the cycle. So for every point off all edges, the number of triangles that
//! cover it (each winds around it once) is the winding number of the cycle: one inside of the polygon, zero
//! outside. No two triangles overlap and none is missing.
//!
//! *No two vertices coincide, and none lies inside of an edge or a triangle of others.* Around a vertex
//! without open edges, its triangles are joined edge to edge in closed fans, which cover its neighbourhood
//! completely. A vertex with one open edge in and one out lies on the polygon, and its triangles cover the
//! part of its neighbourhood inside of the polygon. The cycle passes every position of the polygon once. So a
//! second vertex at the same place, or a triangle around it, would cover something twice.
//!
//! *Each vertex closes by itself*: when it is finalized its triangles must go around it once, or from one
//! open edge to the other ([`winding`]). That follows, too, for a vertex of a mesh that passes; but a mesh
//! that branches at a vertex, or has a second sheet there, is refused at that vertex instead of at the end.
//!
//! *Directed edges are unique*, because two triangles to the left of one edge would overlap. An edge that is
//! used again while it is open is reported at once; an edge that is used again later is found by its
//! consequences.
//!
//! So the mesh is a triangulation of its vertices. Every interior edge is locally Delaunay, so by Delaunay's
//! lemma the whole triangulation is Delaunay. With the perturbed lifts the same lemma shows that it is the
//! canonical triangulation, which is unique. Euler's relation follows too, and is checked as a test of the
//! audit itself.

/// An enumeration of what an audit proves. Each line has a value, its name, and the claim.
macro_rules! claims {
    ($(#[$about:meta])* $kind:ident: $($value:ident $name:literal $claim:literal)+) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum $kind {
            $(#[doc = $claim] $value,)+
        }

        impl $kind {
            /// All of them, in the order of reports.
            pub const ALL: [$kind; [$($name),+].len()] = [$($kind::$value),+];

            /// Name for people and for JSON.
            pub fn name(self) -> &'static str {
                self.row().0
            }

            fn row(self) -> (&'static str, &'static str) {
                match self {
                    $($kind::$value => ($name, $claim),)+
                }
            }
        }
    };
}

mod border;
mod cells;
mod check;
pub mod configurations;
mod constraints;
mod corner;
pub mod diagram;
mod exact;
mod facets;
mod hull;
mod inventory;
mod mesh;
mod partial;
mod partial_triangles;
mod point_set;
mod point_tree;
mod points;
mod regions;
mod residual_fit;
mod tetrahedra;
mod triangles;
mod unused;
mod vertices;
mod winding;
mod within;

pub use check::{Check, CheckLine, Violation};
pub use inventory::{
    CellPoints, ConfigurationInventory, ConstraintInventory, DegreeInventory, Inventory, Inventory4,
    PatchSize,
};
pub use point_set::PointSet;
pub use regions::RegionInventory;
pub use tetrahedra::{Census, Counts, Faults};
pub use triangles::Standard;
pub use within::NearPoints;

use check::Ledger;
use mesh::{MeshAudit, mesh_checks};
use partial::PartialAudit;
use points::{PointsAudit, points_checks};
use tetrahedra::{LiveTetrahedra, TETRAHEDRA_CHECKS, TetrahedraAudit};
use triangles::Triangles;

use spmesh_base::error::Error;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Event, Header, Kind};

/// Audit of one stream of two or three dimensions: pass it every event, then get the report. Streams of four
/// dimensions have [`diagram::StreamAudit`], configurations [`configurations::StreamAudit`].
///
/// Domain: the events must come from a [`spmesh_stream::StreamReader`], which has checked the form of each
/// block.
pub struct Audit {
    state: State,
    given: Option<Given>,
    ledger: Ledger,
    violation: Option<Violation>,
    open_max: usize,
}

/// Points that a mesh is compared with.
pub enum Given {
    /// Its vertices have exactly these positions.
    All(PointSet),
    /// Its vertices are some of these, and the others are near its triangles.
    Near(Box<NearPoints>),
}

enum State {
    Points(PointsAudit),
    Mesh(MeshAudit),
    Partial(PartialAudit<Triangles, 2>),
    PartialTetrahedra(PartialAudit<LiveTetrahedra, 3>),
    Tetrahedra(TetrahedraAudit),
}

/// The results of an audit so far.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// The checks that were made.
    pub lines: Vec<CheckLine>,
    /// The first violation.
    pub violation: Option<Violation>,
    /// Most vertices that were held at once.
    pub live_max: usize,
    /// Most open edges of triangles, or open facets of tetrahedra, that were held at once.
    pub open_max: usize,
}

impl Audit {
    /// An audit of a stream with this header. `given` are points that the mesh must have, or be near to.
    ///
    /// # Errors
    /// Usage, if there is no audit of the kind.
    pub fn new(header: &Header, standard: Standard, given: Option<Given>) -> Result<Self, Error> {
        if header.part.is_some() {
            return Err(Error::usage(
                "a part of a mesh proves nothing alone: audit the manifest that spnode collect writes",
            ));
        }
        let (state, mut checks) = match header.kind {
            Kind::Points => (State::Points(PointsAudit::new(header)), points_checks(header)),
            Kind::TriangleMesh => (State::Mesh(MeshAudit::new(header, standard)), mesh_checks(header)),
            Kind::PartialTriangleMesh => (
                State::Partial(PartialAudit::new(header, standard)),
                PartialAudit::<Triangles, 2>::CHECKS.to_vec(),
            ),
            Kind::PartialTetrahedralMesh => {
                let audit = PartialAudit::new(header, standard);
                (State::PartialTetrahedra(audit), PartialAudit::<LiveTetrahedra, 3>::CHECKS.to_vec())
            }
            Kind::TetrahedralMesh => {
                (State::Tetrahedra(TetrahedraAudit::new(header, standard)), TETRAHEDRA_CHECKS.to_vec())
            }
            Kind::RegionPoints => {
                let kind = header.kind.name();
                let message =
                    format!("a stream of {kind} claims nothing that takes a proof: leave --audit away");
                return Err(Error::usage(message));
            }
            Kind::Points4
            | Kind::Cells4
            | Kind::Simplices4
            | Kind::Configurations
            | Kind::Splines
            | Kind::TriangleResidual
            | Kind::TetrahedralResidual => {
                let kind = header.kind.name();
                let message =
                    format!("streams of kind {kind} have an audit of their own, or nothing to prove");
                return Err(Error::usage(message));
            }
        };
        let is_mesh = header.kind.vertices_per_simplex() > 0;
        checks.extend((is_mesh && standard == Standard::Canonical).then_some(Check::Canonical));
        checks.extend((is_mesh && header.weighted.is_some()).then_some(Check::Hidden));
        checks.extend((is_mesh && given.is_some()).then_some(Check::Points));
        checks.extend(matches!(given, Some(Given::Near(_))).then_some(Check::Within));
        let ledger = Ledger::of(&checks);
        Ok(Audit { state, given, ledger, violation: None, open_max: 0 })
    }

    /// Checks the next event of a stream without weights.
    ///
    /// # Errors
    /// The first violation, which every later event gets too.
    pub fn event(&mut self, event: &Event) -> Result<(), Violation> {
        self.event_with_rows(event, &[])
    }

    /// Checks the next event, with the rows of its points if the stream has attributes.
    ///
    /// # Errors
    /// As [`Audit::event`].
    pub fn event_with_rows(&mut self, event: &Event, rows: &[u8]) -> Result<(), Violation> {
        if let Some(violation) = &self.violation {
            return Err(violation.clone());
        }
        let checked = self.check_given(event).and_then(|()| self.check(event, rows));
        self.open_max = self.open_max.max(self.width().1);
        checked.inspect_err(|violation| self.violation = Some(violation.clone()))
    }

    /// The checks made so far.
    pub fn report(&self) -> Report {
        Report {
            lines: self.ledger.lines(self.violation.as_ref()),
            violation: self.violation.clone(),
            live_max: self.width().0,
            open_max: self.open_max,
        }
    }

    fn check(&mut self, event: &Event, rows: &[u8]) -> Result<(), Violation> {
        let ledger = &mut self.ledger;
        match (&mut self.state, event) {
            (State::Points(audit), Event::Points(points)) => audit.points(points, ledger),
            (State::Points(audit), Event::Cells(cells)) => audit.cells(cells, ledger),
            (State::Points(audit), Event::End(totals)) => audit.end(totals, ledger),
            (State::Mesh(audit), Event::Patch(patch)) => audit.patch(patch, ledger),
            (State::Mesh(audit), Event::Segments(_) | Event::OpenSegments(_)) => {
                audit.constraints(event);
                Ok(())
            }
            (State::Mesh(audit), Event::End(totals)) => audit.end(totals, ledger),
            (State::Partial(audit), event) => audit.event(event, ledger),
            (State::PartialTetrahedra(audit), event) => audit.event(event, ledger),
            (State::Tetrahedra(audit), Event::Patch(patch)) => audit.patch(patch, rows, ledger),
            (State::Tetrahedra(audit), Event::Labels(labels)) => audit.labels(labels, ledger),
            (State::Tetrahedra(audit), Event::End(totals)) => audit.end(totals, ledger),
            _ => unreachable!("the reader lets no such block into a stream of this kind"),
        }
    }

    /// Compares the event with the given points.
    fn check_given(&mut self, event: &Event) -> Result<(), Violation> {
        let given = match &mut self.given {
            None => return Ok(()),
            Some(Given::Near(near)) => {
                return match event {
                    Event::Patch(patch) => near.patch(patch, &mut self.ledger),
                    Event::End(_) => near.check_complete(),
                    _ => Ok(()),
                };
            }
            Some(Given::All(given)) => given,
        };
        let mut take = |id: Option<u64>, at: Point| given.take(id, at, &mut self.ledger);
        match event {
            Event::Patch(patch) => {
                patch.new.iter().zip(patch.first_id..).try_for_each(|(&at, id)| take(Some(id), at))
            }
            Event::ResidualPoints(points) => {
                points.iter().filter(|(id, _)| id.is_none()).try_for_each(|&(id, at)| take(id, at))
            }
            Event::End(_) => given.check_complete(),
            _ => Ok(()),
        }
    }

    /// Most vertices that were live at once, and how many edges or facets are open now.
    fn width(&self) -> (usize, usize) {
        match &self.state {
            State::Points(_) => (0, 0),
            State::Mesh(audit) => (audit.triangles().vertices.live_max(), audit.triangles().edges.len()),
            State::Partial(audit) => audit.width(),
            State::PartialTetrahedra(audit) => audit.width(),
            State::Tetrahedra(audit) => (audit.live_max(), audit.open_facets()),
        }
    }
}
