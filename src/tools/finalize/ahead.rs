//! Reading ahead: a thread decodes and prepares the next batches while the engine works on one.

use std::thread;

use crossbeam_channel::bounded;

use spmesh_core::error::{Error, Result};
use spmesh_io::source::PointReader;
use spmesh_model::bounds::Point;

/// Batches in all: one that is read, one that waits, and one that the engine works on.
const BATCHES: usize = 3;

/// Points, and what was prepared of them on the reader's thread.
#[derive(Default)]
struct Batch<T> {
    points: Vec<Point>,
    prepared: T,
}

/// Reads `reader` to its end. Each batch goes through `prepare` on a thread of its own, which needs to know nothing
/// of the batches before, then through `consume` on this one, in order.
///
/// Memory: three batches.
///
/// # Errors
/// The first error in the order of the points, whichever thread it happens on.
pub(super) fn read_ahead<T: Default + Send>(
    reader: &mut dyn PointReader,
    mut prepare: impl FnMut(&[Point], &mut T) -> Result<()> + Send,
    mut consume: impl FnMut(&[Point], &mut T) -> Result<()>,
) -> Result<()> {
    let (full, filled) = bounded::<Batch<T>>(BATCHES);
    let (used, empty) = bounded::<Batch<T>>(BATCHES);
    let read = move || -> Result<()> {
        // Ends early when the engine failed and its ends of the channels are gone.
        while let Ok(mut batch) = empty.recv() {
            reader.next_batch(&mut batch.points)?;
            if batch.points.is_empty() {
                break;
            }
            prepare(&batch.points, &mut batch.prepared)?;
            if full.send(batch).is_err() {
                break;
            }
        }
        Ok(())
    };
    thread::scope(move |scope| {
        let spawned = thread::Builder::new().name("reader".into()).spawn_scoped(scope, read);
        let reading = spawned.map_err(|e| Error::io("starting a thread", e))?;
        for _ in 0..BATCHES {
            let _ = used.send(Batch::default());
        }
        for mut batch in filled {
            consume(&batch.points, &mut batch.prepared)?;
            let _ = used.send(batch);
        }
        reading.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}
