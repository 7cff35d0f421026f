//! Overviews: the image at half the resolution, then half of that, until it fits one tile.
//!
//! They are made as tiles arrive: each tile is reduced to a quarter of a tile of the next level. Quarters
//! wait in a temporary file until their tile is complete, so overviews need no second pass and hardly any
//! memory.

use std::collections::HashMap;
use std::path::Path;

use crate::raster::geotiff::TILE;
use spmesh_base::error::Result;
use spmesh_base::temporary::Records;

/// Level, column and row of a tile; the image itself is level 0.
pub(super) type TileName = (usize, [usize; 2]);

/// Cells along a side of a quarter.
const HALF: usize = TILE / 2;
/// Bytes of a quarter, for each band.
const QUARTER_LEN: usize = HALF * HALF * size_of::<f32>();

/// How a cell of an overview gets its value from the four cells that it covers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reduction {
    /// The mean of the known values.
    Mean,
    /// The first known value: for values whose mean is meaningless, such as directions.
    First,
}

/// Number of cells along each axis, for each level.
pub(super) fn level_sizes(mut size: [u32; 2], has_overviews: bool) -> Vec<[u32; 2]> {
    let mut sizes = vec![size];
    while has_overviews && size.iter().any(|&count| count as usize > TILE) {
        size = size.map(|count| count.div_ceil(2));
        sizes.push(size);
    }
    sizes
}

/// Number of tiles along each axis, for an image of this size in cells.
pub(super) fn tiles_of(size: [u32; 2]) -> [usize; 2] {
    size.map(|count| (count as usize).div_ceil(TILE))
}

/// Tiles of overviews some of whose quarters have come.
#[derive(Debug)]
pub(super) struct Overviews {
    reduction: Reduction,
    bands: usize,
    sizes: Vec<[u32; 2]>,
    open: HashMap<TileName, OpenTile>,
    quarters: Records,
}

#[derive(Debug)]
struct OpenTile {
    record: u32,
    /// A bit for each quarter that has come.
    present: u8,
}

impl Overviews {
    /// No tiles yet; `sizes` are the sizes of the levels.
    pub(super) fn new(
        reduction: Reduction,
        bands: usize,
        sizes: Vec<[u32; 2]>,
        temp_dir: Option<&Path>,
    ) -> Overviews {
        let quarters = Records::new(temp_dir, (4 * bands * QUARTER_LEN) as u64);
        Overviews { reduction, bands, sizes, open: HashMap::new(), quarters }
    }

    /// Reduces a tile to a quarter of a tile of the next level, and returns that tile if it is complete.
    pub(super) fn add(
        &mut self,
        (level, at): TileName,
        values: &[f32],
    ) -> Result<Option<(TileName, Vec<f32>)>> {
        if level + 1 >= self.sizes.len() {
            return Ok(None);
        }
        let inside = self.inside(level, at);
        let planes = values.chunks_exact(TILE * TILE);
        let quarter: Vec<f32> = planes.flat_map(|plane| self.quarter(plane, inside)).collect();
        let name = (level + 1, at.map(|place| place / 2));
        let number = at[0] % 2 + 2 * (at[1] % 2);
        let quarters = &mut self.quarters;
        let open = self.open.entry(name).or_insert_with(|| OpenTile { record: quarters.add(), present: 0 });
        open.present |= 1 << number;
        let (record, present) = (open.record, open.present);
        let bytes = bytemuck::cast_slice(&quarter);
        self.quarters.write(KEEPING, record, self.start(number), bytes)?;
        if present == self.expected(level, name.1) { self.take(name).map(Some) } else { Ok(None) }
    }

    /// Names of the tiles of a level that are incomplete, row by row.
    pub(super) fn rest(&self, level: usize) -> Vec<TileName> {
        let mut names: Vec<TileName> = self.open.keys().copied().filter(|name| name.0 == level).collect();
        names.sort_unstable_by_key(|(_, [column, row])| [*row, *column]);
        names
    }

    /// Removes and returns a tile; quarters that have not come are NaN.
    pub(super) fn take(&mut self, name: TileName) -> Result<(TileName, Vec<f32>)> {
        let mut values = vec![f32::NAN; self.bands * TILE * TILE];
        let Some(OpenTile { record, present }) = self.open.remove(&name) else { return Ok((name, values)) };
        let mut quarter = vec![0f32; self.bands * HALF * HALF];
        for number in (0..4).filter(|number| present & (1 << number) != 0) {
            let bytes = bytemuck::cast_slice_mut(&mut quarter);
            self.quarters.read("reading overviews back", record, self.start(number), bytes)?;
            let start = number % 2 * HALF + number / 2 * HALF * TILE;
            let planes = values.chunks_exact_mut(TILE * TILE).zip(quarter.chunks_exact(HALF * HALF));
            for (plane, quarter) in planes {
                for (into, from) in plane[start..].chunks_mut(TILE).zip(quarter.chunks_exact(HALF)) {
                    into[..HALF].copy_from_slice(from);
                }
            }
        }
        self.quarters.forget(record);
        Ok((name, values))
    }

    /// First byte of a quarter in its record.
    fn start(&self, number: usize) -> u64 {
        (number * self.bands * QUARTER_LEN) as u64
    }

    /// Number of cells of a tile that are in the image, along each axis.
    fn inside(&self, level: usize, at: [usize; 2]) -> [usize; 2] {
        [0, 1].map(|axis| (self.sizes[level][axis] as usize - at[axis] * TILE).min(TILE))
    }

    /// Bit mask of the quarters that the tile at this column and row of level `level + 1` has.
    fn expected(&self, level: usize, [column, row]: [usize; 2]) -> u8 {
        let [across, down] = tiles_of(self.sizes[level]);
        let quarters = (0..4).filter(|n| 2 * column + n % 2 < across && 2 * row + n / 2 < down);
        quarters.map(|number| 1 << number).sum()
    }

    /// The tile at half the resolution; `inside` is the number of its cells that are in the image, along each
    /// axis.
    fn quarter(&self, values: &[f32], inside: [usize; 2]) -> Vec<f32> {
        let known = |column: usize, row: usize| {
            let value = values[row * TILE + column];
            (column < inside[0] && row < inside[1] && !value.is_nan()).then_some(value)
        };
        let reduced = |column: usize, row: usize| {
            let cells = [[0, 0], [1, 0], [0, 1], [1, 1]];
            let mut found = cells.iter().filter_map(|[x, y]| known(2 * column + x, 2 * row + y));
            match self.reduction {
                Reduction::First => found.next().unwrap_or(f32::NAN),
                Reduction::Mean => {
                    let (sum, count) =
                        found.fold((0.0, 0.0), |(sum, count), value| (sum + f64::from(value), count + 1.0));
                    (sum / count) as f32
                }
            }
        };
        (0..HALF * HALF).map(|cell| reduced(cell % HALF, cell / HALF)).collect()
    }
}

/// The action that errors of writing name.
const KEEPING: &str = "keeping overviews";
