//! Tells which cells are cold: those that have got no points for long.

/// No cell is cold while waiting points take at most this many bytes of pages.
const WARM_LEN: u64 = 24 << 20;

/// A look for cold cells comes after so many points of the input, as a power of two.
const LOOK_BITS: u32 = 20;

/// A cell is cold if it got no point for more than so many looks.
const COLD_LOOKS: u32 = 4;

/// When each cell got its last points. Times are counted in looks.
pub(super) struct ColdCells {
    last_push: Vec<u32>,
    last_look: u32,
    pushed: u64,
    warm_len: u64,
    look_bits: u32,
}

impl ColdCells {
    pub(super) fn new(cells: usize) -> ColdCells {
        ColdCells::of(cells, WARM_LEN, LOOK_BITS)
    }

    pub(super) fn of(cells: usize, warm_len: u64, look_bits: u32) -> ColdCells {
        ColdCells { last_push: vec![0; cells], last_look: 0, pushed: 0, warm_len, look_bits }
    }

    /// Memory of all cells. Units: bytes.
    pub(super) fn bytes(&self) -> u64 {
        size_of_val(&self.last_push[..]) as u64
    }

    /// Counts points of a cell.
    pub(super) fn push(&mut self, cell: usize, count: u64) {
        self.pushed += count;
        self.last_push[cell] = self.now();
    }

    /// Whether it is time for a look, if so many bytes of pages are in use.
    pub(super) fn is_due(&self, in_use: u64) -> bool {
        self.now() != self.last_look && in_use > self.warm_len
    }

    /// Looks for the cold ones among cells.
    pub(super) fn look(&mut self, cells: impl Iterator<Item = usize>) -> Vec<usize> {
        self.last_look = self.now();
        cells.filter(|&cell| self.last_look - self.last_push[cell] > COLD_LOOKS).collect()
    }

    fn now(&self) -> u32 {
        (self.pushed >> self.look_bits) as u32
    }
}
