//! XTC, trajectories of GROMACS with compressed coordinates.
//!
//! A frame: magic number, atoms, step, time, box, then coordinates as integers of a precision. The first of a
//! run of atoms has all bits of the bounding box; those that follow have the few bits of a distance from
//! it. All numbers are big-endian.
//!
//! The format is described by its code in GROMACS (xdrfile, `xdr3dfcoord`); this is none of it. The crate
//! `molly` 0.7.0 decodes it too, but panics on damaged frames.

use super::words::{Words, of_nanometres};
use super::{Content, Frames, Positions, check_count};
use crate::drivers::AnyInput;
use crate::molecules::periodic_box::PeriodicBox;
use spmesh_base::error::{Error, Result};
use spmesh_stream::Coordinates;
use spmesh_stream::model::points::Point3;

/// First numbers of a frame: that of the format, and that with lengths of 64 bits for large frames.
const MAGIC: u32 = 1995;
const MAGIC_LARGE: u32 = 2023;

/// Frames of so many atoms are not compressed.
const ATOMS_PLAIN: u64 = 9;

/// Ranges of distances by their index; each is the cube root of 2 times the one before, so that three
/// distances take as many bits as the index says. The first nine are not used.
const RANGES: [u32; 73] = [
    0, 0, 0, 0, 0, 0, 0, 0, 0, 8, 10, 12, 16, 20, 25, 32, 40, 50, 64, 80, 101, 128, 161, 203, 256, 322, 406,
    512, 645, 812, 1024, 1290, 1625, 2048, 2580, 3250, 4096, 5060, 6501, 8192, 10321, 13003, 16384, 20642,
    26007, 32768, 41285, 52015, 65536, 82570, 104_031, 131_072, 165_140, 208_063, 262_144, 330_280, 416_127,
    524_287, 660_561, 832_255, 1_048_576, 1_321_122, 1_664_510, 2_097_152, 2_642_245, 3_329_021, 4_194_304,
    5_284_491, 6_658_042, 8_388_607, 10_568_983, 13_316_085, 16_777_216,
];

/// Greatest extent that is multiplied with those of other axes.
const EXTENT_MAX: u64 = 0xff_ffff;

/// Opens the frames of an input.
pub(crate) fn open(input: AnyInput, _: &str) -> Result<Box<dyn Frames>> {
    Ok(Box::new(Xtc { words: Words::new(input) }))
}

struct Xtc {
    words: Words,
}

/// The start of a frame.
struct Head {
    atoms: u64,
    /// The vectors of the box in nm.
    vectors: Vec<f64>,
    /// Whether its length has 64 bits.
    is_large: bool,
}

impl Xtc {
    fn head(&mut self) -> Result<Option<Head>> {
        let Some(magic) = self.words.start(&[MAGIC, MAGIC_LARGE])? else { return Ok(None) };
        let atoms = self.words.i32()?;
        // Step and time.
        self.words.skip(8)?;
        let vectors = self.words.reals(9, 4)?;
        let again = self.words.i32()?;
        let count = u64::try_from(atoms).ok().filter(|_| atoms == again);
        let atoms = count
            .ok_or_else(|| Error::malformed(format!("found {atoms} and {again} as numbers of atoms")))?;
        Ok(Some(Head { atoms, vectors, is_large: magic == MAGIC_LARGE }))
    }

    /// Bytes of the compressed coordinates.
    fn len(&mut self, head: &Head) -> Result<u64> {
        let len = if head.is_large { self.words.u64()? } else { u64::from(self.words.u32()?) };
        // Each atom takes a bit or more.
        if head.atoms.div_ceil(8) > len {
            let atoms = head.atoms;
            return Err(Error::malformed(format!("found {len} bytes of coordinates for {atoms} atoms")));
        }
        Ok(len)
    }

