//! A thread that writes the patches of the root while they are made.

use std::io::Write;
use std::mem;

use crossbeam_channel::bounded;

use super::coordinator::thread_gone;
use super::patches::Flush;
use super::sequencer::Sequencer;
use spmesh_base::error::Result;
use spmesh_base::parallel::{self, BufferPool};

/// Most buffers of blocks that wait to be written.
const BLOCKS_AHEAD: usize = 2;

/// Bytes of patches that are handed over together: to wake a thread for each would cost more than to write it.
const TOGETHER: usize = 1 << 19;

/// Calls `make` with a function that takes patches. Another thread writes them to `sequencer`, in their
/// order. `make` keeps the last few.
pub(super) fn write_beside<T, W: Write + Send>(
    sequencer: &mut Sequencer<W>,
    make: impl FnOnce(&mut Flush) -> Result<T>,
) -> Result<T> {
    let pool = BufferPool::new(BLOCKS_AHEAD + 2);
    let (full, full_out) = bounded(BLOCKS_AHEAD);
    std::thread::scope(|scope| {
        let written = &pool;
        let write = move || {
            full_out.iter().try_for_each(|mut blocks| {
                sequencer.patches(&mut blocks)?;
                written.give_back(blocks);
                Ok(())
            })
        };
        let writer = parallel::spawn_scoped(scope, "writer", write)?;
        let made = make(&mut |blocks| {
            if blocks.byte_len() < TOGETHER {
                return Ok(());
            }
            let filled = mem::replace(blocks, pool.take());
            // The writer stops receiving only when it has failed; `join` gives its error.
            full.send(filled).map_err(|_| thread_gone())
        });
        drop(full);
        writer.join().unwrap_or_else(|_| Err(thread_gone()))?;
        made
    })
}
