//! Which cells are objects or pits: openings block by block, each with all cells around that its results
//! depend on.
//!
//! An opening by a disk depends on cells up to twice its radius away, and openings that follow each other on
//! those of all of them. So blocks give the same marks as one raster would, wherever they are cut.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use super::cells::{Lowest, Lows, Z_STEPS, first_cell, gather};
use super::opening::{GAP, Raster};
use super::parameters::Parameters;
use crate::accumulators::Accumulators;
use crate::files::TilePlace;
use spmesh_base::error::Result;
use spmesh_base::parallel::OrderedPool;
use spmesh_formats::raster::TILE;

/// Radius of the disk that closes pits, and of that whose cells are counted around one, in metres.
const PIT_RADII: [f64; 2] = [3.0, 5.0];
/// A pit is noise if at most this share of the cells around it is as low.
const PIT_SHARE: f64 = 0.1;
/// As low as a pit are cells that are at most so much higher, in metres.
const PIT_HEIGHT: f64 = 1.0;
/// Fewest cells with a point within the window of a cell whose point can be ground.
const COMPANY: u32 = 4;

/// A cell that loses more than this in one opening is an object whatever the limit, which grows with the
/// radius. In metres.
const OBJECT_HEIGHT: f64 = 2.0;

/// As many rasters are in memory for each block: its cells, their opposites, disks that were pushed up, their
/// opening.
const RASTERS: u64 = 4;
/// Side of a block, in tiles.
const BLOCK_TILES: usize = 4;
/// Openings that follow each other are done at once, as long as they depend on cells at most so far away.
const STAGE_HALO: usize = 384;

/// The limits of both rounds in cells and steps of z.
#[derive(Debug, Clone)]
pub(super) struct Rules {
    window: usize,
    /// Radii of pits.
    pit_radii: [usize; 2],
    pit: f32,
    pit_height: f32,
    /// What an opening may take away in each round: a constant, and as much for each cell of its radius.
    limits: [[f32; 2]; 2],
    /// The most that it may take away.
    object_height: f32,
}

impl Rules {
    /// The rules; `metre` is the length of one in units of x and y, and of z.
    pub(super) fn new(parameters: &Parameters, metre: [f64; 2]) -> Rules {
        let Parameters { cell, slope, residual_slope, step, pit, .. } = *parameters;
        let limit =
            |constant: f64, slope: f64| [constant, slope * cell].map(|value| (value * Z_STEPS) as f32);
        Rules {
            window: parameters.cells(parameters.window),
            pit_radii: PIT_RADII.map(|radius| parameters.cells(radius * metre[0])),
            pit: (pit * Z_STEPS) as f32,
            pit_height: (PIT_HEIGHT * metre[1] * Z_STEPS) as f32,
            limits: [limit(0.0, slope), limit(step, residual_slope)],
            object_height: (OBJECT_HEIGHT * metre[1] * Z_STEPS) as f32,
        }
    }

    /// Cells around one that its marks of both rounds depend on, beside the surface between them.
    pub(super) fn halo(&self) -> usize {
        self.noise_halo() + 2 * halo_of(&(1..self.window + 1))
    }

    /// Cells around a block that its noise depends on.
    fn noise_halo(&self) -> usize {
        self.window + self.pit_halo()
    }

    fn pit_halo(&self) -> usize {
        self.pit_radii[1].max(2 * self.pit_radii[0])
    }

    /// The radii of openings, in stages.
    fn stages(&self) -> Vec<Range<usize>> {
        let (mut stages, mut start) = (Vec::new(), 1);
        while start <= self.window {
            let fits = |end: &usize| halo_of(&(start..*end)) <= STAGE_HALO;
            let end = (start + 2..=self.window + 1).take_while(fits).last().unwrap_or(start + 1);
            stages.push(start..end);
            start = end;
        }
        stages
    }

    /// Memory for a block under way. Units: bytes.
    pub(super) fn block_memory(&self) -> u64 {
        let halo = self.stages().iter().map(halo_of).chain([self.noise_halo()]).max().unwrap_or(0);
        let side = BLOCK_TILES * TILE + 2 * halo;
        RASTERS * (side * side * size_of::<f32>()) as u64
    }

