//! Files beside sheets that describe them all.

use std::ffi::OsStr;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use spmesh_base::error::{Error, Result};
use spmesh_base::output::Output;
use spmesh_formats::raster::{Date, IndexKind, Mosaic, RasterFile, RasterFormat, Sheet};

/// What is written beside sheets to describe them.
#[derive(Debug, Clone, Default)]
pub struct Index {
    /// The kinds of descriptions, each once.
    kinds: Vec<IndexKind>,
    /// The date of the data.
    date: Option<Date>,
}

impl Index {
    /// Descriptions of these kinds, and of those that they need.
    ///
    /// # Errors
    /// Usage, if there is no date for a collection.
    pub fn new(kinds: &[IndexKind], date: Option<Date>) -> Result<Index> {
        let needs = |kind: IndexKind| match kind {
            IndexKind::Gti => vec![IndexKind::GeoJson, IndexKind::Gti],
            kind => vec![kind],
        };
        let mut all: Vec<IndexKind> = Vec::new();
        for kind in kinds.iter().copied().flat_map(needs) {
            if !all.contains(&kind) {
                all.push(kind);
            }
        }
        if all.contains(&IndexKind::Stac) && date.is_none() {
            return Err(Error::usage("items of a STAC collection state when the data are from: give --date"));
        }
        Ok(Index { kinds: all, date })
    }

    /// Refuses what cannot be described.
    pub(super) fn check(&self, path: &Path, format: RasterFormat) -> Result<()> {
        if self.has_items() && format != RasterFormat::GeoTiff {
            return Err(Error::usage("--tile-index stac is for GeoTIFF: take an output that ends in .tif"));
        }
        if !self.kinds.is_empty() && path.to_str().is_none() {
            return Err(not_text());
        }
        Ok(())
    }

    fn has_items(&self) -> bool {
        self.kinds.contains(&IndexKind::Stac)
    }

    /// The descriptions of the raster `path`, and their paths.
    pub(super) fn paths(&self, path: &Path) -> impl Iterator<Item = (IndexKind, PathBuf)> {
        let name = path.with_extension("");
        self.kinds.iter().map(move |&kind| {
            let mut path = name.clone().into_os_string();
            path.push(".");
            path.push(kind.ending());
            (kind, path.into())
        })
    }

    /// The path of the item of the sheet `name` of the raster `path`, if there are items.
    pub(super) fn item_of(&self, path: &Path, name: &OsStr) -> Option<PathBuf> {
        let mut name = name.to_os_string();
        name.push(".json");
        self.has_items().then(|| path.with_file_name(name))
    }

    /// Describes the sheets of the raster `path`, `count` in number. Returns the bytes of all files.
    pub(super) fn write(
        &self,
        path: &Path,
        file: &RasterFile,
        count: usize,
        sheet: &dyn Fn(usize) -> Sheet,
    ) -> Result<u64> {
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        if self.kinds.is_empty() {
            return Ok(0);
        }
        let folder = folder_of(path)?;
        let mosaic = Mosaic { file, name: &name, folder: &folder, date: self.date, count, sheet };
        let mut bytes = 0;
        if self.has_items() {
            for sheet in (0..count).map(sheet) {
                let item = mosaic.item(&sheet)?;
                let path = path.with_file_name(format!("{}.json", sheet.name));
                bytes += write_file(&path, |output| {
                    output.write_all(item.as_bytes()).map_err(|e| Error::io("writing", e))
                })?;
            }
        }
        for (kind, path) in self.paths(path) {
            bytes += write_file(&path, |output| mosaic.write(kind, output))?;
        }
        Ok(bytes)
    }
}

fn not_text() -> Error {
    Error::usage("a path that is not UTF-8 cannot stand in an index: give -o another one")
}

/// The folder of a file, from the root.
fn folder_of(path: &Path) -> Result<String> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let found = fs::canonicalize(folder).map_err(|e| Error::io("looking for the folder", e))?;
    found.into_os_string().into_string().map_err(|_| not_text())
}

fn write_file(path: &Path, write: impl FnOnce(&mut Output) -> Result<()>) -> Result<u64> {
    let mut output = Output::create(path, false)?;
    write(&mut output)?;
    let bytes = output.bytes_written();
    output.commit()?;
    Ok(bytes)
}
