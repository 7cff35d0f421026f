//! Columns of numbers as tokens and bits.
//!
//! A column has a parameter k. A number below 2^(k+1) is its own token. Of a greater one, the token holds the
//! k + 1 leading bits and how many follow, and the bits that follow go to the bit stream, which all columns
//! of a payload share.

use super::Fault;
use super::choice::choose_k;
use super::frames::Packer;

/// Greatest parameter of a column: with it every token is a number.
const K_MAX: u8 = 7;
/// Zeros behind the bits, so that a whole word can be read anywhere.
const PADDING: usize = 8;

/// 0, -1, 1, -2, ... as 0, 1, 2, 3, ...
pub(super) fn zigzag(number: i32) -> u32 {
    ((number << 1) ^ (number >> 31)) as u32
}

/// The inverse of [`zigzag`].
pub(super) fn unzigzag(code: u32) -> i32 {
    ((code >> 1) as i32) ^ -((code & 1) as i32)
}

/// The number of bits of a number, without leading zeros.
pub(super) fn bit_length(number: u32) -> u32 {
    u32::BITS - number.leading_zeros()
}

/// Encodes columns.
#[derive(Default)]
pub(super) struct ColumnWriter {
    tokens: Vec<u8>,
    /// Where in the tokens the distribution changes.
    cuts: Vec<usize>,
    bits: Vec<u8>,
    /// Bits that are no whole word yet, and how many.
    pending: u64,
    pending_len: u32,
}

impl ColumnWriter {
    /// Appends bytes that are tokens as they are.
    pub(super) fn bytes(&mut self, bytes: &[u8]) {
        self.tokens.extend_from_slice(bytes);
        self.cuts.push(self.tokens.len());
    }

    /// Appends a column and returns its k.
    pub(super) fn column(&mut self, numbers: &[u32]) -> u8 {
        self.sorted_column(numbers, &[])
    }

    /// Appends a column whose distribution changes at `cuts`; returns its k.
    pub(super) fn sorted_column(&mut self, numbers: &[u32], cuts: &[usize]) -> u8 {
        let k = choose_k(numbers, cuts.len() + 1);
        let start = self.tokens.len();
        self.cuts.extend(cuts.iter().map(|cut| start + cut));
        self.tokens.resize(start + numbers.len(), 0);
        self.bits.reserve(4 * numbers.len() + PADDING);
        let (mut pending, mut pending_len) = (self.pending, self.pending_len);
        for (token, &number) in self.tokens[start..].iter_mut().zip(numbers) {
            let raw = if number < 2 << k { 0 } else { 31 - k - number.leading_zeros() };
            *token = ((raw << k) + (number >> raw)) as u8;
            pending |= u64::from(number & ((1 << raw) - 1)) << pending_len;
            pending_len += raw;
            if pending_len >= 32 {
                self.bits.extend_from_slice(&(pending as u32).to_le_bytes());
                pending >>= 32;
                pending_len -= 32;
            }
        }
        (self.pending, self.pending_len) = (pending, pending_len);
        self.cuts.push(self.tokens.len());
        k as u8
    }

    /// Appends length and frame of the tokens, then the bits.
    pub(super) fn finish(mut self, packer: &mut Packer, compressed: &mut Vec<u8>) {
        let last = self.pending.to_le_bytes();
        self.bits.extend_from_slice(&last[..self.pending_len.div_ceil(8) as usize]);
        let frame = packer.tokens(&self.tokens, &self.cuts);
        compressed.extend_from_slice(&(frame.len() as u32).to_le_bytes());
        compressed.extend_from_slice(frame);
        compressed.extend_from_slice(&self.bits);
    }
}

/// Decodes columns.
pub(super) struct ColumnReader<'a> {
    tokens: &'a [u8],
    /// The bits, with padding; the next bit, and one past the last.
    bits: Vec<u8>,
    next: usize,
    end: usize,
}

impl<'a> ColumnReader<'a> {
    pub(super) fn new(tokens: &'a [u8], bits: &[u8]) -> Self {
        let mut padded = Vec::with_capacity(bits.len() + PADDING);
        padded.extend_from_slice(bits);
        padded.resize(bits.len() + PADDING, 0);
        ColumnReader { tokens, bits: padded, next: 0, end: 8 * bits.len() }
    }

