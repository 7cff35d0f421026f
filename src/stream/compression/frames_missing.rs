//! In the place of `frames`, where the feature `zstd` is missing: nothing is compressed, and what is
//! compressed cannot be read.

use super::Fault;

/// Makes no frames: [`super::Compressor`] does not ask for them.
#[derive(Default)]
pub(super) struct Packer;

impl Packer {
    pub(super) fn tokens(&mut self, _tokens: &[u8], _cuts: &[usize]) -> &[u8] {
        unreachable!("nothing is compressed without zstd")
    }

    pub(super) fn records(&mut self, _bytes: &[u8]) -> &[u8] {
        unreachable!("nothing is compressed without zstd")
    }
}

/// Reads no frames.
#[derive(Default)]
pub(super) struct Unpacker;

impl Unpacker {
    pub(super) fn unpack(&mut self, _frame: &[u8], _len_max: usize) -> Result<&[u8], Fault> {
        Err("a zstd frame, and this library is built without its feature `zstd`")
    }
}
