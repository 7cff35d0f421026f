//! Points that wait for their cell to be complete, packed in pages of memory; the excess waits on disk.

use std::path::PathBuf;

use super::cold::ColdCells;
use super::pages::{NO_PAGE, Pages};
use super::run::Stats;
use super::spill::{NO_EXTENT, Spill};
use spmesh_base::error::Result;

/// Bytes of the state of one cell.
pub(super) const CELL_COST: u64 = size_of::<Cell>() as u64;

/// Longest page, in bytes, and fewest points in one.
const PAGE_LEN_MAX: u64 = 16 << 10;
const PAGE_POINTS_MIN: u64 = 4;

/// Shortest and longest piece in which the temporary file is written and read.
const IO_LEN_MIN: u64 = 4 << 10;
const IO_LEN_MAX: u64 = 1 << 20;

/// Where the points of one cell are: the extents first, then the pages.
#[derive(Clone, Copy)]
struct Cell {
    first_page: u32,
    last_page: u32,
    pages: u32,
    /// Bytes in the last page.
    fill: u32,
    first_extent: u64,
    last_extent: u64,
}

impl Cell {
    const EMPTY: Cell = Cell {
        first_page: NO_PAGE,
        last_page: NO_PAGE,
        pages: 0,
        fill: 0,
        first_extent: NO_EXTENT,
        last_extent: NO_EXTENT,
    };

    fn bytes(&self, page_len: usize) -> u64 {
        (u64::from(self.pages) * page_len as u64).saturating_sub(page_len as u64 - u64::from(self.fill))
    }
}

/// Waiting points of all cells, each as a record of its encoded bytes.
///
/// Order: the records of a cell come back in the order in which they went in.
pub(super) struct CellBuffers {
    record_len: usize,
    cells: Vec<Cell>,
    /// `None` if cold cells stay in memory.
    cold_cells: Option<ColdCells>,
    pages: Pages,
    spill: Option<Spill>,
    folder: Option<PathBuf>,
    io_len: usize,
    waiting: u64,
    waiting_max: u64,
    spilled: u64,
    cold: u64,
}

impl CellBuffers {
    /// Buffers of `cells` cells for `records` records in all, that take up to `bytes` of memory and spill to
    /// a file in `folder`.
    ///
    /// If it `spills_cold`, cells that have got no points for long go to the file while there is memory left,
    /// too. In files of tiles these are the cells on the borders, which wait for the tile beyond.
    pub(super) fn new(
        cells: usize,
        record_len: usize,
        records: u64,
        bytes: u64,
        folder: Option<PathBuf>,
        spills_cold: bool,
    ) -> Result<Self> {
        let io_len = (bytes / 16).clamp(IO_LEN_MIN, IO_LEN_MAX);
        let cold_cells = spills_cold.then(|| ColdCells::new(cells));
        let for_cells = cells as u64 * CELL_COST + cold_cells.as_ref().map_or(0, ColdCells::bytes);
        let for_pages = bytes.saturating_sub(for_cells + 2 * io_len);
        let record = record_len as u64;
        // Every cell may have a partly filled page: with many cells, pages must be short.
        let points_max = PAGE_LEN_MAX / record;
        let points = (for_pages / (4 * cells as u64 * record)).clamp(PAGE_POINTS_MIN, points_max);
        Ok(CellBuffers {
            record_len,
            cells: vec![Cell::EMPTY; cells],
            cold_cells,
            // All points at once, with a partly filled page in every cell.
            pages: Pages::new((points * record) as usize, for_pages, records / points + cells as u64)?,
            spill: None,
            folder,
            io_len: io_len as usize,
            waiting: 0,
            waiting_max: 0,
            spilled: 0,
            cold: 0,
        })
    }

    /// Appends whole records to `cell`.
    pub(super) fn push(&mut self, cell: usize, mut records: &[u8]) -> Result<()> {
        debug_assert!(records.len().is_multiple_of(self.record_len));
        let count = (records.len() / self.record_len) as u64;
        self.waiting += count;
        self.spill_cold(cell, count)?;
        while !records.is_empty() {
            if self.cells[cell].pages == 0 || self.cells[cell].fill as usize == self.pages.page_len() {
                self.add_page(cell)?;
            }
            let state = &mut self.cells[cell];
            let free = &mut self.pages.content_mut(state.last_page)[state.fill as usize..];
            let (now, later) = records.split_at(records.len().min(free.len()));
            free[..now.len()].copy_from_slice(now);
            state.fill += now.len() as u32;
            records = later;
        }
        self.waiting_max = self.waiting_max.max(self.waiting);
        Ok(())
    }