    /// Tokens that are bytes as they are.
    pub(super) fn bytes(&mut self, count: usize) -> Result<&'a [u8], Fault> {
        let (taken, rest) = self.tokens.split_at_checked(count).ok_or("too few tokens")?;
        self.tokens = rest;
        Ok(taken)
    }

    /// A column of `count` numbers with the parameter `k`.
    pub(super) fn column(&mut self, count: usize, k: u8) -> Result<Vec<u32>, Fault> {
        let codes = codes(k)?;
        let tokens = self.bytes(count)?;
        // Tokens of great k stand for numbers, all of them.
        if k < 4 && tokens.iter().any(|&token| codes[usize::from(token)].is_none()) {
            return Err("a token stands for no number of 32 bits");
        }
        let codes = codes.map(Option::unwrap_or_default);
        let (mut next, last) = (self.next, self.bits.len() - PADDING);
        let bits = &self.bits[..];
        let number = |&token: &u8| {
            let Code { raw, base } = codes[usize::from(token)];
            let at = (next >> 3).min(last);
            let word = u64::from_le_bytes(bits[at..at + PADDING].try_into().expect("eight bytes"));
            let low = (word >> (next & 7)) as u32 & ((1 << raw) - 1);
            next += raw as usize;
            base | low
        };
        let numbers = tokens.iter().map(number).collect();
        if next > self.end {
            return Err("too few bits");
        }
        self.next = next;
        Ok(numbers)
    }

    /// Checks that nothing is left but the rest of the last byte of bits.
    pub(super) fn check_end(&self) -> Result<(), Fault> {
        if !self.tokens.is_empty() {
            return Err("tokens are left");
        }
        if self.end - self.next >= 8 {
            return Err("bits are left");
        }
        Ok(())
    }
}

/// What a token stands for: the number `base` with `raw` more bits.
#[derive(Debug, Clone, Copy, Default)]
struct Code {
    raw: u32,
    base: u32,
}

/// The numbers that tokens stand for; `None` for those beyond 32 bits.
fn codes(k: u8) -> Result<[Option<Code>; 256], Fault> {
    if k > K_MAX {
        return Err("a parameter k above 7");
    }
    Ok(std::array::from_fn(|token| {
        let token = token as u32;
        if token < 2 << k {
            return Some(Code { raw: 0, base: token });
        }
        let raw = (token >> k) - 1;
        let is_number = raw + u32::from(k) < u32::BITS;
        is_number.then(|| Code { raw, base: (token - (raw << k)) << raw })
    }))
}

#[cfg(test)]
mod tests {
    use super::super::bytes::Bytes;
    use super::super::frames::Unpacker;
    use super::*;

    #[test]
    fn zigzag_goes_both_ways() {
        for number in [0, 1, -1, 5, i32::MAX, i32::MIN] {
            assert_eq!(unzigzag(zigzag(number)), number);
        }
        assert_eq!([0, -1, 1, -2].map(zigzag), [0, 1, 2, 3]);
    }

    #[test]
    fn columns_come_back() {
        let columns: [Vec<u32>; 5] = [
            vec![],
            (0..1000).collect(),
            (0..32).flat_map(|bit| [1 << bit, (1u32 << bit).wrapping_sub(1)]).collect(),
            vec![u32::MAX; 300],
            vec![3],
        ];
        let mut writer = ColumnWriter::default();
        let parameters: Vec<u8> = columns.iter().map(|column| writer.column(column)).collect();
        let mut compressed = Vec::new();
        writer.finish(&mut Packer::default(), &mut compressed);
        let mut bytes = Bytes(&compressed);
        let len = bytes.count().unwrap();
        let mut unpacker = Unpacker::default();
        let tokens = unpacker.unpack(bytes.take(len).unwrap(), 5000).unwrap();
        let mut reader = ColumnReader::new(tokens, bytes.0);
        for (column, k) in columns.iter().zip(parameters) {
            assert_eq!(&reader.column(column.len(), k).unwrap(), column);
        }
        reader.check_end().unwrap();
    }

    #[test]
    fn tokens_beyond_32_bits_are_refused() {
        // k = 3: token 239 has 28 raw bits behind 15, token 240 would have 29 behind 8.
        let bits = [0xff; 8];
        let column = |k, token| ColumnReader::new(&[token], &bits).column(1, k);
        assert_eq!(column(3, 239), Ok(vec![u32::MAX]));
        column(3, 240).unwrap_err();
        column(0, 32).unwrap();
        column(0, 33).unwrap_err();
        column(8, 0).unwrap_err();
        assert_eq!(column(7, 255), Ok(vec![255]));
    }

    #[test]
    fn missing_bits_are_noticed() {
        let column = |bits: &[u8]| ColumnReader::new(&[255, 255], bits).column(2, 4);
        column(&[0; 4]).unwrap();
        column(&[0; 3]).unwrap_err();
        column(&[]).unwrap_err();
    }
}