    /// The noise of a block, and its cells without it. Around the block, the raster has the halo of noise.
    fn noise(&self, raster: Raster) -> Done {
        let (border, window) = (self.pit_halo(), self.window);
        let pits = self.pits(&raster, border);
        let mut sound = raster.cropped(border);
        drop(raster);
        sound.values.iter_mut().zip(&pits).filter(|(_, is_pit)| **is_pit).for_each(|(z, _)| *z = GAP);
        let (known, mut left) = (Counts::of(&sound), sound.cropped(window));
        let columns = left.columns;
        for (at, z) in left.values.iter_mut().enumerate() {
            if known.around([at % columns + window, at / columns + window], window) < COMPANY {
                *z = GAP;
            }
        }
        let mark = |z: &f32| if *z == GAP { Lowest::NOISE } else { 0 };
        Done { marks: left.values.iter().map(mark).collect(), values: left.values }
    }

    /// Opens a block by disks with some radii, one after the other, and marks the cells from which one of
    /// them takes more away than the limits of a round allow. Around the block, the raster has the halo of
    /// these radii.
    fn open(&self, mut raster: Raster, radii: &Range<usize>, round: usize) -> Done {
        let halo = halo_of(radii);
        let (columns, rows) = (raster.columns - 2 * halo, raster.rows() - 2 * halo);
        let mut marks = vec![0; columns * rows];
        let [constant, by_radius] = self.limits[round];
        for radius in radii.clone() {
            let opened = raster.opened(radius);
            let limit = (constant + by_radius * radius as f32).min(self.object_height);
            let border = (opened.columns - columns) / 2;
            for (y, marks) in marks.chunks_exact_mut(columns).enumerate() {
                let inner = border + 2 * radius;
                let before = &raster.values[(y + inner) * raster.columns + inner..];
                let after = &opened.values[(y + border) * opened.columns + border..];
                for (mark, (before, after)) in marks.iter_mut().zip(before.iter().zip(after)) {
                    // Of two gaps this is NaN, which is not greater.
                    if before - after > limit {
                        *mark = Lowest::OBJECT[round];
                    }
                }
            }
            raster = opened;
        }
        Done { marks, values: raster.values }
    }

    /// The cells whose points are pits, without `border` cells at each side: far below a closing by a small
    /// disk, and few of the cells around are as low. Alleys and ditches are deep as well, but they go on.
    fn pits(&self, raster: &Raster, border: usize) -> Vec<bool> {
        let [closing, around] = self.pit_radii;
        let columns = raster.columns;
        let negative = Raster {
            columns,
            values: raster.values.iter().map(|z| if *z == GAP { GAP } else { -z }).collect(),
        };
        let closed = negative.opened(closing);
        let width = columns - 2 * border;
        let is_pit = |at: usize| {
            let [x, y] = [at % width + border, at / width + border];
            let z = raster.values[y * columns + x];
            let top = -closed.values[(y - 2 * closing) * closed.columns + x - 2 * closing];
            top - z > self.pit && self.is_rare(raster, [x, y], around, z + self.pit_height)
        };
        (0..width * (raster.rows() - 2 * border)).map(is_pit).collect()
    }

    /// Whether few cells of a disk are lower than `below`.
    fn is_rare(&self, raster: &Raster, [x, y]: [usize; 2], radius: usize, below: f32) -> bool {
        let (mut known, mut low) = (0u32, 0u32);
        for (row, reach) in super::opening::disk(radius).into_iter().enumerate() {
            let start = (y + row - radius) * raster.columns + x - reach;
            for z in &raster.values[start..=start + 2 * reach] {
                known += u32::from(*z != GAP);
                low += u32::from(*z < below);
            }
        }
        f64::from(low) <= (PIT_SHARE * f64::from(known)).max(1.0)
    }
}

