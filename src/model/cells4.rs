//! Cells of four dimensions in flat arrays: the output of the engines of 4D diagrams, and the contents of
//! their streams.

use spmesh_core::prefetch::prefetch;

/// A point of space and time: x, y, z, t.
pub type Point4 = [f64; 4];

/// Marks a cell as infinite, in the word that counts its vertices.
const INFINITE: u32 = 1 << 31;

/// Cells of four dimensions: each a set of vertices, with the cells across its facets.
///
/// A finite cell is the convex hull of its vertices. An infinite cell lies beyond a facet of the convex hull
/// of all points: its vertices are the vertices of that facet and the faraway point, which is not listed
/// (thesis 4.3). Vertices and neighbours are numbers of points and of cells, in increasing order.
///
/// Memory: 4 bytes per vertex and per neighbour of each cell, and 12 bytes per cell.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Cells4 {
    /// For each cell: the number of vertices, with a mark if it is infinite; the number of neighbours; the
    /// vertices; the neighbours.
    words: Vec<u32>,
    /// Where each cell begins.
    starts: Vec<u32>,
}

/// One cell of [`Cells4`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cell4<'a> {
    /// Whether the faraway point is a vertex, too.
    pub is_infinite: bool,
    /// Numbers of its vertices, increasing.
    pub vertices: &'a [u32],
    /// Numbers of the cells across its facets, increasing.
    pub neighbours: &'a [u32],
}

impl Cells4 {
    /// An empty list with capacity for `cells` cells with `numbers` vertices and neighbours in total.
    #[must_use]
    pub fn with_capacity(cells: usize, numbers: usize) -> Cells4 {
        Cells4 { words: Vec::with_capacity(2 * cells + numbers), starts: Vec::with_capacity(cells) }
    }

    /// Number of cells.
    #[must_use]
    #[inline]
    pub fn len(&self) -> usize {
        self.starts.len()
    }

    /// Whether there are no cells.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.starts.is_empty()
    }

    /// Adds a cell.
    ///
    /// # Panics
    /// If the list already has 2^32 words (17 GB) or more, or the cell has 2^31 vertices or more.
    #[inline]
    pub fn push(&mut self, cell: Cell4) {
        let Cell4 { is_infinite, vertices, neighbours } = cell;
        let count = |numbers: &[u32]| u32::try_from(numbers.len()).expect("numbers of 32 bits");
        assert!(count(vertices) < INFINITE, "too many vertices for a cell");
        self.starts.push(u32::try_from(self.words.len()).expect("at most 2^32 words of cells"));
        self.words.push(count(vertices) | if is_infinite { INFINITE } else { 0 });
        self.words.push(count(neighbours));
        // Lists are short: calls of `memcpy` would take longer.
        self.words.extend(vertices.iter().map(|&vertex| vertex));
        self.words.extend(neighbours.iter().map(|&neighbour| neighbour));
    }

    /// The cell of this number.
    #[must_use]
    #[inline]
    pub fn get(&self, number: usize) -> Cell4<'_> {
        let [vertices, neighbours, rest @ ..] = &self.words[self.starts[number] as usize..] else {
            unreachable!("two words before each cell")
        };
        let (list, rest) = rest.split_at((vertices & !INFINITE) as usize);
        let is_infinite = vertices & INFINITE != 0;
        Cell4 { is_infinite, vertices: list, neighbours: &rest[..*neighbours as usize] }
    }

    /// Number of vertices and neighbours of all cells.
    pub fn numbers(&self) -> usize {
        self.words.len() - 2 * self.len()
    }

    /// Prefetches a cell into the cache.
    #[inline(always)]
    pub fn fetch(&self, number: usize) {
        prefetch(&self.words, self.starts[number] as usize);
    }

    /// All cells, by number.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Cell4<'_>> {
        (0..self.len()).map(|number| self.get(number))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_come_out_as_they_went_in() {
        let mut cells = Cells4::default();
        let simplex = Cell4 { is_infinite: false, vertices: &[0, 1, 2, 5, 9], neighbours: &[1] };
        let beyond = Cell4 { is_infinite: true, vertices: &[0, 1, 2, 5], neighbours: &[0] };
        cells.push(simplex);
        cells.push(beyond);
        assert_eq!(cells.iter().collect::<Vec<_>>(), [simplex, beyond]);
        assert_eq!((cells.len(), cells.is_empty()), (2, false));
    }
}
