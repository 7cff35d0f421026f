//! The columns and the rows that points lie in.

use crate::delaunay2::half_edge::NONE;
use crate::predicates::Point2;

/// An axis may have this many times the square root of the number of points as values: grids may be long, but
/// a search among points in no grid must end soon.
const LONGEST: f64 = 16.0;

/// Slots of the smallest table.
const SLOTS_MIN: usize = 256;

/// 2^64 divided by the golden ratio: the upper bits of its multiples are spread (Knuth, 6.4).
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// How the axes of a grid lie to those of the coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Frame {
    /// Along them.
    Straight,
    /// At 45 degrees: the columns are those of x + y, the rows those of y - x.
    Diagonal,
}

impl Frame {
    /// A point in this frame; `None` if its coordinates there are no `f64`.
    ///
    /// If `sum - x` is y and `sum - y` is x, the sum is exact: one of the differences is, that from the
    /// coordinate of greater magnitude (Dekker, 1971).
    #[inline(always)]
    fn place(self, [x, y]: Point2) -> Option<Point2> {
        let exact_sum = |x: f64, y: f64| {
            let sum = x + y;
            (sum - x == y && sum - y == x).then_some(sum)
        };
        match self {
            Frame::Straight => Some([x, y]),
            Frame::Diagonal => Some([exact_sum(x, y)?, exact_sum(y, -x)?]),
        }
    }
}

/// The axes of the grid of the points.
#[derive(Debug, Default)]
pub(super) struct Axes {
    columns: Axis,
    rows: Axis,
}

impl Axes {
    /// Collects the columns and rows of all points, unless they are so many that half of the nodes would be
    /// without a point.
    pub(super) fn collect(&mut self, points: &[Point2], frame: Frame) -> bool {
        let most = 2 * points.len();
        let longest = (LONGEST * (points.len() as f64).sqrt()) as usize;
        self.columns.clear();
        self.rows.clear();
        for &point in points {
            let Some([u, v]) = frame.place(point) else { return false };
            if self.columns.insert(u) | self.rows.insert(v) {
                let [columns, rows] = self.counts();
                if columns * rows > most || columns.max(rows) > longest {
                    return false;
                }
            }
        }
        self.columns.rank();
        self.rows.rank();
        true
    }

    /// How many columns and rows.
    pub(super) fn counts(&self) -> [usize; 2] {
        [self.columns.values.len(), self.rows.values.len()]
    }

    /// The column and the row of one of the points.
    #[inline(always)]
    pub(super) fn node(&self, point: Point2, frame: Frame) -> [usize; 2] {
        let [u, v] = frame.place(point).expect("checked when the axes were collected");
        [self.columns.rank_of(u), self.rows.rank_of(v)]
    }
}

/// Distinct numbers, in a hash table.
#[derive(Debug, Default)]
struct Axis {
    /// A power of two.
    slots: Vec<Slot>,
    values: Vec<f64>,
}

#[derive(Debug, Clone, Copy)]
struct Slot {
    bits: u64,
    /// Rank of the value among all; `NONE` if the slot is empty.
    rank: u32,
}

const EMPTY: Slot = Slot { bits: 0, rank: NONE };

impl Axis {
    fn clear(&mut self) {
        self.values.clear();
        self.slots.clear();
        self.slots.resize(SLOTS_MIN, EMPTY);
    }

    /// Bits that are the same for equal numbers: those of -0 and 0.
    #[inline(always)]
    fn bits(value: f64) -> u64 {
        (value + 0.0).to_bits()
    }

    /// The slot of a number, or the empty one where it belongs.
    #[inline(always)]
    fn slot(&self, bits: u64) -> usize {
        let last = self.slots.len() - 1;
        let mut place = (bits.wrapping_mul(GOLDEN) >> (64 - self.slots.len().ilog2())) as usize;
        while self.slots[place].rank != NONE && self.slots[place].bits != bits {
            place = (place + 1) & last;
        }
        place
    }

    /// Adds a number; whether it is new.
    #[inline(always)]
    fn insert(&mut self, value: f64) -> bool {
        let bits = Self::bits(value);
        let place = self.slot(bits);
        let is_new = self.slots[place].rank == NONE;
        if is_new {
            self.slots[place] = Slot { bits, rank: 0 };
            self.values.push(value);
            if 4 * self.values.len() > self.slots.len() {
                self.rehash(2 * self.slots.len());
            }
        }
        is_new
    }

    /// Notes the rank of each number.
    fn rank(&mut self) {
        self.values.sort_unstable_by(f64::total_cmp);
        self.rehash(self.slots.len());
    }

    /// Fills a new table with all numbers, ranked by their places in `values`.
    #[cold]
    fn rehash(&mut self, slots: usize) {
        self.slots.clear();
        self.slots.resize(slots, EMPTY);
        for (rank, &value) in (0..).zip(&self.values) {
            let bits = Self::bits(value);
            let place = self.slot(bits);
            self.slots[place] = Slot { bits, rank };
        }
    }

    #[inline(always)]
    fn rank_of(&self, value: f64) -> usize {
        self.slots[self.slot(Self::bits(value))].rank as usize
    }
}
