//! A bit for each square of a grid.

/// Squares in columns and rows; each row starts with a new word.
#[derive(Debug, Default)]
pub(super) struct Bits {
    words: Vec<u64>,
    /// Words in a row.
    stride: usize,
}

impl Bits {
    /// A grid without any bit.
    pub(super) fn new([columns, rows]: [usize; 2]) -> Bits {
        let stride = columns.div_ceil(64);
        Bits { words: vec![0; stride * rows], stride }
    }

    pub(super) fn set(&mut self, [column, row]: [usize; 2]) {
        self.words[row * self.stride + column / 64] |= 1 << (column % 64);
    }

    pub(super) fn clear(&mut self, [column, row]: [usize; 2]) {
        self.words[row * self.stride + column / 64] &= !(1 << (column % 64));
    }

    pub(super) fn get(&self, [column, row]: [usize; 2]) -> bool {
        self.words[row * self.stride + column / 64] >> (column % 64) & 1 == 1
    }

    /// Whether a bit is set in a range of columns and rows, ends included.
    #[inline]
    pub(super) fn any(&self, [[left, right], [bottom, top]]: [[usize; 2]; 2]) -> bool {
        let [first, last] = [left / 64, right / 64];
        let (from, to) = (u64::MAX << (left % 64), u64::MAX >> (63 - right % 64));
        (bottom..=top).any(|row| {
            let words = &self.words[row * self.stride + first..=row * self.stride + last];
            match words {
                [word] => word & from & to != 0,
                [start, between @ .., end] => {
                    start & from != 0 || end & to != 0 || between.iter().any(|&word| word != 0)
                }
                [] => false,
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_have_the_bits_that_are_set() {
        let mut bits = Bits::new([200, 3]);
        for column in [0, 63, 64, 130, 199] {
            bits.set([column, 1]);
        }
        for left in 0..200 {
            for right in left..200 {
                let expected = [0, 63, 64, 130, 199].iter().any(|column| (left..=right).contains(column));
                assert_eq!(bits.any([[left, right], [0, 2]]), expected, "{left} to {right}");
                assert!(!bits.any([[left, right], [2, 2]]));
            }
        }
        bits.clear([64, 1]);
        assert!(!bits.get([64, 1]) && bits.get([63, 1]));
    }
}
