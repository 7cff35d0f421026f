//! A raster in many files.

use std::collections::HashMap;
use std::ffi::OsString;
use std::fs;
use std::hash::BuildHasher;
use std::io::Seek;
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::dependencies::Dependencies;
use super::division::{Division, Strip, Strips};
use super::index::Index;
use super::names::Pattern;
use super::part::{Part, write};
use super::tile_store::TileStore;
use super::tiles::{TilePlace, TileSource, TileTarget, places, tiles_of};
use spmesh_base::error::{Error, Result};
use spmesh_base::inputs;
use spmesh_base::output::{Output, create_folder, remove_earlier};
use spmesh_formats::raster::{Grid, RasterFile, RasterFormat, Sheet, TILE};

/// A raster in many files, each of which gets its name when it is complete. Sheets without data are not
/// written; a file that has the name of one is removed.
#[derive(Debug)]
pub struct Sheets {
    /// The name of the raster, to which those of sheets are added.
    path: PathBuf,
    division: Division,
    names: Pattern,
    index: Index,
    /// Number of files.
    pub written: u64,
    /// Number of sheets without data.
    pub blank: u64,
    /// Number of sheets that a table has no name for.
    pub unnamed: u64,
    /// Length of all files. Units: bytes.
    pub bytes: u64,
}

impl Sheets {
    /// No sheets so far. `path` is the name of the raster: its folder and ending are those of sheets, whose
    /// names follow a pattern. The folder is made if necessary.
    ///
    /// # Errors
    /// If no files can be made there; usage, if the pattern does not fit the division.
    pub fn new(
        path: &Path,
        division: Division,
        names: Pattern,
        index: Index,
        format: RasterFormat,
    ) -> Result<Sheets> {
        let is_stream = path == Path::new("-") || fs::metadata(path).is_ok_and(|found| !found.is_file());
        if is_stream || path.file_name().is_none() {
            return Err(Error::usage("--tiles writes many files: give their name, as in -o folder/name.tif"));
        }
        names.check(division.size)?;
        index.check(path, format)?;
        path.parent().map_or(Ok(()), create_folder)?;
        // Fails now rather than after the work; it leaves no file.
        Output::create(path, format == RasterFormat::GeoTiff)?;
        Ok(Sheets {
            path: path.to_path_buf(),
            division,
            names,
            index,
            written: 0,
            blank: 0,
            unnamed: 0,
            bytes: 0,
        })
    }

    /// The name of a sheet, without its ending, if it has one.
    fn name_of(&self, strips: &[Strips; 2], at: TilePlace) -> Option<OsString> {
        self.names.name(self.path.file_stem().unwrap_or_default(), &self.division, strips, at)
    }

    /// The path of a sheet, if it has a name.
    fn path_of(&self, strips: &[Strips; 2], at: TilePlace) -> Option<PathBuf> {
        let (mut name, ending) = (self.name_of(strips, at)?, self.path.extension().unwrap_or_default());
        if !ending.is_empty() {
            name.push(".");
            name.push(ending);
        }
        Some(self.path.with_file_name(name))
    }

    /// The path of the item of a sheet, if there are items.
    fn item_of(&self, strips: &[Strips; 2], at: TilePlace) -> Option<PathBuf> {
        self.index.item_of(&self.path, &self.name_of(strips, at)?)
    }

