//! Compresses tiles on a thread of its own, in order.

use std::io;
use std::thread::{self, JoinHandle};

use crossbeam_channel::{Receiver, Sender, bounded};

use super::overviews::TileName;
use super::tile_code;
use crate::raster::NoData;
use spmesh_core::error::{Error, Result};

/// Tiles that may be on their way.
const WAITING_MAX: usize = 8;

/// A tile that is compressed.
pub(super) struct Compressed {
    pub(super) name: TileName,
    pub(super) bytes: Vec<u8>,
    /// The memory of its values, to be used again.
    pub(super) values: Vec<f32>,
}

/// The thread, and what is on its way to it and back.
pub(super) struct Compressor {
    /// None when no more come.
    jobs: Option<Sender<(TileName, Vec<f32>)>>,
    done: Receiver<Compressed>,
    thread: Option<JoinHandle<()>>,
    waiting: usize,
}

impl Compressor {
    /// Starts the thread.
    ///
    /// # Errors
    /// If the system has none.
    pub(super) fn start(no_data: NoData) -> Result<Compressor> {
        let (jobs, jobs_out) = bounded::<(TileName, Vec<f32>)>(WAITING_MAX);
        let (done_in, done) = bounded(WAITING_MAX);
        let work = move || {
            for (name, values) in jobs_out {
                let bytes = tile_code::encode(&values, no_data);
                if done_in.send(Compressed { name, bytes, values }).is_err() {
                    return;
                }
            }
        };
        let thread = thread::Builder::new().spawn(work).map_err(|e| Error::io("starting a thread", e))?;
        Ok(Compressor { jobs: Some(jobs), done, thread: Some(thread), waiting: 0 })
    }

    /// Takes a tile; gives one that came before, if many are on their way.
    ///
    /// # Errors
    /// If the thread has ended.
    pub(super) fn push(&mut self, name: TileName, values: Vec<f32>) -> Result<Option<Compressed>> {
        let first = if self.waiting == WAITING_MAX { self.next()? } else { None };
        let jobs = self.jobs.as_ref().ok_or_else(ended)?;
        jobs.send((name, values)).map_err(|_| ended())?;
        self.waiting += 1;
        Ok(first)
    }

    /// Waits for the first tile that is on its way, if there is one.
    ///
    /// # Errors
    /// If the thread has ended.
    pub(super) fn next(&mut self) -> Result<Option<Compressed>> {
        if self.waiting == 0 {
            return Ok(None);
        }
        self.waiting -= 1;
        self.done.recv().map(Some).map_err(|_| ended())
    }
}

impl Drop for Compressor {
    /// Waits for the thread, which has at most so much to do as fits its way back.
    fn drop(&mut self) {
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            // A panic has been printed, and was seen as the end of the channel.
            let _ = thread.join();
        }
    }
}

fn ended() -> Error {
    Error::io("compressing tiles", io::Error::other("the thread has ended"))
}
