//! `tess3`: the Delaunay tetrahedralization of the atoms of molecules and of other points in memory (thesis
//! 3.4), as a mesh stream or as tables, for one file or many.
//!
//! [`run`] turns one structure into one output; [`sweep::sweep`] does so for a list of files in parallel.

mod alpha;
mod balls;
mod exact;
pub mod filtration;
mod frames;
pub mod heap;
mod identity;
mod job;
mod labels;
mod mesh;
mod method;
mod selection;
mod sites;
mod spheres;
pub mod sweep;
mod tables;

pub use alpha::{AlphaComplex, Radius};
pub use balls::{
    BallOptions, Between, ColourBy, ContactFilter, Level, Maxima, NamedRadii, PictureForm, PictureOptions,
};
pub use frames::run_frames;
pub use job::{ModelName, Open, run};
pub use labels::Labels;
pub use mesh::write_mesh;
pub use method::{Arithmetic, Method};
pub use spheres::{Measure, measure};

use std::time::Duration;

use spmesh_base::error::{counted, counted_of};
use spmesh_delaunay::predicates::PredicateCounts;
use spmesh_formats::molecules::{FrameRange, PeriodicBox, RadiusCounts, Selection};
use spmesh_formats::sink::TableFormat;

/// The output made of a triangulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Product {
    /// The stream of the tetrahedral mesh, one per model.
    Mesh,
    /// A table of the tetrahedra.
    Tetrahedra,
    /// A table of the edges.
    Contacts,
    /// A table of the cells of atoms as balls ([`Options::balls`]): areas and volumes.
    Cells,
    /// A table of the molecular surface and of what is inside it, by atoms as balls.
    Surface,
    /// A table of the faces between cells.
    ContactAreas,
    /// A table of the areas that parts take from each other.
    BuriedAreas,
    /// A table of the pockets and voids between them.
    Pockets,
    /// A table of the Voronoi cells, or of those of the power diagram of [`Options::balls`], with rows of
    /// this level.
    SiteCells(Level),
    /// A table of the faces of these.
    SiteFaces,
    /// The filtration of the alpha complex, one per model.
    Filtration,
}

impl Product {
    /// Whether the output is a table.
    pub fn is_table(self) -> bool {
        !self.is_per_model()
    }

    /// Whether each model has an output of its own.
    pub fn is_per_model(self) -> bool {
        matches!(self, Product::Mesh | Product::Filtration)
    }
}

/// Where the periodic box of atoms comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PeriodicFrom {
    /// The file states it.
    File,
    /// It is given.
    Stated(PeriodicBox),
}

/// What to triangulate, and what to write of it.
#[derive(Debug, Clone)]
pub struct Options {
    /// Which atoms; all models are triangulated one by one.
    pub selection: Selection,
    /// The frames of each file that are taken one by one, in place of models.
    pub frames: Option<FrameRange>,
    /// The biological assembly to make of each file first, if one is wanted.
    pub assembly: Option<String>,
    /// What is written.
    pub product: Product,
    /// Write only simplices of the alpha complex with this radius, in world units.
    pub alpha: Option<Radius>,
    /// How the kernel works.
    pub method: Method,
    /// The format of tables.
    pub format: TableFormat,
    /// Whether the blocks of meshes are compressed.
    pub compress: bool,
    /// How atoms become balls, for what is measured of these, and for meshes and filtrations with weights.
    pub balls: Option<BallOptions>,
    /// The box that repeats the atoms, if one does: for cells, areas and contacts.
    pub periodic: Option<PeriodicFrom>,
}

impl Options {
    /// Whether a file may have several models or frames.
    fn are_models_several(&self) -> bool {
        self.frames.is_some() || self.selection.models.are_several()
    }

    /// Whether models, of which a file has so many, are measured on several threads at the same time.
    fn is_by_models(&self, models: usize) -> bool {
        !self.is_per_model() && self.selection.models.are_several() && models >= self.method.threads.get()
    }

    /// Whether each model has an output of its own.
    pub fn is_per_model(&self) -> bool {
        self.product.is_per_model() || self.balls.as_ref().is_some_and(|balls| balls.picture.is_some())
    }
}

/// Counts and times of one model.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Report {
    /// Number that the file gives the model.
    pub model: i64,
    /// Atoms that were selected.
    pub atoms: u64,
    /// Distinct points among them: vertices of the mesh.
    pub vertices: u64,
    /// Tetrahedra of the triangulation, or with a radius of the alpha complex.
    pub tetrahedra: u64,
    /// Facets of the convex hull.
    pub hull_facets: u64,
    /// Balls were measured; counts of the triangulation are unknown.
    pub is_of_cells: bool,
    /// Atoms that have no cell in the power diagram, as others take all of it.
    pub without_cell: u64,
    /// Atoms with Voronoi or Laguerre cells that reach to infinity.
    pub unbounded: u64,
    /// Atoms whose cells are not known, as all are in a plane.
    pub flat: u64,
    /// Atoms whose surface a mesh lacks, as rounding leaves its border in doubt.
    pub left_out: u64,
    /// What the labels of a table do not tell.
    pub labels: Labels,
    /// Atoms whose radii are not those of a table.
    pub radii: RadiusCounts,
    /// Hydrogens that were measured with radii of heavy atoms that include them.
    pub hydrogens: u64,
    /// Tetrahedra that the kernel created, infinite ones included; most were replaced later.
    pub created: u64,
    /// In-sphere tests of the search for cavities.
    pub in_sphere_tests: u64,
    /// Peak memory of the kernel and its result in bytes, the points of the input included; 0 if unknown.
    pub kernel_bytes: u64,
    /// Decisions of the predicates, if they are exact.
    pub predicates: PredicateCounts,
    /// Rounding errors, if they are not exact.
    pub rounding: Rounding,
    /// Time.
    pub times: Times,
}

