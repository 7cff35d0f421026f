//! Inputs by number: first the samples, then mutants of them. Seed and number determine the bytes.

use crate::samples::Samples;
use spmesh_reference::sets::Random;

/// Most bytes of an input.
const INPUT_MAX: usize = 1 << 17;
/// Bytes of the headers of most formats.
const HEAD: usize = 256;
/// Bytes of random points.
const POINTS_MAX: i64 = 1200;

/// Integers that readers often handle wrongly.
const INTEGERS: [i64; 14] =
    [0, 1, -1, 2, 0x7f, 0x80, 0xff, 0x7fff, 0xffff, 0x7fff_ffff, 0xffff_ffff, 1 << 32, i64::MAX, i64::MIN];
/// Numbers as text.
const NUMBERS: [&str; 16] = [
    "0",
    "-0",
    "1",
    "-1",
    "nan",
    "inf",
    "1e308",
    "-1e-320",
    "255",
    "65536",
    "2147483647",
    "4294967296",
    "99999999999999999999",
    "0.1",
    "",
    "1e400",
];

/// The inputs of a seed.
pub struct Inputs {
    samples: Vec<Vec<u8>>,
    seed: u64,
}

impl Inputs {
    /// Inputs of a seed that start with these samples.
    #[must_use]
    pub fn new(samples: Samples, seed: u64) -> Self {
        Inputs { samples: samples.load(), seed }
    }

    /// How many of the first inputs are no mutants: the samples, or a few sets of random bytes.
    #[must_use]
    pub fn first(&self) -> u64 {
        if self.samples.is_empty() { 50 } else { self.samples.len() as u64 }
    }

    /// The input with a number: a sample, or a mutant of one.
    #[must_use]
    pub fn input(&self, number: u64) -> Vec<u8> {
        let mut random =
            Random::new(self.seed.wrapping_mul(0x9e6c_63d0_876a_9a37) ^ Random::new(number).bits());
        if self.samples.is_empty() {
            let count = random.integer(0, POINTS_MAX) as usize >> random.integer(0, 6);
            return (0..count).map(|_| random.bits() as u8).collect();
        }
        if let Some(sample) = usize::try_from(number).ok().and_then(|number| self.samples.get(number)) {
            return sample.clone();
        }
        let mut bytes = self.sample(&mut random).to_vec();
        for _ in 0..1 << random.integer(0, 4) {
            self.mutate(&mut bytes, &mut random);
        }
        bytes.truncate(INPUT_MAX);
        bytes
    }

    fn sample(&self, random: &mut Random) -> &[u8] {
        &self.samples[below(random, self.samples.len())]
    }

    fn mutate(&self, bytes: &mut Vec<u8>, random: &mut Random) {
        // Other changes make most texts nonsense.
        if std::str::from_utf8(bytes).is_ok() && random.integer(0, 1) == 0 {
            let at = below(random, bytes.len() + 1);
            return replace_number(bytes, at, random);
        }
        // Half of the changes are near the start, where lengths and counts are.
        let end = if random.integer(0, 1) == 0 { bytes.len().min(HEAD) } else { bytes.len() };
        let at = below(random, end + 1);
        let rest = bytes.len() - at;
        let short = random.integer(0, 12) as usize;
        match random.integer(0, 11) {
            0 | 1 if rest > 0 => bytes[at] ^= 1 << random.integer(0, 7),
            2 if rest > 0 => bytes[at] = random.bits() as u8,
            // A length that is one too few, or one too many.
            10 | 11 if rest > 0 => {
                bytes[at] = bytes[at].wrapping_add_signed(random.integer(0, 1) as i8 * 2 - 1)
            }
            3 | 4 => overwrite(bytes, at, random),
            5 => drop(bytes.drain(at..at + short.min(rest))),
            6 => {
                let piece = bytes[at..at + short.min(rest)].to_vec();
                let to = below(random, bytes.len() + 1);
                bytes.splice(to..to, piece);
            }
            7 => replace_number(bytes, at, random),
            8 => {
                let other = self.sample(random);
                let from = below(random, other.len() + 1);
                let piece = &other[from..(from + 64).min(other.len())];
                bytes.splice(at..at + piece.len().min(rest), piece.iter().copied());
            }
            9 if random.integer(0, 3) == 0 => bytes.truncate(at),
            _ => {}
        }
    }
}

fn below(random: &mut Random, count: usize) -> usize {
    (random.bits() % count.max(1) as u64) as usize
}

/// Writes an integer over 1, 2, 4 or 8 bytes, in either order.
fn overwrite(bytes: &mut [u8], at: usize, random: &mut Random) {
    let number = INTEGERS[below(random, INTEGERS.len())].wrapping_add(random.integer(-1, 1));
    let width = 1 << random.integer(0, 3);
    let mut word = number.to_le_bytes()[..width].to_vec();
    if random.integer(0, 2) == 0 {
        word.reverse();
    }
    for (to, from) in bytes[at..].iter_mut().zip(word) {
        *to = from;
    }
}

/// Replaces the first number of a text at or after `at`: by one that readers often handle wrongly, or, if it
/// is whole, by one of its neighbours, as an index that is one too many.
fn replace_number(bytes: &mut Vec<u8>, at: usize, random: &mut Random) {
    let is_digit = |byte: &u8| matches!(byte, b'0'..=b'9' | b'.' | b'-' | b'+');
    let Some(start) = bytes[at..].iter().position(is_digit).map(|from| at + from) else { return };
    let length = bytes[start..].iter().take_while(|byte| is_digit(byte)).count();
    let end = start + length;
    let old = std::str::from_utf8(&bytes[start..end]).ok().and_then(|text| text.parse::<i64>().ok());
    let new = match old {
        Some(old) if random.integer(0, 1) == 0 => old.wrapping_add(2 * random.integer(0, 1) - 1).to_string(),
        _ => NUMBERS[below(random, NUMBERS.len())].to_string(),
    };
    bytes.splice(start..end, new.into_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_and_a_number_fix_the_input() {
        let inputs = |seed| -> Vec<Vec<u8>> {
            let inputs = Inputs::new(Samples::Texts(&["v 1 2 3\n", "f 1 2 3\n"]), seed);
            (0..50).map(|number| inputs.input(number)).collect()
        };
        assert_eq!(inputs(1), inputs(1));
        assert_ne!(inputs(1), inputs(2));
        assert_eq!(inputs(1)[..2], [b"v 1 2 3\n", b"f 1 2 3\n"]);
    }
}
