//! Byte order of binary files. Isenburg's files often state it wrongly.

use spmesh_base::error::Result;

/// Order of the bytes of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ByteOrder {
    Little,
    Big,
}

impl ByteOrder {
    /// The order that the flag of a file states: 0 is little-endian.
    fn of_flag(flag: Option<&u8>) -> Self {
        if flag == Some(&0) { ByteOrder::Little } else { ByteOrder::Big }
    }

    fn other(self) -> Self {
        match self {
            ByteOrder::Little => ByteOrder::Big,
            ByteOrder::Big => ByteOrder::Little,
        }
    }

    /// The first `N` bytes in little-endian order; `bytes` must have at least `N`.
    fn little<const N: usize>(self, bytes: &[u8]) -> [u8; N] {
        let mut bytes: [u8; N] = bytes[..N].try_into().expect("N bytes");
        if self == ByteOrder::Big {
            bytes.reverse();
        }
        bytes
    }

    pub(crate) fn u16(self, bytes: &[u8]) -> u16 {
        u16::from_le_bytes(self.little(bytes))
    }

    pub(crate) fn u32(self, bytes: &[u8]) -> u32 {
        u32::from_le_bytes(self.little(bytes))
    }

    pub(crate) fn u64(self, bytes: &[u8]) -> u64 {
        u64::from_le_bytes(self.little(bytes))
    }

    pub(crate) fn f64(self, bytes: &[u8]) -> f64 {
        f64::from_le_bytes(self.little(bytes))
    }
}

/// Parses the start of a file in the byte order with the higher `plausibility`; if they are equal, in the
/// order that the second byte states.
pub(crate) fn parse_in_either<H>(
    head: &[u8],
    parse: impl Fn(ByteOrder) -> Result<H>,
    plausibility: impl Fn(&H) -> u32,
) -> Result<H> {
    let stated = ByteOrder::of_flag(head.get(1));
    match (parse(stated), parse(stated.other())) {
        (Ok(stated), Ok(other)) => {
            Ok(if plausibility(&other) > plausibility(&stated) { other } else { stated })
        }
        (Ok(one), Err(_)) | (Err(_), Ok(one)) => Ok(one),
        (Err(error), Err(_)) => Err(error),
    }
}
