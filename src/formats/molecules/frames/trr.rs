//! TRR, trajectories of GROMACS in full precision: a header with the lengths of the parts of a frame, then
//! box, virial, pressure, coordinates, velocities and forces. All numbers are big-endian.
//!
//! Source: the reference manual of GROMACS, "File formats", trr, and the order of fields in its `trrio`.

use super::words::{Words, of_nanometres};
use super::{Content, Frames, Positions, check_count};
use crate::drivers::AnyInput;
use crate::molecules::periodic_box::PeriodicBox;
use spmesh_base::error::{Error, Result};

/// First number of a frame.
const MAGIC: u32 = 1993;

/// What stands behind it, as a text behind its length.
const VERSION: &[u8] = b"GMX_trn_file";

/// Lengths of parts in bytes, in the order of the file: `ir`, `e`, `box`, `vir`, `pres`, `top`, `sym`, `x`,
/// `v`, `f`.
const PARTS: usize = 10;
const BOX: usize = 2;
const COORDINATES: usize = 7;

/// Opens the frames of an input.
pub(crate) fn open(input: AnyInput, _: &str) -> Result<Box<dyn Frames>> {
    Ok(Box::new(Trr { words: Words::new(input) }))
}

struct Trr {
    words: Words,
}

/// The start of a frame.
struct Head {
    atoms: u64,
    parts: [u64; PARTS],
    /// Bytes of a number.
    width: u64,
}

impl Trr {
    fn head(&mut self) -> Result<Option<Head>> {
        if self.words.start(&[MAGIC])?.is_none() {
            return Ok(None);
        }
        // The length of the text with a zero, and without.
        let lens = [self.words.u32()?, self.words.u32()?];
        let version = self.words.array::<{ VERSION.len() }>()?;
        if lens != [VERSION.len() as u32 + 1, VERSION.len() as u32] || version != VERSION {
            return Err(Error::malformed("found another version than GMX_trn_file"));
        }
        let mut parts = [0; PARTS];
        for part in &mut parts {
            *part = length(self.words.i32()?)?;
        }
        let atoms = length(self.words.i32()?)?;
        let width = match (parts[BOX], parts[COORDINATES], atoms) {
            (len @ (36 | 72), ..) => len / 9,
            (0, len, 1..) if len == 12 * atoms || len == 24 * atoms => len / (3 * atoms),
            _ => 4,
        };
        // Step, counter of energies, time and lambda.
        self.words.skip(4 + 4 + 2 * width)?;
        Ok(Some(Head { atoms, parts, width }))
    }
}

impl Frames for Trr {
    fn next(&mut self, atoms: Option<u64>) -> Result<Option<Content>> {
        let Some(Head { atoms: found, parts, width }) = self.head()? else { return Ok(None) };
        check_count(found, atoms.unwrap_or(found))?;
        let len = parts[COORDINATES];
        if len == 0 {
            let message = "the frame has no coordinates: leave it out, with --frames FIRST:END:STEP";
            return Err(Error::malformed(message));
        }
        if len != 3 * found * width {
            return Err(Error::malformed(format!("found {len} bytes of coordinates for {found} atoms")));
        }
        self.words.skip(parts[..BOX].iter().sum())?;
        let vectors = if parts[BOX] == 9 * width { self.words.reals(9, width)? } else { Vec::new() };
        let rest = parts[BOX..COORDINATES].iter().sum::<u64>();
        self.words.skip(rest - width * vectors.len() as u64)?;
        let reals = self.words.reals(3 * found, width)?;
        self.words.skip(parts[COORDINATES + 1..].iter().sum())?;
        let stated = PeriodicBox::of_nanometres(&vectors);
        Ok(Some(Content::Points(Positions::new(of_nanometres(&reals)?, stated))))
    }

    fn skip(&mut self) -> Result<bool> {
        let Some(Head { parts, .. }) = self.head()? else { return Ok(false) };
        self.words.skip(parts.iter().sum())?;
        Ok(true)
    }

    fn position(&self) -> Option<String> {
        Some(format!("byte {}", self.words.position()))
    }
}

fn length(number: i32) -> Result<u64> {
    u64::try_from(number).map_err(|_| Error::malformed(format!("found {number} as a length")))
}