/// How many cells have a point, in each rectangle from the lower left corner.
struct Counts {
    columns: usize,
    sums: Vec<u32>,
}

impl Counts {
    fn of(raster: &Raster) -> Counts {
        let columns = raster.columns + 1;
        let mut sums = vec![0; columns * (raster.rows() + 1)];
        for (y, values) in raster.values.chunks_exact(raster.columns).enumerate() {
            let mut row = 0;
            for (x, z) in values.iter().enumerate() {
                row += u32::from(*z != GAP);
                sums[(y + 1) * columns + x + 1] = sums[y * columns + x + 1] + row;
            }
        }
        Counts { columns, sums }
    }

    /// The cells with a point in the square around a cell, so many cells to each side.
    fn around(&self, [x, y]: [usize; 2], reach: usize) -> u32 {
        let sum = |x: usize, y: usize| self.sums[y * self.columns + x];
        let [left, right] = [x - reach, x + reach + 1];
        let [low, high] = [y - reach, y + reach + 1];
        sum(right, high) + sum(left, low) - sum(left, high) - sum(right, low)
    }
}

/// What is known of the cells of a block after a stage, row by row.
struct Done {
    marks: Vec<u16>,
    values: Vec<f32>,
}

/// How far away the cells are that openings by disks with these radii depend on.
fn halo_of(radii: &Range<usize>) -> usize {
    radii.clone().map(|radius| 2 * radius).sum()
}

/// Marks noise, and objects of the first round. The values of cells between stages are in `memory`.
///
/// # Errors
/// If temporary files fail, or the system refuses threads.
pub(super) fn mark_first(lows: &mut Lows, rules: &Rules, work: &mut Work) -> Result<()> {
    let of = rules.clone();
    let mut sound = work.values()?;
    let gather = |lows: &mut Lows, first, size| gather(&mut lows.tiles, first, size, GAP, Lowest::height);
    work.run(lows, rules.noise_halo(), gather, Some(&mut sound), move |raster| of.noise(raster))?;
    mark_objects(lows, sound, 0, rules, work)
}

/// Marks objects of a round, whose raster is in `values`.
///
/// # Errors
/// As [`mark_first`].
pub(super) fn mark_objects(
    lows: &mut Lows,
    mut values: Accumulators<f32>,
    round: usize,
    rules: &Rules,
    work: &mut Work,
) -> Result<()> {
    let stages = rules.stages();
    for (number, radii) in stages.iter().enumerate() {
        let (of, own) = (rules.clone(), radii.clone());
        let mut opened = if number + 1 < stages.len() { Some(work.values()?) } else { None };
        let gather = |_: &mut Lows, first, size| gather(&mut values, first, size, GAP, |value| *value);
        let open = move |raster| of.open(raster, &own, round);
        work.run(lows, halo_of(radii), gather, opened.as_mut(), open)?;
        if let Some(opened) = opened {
            values = opened;
        }
    }
    Ok(())
}

/// How blocks are worked on.
pub(super) struct Work<'p> {
    pub(super) threads: usize,
    /// Memory for values between stages. Units: bytes.
    pub(super) memory: u64,
    pub(super) temp_dir: Option<&'p Path>,
    /// Hears the number of blocks that are done.
    pub(super) progress: &'p mut dyn FnMut(u64),
    pub(super) done: u64,
}

