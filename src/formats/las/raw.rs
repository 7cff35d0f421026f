//! The public header block of a LAS file, field by field.
//!
//! Source: LAS specification 1.4 R15, table 3. Versions 1.0 to 1.2 end after the bounding box, 1.3 adds the
//! place of waveforms, and 1.4 that of extended records and wide counts.

use std::io::ErrorKind;

use byteorder::{ByteOrder, LittleEndian as LE};

use crate::source::origin::FileView;
use spmesh_base::error::{Error, Result};

/// Length of the header of LAS 1.0 to 1.2.
pub(crate) const HEADER_LEN_MIN: usize = 227;
const HEADER_LEN_OF_1_3: usize = 235;
const HEADER_LEN_MAX: usize = 375;
/// Bytes up to the end of the version.
const VERSION_END: usize = 26;

/// Where the header states its length.
const HEADER_LEN_AT: usize = 94;

/// The header in messages.
const PLACE: &str = "header at byte 0";

/// What reading needs of the header; numbers are as the file states them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RawHeader {
    pub(crate) global_encoding: u16,
    /// Length of the header with what writers append to it.
    pub(crate) header_len: u16,
    /// Byte at which points start.
    pub(crate) points_start: u32,
    /// Number of variable length records.
    pub(crate) records: u32,
    /// Point format; the upper two bits say that points are compressed.
    pub(crate) format: u8,
    /// Length of a point record.
    pub(crate) record_len: u16,
    /// Number of points in 32 bits, for readers of versions before 1.4.
    pub(crate) legacy_points: u32,
    pub(crate) scale: [f64; 3],
    pub(crate) offset: [f64; 3],
    pub(crate) min: [f64; 3],
    pub(crate) max: [f64; 3],
    /// Byte at which waveforms start; 0 if there are none.
    pub(crate) waveforms_start: u64,
    /// Extended records: the byte at which they start, and their number.
    pub(crate) extended_start: u64,
    pub(crate) extended: u32,
    /// Number of points in 64 bits; 0 before version 1.4.
    pub(crate) points: u64,
}

impl RawHeader {
    /// Reads the header at the start of a file.
    pub(crate) fn read(file: &FileView) -> Result<RawHeader> {
        let mut bytes = [0; HEADER_LEN_MAX];
        read_start(file, &mut bytes[..VERSION_END])?;
        let len = match bytes[24..VERSION_END] {
            [1, 0..=2] => HEADER_LEN_MIN,
            [1, 3] => HEADER_LEN_OF_1_3,
            [1, 4] => HEADER_LEN_MAX,
            _ => {
                let (major, minor) = (bytes[24], bytes[25]);
                return Err(Error::malformed(format!("LAS {major}.{minor}, expected 1.0 to 1.4")));
            }
        };
        read_start(file, &mut bytes[..HEADER_LEN_MIN])?;
        // A header that states to be shorter than those of its version has none of the fields after its end.
        let stated = usize::from(LE::read_u16(&bytes[HEADER_LEN_AT..]));
        let len = if len <= stated { len } else { HEADER_LEN_MIN };
        read_start(file, &mut bytes[..len])?;
        let header = RawHeader::of(&bytes);
        if u64::from(header.header_len) > file.len() {
            return Err(truncated());
        }
        Ok(header)
    }

    /// The fields of a header; those that the version does not have are 0 in `bytes`.
    fn of(bytes: &[u8; HEADER_LEN_MAX]) -> RawHeader {
        let numbers = |at: [usize; 3]| at.map(|at| LE::read_f64(&bytes[at..]));
        RawHeader {
            global_encoding: LE::read_u16(&bytes[6..]),
            header_len: LE::read_u16(&bytes[HEADER_LEN_AT..]),
            points_start: LE::read_u32(&bytes[96..]),
            records: LE::read_u32(&bytes[100..]),
            format: bytes[104],
            record_len: LE::read_u16(&bytes[105..]),
            legacy_points: LE::read_u32(&bytes[107..]),
            scale: numbers([131, 139, 147]),
            offset: numbers([155, 163, 171]),
            max: numbers([179, 195, 211]),
            min: numbers([187, 203, 219]),
            waveforms_start: LE::read_u64(&bytes[227..]),
            extended_start: LE::read_u64(&bytes[235..]),
            extended: LE::read_u32(&bytes[243..]),
            points: LE::read_u64(&bytes[247..]),
        }
    }
}

/// Fills `bytes` from the start of a file.
fn read_start(file: &FileView, bytes: &mut [u8]) -> Result<()> {
    file.read_at(0, bytes).map_err(|cause| match cause.kind() {
        ErrorKind::UnexpectedEof => truncated(),
        _ => Error::io("reading", cause).at(PLACE),
    })
}

fn truncated() -> Error {
    Error::malformed("truncated: the file ends inside").at(PLACE)
}
