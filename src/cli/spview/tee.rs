//! Copies an input to stdout as it is read.

use std::io::{self, Read, Write};
use std::path::Path;

use spmesh_core::error::Result;
use spmesh_core::output::Output;
use spmesh_core::upstream;

/// An input whose bytes are copied to stdout.
pub(super) struct Tee<R> {
    input: R,
    output: Output,
}

impl<R: Read> Tee<R> {
    /// # Errors
    /// If stdout is a terminal.
    pub(super) fn new(input: R) -> Result<Tee<R>> {
        Ok(Tee { input, output: Output::create(Path::new("-"), true)? })
    }
}

impl<R: Read> Read for Tee<R> {
    /// Flushes after each read, so that the reader of stdout gets all bytes that were read here.
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let len = self.input.read(buffer)?;
        if len == 0 && !buffer.is_empty() {
            upstream::output_is_whole();
        }
        self.output.write_all(&buffer[..len])?;
        self.output.flush()?;
        Ok(len)
    }
}
