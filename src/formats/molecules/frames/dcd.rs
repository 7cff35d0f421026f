//! DCD, trajectories of CHARMM, NAMD, X-PLOR, LAMMPS and OpenMM: unformatted records of Fortran, whose length
//! stands before and behind, in either byte order. Coordinates are f32 in Å, each axis by itself.
//!
//! Source: the documentation of CHARMM (dynamc), and the notes on the unit cell in that of VMD's plugin.

use super::words::{Words, finite};
use super::{Content, Frames, Positions, check_count};
use crate::drivers::AnyInput;
use crate::molecules::periodic_box::PeriodicBox;
use spmesh_base::error::{Error, Result};

/// Bytes of the first record: `CORD` and twenty integers.
const HEAD_LEN: u32 = 84;

/// Integers of it: number of frames; fixed atoms; whether frames have a unit cell, and a fourth coordinate;
/// and the version of CHARMM, without which the last two mean nothing.
const FRAMES: usize = 0;
const FIXED: usize = 8;
const CELL: usize = 10;
const FOUR: usize = 11;
const VERSION: usize = 19;

/// Bytes of a unit cell.
const CELL_LEN: u32 = 48;

/// Bytes of a line of the title, and most lines.
const TITLE_LINE_LEN: u64 = 80;
const TITLE_LINES_MAX: u32 = 1 << 16;

/// Whether an input is DCD.
pub(crate) fn is_dcd(head: &[u8]) -> bool {
    let is_head = |kind: &[u8]| kind == b"CORD" || kind == b"VELD";
    let is = |len: &[u8]| head.strip_prefix(len).and_then(|rest| rest.get(..4)).is_some_and(is_head);
    let wide = u64::from(HEAD_LEN);
    is(&HEAD_LEN.to_le_bytes())
        || is(&HEAD_LEN.to_be_bytes())
        || is(&wide.to_le_bytes())
        || is(&wide.to_be_bytes())
}

/// Opens the frames of an input.
pub(crate) fn open(input: AnyInput, _: &str) -> Result<Box<dyn Frames>> {
    Ok(Box::new(Dcd::new(Words::new(input))?))
}

struct Dcd {
    words: Words,
    atoms: u64,
    /// Number of frames that the header states; 0 if it does not.
    stated: u64,
    /// Number of frames so far.
    frames: u64,
    has_cell: bool,
    /// The numbers of the unit cell of the current frame, if there is one.
    cell: Vec<f64>,
    has_four: bool,
}

impl Dcd {
    fn new(mut words: Words) -> Result<Dcd> {
        let len = words.u32()?;
        words.is_little = len == HEAD_LEN.swap_bytes();
        if !words.is_little && len != HEAD_LEN {
            return Err(Error::malformed(format!("found {len} as the length of the first record")));
        }
        match &words.array()? {
            b"CORD" => {}
            b"VELD" => return Err(Error::malformed("the file has velocities, expected coordinates")),
            _ => {
                return Err(Error::malformed(
                    "records with lengths of 64 bits are not read: convert the file",
                ));
            }
        }
        let mut numbers = [0; 20];
        for number in &mut numbers {
            *number = words.i32()?;
        }
        end(&mut words, HEAD_LEN)?;
        let is_charmm = numbers[VERSION] != 0;
        if numbers[FIXED] != 0 {
            let message = "the file has fixed atoms, which later frames leave out: write it with all atoms";
            return Err(Error::malformed(message));
        }
        // Some programs state another length than that of the lines.
        let [title, lines] = [words.u32()?, words.u32()?];
        if lines > TITLE_LINES_MAX {
            return Err(Error::malformed(format!("found {lines} as the number of lines of the title")));
        }
        words.skip(TITLE_LINE_LEN * u64::from(lines))?;
        end(&mut words, title)?;
        start(&mut words, 4)?;
        let count = words.i32()?;
        let atoms = u64::try_from(count).ok().filter(|&atoms| atoms > 0 && atoms < 1 << 30);
        let atoms = atoms.ok_or_else(|| Error::malformed(format!("found {count} as the number of atoms")))?;
        end(&mut words, 4)?;
        Ok(Dcd {
            words,
            atoms,
            stated: u64::try_from(numbers[FRAMES]).unwrap_or(0),
            frames: 0,
            has_cell: is_charmm && numbers[CELL] != 0,
            cell: Vec::new(),
            has_four: is_charmm && numbers[FOUR] != 0,
        })
    }

