//! The Hilbert curve through cells on two, three or four axes.
//!
//! Orientations of the curve, and how a cell passes one on to its parts, are those of Hamilton ("Compact
//! Hilbert indices", 2006), for any number of axes; several bits per axis are looked up at once.

/// For each orientation of the curve, and some bits of each axis, the first axis above the others: the place
/// on the curve, above the orientation within that cell.
struct Table<const ORIENTATIONS: usize, const CELLS: usize>([[u16; CELLS]; ORIENTATIONS]);

/// Four bits per axis.
static PLANE: Table<8, 256> = Table::new(Step { axes: 2, bits: 4 });

/// Two bits per axis.
static SPACE: Table<32, 64> = Table::new(Step { axes: 3, bits: 2 });

/// One bit per axis.
static SPACE_TIME: Table<128, 16> = Table::new(Step { axes: 4, bits: 1 });

impl<const ORIENTATIONS: usize, const CELLS: usize> Table<ORIENTATIONS, CELLS> {
    const fn new(step: Step) -> Self {
        assert!(CELLS == 1 << (step.axes * step.bits) && ORIENTATIONS == 1 << step.orientation_bits());
        let mut table = [[0; CELLS]; ORIENTATIONS];
        let mut orientation = 0;
        while orientation < ORIENTATIONS {
            let mut cell = 0;
            while cell < CELLS {
                table[orientation][cell] = step.descend(orientation as u32, cell as u32);
                cell += 1;
            }
            orientation += 1;
        }
        Table(table)
    }
}

/// What is looked up at once.
#[derive(Debug, Clone, Copy)]
struct Step {
    axes: u32,
    /// Bits of each axis.
    bits: u32,
}

impl Step {
    /// The step for cells on `D` axes.
    const fn of<const D: usize>() -> Step {
        assert!(D == 2 || D == 3 || D == 4);
        Step { axes: D as u32, bits: 1 << (4 - D) }
    }

    /// An orientation is by how many axes the curve is rotated, above a bit per axis for whether that is
    /// reversed.
    const fn orientation_bits(self) -> u32 {
        2 * self.axes - 1
    }

    /// An entry of the table: one bit of each axis after the other.
    const fn descend(self, orientation: u32, cell: u32) -> u16 {
        let n = self.axes;
        let all = (1 << n) - 1;
        let (mut reversed, mut rotation) = (orientation & all, (orientation >> n) % n);
        let mut place = 0;
        let mut level = self.bits;
        while level > 0 {
            level -= 1;
            let turned = self.part(cell, level) ^ reversed;
            let gray = (turned >> rotation | turned << (n - rotation)) & all;
            let part = gray ^ gray >> 1 ^ gray >> 2 ^ gray >> 3;
            place = place << n | part;
            // The corner of that part where the curve enters, and the axis along which it leaves.
            let (entry, exit) = match part {
                0 => (0, 0),
                _ => (gray_code((part - 1) & !1), ((part - 1) | 1).trailing_ones()),
            };
            reversed ^= (entry << rotation | entry >> (n - rotation)) & all;
            rotation = (rotation + exit + 1) % n;
        }
        (place << self.orientation_bits() | rotation << n | reversed) as u16
    }

    /// One bit of each axis.
    const fn part(self, cell: u32, level: u32) -> u32 {
        let mut part = 0;
        let mut axis = self.axes;
        while axis > 0 {
            axis -= 1;
            part = part << 1 | (cell >> (axis * self.bits + level) & 1);
        }
        part
    }
}

const fn gray_code(number: u32) -> u32 {
    number ^ number >> 1
}

/// Place on the curve of a cell among `2^bits` on each of `D` axes.
///
/// Domain: `D` 2, 3 or 4; `bits` at most 16, 10 or 8; numbers of cells below `2^bits`.
#[inline(always)]
pub(super) fn hilbert_key<const D: usize>(cell: [u32; D], bits: u32) -> u32 {
    let step = const { Step::of::<D>() };
    let steps = bits.div_ceil(step.bits);
    let spare = steps * step.bits - bits;
    let cell = cell.map(|number| number << spare);
    let (mut orientation, mut place) = (0, 0);
    for shift in (0..steps).rev().map(|number| number * step.bits) {
        let digit = |number: u32| (number >> shift & ((1 << step.bits) - 1)) as usize;
        let column = cell.iter().fold(0, |column, &number| column << step.bits | digit(number));
        let entry = match D {
            2 => PLANE.0[orientation & 7][column],
            3 => SPACE.0[orientation & 31][column],
            _ => SPACE_TIME.0[orientation & 127][column],
        };
        place = place << (step.axes * step.bits) | u32::from(entry >> step.orientation_bits());
        orientation = usize::from(entry);
    }
    place >> (step.axes * spare)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that each cell has a place of its own, and that the next place is a neighbouring cell.
    fn check_steps<const D: usize>(bits: u32) {
        let count = 1u32 << (D as u32 * bits);
        let mut cells = vec![None; count as usize];
        for number in 0..count {
            let cell = std::array::from_fn(|axis| number >> (axis as u32 * bits) & ((1 << bits) - 1));
            assert_eq!(cells[hilbert_key::<D>(cell, bits) as usize].replace(cell), None);
        }
        let cells: Vec<[u32; D]> = cells.into_iter().map(|cell| cell.expect("all are visited")).collect();
        let distance =
            |p: [u32; D], q: [u32; D]| -> u32 { (0..D).map(|axis| p[axis].abs_diff(q[axis])).sum() };
        assert!(cells.windows(2).all(|pair| distance(pair[0], pair[1]) == 1), "{bits} bits, {D} axes");
        assert_eq!(cells[0], [0; D]);
    }

    #[test]
    fn the_curve_steps_from_cell_to_neighbouring_cell_and_visits_all() {
        (0..=8).for_each(check_steps::<2>);
        (0..=6).for_each(check_steps::<3>);
        (0..=4).for_each(check_steps::<4>);
    }

    #[test]
    fn a_finer_curve_passes_the_cells_of_a_coarser_one_in_their_order() {
        for (bits, [x, y, z]) in [(10, [1023, 512, 77]), (9, [300, 511, 0]), (7, [1, 90, 127])] {
            for coarse in 0..bits {
                let cell = [x, y, z].map(|number| number >> (bits - coarse));
                // Whether the number of bits is odd must not matter: it is filled up to a whole step.
                assert_eq!(hilbert_key([x, y, z], bits) >> (3 * (bits - coarse)), hilbert_key(cell, coarse));
            }
        }
    }

    #[test]
    fn keys_of_most_bits_per_axis_fill_their_word() {
        let corners = [[0, 0], [0, 65_535], [65_535, 65_535], [65_535, 0]];
        let keys = corners.map(|corner| hilbert_key(corner, 16));
        assert_eq!((keys[0], keys[3]), (0, u32::MAX));
        assert!(keys.is_sorted());
        let last = (1 << 10) - 1;
        let gray = [0, 1, 3, 2, 6, 7, 5, 4];
        let keys = gray.map(|bits: u32| hilbert_key([2, 1, 0].map(|axis| (bits >> axis & 1) * last), 10));
        assert_eq!((keys[0], keys[7]), (0, (1 << 30) - 1));
        // Each corner of the cube is in an eighth of its own.
        assert!(keys.iter().enumerate().all(|(eighth, key)| (key >> 27) as usize == eighth), "{keys:?}");
    }
}
