//! The encoder's choice of the parameter of a column: the one with the least estimated size.

use super::columns::bit_length;

/// The parameters among which the encoder chooses.
const K_MIN: u32 = 2;
const K_MAX: u32 = 5;
/// Numbers below this are tokens of their own for the greatest parameter.
const DIRECT: usize = 2 << K_MAX;
/// Tokens of the greatest parameter for numbers of 32 bits.
const TOKENS: usize = DIRECT + ((32 - (K_MAX as usize + 1)) << K_MAX);
/// Bits that a Huffman code takes to describe a token.
const TOKEN_BITS: u32 = 4;

/// How often each token of the greatest parameter occurs.
struct Histogram {
    counts: [u32; TOKENS],
    /// One past the greatest token that occurs, up to the end of its magnitude.
    end: usize,
    /// All bits that occur.
    union: u32,
}

/// The parameter for a column that is compressed in so many segments.
pub(super) fn choose_k(numbers: &[u32], segments: usize) -> u32 {
    let histogram = Histogram::of(numbers);
    let fits = |&k: &u32| match k {
        4 => histogram.union < 1 << 19,
        5 => histogram.union < 1 << 12,
        _ => true,
    };
    let constant = n_log_n(numbers.len() as u32);
    let sizes = (K_MIN..=K_MAX).filter(fits).map(|k| (constant + histogram.size(k, segments), k));
    sizes.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(K_MIN, |(_, k)| k)
}

impl Histogram {
    fn of(numbers: &[u32]) -> Histogram {
        let mut counts = [0; TOKENS];
        let mut union = 0;
        for &number in numbers {
            union |= number;
            let raw = if number < DIRECT as u32 { 0 } else { 31 - K_MAX - number.leading_zeros() };
            counts[((raw << K_MAX) + (number >> raw)) as usize] += 1;
        }
        let magnitudes = bit_length(union).saturating_sub(K_MAX + 1) as usize;
        Histogram { counts, end: DIRECT + (magnitudes << K_MAX), union }
    }

    /// Estimated size of the column in bits, apart from what all parameters have in common.
    fn size(&self, k: u32, segments: usize) -> f32 {
        let (mut entropy, mut raw, mut used) = (0f32, 0f32, 0u32);
        let mut add = |count: u32, bits: u32| {
            if count > 0 {
                entropy += n_log_n(count);
                raw += (count * bits) as f32;
                used += 1;
            }
        };
        self.counts[..2 << k].iter().for_each(|&count| add(count, 0));
        // Tokens below the middle are numbers, of which this k joins runs of a power of two.
        let mut first = 2usize << k;
        while first < DIRECT {
            let bits = 31 - (first as u32).leading_zeros() - k;
            add(self.counts[first..first + (1 << bits)].iter().sum(), bits);
            first += 1 << bits;
        }
        let joined = 1usize << (K_MAX - k);
        while first < self.end {
            let bits = (first >> K_MAX) as u32 - 1 + K_MAX - k;
            add(self.counts[first..first + joined].iter().sum(), bits);
            first += joined;
        }
        raw - entropy + (used * TOKEN_BITS) as f32 * segments as f32
    }
}

/// About n log2 n. It uses no library function, so that all machines choose the same.
fn n_log_n(n: u32) -> f32 {
    if n == 0 {
        return 0.0;
    }
    let n = n as f32;
    let exponent = (n.to_bits() >> 23) as f32 - 127.0;
    let mantissa = f32::from_bits((n.to_bits() & 0x7f_ffff) | 0x3f80_0000);
    n * (exponent + (2.0 - 0.335_828_78 * mantissa) * mantissa - 1.658_71)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_can_be_coded_with_the_choice() {
        for numbers in
            [vec![], vec![0; 9], vec![u32::MAX], (0..5000).collect(), (0..1 << 19).step_by(99).collect()]
        {
            let k = choose_k(&numbers, 1);
            let greatest: u32 = numbers.iter().fold(0, |union, number| union | number);
            let raw = if greatest < 2 << k { 0 } else { 31 - k - greatest.leading_zeros() };
            assert!((raw << k) + (greatest >> raw) < 256, "{k} for up to {greatest}");
        }
    }

    #[test]
    fn logarithms_are_about_right() {
        for n in [1u32, 2, 3, 100, 65_537, 1 << 20] {
            let exact = f64::from(n) * f64::from(n).log2();
            assert!((f64::from(n_log_n(n)) - exact).abs() <= 0.01 * f64::from(n), "{n}");
        }
    }
}
