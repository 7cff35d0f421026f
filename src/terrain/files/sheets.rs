//! A raster in many files.

use std::fs;
use std::io::Seek;
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::dependencies::Dependencies;
use super::division::{Division, Strips};
use super::part::{Part, write};
use super::tile_store::TileStore;
use super::tiles::{TilePlace, TileSource, TileTarget, places, tiles_of};
use spmesh_base::error::{Error, Result};
use spmesh_base::inputs;
use spmesh_base::output::{Output, create_folder, remove_earlier};
use spmesh_formats::raster::{Grid, RasterFile, RasterFormat, TILE};

/// A raster in many files, each of which gets its name when it is complete. Sheets without data are not
/// written; a file that has the name of one is removed.
#[derive(Debug)]
pub struct Sheets {
    /// The name of the raster, to which those of sheets are added.
    path: PathBuf,
    division: Division,
    /// Number of files.
    pub written: u64,
    /// Number of sheets without data.
    pub blank: u64,
    /// Length of all files. Units: bytes.
    pub bytes: u64,
}

impl Sheets {
    /// No sheets so far. `path` is the name of the raster: sheets of `dir/name.tif` are `dir/name_X_Y.tif`.
    /// Their folder is made if necessary.
    ///
    /// # Errors
    /// If no files can be made there.
    pub fn new(path: &Path, division: Division, format: RasterFormat) -> Result<Sheets> {
        let is_stream = path == Path::new("-") || fs::metadata(path).is_ok_and(|found| !found.is_file());
        if is_stream || path.file_name().is_none() {
            return Err(Error::usage("--tiles writes many files: give their name, as in -o folder/name.tif"));
        }
        path.parent().map_or(Ok(()), create_folder)?;
        // Fails now rather than after the work; it leaves no file.
        Output::create(path, format == RasterFormat::GeoTiff)?;
        Ok(Sheets { path: path.to_path_buf(), division, written: 0, blank: 0, bytes: 0 })
    }

    /// The path of a sheet.
    fn path_of(&self, names: [&str; 2]) -> PathBuf {
        let [mut name, ending] = [self.path.file_stem(), self.path.extension()]
            .map(Option::unwrap_or_default)
            .map(ToOwned::to_owned);
        for part in names {
            name.push("_");
            name.push(part);
        }
        if !ending.is_empty() {
            name.push(".");
            name.push(ending);
        }
        self.path.with_file_name(name)
    }

    /// Refuses sheets that would replace inputs.
    fn check_apart(&self, strips: &[Strips; 2]) -> Result<()> {
        for [column, row] in places([strips[0].len(), strips[1].len()]) {
            let path = self.path_of([&strips[0][column].name, &strips[1][row].name]);
            inputs::check_output(&path)?;
        }
        Ok(())
    }
}

/// Cuts tiles of a raster into sheets, and writes each as soon as all of its tiles have come.
///
/// Memory: the budget, and some 10 bytes for each tile and each sheet. Tiles wait only while a sheet needs
/// them.
pub(super) struct Cutter<'s> {
    sheets: &'s mut Sheets,
    file: RasterFile<'s>,
    strips: [Strips; 2],
    /// The first column and row of the raster among those of the tiles.
    first: [u32; 2],
    tiles: [usize; 2],
    dependencies: Dependencies,
    store: TileStore,
}

