//! The flag for compressed streams.

use clap::Args;

use spmesh_base::error::{Error, Result};

/// Whether the stream that a program writes is compressed.
#[derive(Debug, Clone, Copy, Args)]
pub struct Compression {
    /// Compress the stream: to a quarter or a fifth, for files to keep and for other machines, as in
    /// spfinalize --compress tile.laz | ssh host spdelaunay2d. In a pipe on one machine it costs time. All
    /// programs read compressed streams without a flag
    #[arg(long)]
    compress: bool,
}

impl Compression {
    /// Whether to compress an output that is a stream.
    pub fn of_stream(self) -> bool {
        self.compress
    }

    /// Whether to compress an output that may be something else.
    ///
    /// # Errors
    /// Usage, if the flag is given for no stream.
    pub fn of_output(self, is_stream: bool) -> Result<bool> {
        if self.compress && !is_stream {
            let message = "--compress is for streams, and the output is none: compress it with gzip";
            return Err(Error::usage(message));
        }
        Ok(self.compress)
    }
}