impl Work<'_> {
    fn values(&self) -> Result<Accumulators<f32>> {
        Accumulators::anywhere(GAP, self.memory, self.temp_dir)
    }

    /// Does the work of a stage for all blocks with a halo; values go to `values`.
    fn run(
        &mut self,
        lows: &mut Lows,
        halo: usize,
        mut gather: impl FnMut(&mut Lows, [i64; 2], [usize; 2]) -> Result<Vec<f32>>,
        mut values: Option<&mut Accumulators<f32>>,
        work: impl Fn(Raster) -> Done + Send + Sync + 'static,
    ) -> Result<()> {
        let mut tiles: BTreeMap<[usize; 2], Vec<TilePlace>> = BTreeMap::new();
        for [x, y] in lows.tiles.tiles() {
            tiles.entry([y / BLOCK_TILES, x / BLOCK_TILES]).or_default().push([x, y]);
        }
        let work = move |raster: Raster| Part::of(raster, halo).map(|part| part.done(halo, &work));
        let mut pool = OrderedPool::start("opening", self.threads, self.threads as u64, work)?;
        let (mut blocks, mut given) = (tiles.values(), tiles.keys());
        loop {
            let next = if pool.is_full() { None } else { given.next() };
            if let Some(&[y, x]) = next {
                let first = first_cell([x * BLOCK_TILES, y * BLOCK_TILES]).map(|cell| cell - halo as i64);
                let columns = BLOCK_TILES * TILE + 2 * halo;
                pool.give(Raster { columns, values: gather(lows, first, [columns; 2])? }, 1);
                continue;
            }
            let (Some(done), Some(block)) = (pool.take(), blocks.next()) else { return Ok(()) };
            if let Some(part) = done {
                block.iter().try_for_each(|&tile| part.keep(tile, lows, values.as_deref_mut()))?;
            }
            self.done += 1;
            (self.progress)(self.done);
        }
    }
}

/// The part of a block with cells that are known, with its halo: what is beyond depends on none of them.
struct Part {
    raster: Raster,
    /// The lower left cell of the part in the block.
    corner: [usize; 2],
}

impl Part {
    /// `None` if nothing is known in the block.
    fn of(raster: Raster, halo: usize) -> Option<Part> {
        let side = raster.columns - 2 * halo;
        let row = |y: usize| &raster.values[(y + halo) * raster.columns + halo..][..side];
        let is_known = |y: &usize| row(*y).iter().any(|z| *z != GAP);
        let (low, high) = ((0..side).find(is_known)?, (0..side).rev().find(is_known)?);
        let ends = (low..=high).filter_map(|y| {
            let z = row(y);
            Some([z.iter().position(|z| *z != GAP)?, z.iter().rposition(|z| *z != GAP)?])
        });
        let [left, right] = ends.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])?;
        let (columns, rows) = (right - left + 1 + 2 * halo, high - low + 1 + 2 * halo);
        let rows = low..low + rows;
        let values = rows.flat_map(|y| &raster.values[y * raster.columns + left..][..columns]).copied();
        Some(Part { raster: Raster { columns, values: values.collect() }, corner: [left, low] })
    }

    /// What work makes of the part.
    fn done(self, halo: usize, work: &impl Fn(Raster) -> Done) -> DonePart {
        let columns = self.raster.columns - 2 * halo;
        DonePart { done: work(self.raster), columns, corner: self.corner }
    }
}

/// A part of a block after a stage, without its halo.
struct DonePart {
    done: Done,
    columns: usize,
    corner: [usize; 2],
}

impl DonePart {
    /// Adds marks and values to the cells of a tile of the block.
    fn keep(
        &self,
        tile: TilePlace,
        lows: &mut Lows,
        mut values: Option<&mut Accumulators<f32>>,
    ) -> Result<()> {
        let rows = self.done.marks.len() / self.columns;
        let [x, y] = [(0, self.columns), (1, rows)].map(|(axis, count)| {
            let (start, corner) = (tile[axis] % BLOCK_TILES * TILE, self.corner[axis]);
            start.max(corner) - start..(start + TILE).min(corner + count).max(start) - start
        });
        for row in y {
            let from = row + tile[1] % BLOCK_TILES * TILE - self.corner[1];
            for column in x.clone() {
                let from = from * self.columns + column + tile[0] % BLOCK_TILES * TILE - self.corner[0];
                let (cell, mark, value) =
                    (row * TILE + column, self.done.marks[from], self.done.values[from]);
                if mark != 0 {
                    lows.tiles.cell(tile, cell)?.marks |= mark;
                }
                if let Some(values) = values.as_deref_mut().filter(|_| value != GAP) {
                    *values.cell(tile, cell)? = value;
                }
            }
        }
        Ok(())
    }
}
