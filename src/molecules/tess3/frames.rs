//! The frames of a file, or the models of a structure, one after the other on several threads. A frame is in
//! memory for each thread; what comes of them goes to one table in their order.

use std::num::NonZeroUsize;

use super::job::{Job, Open};
use super::{Options, Report};
use spmesh_base::error::Result;
use spmesh_base::parallel::{InTurn, in_turn};
use spmesh_formats::molecules::{Frame, FrameReader, Models, Structure};
use spmesh_formats::sink::TableSink;

/// Measures the frames of a file, and reports each to `listener`, in their order. Outputs are those of
/// [`super::run`].
///
/// Memory: for each thread a frame, what names its atoms, and what measuring it takes.
///
/// # Errors
/// As [`super::run`], and those of reading. Then no table gets its name.
pub fn run_frames(
    mut frames: FrameReader,
    options: &Options,
    open: &mut Open<'_>,
    listener: &mut (dyn FnMut(Report) + Send),
) -> Result<()> {
    let mut of_frame = options.clone();
    of_frame.selection.models = Models::First;
    // Meshes are made in turn, and a single frame is measured on all threads.
    let is_alone = options.is_per_model() || frames.is_single();
    let threads = if is_alone { NonZeroUsize::MIN } else { options.method.threads };
    if !is_alone {
        of_frame.method.threads = NonZeroUsize::MIN;
        of_frame.balls.iter_mut().for_each(|balls| balls.threads = NonZeroUsize::MIN);
    }
    let states = vec![frames.topology().cloned(); threads.get()];
    let measure = Measure { options: &of_frame };
    let name = frames.name().to_string();
    let job = Job { options: of_frame.clone(), open: Some(open), table: None };
    let next = |_: &_| frames.next_frame();
    let (_, written) =
        in_turn(&measure, states, Written { job, listener }, next).map_err(|e| e.of_input(name))?;
    written.job.table.map_or(Ok(()), TableSink::commit)
}

/// Measures the models of a structure, as [`super::run`] does.
pub(super) fn run_models(
    structure: Structure,
    options: &Options,
    open: &mut Open<'_>,
) -> Result<Vec<Report>> {
    let frames = FrameReader::of_models(structure, &options.selection)?;
    let mut reports = Vec::new();
    run_frames(frames, options, open, &mut |report| reports.push(report))?;
    Ok(reports)
}

/// What is done with a frame on its thread.
struct Measure<'o> {
    options: &'o Options,
}

/// What frames are written to in turn, and who hears of them.
struct Written<'o, 'f> {
    job: Job<'o, 'f>,
    listener: &'o mut (dyn FnMut(Report) + Send),
}

/// A frame after the work on its thread.
struct Measured {
    /// Its place in the file.
    place: usize,
    /// Its rows and report; `None` if its outputs are made in turn.
    rows: Option<(TableSink, Report)>,
    read: std::time::Duration,
}

impl<'o> InTurn for Measure<'o> {
    type Item = Frame;
    type Done = Measured;
    /// The structure with the atoms of the frame.
    type State = Option<Structure>;
    type Shared = Written<'o, 'o>;

    fn admits(&self, _: &mut Frame, _: u64, _: &Self::Shared) -> Result<bool> {
        Ok(true)
    }

    fn weight(&self, _: &Frame) -> u64 {
        1
    }

    fn work(&self, state: &mut Option<Structure>, frame: Frame) -> Result<Measured> {
        let (place, read) = (frame.place as usize, frame.read);
        let structure = frame.put(state);
        if self.options.is_per_model() {
            return Ok(Measured { place, rows: None, read });
        }
        let mut job = Job { options: self.options.clone(), open: None, table: None };
        let report = job.model(structure, place)?;
        job.table()?;
        Ok(Measured { place, rows: job.table.zip(Some(report)), read })
    }

    fn finish(
        &self,
        state: &mut Option<Structure>,
        done: Measured,
        written: &mut Self::Shared,
    ) -> Result<()> {
        let mut report = match (done.rows, state) {
            (Some((rows, report)), _) => {
                written.job.table()?.append(rows)?;
                report
            }
            (None, Some(structure)) => written.job.model(structure, done.place)?,
            (None, None) => return Ok(()),
        };
        report.times.read = done.read;
        (written.listener)(report);
        Ok(())
    }
}
