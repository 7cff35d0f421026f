//! `tess3`: the Delaunay tetrahedralization of the atoms of molecules and of other points in memory (thesis 3.4), as a
//! mesh stream or as tables, of one file or of very many.
//!
//! [`run`] turns one structure into one output; [`sweep::sweep`] does so for a list of files, beside each other.

mod alpha;
mod choice;
mod edges;
mod exact;
pub mod heap;
mod job;
mod mesh;
mod names;
mod number;
mod radius;
mod spheres;
pub mod sweep;
mod tables;

pub use alpha::AlphaComplex;
pub use job::{ModelName, run};
pub use mesh::write_mesh;
pub use radius::Radius;
pub use spheres::{Measure, measure};

use std::time::Duration;

use crate::delaunay3::{Kernel, Tetrahedralization};
use crate::order::{Curve, Sequence};
use crate::predicates::PredicateCounts;
use crate::source::structure::Selection;

/// What is written of a triangulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Product {
    /// The stream of the tetrahedral mesh, one per model.
    Mesh,
    /// A table of the tetrahedra.
    Tetrahedra,
    /// A table of the edges.
    Contacts,
}

/// What to triangulate, and what to write of it.
#[derive(Debug, Clone)]
pub struct Options {
    /// Which atoms; all models are triangulated one by one.
    pub selection: Selection,
    /// What is written.
    pub product: Product,
    /// Write only simplices of the alpha complex with this radius, in world units.
    pub alpha: Option<Radius>,
    /// How the kernel is to go about it; nothing that is written depends on it but the order.
    pub method: Method,
}

/// How the kernel works, for experiments.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Method {
    /// The curve along which points are stored and inserted.
    pub curve: Curve,
    /// In which sequence they are inserted.
    pub sequence: Sequence,
    /// Whether points that have more low bits in common are inserted first.
    pub by_bit_levels: bool,
    /// Measure the parts of insertions, too, which takes some time itself.
    pub is_timed: bool,
}

impl Method {
    fn kernel(&self) -> Kernel {
        let Method { curve, sequence, by_bit_levels, is_timed } = *self;
        let mut kernel = Kernel::new();
        kernel.curve = curve;
        kernel.sequence = sequence;
        kernel.by_bit_levels = by_bit_levels;
        kernel.is_timed = is_timed;
        kernel
    }
}

/// What was done with one model.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Report {
    /// Number that the file gives the model.
    pub model: i64,
    /// Atoms that were selected.
    pub atoms: u64,
    /// Different points among them: vertices of the mesh.
    pub vertices: u64,
    /// Tetrahedra of the triangulation, or with a radius of the alpha complex.
    pub tetrahedra: u64,
    /// Facets of the convex hull.
    pub hull_facets: u64,
    /// Tetrahedra that the kernel made, infinite ones included; most of them did not last.
    pub created: u64,
    /// Greatest number of bytes that the kernel and its result held at once.
    pub kernel_bytes: u64,
    /// Decisions of the predicates.
    pub predicates: PredicateCounts,
    /// Time.
    pub times: Times,
}

impl Report {
    /// Of a model with the given number of atoms, before anything is done.
    fn new(model: i64, atoms: usize) -> Self {
        Report { model, atoms: atoms as u64, ..Report::default() }
    }

    /// Takes over what the kernel has to say.
    fn count(&mut self, kernel: &Kernel, mesh: &Tetrahedralization) {
        let stats = mesh.stats;
        self.vertices = mesh.vertices().len() as u64;
        self.tetrahedra = mesh.tetrahedra().len() as u64;
        self.hull_facets = mesh.hull_facets as u64;
        self.created = stats.created;
        self.kernel_bytes = stats.bytes;
        self.predicates = *kernel.counts();
        self.times.order = stats.order;
        self.times.locate = stats.locate;
        self.times.cavity = stats.cavity;
        self.times.update = stats.update;
    }
}

/// Where the time went.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Times {
    /// Reading the file and finding out what is in it; counted with the first model.
    pub read: Duration,
    /// Selecting atoms and triangulating.
    pub triangulate: Duration,
    /// Of that, ordering the points.
    pub order: Duration,
    /// Of that, if it was to be measured, the walks to the points; the search of cavities, with the predicates; and
    /// putting new tetrahedra in their place.
    pub locate: Duration,
    /// See `locate`.
    pub cavity: Duration,
    /// See `locate`.
    pub update: Duration,
    /// Measuring, formatting and writing.
    pub write: Duration,
}

impl Times {
    /// All of it.
    #[must_use]
    pub fn total(&self) -> Duration {
        self.read + self.triangulate + self.write
    }

    fn add(&mut self, other: &Times) {
        let Times { read, triangulate, order, locate, cavity, update, write } = self;
        *read += other.read;
        *triangulate += other.triangulate;
        *order += other.order;
        *locate += other.locate;
        *cavity += other.cavity;
        *update += other.update;
        *write += other.write;
    }
}

/// What was done with all models together.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stats {
    /// Models.
    pub models: u64,
    /// Sums of the models, and the greatest [`Report::kernel_bytes`]; the number of the model means nothing.
    pub sums: Report,
    /// Greatest number of atoms of a model.
    pub atoms_max: u64,
}

impl Stats {
    /// Adds a model.
    pub fn add(&mut self, report: &Report) {
        let Stats { models, sums, atoms_max } = self;
        *models += 1;
        *atoms_max = report.atoms.max(*atoms_max);
        sums.atoms += report.atoms;
        sums.vertices += report.vertices;
        sums.tetrahedra += report.tetrahedra;
        sums.hull_facets += report.hull_facets;
        sums.created += report.created;
        sums.kernel_bytes = report.kernel_bytes.max(sums.kernel_bytes);
        sums.predicates.merge(&report.predicates);
        sums.times.add(&report.times);
    }
}
