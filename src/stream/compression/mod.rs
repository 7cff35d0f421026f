//! Compressed payloads of blocks. `formats/spmesh.md` specifies them in section 4.16.
//!
//! A compressed payload starts with its method. Points and triangle patches are split into columns of similar
//! numbers, each a byte for its magnitude and a few raw bits; zstd compresses the bytes. All other payloads
//! are rearranged by bytes of records before zstd.

mod bytes;
mod choice;
mod columns;
#[cfg(feature = "zstd")]
mod frames;
#[cfg(not(feature = "zstd"))]
#[path = "frames_missing.rs"]
mod frames;
mod open_edges;
mod operations;
mod order;
mod patch;
mod patch_triangles;
mod points;
mod predictors;
mod records;
mod shapes;

use super::block::Tag;
use super::coordinates::Coordinates;
use super::header::Header;
use frames::{Packer, Unpacker};
use shapes::Shapes;
use spmesh_base::error::{Error, Result};

/// Shorter payloads stay as they are: heads of methods and frames would take what compression saves.
const PAYLOAD_MIN: usize = 64;

/// Why a compressed payload is malformed.
type Fault = &'static str;

/// The first byte of a compressed payload.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
enum Method {
    /// Points of three i32 coordinates.
    Points = 1,
    /// A patch of triangles, its vertices of three i32 coordinates.
    Patch = 2,
    /// Anything, as records of one length.
    Records = 3,
}

impl Method {
    fn of_byte(byte: u8) -> Option<Method> {
        [Method::Points, Method::Patch, Method::Records].into_iter().find(|&method| method as u8 == byte)
    }
}

/// Decompresses zstd frames (RFC 8878), one behind the other. Memory: 128 MB for the largest window.
#[cfg(feature = "zstd")]
pub struct ZstdReader<R: std::io::BufRead>(zstd::stream::read::Decoder<'static, R>);

#[cfg(feature = "zstd")]
impl<R: std::io::BufRead> ZstdReader<R> {
    /// The frames of `input`.
    ///
    /// # Errors
    /// If zstd gets no memory.
    pub fn new(input: R) -> std::io::Result<ZstdReader<R>> {
        zstd::stream::read::Decoder::with_buffer(input).map(ZstdReader)
    }

    /// The input.
    pub fn input(&self) -> &R {
        self.0.get_ref()
    }
}

#[cfg(feature = "zstd")]
impl<R: std::io::BufRead> std::io::Read for ZstdReader<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        self.0.read(buffer)
    }
}

/// A zstd frame (RFC 8878) of any bytes, for formats that hold such frames.
#[cfg(feature = "zstd")]
pub fn zstd_frame(bytes: &[u8]) -> Vec<u8> {
    Packer::default().records(bytes).to_vec()
}

/// Compresses payloads in buffers that are used again.
#[derive(Default)]
pub(super) struct Compressor {
    packer: Packer,
    shapes: Shapes,
    compressed: Vec<u8>,
}

impl Compressor {
    /// The compressed form of the payload of a block; `None` if it is not shorter.
    pub(super) fn compress(&mut self, header: &Header, tag: Tag, payload: &[u8]) -> Option<&[u8]> {
        if cfg!(not(feature = "zstd")) || payload.len() < PAYLOAD_MIN || tag == Tag::End {
            return None;
        }
        self.compressed.clear();
        let (packer, compressed) = (&mut self.packer, &mut self.compressed);
        let has_columns = has_three_integers(header)
            && match tag {
                Tag::Points => points::encode(payload, packer, compressed),
                Tag::Patch if header.kind.vertices_per_simplex() == 3 => {
                    patch::encode(payload, packer, compressed)
                }
                _ => false,
            };
        if !has_columns {
            compressed.clear();
            self.shapes.encode(header, tag, payload, packer, compressed);
        }
        (self.compressed.len() < payload.len()).then_some(&self.compressed)
    }
}

/// Decompresses payloads in buffers that are used again.
#[derive(Default)]
pub struct Decompressor {
    unpacker: Unpacker,
}

impl Decompressor {
    /// Puts the payload that `compressed` stands for into `payload`, at most
    /// [`spmesh_base::limits::BLOCK_PAYLOAD_MAX`] bytes.
    ///
    /// # Errors
    /// Malformed, with what is wrong.
    pub fn decompress(&mut self, compressed: &[u8], payload: &mut Vec<u8>) -> Result<()> {
        payload.clear();
        let Some((&byte, body)) = compressed.split_first() else {
            return Err(Error::malformed("compressed payload: empty, expected a method"));
        };
        let Some(method) = Method::of_byte(byte) else {
            return Err(Error::malformed(format!("compressed payload: method {byte}, expected 1, 2 or 3")));
        };
        let done = match method {
            Method::Points => points::decode(body, &mut self.unpacker, payload),
            Method::Patch => patch::decode(body, &mut self.unpacker, payload),
            Method::Records => records::decode(body, &mut self.unpacker, payload),
        };
        done.map_err(|fault| Error::malformed(format!("compressed payload of method {byte}: {fault}")))
    }
}

fn has_three_integers(header: &Header) -> bool {
    matches!(header.coordinates, Coordinates::I32 { .. }) && header.coordinates_per_point() == 3
}

#[cfg(all(test, feature = "zstd"))]
mod tests;
