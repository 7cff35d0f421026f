//! The passes of a run, and what they share.

use std::io::Write;
use std::time::Instant;

use super::plan::Plan;
use super::read_ahead::read_ahead;
use super::spool::{Spool, SpoolPlan, Tee};
use super::survey::Survey;
use super::{Observer, Options, Order, Pass, Passes, Stats};
use spmesh_core::error::Result;
use spmesh_io::source::{Description, PointReader};
use spmesh_model::bounds::Point;
use spmesh_stream::{Header, Kind, StreamWriter};

/// What all passes share.
pub(super) struct Work<'a, P: Passes + ?Sized> {
    pub(super) input: &'a P,
    pub(super) observer: &'a mut dyn Observer,
    pub(super) stats: Stats,
    kept: Kept,
}

/// Where decoded points are kept for later passes.
enum Kept {
    Not,
    /// The next pass, which is the first, keeps them.
    Next(SpoolPlan),
    In(Box<Spool>),
}

impl<'a, P: Passes + ?Sized> Work<'a, P> {
    /// Work on `input`, whose points are kept as `options` say.
    pub(super) fn new(input: &'a P, options: &Options, observer: &'a mut dyn Observer) -> Self {
        let folder = options.temp_dir.as_deref();
        let spooling = SpoolPlan::new(options.spooling, input.is_costly(), folder, input.description());
        Work { input, observer, stats: Stats::default(), kept: spooling.map_or(Kept::Not, Kept::Next) }
    }

    /// Makes all passes.
    pub(super) fn write<W: Write>(&mut self, options: &Options, output: W) -> Result<()> {
        let survey = self.survey(options)?;
        let header = header_of(self.input.description(), &survey, options);
        let Some(grid) = survey.grid else {
            return self.write_untagged(StreamWriter::new(output, header)?);
        };
        let plan = Plan::new(grid, options.leaves, &options.budget)?;
        self.note_plan(&plan);
        let writer = StreamWriter::new(output, Header { tree: Some(plan.tree()), ..header })?;
        match options.order {
            Order::Chunked => self.write_chunked(plan, options, writer),
            Order::Preserved => self.write_preserved(plan, writer),
        }
    }

    /// Makes one pass over the input: every batch goes through `prepare`, ahead on another thread, then `consume`.
    pub(super) fn read_all<T: Default + Send>(
        &mut self,
        pass: Pass,
        prepare: impl FnMut(&[Point], &mut T) -> Result<()> + Send,
        mut consume: impl FnMut(&[Point], &mut T) -> Result<()>,
    ) -> Result<()> {
        let start = Instant::now();
        let total = match self.stats.points {
            0 => self.input.description().stated_points,
            known => Some(known),
        };
        self.observer.pass(pass, total);
        let mut done = 0;
        let observer = &mut *self.observer;
        let consume = |batch: &[Point], prepared: &mut T| {
            consume(batch, prepared)?;
            done += batch.len() as u64;
            observer.done(done);
            Ok(())
        };
        match std::mem::replace(&mut self.kept, Kept::Not) {
            Kept::Not => {
                let mut reader = self.input.read()?;
                read_ahead(&mut *reader, prepare, consume)?;
                self.stats.invalid = reader.invalid();
            }
            Kept::Next(plan) => {
                let mut tee = Tee::new(self.input.read()?, plan, self.input.description())?;
                read_ahead(&mut tee, prepare, consume)?;
                self.stats.invalid = tee.invalid();
                self.keep(tee.finish());
            }
            Kept::In(spool) => {
                read_ahead(&mut spool.read(), prepare, consume)?;
                self.kept = Kept::In(spool);
            }
        }
        self.stats.passes.push((pass.name(), start.elapsed()));
        Ok(())
    }

    fn keep(&mut self, spool: Result<Spool>) {
        match spool {
            Ok(spool) => {
                self.stats.spooled_points = spool.points();
                self.stats.spooled_bytes = spool.bytes();
                self.kept = Kept::In(Box::new(spool));
            }
            Err(reason) => {
                self.observer.notice(&format!("{reason}: decoding the input again in each pass"));
            }
        }
    }

    fn note_plan(&mut self, plan: &Plan) {
        self.stats.level = plan.tree().depth();
        self.stats.occupied_cells = plan.leaves() as u64;
        self.stats.empty_cells = plan.empty().len() as u64;
        self.stats.cell_points_max = plan.count_max();
    }
}

fn header_of(description: &Description, survey: &Survey, options: &Options) -> Header {
    let Description { coordinates, dims, has_elevation, ref crs, .. } = *description;
    Header {
        bounds: survey.bounds,
        points: Some(survey.points),
        chunked: survey.grid.is_some() && options.order == Order::Chunked,
        crs: crs.clone(),
        ..Header::new(Kind::Points, coordinates, dims, has_elevation)
    }
}
