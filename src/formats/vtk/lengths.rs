//! Lengths of arrays and blocks.

use std::io::{self, Read};

use crate::raw::byte_order::ByteOrder;

/// How lengths are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Lengths {
    /// Whether they have 8 bytes instead of 4.
    pub(crate) is_wide: bool,
    pub(crate) order: ByteOrder,
}

impl Lengths {
    /// Number of bytes of a length.
    pub(crate) fn len(self) -> u64 {
        if self.is_wide { 8 } else { 4 }
    }

    /// The next length.
    pub(crate) fn read(self, input: &mut impl Read) -> io::Result<u64> {
        let mut bytes = [0; 8];
        let bytes = &mut bytes[..self.len() as usize];
        input.read_exact(bytes)?;
        Ok(if self.is_wide { self.order.u64(bytes) } else { u64::from(self.order.u32(bytes)) })
    }
}
