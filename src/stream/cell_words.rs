//! Assembles cells of four dimensions from the words of blocks: a cell may begin in one block and end in a
//! later one.

use byteorder::{ByteOrder, LittleEndian as LE};

use super::block::whole_records;
use super::rules4::{check_cell, check_neighbour_count, check_vertex_count};
use crate::model::cells4::{Cell4, Cells4};
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::CELL_WORDS_MAX;

/// Marks a cell as infinite, in the word that counts its vertices.
pub(super) const INFINITE: u32 = 1 << 31;

/// The words of the incomplete cell. Memory: the words that have arrived. The counts allocate nothing, and are
/// checked when they arrive.
#[derive(Debug, Default)]
pub(super) struct CellWords {
    open: Vec<u32>,
}

impl CellWords {
    /// The cells that a block completes; `points` points came before.
    pub(super) fn take(&mut self, points: u64, payload: &[u8]) -> Result<Cells4> {
        self.open.extend(whole_records(payload, 4)?.map(LE::read_u32));
        let (mut cells, mut rest) = (Cells4::default(), &self.open[..]);
        while let Some((cell, after)) = split_cell(rest, points)? {
            check_cell(cell, points)?;
            cells.push(cell);
            rest = after;
        }
        self.open.drain(..self.open.len() - rest.len());
        Ok(cells)
    }

    /// Checks that no cell is cut off.
    pub(super) fn check_end(&self) -> Result<()> {
        match self.open.len() {
            0 => Ok(()),
            words => Err(Error::malformed(format!("END: the last cell is cut off after {words} words"))),
        }
    }
}

/// The first cell of `words` and the words after it; `None` if it is incomplete.
fn split_cell(words: &[u32], points: u64) -> Result<Option<(Cell4<'_>, &[u32])>> {
    let Some((marked, rest)) = words.split_first() else { return Ok(None) };
    let (is_infinite, vertices) = (marked & INFINITE != 0, u64::from(marked & !INFINITE));
    check_vertex_count(is_infinite, vertices, points)?;
    let Some((&neighbours, rest)) = rest.split_first() else { return Ok(None) };
    let neighbours = u64::from(neighbours);
    check_neighbour_count(is_infinite, vertices, neighbours)?;
    check_word_count(2 + vertices + neighbours)?;
    let len = (vertices + neighbours) as usize;
    let Some((lists, after)) = rest.split_at_checked(len) else { return Ok(None) };
    let (vertices, neighbours) = lists.split_at(vertices as usize);
    Ok(Some((Cell4 { is_infinite, vertices, neighbours }, after)))
}

/// Checks the number of words of a cell, which bounds the memory of a reader.
///
/// # Errors
/// Malformed, if there are more than `CELL_WORDS_MAX`.
pub fn check_word_count(words: u64) -> Result<()> {
    if words <= CELL_WORDS_MAX {
        return Ok(());
    }
    Err(Error::malformed(format!("cell of {words} words, the maximum is {CELL_WORDS_MAX}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_have_a_limit() {
        // Two words count the vertices and the neighbours; only the counts have arrived.
        let started = |vertices: u64, neighbours: u64| {
            split_cell(&[INFINITE | vertices as u32, neighbours as u32], u64::from(u32::MAX)).map(drop)
        };
        let half = CELL_WORDS_MAX / 2;
        assert!(started(half - 1, half - 1).is_ok(), "{:?}", started(half - 1, half - 1));
        let message = started(half, half - 1).unwrap_err().to_string();
        assert!(message.contains("cell of 2147483649 words, the maximum is 2147483648"), "{message}");
    }
}
