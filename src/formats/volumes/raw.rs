//! Volumes without a header, x fastest.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

use crate::raw::number::RawType;
use crate::source::origin::Origin;
use crate::volumes::data::{Data, Encoding, Part, Skip};
use crate::volumes::lattice::Lattice;
use crate::volumes::volume::Volume;
use spmesh_base::error::Result;

/// Sizes and type of a raw volume, as in `64x64x64x20:f32le`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RawLayout {
    lens: [u64; 4],
    kind: RawType,
}

impl FromStr for RawLayout {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<RawLayout, String> {
        let (sizes, kind) =
            text.split_once(':').ok_or("expected sizes and a type, as in 64x64x64x20:f32le")?;
        let lens = parse_sizes(sizes)?;
        Lattice::new(lens).map_err(|e| e.to_string())?;
        Ok(RawLayout { lens, kind: kind.parse()? })
    }
}

impl RawLayout {
    /// Length of the values in bytes.
    pub(crate) fn bytes(&self) -> u64 {
        self.lens.iter().fold(self.kind.sample.len() as u64, |bytes, &len| bytes.saturating_mul(len))
    }
}

impl fmt::Display for RawLayout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z, t] = self.lens;
        write!(f, "{x}x{y}x{z}x{t}:{}", self.kind)
    }
}

/// Four sizes with `x` between them, as in `16x16x16x16`.
///
/// # Errors
/// If they are not four positive integers.
pub fn parse_sizes(text: &str) -> std::result::Result<[u64; 4], String> {
    let expected = || format!("{text:?} is not four sizes, as in 16x16x16x16");
    let mut lens = [0; 4];
    let mut sizes = text.split('x');
    for len in &mut lens {
        let size = sizes.next().filter(|size| size.bytes().all(|byte| byte.is_ascii_digit()));
        *len = size.and_then(|size| size.parse().ok()).filter(|&len| len > 0).ok_or_else(expected)?;
    }
    sizes.next().map_or(Ok(lens), |_| Err(expected()))
}

/// The volume in `origin`, decompressed if the file's name ends with .gz: raw numbers may start with any
/// bytes, even those of gzip.
pub(crate) fn open(origin: Origin, path: Option<&Path>, layout: &RawLayout) -> Result<Volume> {
    let is_gzip = path.and_then(Path::extension).is_some_and(|ending| ending.eq_ignore_ascii_case("gz"));
    Ok(Volume {
        units: None,
        lattice: Lattice::new(layout.lens)?,
        data: Data {
            parts: vec![Part { origin, name: None, is_gzip, header_len: 0 }],
            sample: layout.kind.sample,
            encoding: Encoding::Raw(layout.kind.order),
            line_skip: 0,
            byte_skip: Skip::Bytes(0),
            is_exact: true,
        },
        scaling: None,
        world: Err("raw numbers have no world units".to_string()),
    })
}