    /// Calls `consume` with the records of `cell`, in pieces of whole records, and empties the cell.
    pub(super) fn drain(&mut self, cell: usize, mut consume: impl FnMut(&[u8]) -> Result<()>) -> Result<()> {
        let state = std::mem::replace(&mut self.cells[cell], Cell::EMPTY);
        let mut drained = 0;
        let mut consume = |bytes: &[u8]| {
            drained += bytes.len() as u64;
            consume(bytes)
        };
        if let Some(spill) = self.spill.as_mut().filter(|_| state.first_extent != NO_EXTENT) {
            spill.read_chain(state.first_extent, self.record_len, &mut consume)?;
        }
        for_each_page(&self.pages, &state, &mut consume)?;
        self.waiting -= drained / self.record_len as u64;
        self.give_back(&state);
        Ok(())
    }

    /// Adds the figures of the buffers to `stats`, beside those of others.
    pub(super) fn add_to(&self, stats: &mut Stats) {
        stats.buffered_points_max += self.waiting_max;
        stats.buffered_bytes_max += self.pages.bytes_max();
        stats.spilled_points += self.spilled;
        stats.cold_points += self.cold;
        stats.spilled_bytes += self.spill.as_ref().map_or(0, Spill::len);
    }

    /// Appends a page to a cell, after a spill if no page is free.
    fn add_page(&mut self, cell: usize) -> Result<()> {
        let page = match self.pages.take() {
            Some(page) => page,
            None => {
                self.spill_fullest()?;
                self.pages.take().expect("spilling frees pages")
            }
        };
        let state = &mut self.cells[cell];
        if state.pages == 0 {
            state.first_page = page;
        } else {
            self.pages.link(state.last_page, page);
        }
        state.last_page = page;
        state.pages += 1;
        state.fill = 0;
        Ok(())
    }

    /// Counts points that come to a cell. From time to time, writes cells to disk that have got none for
    /// long.
    fn spill_cold(&mut self, cell: usize, count: u64) -> Result<()> {
        let Some(cold_cells) = &mut self.cold_cells else { return Ok(()) };
        cold_cells.push(cell, count);
        if !cold_cells.is_due(self.pages.in_use() as u64 * self.pages.page_len() as u64) {
            return Ok(());
        }
        let in_memory = (0..self.cells.len()).filter(|&cell| self.cells[cell].pages > 0);
        let cold = cold_cells.look(in_memory);
        let before = self.spilled;
        self.spill(&cold)?;
        self.cold += self.spilled - before;
        Ok(())
    }

    /// Writes the fullest cells to disk until at least half of the pages are free. This makes extents long,
    /// and writes each cell rarely.
    fn spill_fullest(&mut self) -> Result<()> {
        let pages_min = self.victim_pages_min();
        let fullest = (0..self.cells.len()).filter(|&cell| self.cells[cell].pages >= pages_min);
        let fullest: Vec<usize> = fullest.collect();
        self.spill(&fullest)
    }

    /// Writes cells to disk, and makes sure that they can be read back.
    fn spill(&mut self, cells: &[usize]) -> Result<()> {
        if cells.is_empty() {
            return Ok(());
        }
        if self.spill.is_none() {
            self.spill = Some(Spill::create(self.folder.as_deref(), self.io_len)?);
        }
        cells.iter().try_for_each(|&cell| self.spill_cell(cell))?;
        self.spill.as_mut().expect("created above").flush()
    }

    /// The greatest power of two such that the cells with at least that many pages have at least half of all
    /// pages in use.
    fn victim_pages_min(&self) -> u32 {
        let mut pages_of_size = [0u64; 32];
        for cell in self.cells.iter().filter(|cell| cell.pages > 0) {
            pages_of_size[cell.pages.ilog2() as usize] += u64::from(cell.pages);
        }
        let mut pages = 0;
        let size = pages_of_size.iter().rposition(|&of_size| {
            pages += of_size;
            pages * 2 >= self.pages.in_use() as u64
        });
        1 << size.expect("all pages are more than half of them")
    }

