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

use crate::delaunay3::Tetrahedralization;
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
    /// Time.
    pub times: Times,
}

impl Report {
    /// Of a model with the given number of atoms, before anything is done.
    fn new(model: i64, atoms: usize) -> Self {
        let times = Times::default();
        Report { model, atoms: atoms as u64, vertices: 0, tetrahedra: 0, hull_facets: 0, times }
    }

    fn count(&mut self, mesh: &Tetrahedralization) {
        self.vertices = mesh.vertices().len() as u64;
        self.tetrahedra = mesh.tetrahedra().len() as u64;
        self.hull_facets = mesh.hull_facets as u64;
    }
}

/// Where the time went.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Times {
    /// Reading the file and finding out what is in it; counted with the first model.
    pub read: Duration,
    /// Selecting atoms and triangulating.
    pub triangulate: Duration,
    /// Measuring, formatting and writing.
    pub write: Duration,
}

impl Times {
    /// All of it.
    #[must_use]
    pub fn total(&self) -> Duration {
        self.read + self.triangulate + self.write
    }
}

/// What was done with all models together.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stats {
    /// Models.
    pub models: u64,
    /// Sums; the number of the model means nothing.
    pub sums: Report,
}

impl Stats {
    /// Adds a model.
    pub fn add(&mut self, report: &Report) {
        let Stats { models, sums } = self;
        *models += 1;
        sums.atoms += report.atoms;
        sums.vertices += report.vertices;
        sums.tetrahedra += report.tetrahedra;
        sums.hull_facets += report.hull_facets;
        sums.times.read += report.times.read;
        sums.times.triangulate += report.times.triangulate;
        sums.times.write += report.times.write;
    }
}
