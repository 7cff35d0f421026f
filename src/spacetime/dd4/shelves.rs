//! The cells of a sweep on disk, and their canonical order.
//!
//! Cells go to shelves by their first vertex, because the order is that of vertices. Each shelf is sorted in
//! memory. When the place of every cell is known, places replace the numbers of neighbours.

use std::path::{Path, PathBuf};

use super::words::{WordFile, WordReader};
use crate::diagram4::{CellSink, sort_distinct};
use spmesh_base::error::Result;
use spmesh_stream::model::cells4::Cell4;

/// Maximum number of shelves; each may be a file.
const SHELVES_MAX: usize = 192;

/// Marks an infinite cell in the word that counts its vertices, and in its place.
const INFINITE: u32 = 1 << 31;

/// Cells as they come. The words of a cell: its number, the count of its vertices with a mark if it is
/// infinite, the vertices, the count of neighbours, the neighbours. A further neighbour of a cell that came
/// before: the number of the cell, 0, the neighbour.
#[derive(Debug)]
pub(super) struct Shelves {
    folder: Option<PathBuf>,
    files: Vec<WordFile>,
    /// How many first vertices belong to a shelf.
    width: u32,
    cells: usize,
}

/// Cells in canonical order.
#[derive(Debug)]
pub(super) struct Sorted {
    finite: WordReader,
    infinite: WordReader,
    finite_count: u32,
    /// For each cell by its number: its place among the finite, or the infinite ones with a mark.
    places: Vec<u32>,
}

impl Shelves {
    /// Empty shelves for the cells of so many points, in a folder or in that of the system. Shelf i gets the
    /// cells whose first vertex is one of `width` vertices from i * `width` on. There are more to a shelf if
    /// there would be too many shelves.
    pub(super) fn new(points: usize, width: usize, folder: Option<&Path>) -> Shelves {
        let width = width.max(points.div_ceil(SHELVES_MAX)).max(1);
        let files = (0..points.div_ceil(width)).map(|_| WordFile::new(folder)).collect();
        Shelves { folder: folder.map(Path::to_path_buf), files, width: width as u32, cells: 0 }
    }

    /// Sorts all cells.
    pub(super) fn sorted(self) -> Result<Sorted> {
        let mut places = vec![0; self.cells];
        let mut sorted = [WordFile::new(self.folder.as_deref()), WordFile::new(self.folder.as_deref())];
        let mut counts = [0; 2];
        for file in self.files {
            Shelf::of(file.into_words()?).sort(&mut sorted, &mut counts, &mut places)?;
        }
        let [finite, infinite] = sorted;
        let [finite, infinite] = [finite.into_reader()?, infinite.into_reader()?];
        Ok(Sorted { finite, infinite, finite_count: counts[0], places })
    }
}

impl CellSink for Shelves {
    fn clear(&mut self) {
        let folder = self.folder.as_deref();
        self.files.fill_with(|| WordFile::new(folder));
        self.cells = 0;
    }

    #[inline]
    fn cell(&mut self, number: u32, cell: Cell4) -> Result<()> {
        let Cell4 { is_infinite, vertices, neighbours } = cell;
        self.cells += 1;
        let file = &mut self.files[(vertices[0] / self.width) as usize];
        file.extend(&[number, vertices.len() as u32 | if is_infinite { INFINITE } else { 0 }])?;
        file.extend(vertices)?;
        file.extend(&[neighbours.len() as u32])?;
        file.extend(neighbours)
    }

    #[inline]
    fn neighbour(&mut self, number: u32, first: u32, neighbour: u32) -> Result<()> {
        self.files[(first / self.width) as usize].extend(&[number, 0, neighbour])
    }
}

struct Shelf {
    words: Vec<u32>,
    /// Where the cells begin, in the order of their numbers.
    cells: Vec<usize>,
    /// Cells with their further neighbours, sorted.
    further: Vec<[u32; 2]>,
}

impl Shelf {
    fn of(words: Vec<u32>) -> Shelf {
        let (mut cells, mut further) = (Vec::new(), Vec::new());
        let mut at = 0;
        while at < words.len() {
            let vertices = (words[at + 1] & !INFINITE) as usize;
            if vertices == 0 {
                further.push([words[at], words[at + 2]]);
                at += 3;
            } else {
                cells.push(at);
                at += 3 + vertices + words[at + 2 + vertices] as usize;
            }
        }
        further.sort_unstable();
        Shelf { words, cells, further }
    }

    /// Writes the cells in canonical order to the file of finite and of infinite ones, and counts on.
    fn sort(&self, files: &mut [WordFile; 2], counts: &mut [u32; 2], places: &mut [u32]) -> Result<()> {
        let key = |&start: &usize| {
            let vertices = self.vertices(start);
            // Every cell has at least four vertices.
            (vertices[..4].iter().fold(0, |key, &vertex| key << 32 | u128::from(vertex)), start)
        };
        let mut keys: Vec<(u128, usize)> = self.cells.iter().map(key).collect();
        keys.sort_unstable_by(|&(key, a), &(other, b)| {
            key.cmp(&other).then_with(|| self.vertices(a).cmp(self.vertices(b)))
        });
        let mut list = Vec::new();
        for (_, start) in keys {
            let (number, mark) = (self.words[start], self.words[start + 1] & INFINITE);
            let kind = usize::from(mark != 0);
            places[number as usize] = counts[kind] | mark;
            counts[kind] += 1;
            let vertices = self.vertices(start);
            list.clear();
            list.push(self.words[start + 1]);
            list.extend_from_slice(vertices);
            let [count, rest @ ..] = &self.words[start + 2 + vertices.len()..] else {
                unreachable!("a count")
            };
            let further = self.further(number);
            list.push(count + further.len() as u32);
            list.extend_from_slice(&rest[..*count as usize]);
            list.extend(further.iter().map(|[_, neighbour]| neighbour));
            files[kind].extend(&list)?;
        }
        Ok(())
    }

    /// The vertices of the cell that begins at a word.
    #[inline(always)]
    fn vertices(&self, start: usize) -> &[u32] {
        &self.words[start + 2..][..(self.words[start + 1] & !INFINITE) as usize]
    }

    /// The further neighbours of a cell.
    fn further(&self, number: u32) -> &[[u32; 2]] {
        let start = self.further.partition_point(|[cell, _]| *cell < number);
        let count = self.further[start..].iter().take_while(|[cell, _]| *cell == number).count();
        &self.further[start..][..count]
    }
}

impl Sorted {
    /// Gives all cells in their order.
    pub(super) fn each(self, mut give: impl FnMut(Cell4) -> Result<()>) -> Result<()> {
        let Sorted { finite, infinite, finite_count, places } = self;
        let place = |number: u32| match places[number as usize] {
            place if place & INFINITE == 0 => place,
            place => finite_count + (place & !INFINITE),
        };
        let (mut vertices, mut neighbours) = (Vec::new(), Vec::new());
        for mut reader in [finite, infinite] {
            while let Some((word, count)) = reader.list(!INFINITE)? {
                vertices.clear();
                vertices.extend_from_slice(reader.last(count));
                let (_, count) = reader.list(!INFINITE)?.unwrap_or_default();
                neighbours.clear();
                neighbours.extend(reader.last(count).iter().map(|&number| place(number)));
                sort_distinct(&mut neighbours);
                let is_infinite = word & INFINITE != 0;
                give(Cell4 { is_infinite, vertices: &vertices, neighbours: &neighbours })?;
            }
        }
        Ok(())
    }
}