    /// Begins a frame; false at the end of the file.
    fn begin(&mut self) -> Result<bool> {
        if self.words.is_ended()? {
            if self.frames < self.stated {
                let (frames, stated) = (self.frames, self.stated);
                let message = format!(
                    "truncated: the header states {stated} frames, found {frames}; --frames 0:{frames} takes them"
                );
                return Err(Error::malformed(message));
            }
            return Ok(false);
        }
        self.frames += 1;
        if self.has_cell {
            start(&mut self.words, CELL_LEN)?;
            self.cell = self.words.reals(6, 8)?;
            end(&mut self.words, CELL_LEN)?;
        }
        Ok(true)
    }

    /// Passes over a record of this length.
    fn pass(&mut self, len: u32) -> Result<()> {
        start(&mut self.words, len)?;
        self.words.skip(u64::from(len))?;
        end(&mut self.words, len)
    }

    /// Bytes of the record of an axis.
    fn axis_len(&self) -> u32 {
        4 * self.atoms as u32
    }
}

impl Frames for Dcd {
    fn next(&mut self, atoms: Option<u64>) -> Result<Option<Content>> {
        check_count(self.atoms, atoms.unwrap_or(self.atoms))?;
        if !self.begin()? {
            return Ok(None);
        }
        let mut axes = [const { Vec::new() }; 3];
        let len = self.axis_len();
        for axis in &mut axes {
            start(&mut self.words, len)?;
            *axis = self.words.reals(self.atoms, 4)?;
            end(&mut self.words, len)?;
        }
        if self.has_four {
            self.pass(len)?;
        }
        let [x, y, z] = axes;
        let points = x.into_iter().zip(y).zip(z).map(|((x, y), z)| [x, y, z]).collect();
        let stated = self.cell.first_chunk().and_then(|&cell| box_of(cell));
        Ok(Some(Content::Points(Positions::new(finite(points)?, stated))))
    }

    fn skip(&mut self) -> Result<bool> {
        if !self.begin()? {
            return Ok(false);
        }
        (0..3 + usize::from(self.has_four)).try_for_each(|_| self.pass(self.axis_len()))?;
        Ok(true)
    }

    fn position(&self) -> Option<String> {
        Some(format!("byte {}", self.words.position()))
    }
}

/// The box of a unit cell. It has sides and angles, in degrees or, of NAMD and CHARMM, as cosines; recent
/// versions of CHARMM write a symmetric matrix, of which an angle makes no sense.
fn box_of(cell: [f64; 6]) -> Option<Result<PeriodicBox>> {
    let [a, gamma, b, beta, alpha, c] = cell;
    let angles = [alpha, beta, gamma];
    if angles.iter().all(|angle| angle.abs() <= 1.0) {
        let [alpha, beta, gamma] = angles.map(|cosine| cosine.acos().to_degrees());
        return PeriodicBox::of_unit_cell([a, b, c, alpha, beta, gamma]);
    }
    if cell.iter().any(|&number| number < 0.0) || angles.iter().any(|&angle| angle > 180.0) {
        return PeriodicBox::of_vectors([[a, gamma, beta], [gamma, b, alpha], [beta, alpha, c]]);
    }
    PeriodicBox::of_unit_cell([a, b, c, alpha, beta, gamma])
}

/// The length before a record.
fn start(words: &mut Words, expected: u32) -> Result<()> {
    let len = words.u32()?;
    if len == expected {
        return Ok(());
    }
    Err(Error::malformed(format!("found a record of {len} bytes, expected {expected}")))
}

/// The length behind a record.
fn end(words: &mut Words, expected: u32) -> Result<()> {
    let len = words.u32()?;
    if len == expected {
        return Ok(());
    }
    Err(Error::malformed(format!("found {len} behind a record of {expected} bytes")))
}

#[cfg(test)]
mod tests {
    use super::box_of;

    /// As MDAnalysis reads them.
    #[test]
    fn unit_cells_have_angles_cosines_or_vectors() {
        let vectors = |cell| box_of(cell).map(|found| found.unwrap().vectors());
        let half = [[10.0, 0.0, 0.0], [10.0, 300f64.sqrt(), 0.0], [0.0, 0.0, 30.0]];
        for cell in [[10.0, 60.0, 20.0, 90.0, 90.0, 30.0], [10.0, 0.5, 20.0, 0.0, 0.0, 30.0]] {
            let found = vectors(cell).unwrap();
            assert!(found.as_flattened().iter().zip(half.as_flattened()).all(|(c, d)| (c - d).abs() < 1e-13));
        }
        let symmetric = vectors([10.0, -2.0, 20.0, 3.0, 4.0, 30.0]).unwrap();
        assert_eq!(symmetric, [[10.0, -2.0, 3.0], [-2.0, 20.0, 4.0], [3.0, 4.0, 30.0]]);
        assert_eq!(vectors([0.0; 6]), None);
        assert!(box_of([f64::NAN; 6]).unwrap().is_err());
    }
}