    fn compressed(&mut self, head: &Head) -> Result<(Vec<Point3>, Coordinates)> {
        let precision = self.words.f32()?;
        if !(precision > 0.0 && precision.is_finite()) {
            return Err(Error::malformed(format!("found {precision} as the precision")));
        }
        let mut bounds = [[0; 3]; 2];
        for bound in bounds.as_flattened_mut() {
            *bound = i64::from(self.words.i32()?);
        }
        let index = self.words.u32()?;
        let len = self.len(head)?;
        let bytes = self.words.bytes(len)?;
        self.words.skip(padding(len))?;
        let decoder = Decoder::new(bounds, index, &bytes)?;
        let integers = decoder.decode(head.atoms as usize)?;
        Ok(points(integers, precision))
    }
}

impl Frames for Xtc {
    fn next(&mut self, atoms: Option<u64>) -> Result<Option<Content>> {
        let Some(head) = self.head()? else { return Ok(None) };
        check_count(head.atoms, atoms.unwrap_or(head.atoms))?;
        let points = if head.atoms <= ATOMS_PLAIN {
            of_nanometres(&self.words.reals(3 * head.atoms, 4)?)?
        } else {
            self.compressed(&head)?
        };
        Ok(Some(Content::Points(Positions::new(points, PeriodicBox::of_nanometres(&head.vectors)))))
    }

    fn skip(&mut self) -> Result<bool> {
        let Some(head) = self.head()? else { return Ok(false) };
        if head.atoms <= ATOMS_PLAIN {
            self.words.skip(12 * head.atoms)?;
        } else {
            self.words.skip(8 * 4)?;
            let len = self.len(&head)?;
            self.words.skip(len)?;
            self.words.skip(padding(len))?;
        }
        Ok(true)
    }

    fn position(&self) -> Option<String> {
        Some(format!("byte {}", self.words.position()))
    }
}

/// Bytes up to a multiple of four.
fn padding(len: u64) -> u64 {
    len.wrapping_neg() % 4
}

/// Most decimal places of a unit of Å in which integers are stored, and the least.
const PLACES: std::ops::RangeInclusive<i32> = 3..=6;

/// Points of integers in steps of 1 nm / `precision`. With a usual precision, they are integers of a unit of
/// structures.
fn points(integers: Vec<[i64; 3]>, precision: f32) -> (Vec<Point3>, Coordinates) {
    let tens = (0..=7).find(|&tens| 10f32.powi(tens) == precision);
    if let Some(tens) = tens {
        // 1 nm is 10 Å.
        let places = (tens - 1).clamp(*PLACES.start(), *PLACES.end());
        let factor = 10i64.pow((places + 1 - tens) as u32);
        let most = i64::from(i32::MAX) / factor;
        if integers.as_flattened().iter().all(|value| value.abs() <= most) {
            let scale = 10f64.powi(places).recip();
            let points =
                integers.into_iter().map(|point| point.map(|value| (value * factor) as f64)).collect();
            return (points, Coordinates::I32 { scale: [scale; 3], offset: [0.0; 3] });
        }
    }
    let place = |value: i64| 10.0 * value as f64 / f64::from(precision);
    (integers.into_iter().map(|point| point.map(place)).collect(), Coordinates::F64)
}

/// Decodes the coordinates of a frame.
struct Decoder<'b> {
    bits: Bits<'b>,
    min: [i64; 3],
    /// Number of values of each axis.
    extents: [u64; 3],
    /// Bits of the three coordinates together, or else of each.
    widths: Widths,
    /// Index of the range of small distances.
    index: usize,
}

#[derive(Clone, Copy)]
enum Widths {
    Together(u32),
    Each([u32; 3]),
}

