//! Cells of four dimensions in flat arrays: the output of the engines of 4D diagrams, and the contents of
//! their streams.

use spmesh_base::prefetch::prefetch;

/// A point of space and time: x, y, z, t.
pub type Point4 = [f64; 4];

/// Marks a cell as infinite, in the word that counts its vertices.
const INFINITE: u32 = 1 << 31;

/// Cells to prefetch ahead.
const AHEAD: usize = 8;

/// Cells of four dimensions: each a set of vertices, with the cells across its facets.
///
/// A finite cell is the convex hull of its vertices. An infinite cell lies beyond a facet of the convex hull
/// of all points: its vertices are the vertices of that facet and the faraway point, which is not listed
/// (thesis 4.3). Vertices and neighbours are numbers of points and of cells, in increasing order.
///
/// Memory: 4 bytes per vertex and per neighbour of each cell, and 16 bytes per cell.
#[derive(Debug, Clone, Default)]
pub struct Cells4 {
    /// For each cell, in any order: the number of vertices, with a mark if it is infinite; the vertices.
    vertices: Vec<u32>,
    /// For each cell, in any order: the number of neighbours; the neighbours.
    neighbours: Vec<u32>,
    /// Where the vertices and the neighbours of each cell begin.
    starts: Vec<[u32; 2]>,
}

/// Lists of vertices or neighbours of cells, for [`Cells4::from_lists`].
#[derive(Debug, Clone)]
pub struct Lists4 {
    /// For each list: the number of its numbers, and these.
    words: Vec<u32>,
    /// Where each list begins, and where the next one would.
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
    /// Cells of lists of vertices and of neighbours, which both have a list for each cell. `order` gives the
    /// numbers of the lists of each cell. The first `finite` cells are finite.
    ///
    /// # Panics
    /// If `order` contains other numbers.
    pub fn from_lists(mut vertices: Lists4, neighbours: Lists4, order: &[u32], finite: usize) -> Cells4 {
        let starts = |&list: &u32| [vertices.starts[list as usize], neighbours.starts[list as usize]];
        let starts = order.iter().map(starts).collect();
        for &list in &order[finite..] {
            vertices.words[vertices.starts[list as usize] as usize] |= INFINITE;
        }
        Cells4 { vertices: vertices.words, neighbours: neighbours.words, starts }
    }

    /// Number of cells.
    #[inline]
    pub fn len(&self) -> usize {
        self.starts.len()
    }

    /// Whether there are no cells.
    pub fn is_empty(&self) -> bool {
        self.starts.is_empty()
    }

    /// Adds a cell.
    ///
    /// # Panics
    /// If the list already has 2^32 vertices or neighbours (17 GB) or more, or the cell has 2^31 vertices or
    /// more.
    #[inline]
    pub fn push(&mut self, cell: Cell4) {
        let Cell4 { is_infinite, vertices, neighbours } = cell;
        let number = |length: usize| u32::try_from(length).expect("at most 2^32 vertices or neighbours");
        assert!(number(vertices.len()) < INFINITE, "too many vertices for a cell");
        self.starts.push([number(self.vertices.len()), number(self.neighbours.len())]);
        self.vertices.push(number(vertices.len()) | if is_infinite { INFINITE } else { 0 });
        self.vertices.extend_from_slice(vertices);
        self.neighbours.push(number(neighbours.len()));
        self.neighbours.extend_from_slice(neighbours);
    }

    /// The cell of this number.
    #[inline]
    pub fn get(&self, number: usize) -> Cell4<'_> {
        let [start, neighbours_start] = self.starts[number].map(|start| start as usize);
        let [count, vertices @ ..] = &self.vertices[start..] else { unreachable!("a word before each list") };
        let vertices = &vertices[..(count & !INFINITE) as usize];
        Cell4 {
            is_infinite: count & INFINITE != 0,
            vertices,
            neighbours: list(&self.neighbours, neighbours_start),
        }
    }

    /// Prefetches a cell into the cache.
    #[inline(always)]
    fn fetch(&self, number: usize) {
        if let Some(&[vertices, neighbours]) = self.starts.get(number) {
            prefetch(&self.vertices, vertices as usize);
            prefetch(&self.neighbours, neighbours as usize);
        }
    }

    /// All cells, by number.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Cell4<'_>> {
        (0..self.len()).map(|number| {
            self.fetch(number + AHEAD);
            self.get(number)
        })
    }
}

/// The list that starts at a word with its length.
#[inline(always)]
fn list(words: &[u32], start: usize) -> &[u32] {
    let [count, rest @ ..] = &words[start..] else { unreachable!("a word before each list") };
    &rest[..*count as usize]
}

impl PartialEq for Cells4 {
    /// Whether the cells of each number are equal, wherever in memory they are.
    fn eq(&self, other: &Cells4) -> bool {
        self.len() == other.len() && self.iter().eq(other.iter())
    }
}

impl Eq for Cells4 {}

