//! Counts of points in square cells at multiples of their side, of which only those with points take memory.

use foldhash::HashMap;

/// Bytes of a cell in the map, and of the free places beside it while the map grows.
const CELL_LEN: u64 = 96;
/// Units in the last place by which a coordinate may be off.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// A cell: its column and row are the multiples of the side at its lower left corner.
pub(super) type Cell = [i64; 2];

/// Points in a cell.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Counts {
    pub(super) points: u64,
    /// First returns.
    pub(super) first: u64,
}

/// Counts by cell. Sides double when memory has no room for more cells, so a cell becomes a quarter of
/// another.
#[derive(Debug)]
pub(super) struct CellMap {
    side: f64,
    most: usize,
    cells: HashMap<Cell, Counts>,
}

impl CellMap {
    /// No cells. `memory` is for all of them. Units: bytes.
    pub(super) fn new(side: f64, memory: u64) -> CellMap {
        // Four cells can remain however large they are: those around the origin.
        let most = usize::try_from(memory / CELL_LEN).unwrap_or(usize::MAX).max(4);
        CellMap { side, most, cells: HashMap::default() }
    }

    /// Counts a point.
    pub(super) fn add(&mut self, place: [f64; 2], is_first: bool) {
        let counts = self.cells.entry(place.map(|at| multiple(at, self.side))).or_default();
        counts.points += 1;
        counts.first += u64::from(is_first);
        while self.cells.len() > self.most {
            self.coarsen();
        }
    }

    fn coarsen(&mut self) {
        self.side *= 2.0;
        let mut cells: HashMap<Cell, Counts> = HashMap::default();
        for (cell, counts) in self.cells.drain() {
            let sums = cells.entry(cell.map(|multiple| multiple >> 1)).or_default();
            sums.points += counts.points;
            sums.first += counts.first;
        }
        self.cells = cells;
    }

    /// The side of cells.
    pub(super) fn side(&self) -> f64 {
        self.side
    }

    /// The cells with points, in any order.
    pub(super) fn cells(&self) -> impl ExactSizeIterator<Item = (&Cell, &Counts)> {
        self.cells.iter()
    }
}

/// The greatest multiple of a side that is not above a coordinate. A coordinate nearer to one than numbers
/// can tell is on it.
fn multiple(at: f64, side: f64) -> i64 {
    let place = at / side;
    let nearest = place.round();
    let is_on = (place - nearest).abs() <= ROUNDING * place.abs();
    // Conversion saturates.
    (if is_on { nearest } else { place.floor() }) as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_become_coarser_when_memory_is_short() {
        let place = |number: u64| [(number % 40) as f64 - 20.0, (number / 40) as f64 - 20.0];
        let (mut small, mut large) = (CellMap::new(1.0, 100 * CELL_LEN), CellMap::new(4.0, u64::MAX));
        for number in 0..1600 {
            small.add(place(number), number % 3 == 0);
            large.add(place(number), number % 3 == 0);
        }
        assert_eq!((small.side(), small.cells().len()), (4.0, 100));
        assert_eq!(small.cells, large.cells);
    }

    #[test]
    fn points_far_away_take_a_cell() {
        let mut map = CellMap::new(10.0, 0);
        for at in [
            [1e300, -1e300],
            [-1e300, 1e300],
            [5.0, 5.0],
            [-5.0, -5.0],
            [1e9, -1e12],
            [29.999_999_999_999_996; 2],
        ] {
            map.add(at, true);
        }
        assert!(map.cells().len() <= 4);
        assert_eq!(multiple(0.3, 0.1), 3);
    }
}