impl<'b> Decoder<'b> {
    fn new([min, max]: [[i64; 3]; 2], index: u32, bytes: &'b [u8]) -> Result<Decoder<'b>> {
        let extents = [0, 1, 2].map(|axis| u64::try_from(max[axis] - min[axis] + 1).unwrap_or(0));
        if extents.contains(&0) {
            return Err(Error::malformed(format!("found {min:?} and {max:?} as least and greatest numbers")));
        }
        let len = |number: u128| u128::BITS - number.leading_zeros();
        let widths = if extents.iter().any(|&extent| extent > EXTENT_MAX) {
            Widths::Each(extents.map(|extent| len(u128::from(extent))))
        } else {
            Widths::Together(len(extents.into_iter().map(u128::from).product()))
        };
        let index = usize::try_from(index).map_err(|_| wrong_index())?;
        Ok(Decoder { bits: Bits { bytes, at: 0 }, min, extents, widths, index })
    }

    fn decode(mut self, atoms: usize) -> Result<Vec<[i64; 3]>> {
        // At most eight times the bytes that have arrived.
        let mut points = Vec::with_capacity(atoms);
        let mut run = 0;
        while points.len() < atoms {
            let first = self.first()?;
            // How the range changes: to the one below, not at all, or to the one above.
            let mut step = 1;
            if self.bits.take(1)? == 1 {
                let code = self.bits.take(5)? as usize;
                (run, step) = (code / 3, code % 3);
            }
            if points.len() + run + 1 > atoms {
                return Err(Error::malformed("a run of coordinates goes beyond the last atom"));
            }
            self.run(first, run, &mut points)?;
            self.index = match step {
                0 => self.index.checked_sub(1).ok_or_else(wrong_index)?,
                1 => self.index,
                _ => self.index + 1,
            };
        }
        Ok(points)
    }

    /// An atom by its place in the bounding box.
    fn first(&mut self) -> Result<[i64; 3]> {
        let mut place = match self.widths {
            Widths::Together(width) => self.bits.split(width, self.extents)?,
            Widths::Each(widths) => {
                let mut place = [0; 3];
                for (number, width) in place.iter_mut().zip(widths) {
                    *number = self.bits.take(width)? as i64;
                }
                place
            }
        };
        place.iter_mut().zip(self.min).for_each(|(number, min)| *number += min);
        Ok(place)
    }

    /// The atoms of a run by their distances. The second one is stored before the first, as the oxygen of
    /// water is near both hydrogens.
    fn run(&mut self, first: [i64; 3], len: usize, points: &mut Vec<[i64; 3]>) -> Result<()> {
        if len == 0 {
            points.push(first);
            return Ok(());
        }
        let range = *RANGES.get(self.index).filter(|&&range| range > 0).ok_or_else(wrong_index)?;
        let mut last = first;
        for at in 0..len {
            let distances = self.bits.split(self.index as u32, [u64::from(range); 3])?;
            let next = [0, 1, 2].map(|axis| last[axis] + distances[axis] - i64::from(range / 2));
            points.push(next);
            if at == 0 {
                points.push(first);
            }
            last = next;
        }
        Ok(())
    }
}

fn wrong_index() -> Error {
    Error::malformed("the range of small distances is none of the format")
}

/// Bits of bytes, from the highest of the first on.
struct Bits<'b> {
    bytes: &'b [u8],
    /// Number of the next bit.
    at: usize,
}

impl Bits<'_> {
    /// The next `width` bits as a number; at most 32.
    fn take(&mut self, width: u32) -> Result<u64> {
        let start = self.at / 8;
        let end = self.at + width as usize;
        if end > 8 * self.bytes.len() {
            return Err(Error::malformed("the coordinates end before the last atom"));
        }
        let mut word = [0; 8];
        let rest = &self.bytes[start..self.bytes.len().min(start + 8)];
        word[..rest.len()].copy_from_slice(rest);
        let word = u64::from_be_bytes(word) << (self.at % 8);
        self.at = end;
        Ok(if width == 0 { 0 } else { word >> (64 - width) })
    }

    /// The next `width` bits, at most 72, as three numbers below `extents`. Bytes of the number come with the
    /// lowest first; the bits that fill no byte are the highest.
    fn split(&mut self, width: u32, extents: [u64; 3]) -> Result<[i64; 3]> {
        let mut number: u128 = 0;
        let mut shift = 0;
        while shift < width {
            let part = (width - shift).min(8);
            number |= u128::from(self.take(part)?) << shift;
            shift += part;
        }
        let [_, y, z] = extents;
        if let Ok(mut number) = u64::try_from(number) {
            let third = number % z;
            number /= z;
            return Ok([number / y, number % y, third].map(u64::cast_signed));
        }
        let (rest, third) = (number / u128::from(z), number % u128::from(z));
        Ok([(rest / u128::from(y)) as i64, (rest % u128::from(y)) as i64, third as i64])
    }
}