impl Report {
    /// The report of a model with `atoms` atoms, before any work.
    fn new(model: i64, atoms: usize) -> Self {
        Report { model, atoms: atoms as u64, ..Report::default() }
    }

    /// What a user may not expect of the model, in sentences; usually nothing.
    pub fn warnings(&self) -> Vec<String> {
        let mut texts = Vec::new();
        if self.hydrogens > 0 {
            let counted = if self.hydrogens == 1 { "hydrogen counts" } else { "hydrogens count" };
            let reason = "radii of heavy atoms include them: use --atoms heavy, or --radii bondi";
            texts.push(format!("{} {counted} twice, as {reason}", self.hydrogens));
        }
        texts.extend(self.radii.notices());
        texts.extend(self.labels.warnings());
        if self.without_cell > 0 {
            let without = counted_of(self.without_cell, self.atoms, ["atom", "atoms"], ["has", "have"]);
            texts.push(format!("{without} no cell: others take all of it"));
        }
        if self.left_out > 0 {
            let reason = "rounding leaves the border of their surface in doubt";
            let atoms = counted(self.left_out, "atom is", "atoms are");
            texts.push(format!("{atoms} left out of the mesh: {reason}"));
        }
        if self.unbounded > 0 {
            let cells = counted_of(self.unbounded, self.atoms, ["cell", "cells"], ["reaches", "reach"]);
            texts.push(format!("{cells} to infinity: there is no box, and they are on the hull"));
        }
        if self.flat > 0 {
            texts.push("cells are not measured: there is no box, and all points are in a plane".to_string());
        }
        let merged = self.atoms - self.vertices;
        if merged > 0 {
            let merged = counted_of(merged, self.atoms, ["point", "points"], ["coincides", "coincide"]);
            texts.push(format!("{merged} with an earlier one"));
        }
        if self.is_of_cells {
            return texts;
        }
        let missing = self.rounding.missing;
        if missing > 0 && self.hull_facets > 0 {
            let missing = counted_of(missing, self.vertices, ["point", "points"], ["is", "are"]);
            let why = "rounding in floating-point arithmetic left them out";
            texts.push(format!("{missing} in no tetrahedron: {why}"));
        }
        if self.hull_facets == 0 {
            let few = self.vertices < 4;
            let reason = if few { "fewer than four different points" } else { "all points in a plane" };
            let points = counted(self.atoms, "point", "points");
            texts.push(format!("no tetrahedra: {reason} ({points})"));
        }
        texts
    }
}

/// Rounding errors in a triangulation in floating-point arithmetic.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Rounding {
    /// In-sphere tests with a wrong sign, except those whose exact value is zero. This count and the next two
    /// are known only if signs are checked.
    pub wrong_signs: u64,
    /// In-sphere tests whose exact value is zero and whose computed value is not.
    pub wrong_zeros: u64,
    /// In-sphere tests whose value was not the exact one.
    pub rounded: u64,
    /// Distinct points that are in no tetrahedron.
    pub missing: u64,
    /// Tetrahedra that are inverted or flat, or have a vertex of a neighbour inside of their sphere; `None`
    /// in exact arithmetic.
    pub violations: Option<u64>,
}

impl Rounding {
    fn add(&mut self, other: &Rounding) {
        let Rounding { wrong_signs, wrong_zeros, rounded, missing, violations } = self;
        *wrong_signs += other.wrong_signs;
        *wrong_zeros += other.wrong_zeros;
        *rounded += other.rounded;
        *missing += other.missing;
        if let Some(count) = other.violations {
            *violations.get_or_insert(0) += count;
        }
    }
}

/// Where the time went.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Times {
    /// Reading and parsing the file; counted with the first model.
    pub read: Duration,
    /// Selecting atoms and triangulating.
    pub triangulate: Duration,
    /// Of that, ordering the points.
    pub order: Duration,
    /// Of that, if measured: the walks to the points (`locate`), the search of cavities (`predicates`), and
    /// the replacement of tetrahedra (`update`).
    pub locate: Duration,
    /// See `locate`.
    pub predicates: Duration,
    /// See `locate`.
    pub update: Duration,
    /// Measuring, formatting and writing.
    pub write: Duration,
}

impl Times {
    /// All of it.
    pub fn total(&self) -> Duration {
        self.read + self.triangulate + self.write
    }

    fn add(&mut self, other: &Times) {
        let Times { read, triangulate, order, locate, predicates, update, write } = self;
        *read += other.read;
        *triangulate += other.triangulate;
        *order += other.order;
        *locate += other.locate;
        *predicates += other.predicates;
        *update += other.update;
        *write += other.write;
    }
}

/// Counts and times of all models together.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stats {
    /// Models.
    pub models: u64,
    /// Sums over the models, and the maximum of [`Report::kernel_bytes`]; `model` is unused.
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
        sums.in_sphere_tests += report.in_sphere_tests;
        sums.kernel_bytes = report.kernel_bytes.max(sums.kernel_bytes);
        sums.predicates.merge(&report.predicates);
        sums.rounding.add(&report.rounding);
        sums.times.add(&report.times);
    }
}
