//! The cells with centres in polygons.

use std::ops::Range;

use super::axis::Axis;
use super::search::first;
use super::tile::{WORD, WORDS, WORDS_OF_TILE};
use crate::files::TilePlace;
use spmesh_delaunay::cell_tree::CellBox;
use spmesh_delaunay::predicates::{FiniteFloatPredicates, Point2, Predicates2, Sign};
use spmesh_formats::raster::{Grid, TILE};
use spmesh_formats::source::Mask;

/// Which cells of a grid have their centre in one of some polygons, or on the border of one.
///
/// A ray to the left of a centre in a polygon crosses its edges an odd number of times. So each edge flips
/// the cells on its right in every row that it crosses, and the parity of the flips is the sum along the row.
/// Centres are f64 coordinates of the world; on which side of an edge they are is decided exactly.
///
/// Cost: for a tile, a look at each edge in its rows, and the rows of the edges of polygons that reach into
/// it.
///
/// Memory: some 50 bytes for each edge and each polygon.
#[derive(Debug)]
pub(super) struct CellMask {
    columns: Axis,
    rows: Axis,
    /// Edges with the numbers of their polygons, from the lower end; those of one polygon in a row.
    edges: Vec<(u32, [Point2; 2])>,
    /// The box of each polygon.
    boxes: Vec<CellBox>,
    /// For each row of tiles, the edges that meet no other one.
    short: Vec<Vec<u32>>,
    /// The other edges, with their first and last row of tiles.
    long: Vec<(u32, [usize; 2])>,
}

impl CellMask {
    pub(super) fn new(mask: &Mask, grid: Grid) -> CellMask {
        let Grid { left, top, step, columns, rows } = grid;
        let [columns, rows] =
            [Axis::new(left, step, columns, 1.0, 0.0), Axis::new(top, -step, rows, 1.0, 0.0)];
        let upward = |(polygon, [p, q]): (u32, [Point2; 2])| {
            (polygon, if (p[1], p[0]) <= (q[1], q[0]) { [p, q] } else { [q, p] })
        };
        let edges: Vec<(u32, [Point2; 2])> = mask.edges().map(upward).filter(|(_, [p, q])| p != q).collect();
        let mut boxes = Vec::new();
        for (polygon, ends) in &edges {
            boxes.resize(boxes.len().max(*polygon as usize + 1), CellBox::of(&[]));
            ends.iter().for_each(|&end| boxes[*polygon as usize].extend(end));
        }
        let mut short = vec![Vec::new(); (grid.rows as usize).div_ceil(TILE)];
        let mut long = Vec::new();
        for (number, (_, [low, high])) in (0..).zip(&edges) {
            let met = rows.cells(low[1], high[1]);
            if met.is_empty() {
                continue;
            }
            let bands = [met.start, met.end - 1].map(|row| row as usize / TILE);
            if bands[0] == bands[1] {
                short[bands[0]].push(number);
            } else {
                long.push((number, bands));
            }
        }
        CellMask { columns, rows, edges, boxes, short, long }
    }

    /// The cells of a tile: a bit for each, row by row.
    pub(super) fn tile(&self, at: TilePlace) -> Vec<u64> {
        let band = at[1];
        let long = self.long.iter().filter(|(_, [first, last])| (*first..=*last).contains(&band));
        let mut numbers: Vec<u32> =
            self.short[band].iter().copied().chain(long.map(|(number, _)| *number)).collect();
        numbers.sort_unstable();
        let (mut inside, mut flips) = (vec![0; WORDS_OF_TILE], vec![0; WORDS_OF_TILE]);
        let mut predicates = FiniteFloatPredicates::default();
        let polygon_of = |number: &u32| self.edges[*number as usize].0;
        for edges in numbers.chunk_by(|a, b| polygon_of(a) == polygon_of(b)) {
            let Some(rows) = self.rows_of(polygon_of(&edges[0]), at) else { continue };
            for &number in edges {
                self.add(self.edges[number as usize].1, at, &mut flips, &mut inside, &mut predicates);
            }
            let words = rows.start * WORDS..rows.end * WORDS;
            let flips = flips[words.clone()].chunks_exact_mut(WORDS);
            flips
                .zip(inside[words].chunks_exact_mut(WORDS))
                .for_each(|(row, inside)| add_parities(row, inside));
        }
        inside
    }

    /// The rows of a tile that a polygon reaches; `None` if it reaches no cell. On the left of the tile, it
    /// has an even number of edges in each row.
    fn rows_of(&self, polygon: u32, at: TilePlace) -> Option<Range<usize>> {
        let CellBox { min, max } = self.boxes[polygon as usize];
        let [left, top] = at.map(|place| (place * TILE) as u32);
        let right = (left + TILE as u32).min(self.columns.count);
        if max[0] < self.columns.at(left) || min[0] > self.columns.at(right - 1) {
            return None;
        }
        let rows = self.rows.cells(min[1], max[1]);
        let (first, behind) = (rows.start.max(top), rows.end.min(top + TILE as u32));
        (first < behind).then(|| (first - top) as usize..(behind - top) as usize)
    }

    /// Flips the cells of a tile at an edge, in the rows that it crosses, and adds those with centres on it.
    fn add(
        &self,
        [low, high]: [Point2; 2],
        at: TilePlace,
        flips: &mut [u64],
        inside: &mut [u64],
        predicates: &mut impl Predicates2,
    ) {
        let [left, top] = at.map(|place| (place * TILE) as u32);
        let (right, bottom) = ((left + TILE as u32).min(self.columns.count), top + TILE as u32);
        let rows = self.rows.cells(low[1], high[1]);
        if low[1] == high[1] {
            let cells = self.columns.cells(low[0], high[0]);
            for row in rows.start.max(top)..rows.end.min(bottom) {
                for column in cells.start.max(left)..cells.end.min(right) {
                    set(inside, [column - left, row - top]);
                }
            }
            return;
        }
        let slope = (high[0] - low[0]) / (high[1] - low[1]);
        for row in rows.start.max(top)..rows.end.min(bottom) {
            let y = self.rows.at(row);
            let guess = self.columns.place(low[0] + (y - low[1]) * slope).near;
            let side = |column: u32, predicates: &mut _| {
                Predicates2::orient2d(predicates, low, high, [self.columns.at(column), y])
            };
            let column = first(left..right, guess, |column| side(column, predicates) != Sign::Positive);
            // The edge has its lower end, but not its upper one: a row through a vertex crosses one of its
            // edges.
            if column < right {
                let word = &mut flips[(row - top) as usize * WORDS + (column - left) as usize / WORD];
                *word ^= u64::from(y < high[1]) << ((column - left) as usize % WORD);
            }
            for column in (column..right).take_while(|&column| side(column, predicates) == Sign::Zero) {
                set(inside, [column - left, row - top]);
            }
        }
    }
}

/// Sets the bit of a cell.
fn set(cells: &mut [u64], [column, row]: [u32; 2]) {
    cells[row as usize * WORDS + column as usize / WORD] |= 1 << (column as usize % WORD);
}

/// Adds the cells of a row with an odd number of flips up to them, and clears the flips.
fn add_parities(flips: &mut [u64], inside: &mut [u64]) {
    let mut carry = 0;
    for (flips, inside) in flips.iter_mut().zip(inside) {
        let mut word = std::mem::take(flips);
        for shift in [1, 2, 4, 8, 16, 32] {
            word ^= word << shift;
        }
        word ^= carry;
        carry = 0u64.wrapping_sub(word >> 63);
        *inside |= word;
    }
}