impl Lists4 {
    /// No lists, with capacity for some lists of so many numbers in total.
    pub fn with_capacity(lists: usize, numbers: usize) -> Lists4 {
        let mut words = Vec::with_capacity(lists + numbers + 1);
        words.push(0);
        let mut starts = Vec::with_capacity(lists + 1);
        starts.push(0);
        Lists4 { words, starts }
    }

    /// All lists of `parts`, one part after the other, in the memory of the first.
    ///
    /// # Panics
    /// As [`Lists4::end`].
    pub fn joined(parts: impl IntoIterator<Item = Lists4>) -> Lists4 {
        let mut parts = parts.into_iter();
        let mut joined = parts.next().unwrap_or_else(|| Lists4::with_capacity(0, 0));
        for part in parts {
            let offset = joined.words.len() - 1;
            let end = u32::try_from(offset + part.words.len() - 1).expect("at most 2^32 numbers of cells");
            let offset = end - (part.words.len() as u32 - 1);
            joined.words.pop();
            joined.words.extend_from_slice(&part.words);
            joined.starts.extend(part.starts[1..].iter().map(|start| start + offset));
        }
        joined
    }

    /// Number of lists.
    #[inline]
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there are no lists.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bytes that the lists take.
    pub fn bytes(&self) -> usize {
        size_of::<u32>() * (self.words.len() + self.starts.len())
    }

    /// The list of this number.
    #[inline(always)]
    pub fn get(&self, number: usize) -> &[u32] {
        list(&self.words, self.starts[number] as usize)
    }

    /// The list of this number.
    #[inline(always)]
    pub fn get_mut(&mut self, number: usize) -> &mut [u32] {
        let start = self.starts[number] as usize;
        let count = self.words[start] as usize;
        &mut self.words[start + 1..][..count]
    }

    /// Adds numbers to the list that is not ended yet.
    #[inline(always)]
    pub fn extend<const N: usize>(&mut self, numbers: [u32; N]) {
        self.words.extend(numbers);
    }

    /// Adds those numbers for which `wanted`, without branches: both outcomes are written.
    #[inline(always)]
    pub fn extend_if<const N: usize>(&mut self, numbers: [u32; N], mut wanted: impl FnMut(u32) -> bool) {
        let mut end = self.words.len();
        self.words.extend(numbers);
        for number in numbers {
            self.words[end] = number;
            end += usize::from(wanted(number));
        }
        self.words.truncate(end);
    }

    /// Ends the list of the numbers that were added since the last one ended; returns it.
    ///
    /// # Panics
    /// If there are 2^32 numbers or more.
    #[inline(always)]
    pub fn end(&mut self) -> &mut [u32] {
        let start = self.starts[self.starts.len() - 1] as usize;
        let end = self.words.len();
        self.starts.push(u32::try_from(end).expect("at most 2^32 numbers of cells"));
        self.words[start] = (end - start - 1) as u32;
        self.words.push(0);
        &mut self.words[start + 1..end]
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
    #[test]
    fn cells_of_lists_are_those_of_their_order() {
        let (mut vertices, mut neighbours) = (Lists4::with_capacity(2, 9), Lists4::with_capacity(2, 2));
        vertices.extend([0, 1, 2, 9]);
        vertices.extend_if([7, 11], |vertex| vertex > 7);
        vertices.end();
        neighbours.extend([1]);
        assert_eq!(neighbours.end(), [1]);
        vertices.extend([0, 1, 2, 5]);
        assert_eq!(vertices.end(), [0, 1, 2, 5]);
        neighbours.extend([8]);
        neighbours.end();
        neighbours.get_mut(1)[0] = 0;
        assert_eq!((vertices.len(), vertices.get(0)), (2, &[0, 1, 2, 9, 11][..]));
        let cells = Cells4::from_lists(vertices, neighbours, &[1, 0], 1);
        let mut pushed = Cells4::default();
        pushed.push(Cell4 { is_infinite: false, vertices: &[0, 1, 2, 5], neighbours: &[0] });
        assert_ne!(cells, pushed);
        pushed.push(Cell4 { is_infinite: true, vertices: &[0, 1, 2, 9, 11], neighbours: &[1] });
        assert_eq!(cells, pushed);
    }

    #[test]
    fn joined_lists_are_those_of_the_parts() {
        let parts = [vec![vec![3, 4], vec![]], vec![], vec![vec![5], vec![6, 7, 8]]];
        let lists = |part: &Vec<Vec<u32>>| {
            let mut lists = Lists4::with_capacity(0, 0);
            for list in part {
                list.iter().for_each(|&number| lists.extend([number]));
                lists.end();
            }
            lists
        };
        let joined = Lists4::joined(parts.iter().map(lists));
        let all: Vec<&[u32]> = (0..joined.len()).map(|list| joined.get(list)).collect();
        assert_eq!(all, parts.concat());
        assert!(Lists4::joined([]).is_empty());
    }
}
