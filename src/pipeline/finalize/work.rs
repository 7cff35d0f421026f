//! The state that all passes of a run share, and one pass over the input.

use std::time::Instant;

use super::batch::{PointBatch, read_ahead};
use super::in_regions;
use super::options::Options;
use super::passes::{Observer, Pass, Passes};
use super::run::Stats;
use super::spool::{Spool, SpoolPlan, Tee};
use crate::regions::Sample;
use spmesh_base::error::Result;
use spmesh_formats::source::PointReader;

/// The state that all passes share.
pub(super) struct Work<'a> {
    pub(super) input: &'a dyn Passes,
    pub(super) observer: &'a mut dyn Observer,
    pub(super) stats: Stats,
    /// A sample of the points of the counting pass, if they may come in regions.
    pub(super) sample: Option<Sample>,
    kept: Kept,
}

/// Where decoded points are kept for later passes.
enum Kept {
    Not,
    /// The next pass, which is the first one, will keep them.
    Next(SpoolPlan),
    In(Box<Spool>),
}

impl<'a> Work<'a> {
    /// A run over `input`. The options decide whether its points are kept.
    pub(super) fn new(input: &'a dyn Passes, options: &Options, observer: &'a mut dyn Observer) -> Self {
        let folder = options.temp_dir.as_deref();
        let spooling = SpoolPlan::new(options.spooling, input.is_costly(), folder, input.description());
        let sample = in_regions::sample(options, input.description());
        Work {
            input,
            observer,
            stats: Stats::default(),
            sample,
            kept: spooling.map_or(Kept::Not, Kept::Next),
        }
    }

    /// Makes one pass over the input: every batch goes through `prepare`, ahead on another thread, then
    /// through `consume`.
    pub(super) fn read_all<T: Default + Send>(
        &mut self,
        pass: Pass,
        prepare: impl FnMut(&PointBatch, &mut T) -> Result<()> + Send,
        mut consume: impl FnMut(&PointBatch, &mut T) -> Result<()>,
    ) -> Result<()> {
        let start = Instant::now();
        let total = match self.stats.points {
            0 => self.input.description().stated_points,
            known => Some(known),
        };
        self.observer.pass(pass, total);
        let mut done = 0;
        let observer = &mut *self.observer;
        let consume = |batch: &PointBatch, prepared: &mut T| {
            consume(batch, prepared)?;
            done += batch.points.len() as u64;
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

    /// Whether decoded points are kept.
    pub(super) fn is_spooled(&self) -> bool {
        matches!(self.kept, Kept::In(_))
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
}
