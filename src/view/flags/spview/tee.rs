//! Copies a stream to stdout as it is read, block by block.

use std::cell::RefCell;
use std::io::{self, Read, Write};
use std::path::Path;
use std::rc::Rc;

use spmesh_base::error::{Error, Result};
use spmesh_base::output::Output;
use spmesh_base::upstream;

/// An input whose bytes go to stdout once they are known to be right.
///
/// What was read since the last call of [`Passed::confirm`] waits: a block is checked when it was read, and a
/// damaged one must not reach the next program.
pub(super) struct Tee<R> {
    input: R,
    passed: Passed,
}

/// What a [`Tee`] has read, and what of it is passed on.
#[derive(Clone)]
pub(super) struct Passed(Rc<RefCell<State>>);

struct State {
    output: Output,
    /// Bytes that are not written yet.
    waiting: Vec<u8>,
    /// Whether they are right.
    is_right: bool,
}

impl<R: Read> Tee<R> {
    pub(super) fn new(input: R, passed: Passed) -> Tee<R> {
        Tee { input, passed }
    }
}

impl Passed {
    pub(super) fn to_stdout() -> Result<Passed> {
        let output = Output::create(Path::new("-"), true)?;
        Ok(Passed(Rc::new(RefCell::new(State { output, waiting: Vec::new(), is_right: false }))))
    }

    /// Says that everything that was read is right. It is written before more is read.
    pub(super) fn confirm(&self) {
        self.0.borrow_mut().is_right = true;
    }

    /// Writes the rest, which makes the output whole.
    pub(super) fn finish(&self) -> Result<()> {
        upstream::output_is_whole();
        self.0.borrow_mut().pass().map_err(|e| Error::io("writing", e))
    }
}

impl State {
    /// Flushes, so that the reader of stdout gets all bytes before this program waits for more.
    fn pass(&mut self) -> io::Result<()> {
        self.output.write_all(&self.waiting)?;
        self.output.flush()?;
        self.waiting.clear();
        self.is_right = false;
        Ok(())
    }
}

impl<R: Read> Read for Tee<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut state = self.passed.0.borrow_mut();
        if state.is_right {
            state.pass()?;
        }
        let len = self.input.read(buffer)?;
        state.waiting.extend_from_slice(&buffer[..len]);
        Ok(len)
    }
}
