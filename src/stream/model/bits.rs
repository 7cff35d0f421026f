//! Interleaved bits of two or three integers: Morton keys, and location codes of cells.

/// Moves bit i to bit 2i.
#[inline(always)]
pub fn spread2(x: u32) -> u64 {
    let mut x = u64::from(x);
    x = (x | x << 16) & 0x0000_ffff_0000_ffff;
    x = (x | x << 8) & 0x00ff_00ff_00ff_00ff;
    x = (x | x << 4) & 0x0f0f_0f0f_0f0f_0f0f;
    x = (x | x << 2) & 0x3333_3333_3333_3333;
    (x | x << 1) & 0x5555_5555_5555_5555
}

/// Undoes [`spread2`]: moves bit 2i to bit i and ignores odd bits.
#[inline(always)]
pub(crate) fn gather2(x: u64) -> u32 {
    let mut x = x & 0x5555_5555_5555_5555;
    x = (x | x >> 1) & 0x3333_3333_3333_3333;
    x = (x | x >> 2) & 0x0f0f_0f0f_0f0f_0f0f;
    x = (x | x >> 4) & 0x00ff_00ff_00ff_00ff;
    x = (x | x >> 8) & 0x0000_ffff_0000_ffff;
    (x | x >> 16) as u32
}

/// Moves bit i to bit 3i, for the lowest 21 bits.
#[inline(always)]
pub fn spread3(x: u32) -> u64 {
    let mut x = u64::from(x) & 0x1f_ffff;
    x = (x | x << 32) & 0x001f_0000_0000_ffff;
    x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

/// Undoes [`spread3`]: moves bit 3i to bit i and ignores the other bits.
#[inline(always)]
pub fn gather3(x: u64) -> u32 {
    let mut x = x & 0x1249_2492_4924_9249;
    x = (x | x >> 2) & 0x10c3_0c30_c30c_30c3;
    x = (x | x >> 4) & 0x100f_00f0_0f00_f00f;
    x = (x | x >> 8) & 0x001f_0000_ff00_00ff;
    x = (x | x >> 16) & 0x001f_0000_0000_ffff;
    (x | x >> 32) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_bits_gather_again() {
        for value in [0, 1, 2, 0x1f_ffff, 0x15_5555, 0x0a_aaaa] {
            assert_eq!(gather2(spread2(value) | spread2(!value) << 1), value);
            assert_eq!(gather3(spread3(value) | spread3(!value) << 1 | spread3(!value) << 2), value);
        }
        assert_eq!(spread2(0b11), 0b101);
        assert_eq!(spread3(0b11), 0b1001);
        assert_eq!(spread2(u32::MAX), 0x5555_5555_5555_5555);
    }
}