impl<'s> Cutter<'s> {
    /// A cutter of a raster, which starts at the cell `first` of the grid that tiles are of; tiles beyond
    /// `memory` wait in a temporary file.
    pub(super) fn new(
        sheets: &'s mut Sheets,
        file: &RasterFile<'s>,
        grid: &Grid,
        first: [u32; 2],
        memory: u64,
    ) -> Result<Cutter<'s>> {
        let tiles = tiles_of(grid)?;
        let strips = sheets.division.strips(&file.grid)?;
        sheets.check_apart(&strips)?;
        let needs = [0, 1].map(|axis| {
            strips[axis].iter().map(|strip| tiles_of_cells(&behind(&strip.cells, first[axis]))).collect()
        });
        let dependencies = Dependencies::new(tiles, needs);
        let store = TileStore::new(file.samples.bands(), memory, file.options.temp_dir.as_deref());
        Ok(Cutter { sheets, file: *file, strips, first, tiles, dependencies, store })
    }

    /// Writes the sheets that are left. Returns the number of tiles and the bytes that were in temporary
    /// files.
    pub(super) fn finish(mut self) -> Result<[u64; 2]> {
        for at in places(self.tiles) {
            if !self.dependencies.has_come(at) {
                self.come(at)?;
            }
        }
        Ok([self.store.spilled, self.store.spill_len()])
    }

    /// Takes note of a tile, and writes the sheets that are complete with it.
    fn come(&mut self, at: TilePlace) -> Result<()> {
        for sheet in self.dependencies.come(at) {
            self.write(sheet)?;
            self.dependencies.made(sheet).into_iter().for_each(|tile| self.store.remove(tile));
        }
        Ok(())
    }

    /// Writes a sheet, or removes the file that has its name if it has no data.
    fn write(&mut self, [column, row]: TilePlace) -> Result<()> {
        let [columns, rows] = [&self.strips[0][column], &self.strips[1][row]];
        let path = self.sheets.path_of([&columns.name, &rows.name]);
        let cells = [columns.cells.clone(), rows.cells.clone()];
        // Most sheets without data have no tiles either, and a file takes much longer than this test.
        let [columns, rows] = self.drawn(&cells).each_ref().map(tiles_of_cells);
        let has_tiles =
            rows.into_iter().any(|row| columns.clone().any(|column| self.store.holds([column, row])));
        if has_tiles && self.write_file(&path, cells)? {
            return Ok(());
        }
        self.sheets.blank += 1;
        remove_earlier(&path, "the raster")
    }

    /// Columns and rows of the raster as those of the tiles.
    fn drawn(&self, cells: &[Range<u32>; 2]) -> [Range<u32>; 2] {
        [0, 1].map(|axis| behind(&cells[axis], self.first[axis]))
    }

    /// Writes the file of a sheet, if it has data; returns whether it has.
    fn write_file(&mut self, path: &Path, cells: [Range<u32>; 2]) -> Result<bool> {
        let of_path = |error: Error| error.of_input(path.display().to_string());
        let file = RasterFile { grid: window(&self.file.grid, &cells), is_staged: false, ..self.file };
        let drawn = self.drawn(&cells);
        let mut part = Part::new(&mut self.store, drawn, file.samples.bands());
        let mut output = Output::create(path, file.options.format == RasterFormat::GeoTiff)?;
        write(&mut output, &file, &mut part).map_err(of_path)?;
        if !part.has_data {
            return Ok(false);
        }
        // Not the bytes written, of which some replace others.
        self.sheets.bytes += output.stream_position().map_err(|e| of_path(Error::io("writing", e)))?;
        self.sheets.written += 1;
        output.commit()?;
        Ok(true)
    }
}

/// Cells along an axis that begins `first` cells earlier.
fn behind(cells: &Range<u32>, first: u32) -> Range<u32> {
    cells.start + first..cells.end + first
}

/// The tiles along an axis that hold these cells.
fn tiles_of_cells(cells: &Range<u32>) -> Range<usize> {
    cells.start as usize / TILE..(cells.end as usize).div_ceil(TILE)
}

impl TileSource for Cutter<'_> {
    fn get(&mut self, at: TilePlace, values: &mut [f32]) -> Result<bool> {
        self.store.get(at, values)
    }
}

impl TileTarget for Cutter<'_> {
    fn put(&mut self, at: TilePlace, values: &[f32]) -> Result<()> {
        self.store.put(at, values)?;
        // Tiles that are to be read back must stay.
        if self.file.is_staged { Ok(()) } else { self.come(at) }
    }

    fn skip(&mut self, at: TilePlace) -> Result<()> {
        if self.file.is_staged { Ok(()) } else { self.come(at) }
    }
}

/// The grid of some columns and rows.
fn window(grid: &Grid, [columns, rows]: &[Range<u32>; 2]) -> Grid {
    Grid {
        left: grid.left + f64::from(columns.start) * grid.step,
        top: grid.top - f64::from(rows.start) * grid.step,
        step: grid.step,
        columns: columns.end - columns.start,
        rows: rows.end - rows.start,
    }
}
