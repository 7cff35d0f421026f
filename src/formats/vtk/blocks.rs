//! Consecutive compressed blocks.

use std::io::{self, BufRead, Cursor, Read, Take};

use flate2::bufread::ZlibDecoder;

use crate::source::panic_guard::guarded;
use crate::source::point_arrays::Numbers;
use crate::vtk::lengths::Lengths;
use spmesh_base::limits::VTK_BLOCK_MAX;
use spmesh_base::system::expect_inflate_memory;

/// Greatest ratio of LZ4 decompression: a length is coded in steps of 255.
const LZ4_RATIO_MAX: u64 = 255;

/// How blocks are compressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Compressor {
    Zlib,
    Lz4,
}

/// Layout of the blocks of an array.
pub(crate) struct Blocks {
    /// Their compressed lengths.
    pub(crate) sizes: Numbers,
    pub(crate) lengths: Lengths,
    pub(crate) compressor: Compressor,
    /// Decompressed length of a block in bytes; the last may be shorter.
    pub(crate) block_len: u64,
    /// Decompressed bytes of the blocks not yet begun.
    pub(crate) left: u64,
    /// Number of the last block begun, counted from 1.
    pub(crate) number: u64,
}

/// The decompressed bytes of all blocks.
pub(crate) struct BlockReader {
    blocks: Blocks,
    /// The compressed bytes; `None` while a zlib block is read, which owns them.
    data: Option<Numbers>,
    block: Option<Block>,
    /// Decompressed bytes left of the block.
    left: u64,
}

/// The block being read.
enum Block {
    /// Decompressed as it is read, whatever its length: some writers make one block of an array.
    Zlib(ZlibDecoder<Take<Numbers>>),
    Lz4(Cursor<Vec<u8>>),
}

impl Blocks {
    /// Reads the decompressed bytes of all blocks from `data`.
    pub(crate) fn reader(self, data: Numbers) -> BlockReader {
        BlockReader { blocks: self, data: Some(data), block: None, left: 0 }
    }
}

impl BlockReader {
    /// Begins the next block; false if there is none.
    fn begin(&mut self) -> io::Result<bool> {
        if self.blocks.left == 0 {
            return Ok(false);
        }
        self.blocks.number += 1;
        let size = self.blocks.lengths.read(&mut self.blocks.sizes)?;
        self.left = self.blocks.left.min(self.blocks.block_len);
        self.blocks.left -= self.left;
        let Some(mut data) = self.data.take() else {
            return Err(invalid("reading goes on after an error"));
        };
        self.block = Some(match self.blocks.compressor {
            Compressor::Zlib => {
                expect_inflate_memory();
                Block::Zlib(ZlibDecoder::new(data.take(size)))
            }
            Compressor::Lz4 => {
                let block = read_lz4(&mut data, size, self.left)?;
                self.data = Some(data);
                Block::Lz4(Cursor::new(block))
            }
        });
        Ok(true)
    }

    /// Ends a block after its last byte, and checks that its compressed data end too.
    fn end(&mut self) -> io::Result<()> {
        if let Some(Block::Zlib(mut decoder)) = self.block.take() {
            // Reading at the end of the data verifies the checksum.
            if decoder.read(&mut [0])? > 0 {
                return Err(invalid("it is longer than stated"));
            }
            let rest = decoder.into_inner();
            if rest.limit() > 0 {
                return Err(invalid("its compressed data are longer than they should be"));
            }
            self.data = Some(rest.into_inner());
        }
        Ok(())
    }

    fn read_on(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while self.block.is_none() {
            if !self.begin()? {
                return Ok(0);
            }
        }
        let wanted = buffer.len().min(usize::try_from(self.left).unwrap_or(usize::MAX));
        let read = match &mut self.block {
            Some(Block::Zlib(decoder)) => decoder.read(&mut buffer[..wanted])?,
            Some(Block::Lz4(bytes)) => bytes.read(&mut buffer[..wanted])?,
            None => 0,
        };
        if read == 0 && wanted > 0 {
            return Err(invalid("it is shorter than stated"));
        }
        self.left -= read as u64;
        if self.left == 0 {
            self.end()?;
        }
        Ok(read)
    }
}

impl Read for BlockReader {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.read_on(buffer).map_err(|e| match e.kind() {
            io::ErrorKind::Interrupted => e,
            kind => {
                // Decompressors call damage invalid input; only errors of the system concern reading itself.
                let kind = if e.raw_os_error().is_some() { kind } else { io::ErrorKind::InvalidData };
                io::Error::new(kind, format!("compressed block {}: {e}", self.blocks.number))
            }
        })
    }
}

/// The block of `len` bytes, decompressed from the next `size` bytes of `data`.
fn read_lz4(data: &mut impl BufRead, size: u64, len: u64) -> io::Result<Vec<u8>> {
    if len > VTK_BLOCK_MAX {
        return Err(invalid(&format!("{len} bytes, the maximum for LZ4 is {VTK_BLOCK_MAX}")));
    }
    let mut compressed = Vec::new();
    data.take(size.min(VTK_BLOCK_MAX)).read_to_end(&mut compressed)?;
    let arrived = compressed.len() as u64;
    if arrived < size || len > arrived * LZ4_RATIO_MAX {
        return Err(invalid(&format!("{arrived} bytes cannot hold {len}: it was cut off")));
    }
    let block = guarded(|| lz4_flex::block::decompress(&compressed, len as usize));
    match block.unwrap_or_else(|_| Ok(Vec::new())) {
        Ok(block) if block.len() as u64 == len => Ok(block),
        Ok(_) => Err(invalid(&format!("the LZ4 data are damaged: they do not make {len} bytes"))),
        Err(e) => Err(invalid(&format!("the LZ4 data are damaged ({e})"))),
    }
}

fn invalid(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_of_lz4_have_a_limit() {
        let block = |len: u64| {
            let compressed = lz4_flex::block::compress(&vec![0; len as usize]);
            read_lz4(&mut &compressed[..], compressed.len() as u64, len).map(|block| block.len() as u64)
        };
        assert_eq!(block(VTK_BLOCK_MAX).unwrap(), VTK_BLOCK_MAX);
        let message = block(VTK_BLOCK_MAX + 1).unwrap_err().to_string();
        assert!(message.contains("67108865 bytes, the maximum for LZ4 is 67108864"), "{message}");
    }
}
