//! The Hilbert curve through a square of cells.

/// For each orientation of the curve, and 4 bits of x over 4 of y: 8 bits of the place on the curve, over 2 bits of
/// the orientation within that cell.
struct Table([[u16; 256]; ORIENTATIONS]);

/// Bit 0: x and y swapped; bit 1: both complemented.
const ORIENTATIONS: usize = 4;

const BITS_AT_ONCE: u32 = 4;

static TABLE: Table = Table::new();

impl Table {
    const fn new() -> Table {
        let mut table = [[0; 256]; ORIENTATIONS];
        let mut orientation = 0;
        while orientation < ORIENTATIONS {
            let mut cell = 0;
            while cell < 256 {
                table[orientation][cell] = descend(orientation, cell as u32);
                cell += 1;
            }
            orientation += 1;
        }
        Table(table)
    }
}

/// An entry of the table: one bit of x and y after the other.
const fn descend(mut orientation: usize, cell: u32) -> u16 {
    let mut place = 0;
    let mut level = BITS_AT_ONCE;
    while level > 0 {
        level -= 1;
        let (mut x, mut y) = (cell >> (BITS_AT_ONCE + level) & 1, cell >> level & 1);
        if orientation & 2 != 0 {
            (x, y) = (x ^ 1, y ^ 1);
        }
        if orientation & 1 != 0 {
            (x, y) = (y, x);
        }
        let quadrant = (3 * x) ^ y;
        place = place << 2 | quadrant as u16;
        match quadrant {
            0 => orientation ^= 1,
            3 => orientation ^= 3,
            _ => {}
        }
    }
    place << 2 | orientation as u16
}

/// Place on the curve of the cell (`x`, `y`) among `2^bits` by `2^bits`.
///
/// Domain: `bits` at most 16, `x` and `y` below `2^bits`.
#[inline(always)]
#[must_use]
pub fn hilbert_key(x: u32, y: u32, bits: u32) -> u32 {
    let steps = bits.div_ceil(BITS_AT_ONCE);
    let spare = steps * BITS_AT_ONCE - bits;
    let (x, y) = (x << spare, y << spare);
    let (mut orientation, mut place) = (0, 0);
    for step in (0..steps).rev() {
        let shift = step * BITS_AT_ONCE;
        let cell = (x >> shift & 15) << BITS_AT_ONCE | (y >> shift & 15);
        let entry = TABLE.0[orientation & 3][cell as usize];
        place = place << 8 | u32::from(entry >> 2);
        orientation = usize::from(entry);
    }
    place >> (2 * spare)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_steps_from_cell_to_neighbouring_cell_and_visits_all() {
        for bits in 0..=8 {
            let side = 1u32 << bits;
            let mut cells = vec![None; (side * side) as usize];
            for (x, y) in (0..side).flat_map(|x| (0..side).map(move |y| (x, y))) {
                assert_eq!(cells[hilbert_key(x, y, bits) as usize].replace((x, y)), None);
            }
            let cells: Vec<(u32, u32)> =
                cells.into_iter().map(|cell| cell.expect("all are visited")).collect();
            assert!(
                cells.windows(2).all(|w| w[0].0.abs_diff(w[1].0) + w[0].1.abs_diff(w[1].1) == 1),
                "{bits}"
            );
        }
    }

    #[test]
    fn keys_of_sixteen_bits_per_axis_fill_the_word() {
        let corners = [(0, 0), (0, 65_535), (65_535, 65_535), (65_535, 0)];
        let keys = corners.map(|(x, y)| hilbert_key(x, y, 16));
        assert_eq!((keys[0], keys[3]), (0, u32::MAX));
        assert!(keys.is_sorted());
    }
}