    fn spill_cell(&mut self, cell: usize) -> Result<()> {
        let state = self.cells[cell];
        let spill = self.spill.as_mut().expect("the caller created it");
        let len = state.bytes(self.pages.page_len());
        let extent = spill.start_extent(state.last_extent, len)?;
        for_each_page(&self.pages, &state, |bytes| spill.append(bytes))?;
        self.spilled += len / self.record_len as u64;
        self.give_back(&state);
        let first_extent = if state.first_extent == NO_EXTENT { extent } else { state.first_extent };
        self.cells[cell] = Cell { first_extent, last_extent: extent, ..Cell::EMPTY };
        Ok(())
    }

    fn give_back(&mut self, state: &Cell) {
        if state.pages > 0 {
            self.pages.give_back(state.first_page, state.last_page, state.pages as usize);
        }
    }
}

/// Calls `consume` with the filled part of every page of a cell, in order.
fn for_each_page(pages: &Pages, state: &Cell, mut consume: impl FnMut(&[u8]) -> Result<()>) -> Result<()> {
    let mut page = state.first_page;
    while page != NO_PAGE {
        let fill = if page == state.last_page { state.fill as usize } else { pages.page_len() };
        consume(&pages.content(page)[..fill])?;
        page = pages.after(page);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const RECORD: usize = 12;

    fn record(value: u32) -> [u8; RECORD] {
        let mut bytes = [0; RECORD];
        bytes[..4].copy_from_slice(&value.to_le_bytes());
        bytes
    }

    fn drain(buffers: &mut CellBuffers, cell: usize) -> Vec<u32> {
        let mut values = Vec::new();
        buffers
            .drain(cell, |bytes| {
                let records = bytes.chunks_exact(RECORD);
                values.extend(records.map(|r| u32::from_le_bytes([r[0], r[1], r[2], r[3]])));
                Ok(())
            })
            .expect("drains");
        values
    }

    #[test]
    fn records_come_back_once_in_order_whatever_the_memory() {
        let cells = 50;
        for bytes in [16 << 10, 40 << 10, 4 << 20] {
            let mut buffers =
                CellBuffers::new(cells, RECORD, 20_000, bytes, None, false).expect("enough memory");
            let cell_of = |value: u32| (value.wrapping_mul(2_654_435_761) >> 20) as usize % cells;
            for round in 0..3 {
                let values = round * 20_000..(round + 1) * 20_000;
                values.clone().for_each(|v| buffers.push(cell_of(v), &record(v)).expect("pushes"));
                for cell in (0..cells).rev() {
                    let expected: Vec<u32> = values.clone().filter(|&v| cell_of(v) == cell).collect();
                    assert_eq!(drain(&mut buffers, cell), expected);
                    assert!(drain(&mut buffers, cell).is_empty());
                }
                assert_eq!((buffers.waiting, buffers.pages.in_use()), (0, 0));
            }
            assert!(buffers.pages.bytes_max() <= bytes);
            assert_eq!(buffers.spilled > 0, bytes < 1 << 20);
        }
    }

    #[test]
    fn cells_that_get_no_points_for_long_wait_on_disk() {
        let look = 1 << 10;
        for spills_cold in [false, true] {
            let mut buffers =
                CellBuffers::new(3, RECORD, 8 * look, 1 << 30, None, spills_cold).expect("enough memory");
            buffers.cold_cells = spills_cold.then(|| ColdCells::of(3, 0, 10));
            let mut pushed = [Vec::new(), Vec::new(), Vec::new()];
            let mut push = |buffers: &mut CellBuffers, cell: usize, count: u64| {
                for value in 0..count as u32 {
                    buffers.push(cell, &record(value)).expect("pushes");
                    pushed[cell].push(value);
                }
            };
            push(&mut buffers, 0, 100);
            push(&mut buffers, 1, 100);
            for _ in 0..7 {
                push(&mut buffers, 2, look);
                push(&mut buffers, 1, 10);
            }
            push(&mut buffers, 0, 50);
            assert_eq!(buffers.cells.iter().map(|cell| cell.pages > 0).collect::<Vec<_>>(), [true; 3]);
            let expected = if spills_cold { 100 } else { 0 };
            assert_eq!((buffers.spilled, buffers.cold), (expected, expected));
            for cell in [1, 0, 2] {
                assert_eq!(drain(&mut buffers, cell), pushed[cell]);
            }
            assert_eq!((buffers.waiting, buffers.pages.in_use()), (0, 0));
        }
    }
}
