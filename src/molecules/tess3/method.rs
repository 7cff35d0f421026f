//! How points are triangulated: by the exact kernel, or in floating point as by the program of the thesis.

use std::borrow::Cow;
use std::num::NonZeroUsize;
use std::time::Duration;

use super::Report;
use super::Rounding;
use super::heap::peak_during;
use crate::float;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay3::{Kernel, Tetrahedralization};
use spmesh_delaunay::order::{Curve, Sequence};
use spmesh_delaunay::predicates::Point3;

/// Which arithmetic decides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Arithmetic {
    /// Signs are never wrong.
    #[default]
    Exact,
    /// `f64`, whose signs are wrong where rounding matters.
    Float {
        /// Whether signs are compared with the exact ones.
        check_signs: bool,
    },
}

/// How the kernel works, for experiments. With exact arithmetic, the result is always the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Method {
    /// The arithmetic of the predicates.
    pub arithmetic: Arithmetic,
    /// The curve along which points are stored and inserted.
    pub curve: Curve,
    /// In which sequence they are inserted.
    pub sequence: Sequence,
    /// Whether points that have more low bits in common are inserted first.
    pub by_bit_levels: bool,
    /// Seed of the walks in floating-point arithmetic.
    pub seed: u64,
    /// Whether to time the parts of exact insertions too, which slows them down.
    pub is_timed: bool,
    /// How many threads triangulate points without weights in exact arithmetic.
    pub threads: NonZeroUsize,
}

impl Default for Method {
    fn default() -> Method {
        Method {
            arithmetic: Arithmetic::Exact,
            curve: Curve::default(),
            sequence: Sequence::default(),
            by_bit_levels: false,
            seed: 0,
            is_timed: false,
            threads: NonZeroUsize::MIN,
        }
    }
}

impl Method {
    /// Triangulates, with weights only in exact arithmetic, and records counts and times in `report`.
    pub(super) fn triangulate(
        &self,
        points: Cow<[Point3]>,
        weights: Option<&[f64]>,
        report: &mut Report,
    ) -> Result<Tetrahedralization> {
        let input_bytes = size_of_val(&points[..]) as u64;
        let (mesh, peak) = peak_during(|| match self.arithmetic {
            Arithmetic::Exact => self.exactly(points, weights, report),
            Arithmetic::Float { check_signs } => self.in_floating_point(&points, check_signs, report),
        });
        let mesh = mesh?;
        report.kernel_bytes = peak.map_or(0, |bytes| input_bytes + bytes);
        report.vertices = mesh.vertices().len() as u64;
        report.tetrahedra = mesh.tetrahedra().len() as u64;
        report.hull_facets = mesh.hull_facets as u64;
        report.without_cell = mesh.hidden.len() as u64;
        Ok(mesh)
    }

    fn exactly(
        &self,
        points: Cow<[Point3]>,
        weights: Option<&[f64]>,
        report: &mut Report,
    ) -> Result<Tetrahedralization> {
        let mut kernel = Kernel::new();
        kernel.curve = self.curve;
        kernel.sequence = self.sequence;
        kernel.by_bit_levels = self.by_bit_levels;
        kernel.is_timed = self.is_timed;
        kernel.threads = self.threads;
        let mut mesh = Tetrahedralization::default();
        let done = match weights {
            Some(weights) => kernel.triangulate_weighted(points, weights, &mut mesh),
            None => kernel.triangulate(points, &mut mesh),
        };
        done.map_err(Error::of_computation)?;
        let stats = mesh.stats;
        report.created = stats.created;
        report.in_sphere_tests = stats.insphere_tests;
        report.predicates = *kernel.counts();
        report.times.order = stats.order;
        report.times.locate = stats.locate;
        report.times.predicates = stats.cavity;
        report.times.update = stats.update;
        Ok(mesh)
    }

    /// Counts what rounding made wrong in a mesh of this method.
    pub(super) fn count_violations(&self, mesh: &Tetrahedralization, report: &mut Report) {
        if self.arithmetic != Arithmetic::Exact {
            report.rounding.violations = Some(float::violations(mesh));
        }
    }

    fn in_floating_point(
        &self,
        points: &[Point3],
        check_signs: bool,
        report: &mut Report,
    ) -> Result<Tetrahedralization> {
        let Method { curve, sequence, by_bit_levels, seed, .. } = *self;
        let thesis = float::Options::default();
        let options = float::Options { curve, sequence, by_bit_levels, seed, check_signs, ..thesis };
        let (mesh, stats) = float::triangulate(points, &options).map_err(Error::of_computation)?;
        let float::Stats { wrong_signs, wrong_zeros, rounded, missing, .. } = stats;
        report.created = stats.created;
        report.in_sphere_tests = stats.in_sphere_tests;
        report.rounding = Rounding { wrong_signs, wrong_zeros, rounded, missing, violations: None };
        report.times.order = Duration::from_secs_f64(stats.seconds.order);
        report.times.locate = Duration::from_secs_f64(stats.seconds.locate);
        report.times.predicates = Duration::from_secs_f64(stats.seconds.predicates);
        report.times.update = Duration::from_secs_f64(stats.seconds.update);
        Ok(mesh)
    }
}