    /// Refuses sheets that would replace inputs or each other.
    fn check_apart(&self, strips: &[Strips; 2]) -> Result<()> {
        // Names may be many, so only what is made of them is kept.
        let (hasher, mut seen) = (foldhash::fast::RandomState::default(), HashMap::new());
        self.index.paths(&self.path).try_for_each(|(_, path)| inputs::check_output(&path))?;
        for at in places([strips[0].len(), strips[1].len()]) {
            let Some(path) = self.path_of(strips, at) else { continue };
            inputs::check_output(&path)?;
            self.item_of(strips, at).map_or(Ok(()), |item| inputs::check_output(&item))?;
            if let Some(other) = seen.insert(hasher.hash_one(&path), at)
                && self.path_of(strips, other).as_ref() == Some(&path)
            {
                return Err(Error::usage(format!(
                    "two rasters would have the name {}: give --tile-name a pattern that tells them apart, such as \
                     {{x}}_{{y}}",
                    path.display()
                )));
            }
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
    /// The columns and rows of the raster among those of the tiles.
    raster: [Range<u32>; 2],
    tiles: [usize; 2],
    dependencies: Dependencies,
    store: TileStore,
    /// Sheets with data.
    written: Vec<TilePlace>,
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
        let counts = [file.grid.columns, file.grid.rows];
        let raster = [0, 1].map(|axis| first[axis]..first[axis] + counts[axis]);
        let tiles_of_strip =
            |strip: &Strip, axis: usize| tiles_of_cells(&behind(&strip.cells, &raster[axis]), &raster[axis]);
        let needs = [0, 1].map(|axis| strips[axis].iter().map(|strip| tiles_of_strip(strip, axis)).collect());
        let dependencies = Dependencies::new(tiles, needs);
        let store = TileStore::new(file.samples.bands(), memory, file.options.temp_dir.as_deref());
        Ok(Cutter { sheets, file: *file, strips, raster, tiles, dependencies, store, written: Vec::new() })
    }

    /// Writes the sheets that are left. Returns the number of tiles and the bytes that were in temporary
    /// files.
    pub(super) fn finish(mut self) -> Result<[u64; 2]> {
        for at in places(self.tiles) {
            if !self.dependencies.has_come(at) {
                self.come(at)?;
            }
        }
        self.write_index()?;
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
        let Some(path) = self.sheets.path_of(&self.strips, [column, row]) else {
            self.sheets.unnamed += 1;
            return Ok(());
        };
        let cells = [self.strips[0][column].cells.clone(), self.strips[1][row].cells.clone()];
        // Most sheets without data have no tiles either, and a file takes much longer than this test.
        let drawn = self.drawn(&cells);
        let [across, down] = [0, 1].map(|axis| tiles_of_cells(&drawn[axis], &self.raster[axis]));
        let has_tiles =
            down.into_iter().any(|row| across.clone().any(|column| self.store.holds([column, row])));
        if has_tiles && self.write_file(&path, cells)? {
            self.written.push([column, row]);
            return Ok(());
        }
        self.sheets.blank += 1;
        self.sheets
            .item_of(&self.strips, [column, row])
            .map_or(Ok(()), |item| remove_earlier(&item, "the item of a raster"))?;
        remove_earlier(&path, "the raster")
    }

    /// Writes what describes all sheets, after them.
    fn write_index(&mut self) -> Result<()> {
        // Row by row, in whatever order tiles have come.
        self.written.sort_unstable_by_key(|&[column, row]| [row, column]);
        let Cutter { sheets, strips, written, .. } = &*self;
        let sheet = |number: usize| {
            let [column, row] = written[number];
            let name = sheets.name_of(strips, [column, row]).unwrap_or_default();
            let path = sheets.path_of(strips, [column, row]).unwrap_or_default();
            Sheet {
                name: name.to_string_lossy().into_owned(),
                file_name: path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
                cells: [strips[0][column].cells.clone(), strips[1][row].cells.clone()],
            }
        };
        let bytes = sheets.index.write(&sheets.path, &self.file, written.len(), &sheet)?;
        self.sheets.bytes += bytes;
        Ok(())
    }

    /// Columns and rows of the raster as those of the tiles.
    fn drawn(&self, cells: &[Range<i64>; 2]) -> [Range<i64>; 2] {
        [0, 1].map(|axis| behind(&cells[axis], &self.raster[axis]))
    }

    /// Writes the file of a sheet, if it has data; returns whether it has.
    fn write_file(&mut self, path: &Path, cells: [Range<i64>; 2]) -> Result<bool> {
        let of_path = |error: Error| error.of_input(path.display().to_string());
        let file = RasterFile { grid: self.file.grid.part(&cells), is_staged: false, ..self.file };
        let drawn = self.drawn(&cells);
        let mut part = Part::new(&mut self.store, drawn, self.raster.clone(), file.samples.bands());
        let mut output = Output::create(path, file.options.format == RasterFormat::GeoTiff)?;
        write(&mut output, &file, &mut part).map_err(of_path)?;
        if !part.has_data {
            return Ok(false);
        }
        // Not the bytes written, of which some replace others.
        self.sheets.bytes += output.stream_position().map_err(|e| of_path(Error::io("writing", e)))?;
        self.sheets.written += 1;
        if file.options.format == RasterFormat::Ascii {
            file.reference.write_prj(path)?;
        }
        output.commit()?;
        Ok(true)
    }
}

/// Cells of the raster, along an axis on which it is in this place.
fn behind(cells: &Range<i64>, raster: &Range<u32>) -> Range<i64> {
    let first = i64::from(raster.start);
    cells.start + first..cells.end + first
}

/// The tiles along an axis that hold those of these cells that are in the raster.
fn tiles_of_cells(cells: &Range<i64>, raster: &Range<u32>) -> Range<usize> {
    let [start, end] = [cells.start.max(raster.start.into()), cells.end.min(raster.end.into())];
    start as usize / TILE..(end as usize).div_ceil(TILE)
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
