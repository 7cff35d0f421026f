//! The grid of an existing GeoTIFF.

use std::io::BufReader;
use std::path::Path;

use tiff::decoder::Decoder;
use tiff::tags::Tag;

use crate::crs::{GeoKeys, System, differences};
use crate::raster::Grid;
use crate::raster::geotiff::{KEY_DIRECTORY, KEY_DOUBLES, KEY_TEXTS, PIXEL_SCALE, TIEPOINT};
use crate::source::open_file;
use spmesh_base::error::{Error, Result};
use spmesh_stream::Crs;

impl Grid {
    /// The cells of a GeoTIFF.
    ///
    /// # Errors
    /// If it cannot be read, is not a GeoTIFF, or has cells that are not square or not along the axes.
    pub fn of_file(path: &Path) -> Result<Grid> {
        located(path, read(path)).map(|(grid, _)| grid)
    }

    /// The cells of a GeoTIFF for data in `crs`. Nothing is compared if the file or `crs` states no system.
    ///
    /// # Errors
    /// As [`Grid::of_file`]; usage, if x and y of the two systems differ.
    pub fn of_file_for(path: &Path, crs: &Crs) -> Result<Grid> {
        let (grid, of_file) = located(path, read(path))?;
        let of_data = System { vertical: None, ..System::of(crs) };
        let found = differences(&of_file, &of_data);
        if found.is_empty() {
            return Ok(grid);
        }
        let name = |system: &System| system.name().unwrap_or_else(|| "a system without a name".to_string());
        let (of_file, of_data) = (name(&of_file), name(&of_data));
        let message = format!(
            "its cells are in {of_file}, the data in {of_data} ({}): warp it first, for example with gdalwarp -t_srs \
             {of_data}",
            found.join(", ")
        );
        located(path, Err(Error::usage(message)))
    }
}

fn located<T>(path: &Path, result: Result<T>) -> Result<T> {
    result.map_err(|error| error.of_input(path.display().to_string()))
}

/// The cells, and what x and y are.
fn read(path: &Path) -> Result<(Grid, System)> {
    let (file, _) = open_file(path)?;
    let malformed =
        |error: tiff::TiffError| Error::malformed(format!("this cannot be read as TIFF: {error}"));
    let mut decoder = Decoder::new(BufReader::new(file)).map_err(malformed)?;
    let (columns, rows) = decoder.dimensions().map_err(malformed)?;
    let mut numbers = |tag: u16| decoder.get_tag_f64_vec(Tag::Unknown(tag)).unwrap_or_default();
    let (scale, tie) = (numbers(PIXEL_SCALE), numbers(TIEPOINT));
    let (&[width, height, ..], &[column, row, _, x, y, ..]) = (&scale[..], &tie[..]) else {
        let what =
            "it does not say where its cells are by their size and one place: warp it to a plain grid first";
        return Err(Error::malformed(what));
    };
    if !(width > 0.0 && width.is_finite() && [column, row, x, y].iter().all(|number| number.is_finite())) {
        return Err(Error::malformed(format!("cells of size {width} at {x}, {y} cannot be")));
    }
    let directory = decoder.get_tag_u16_vec(Tag::Unknown(KEY_DIRECTORY)).unwrap_or_default();
    let doubles = decoder.get_tag_f64_vec(Tag::Unknown(KEY_DOUBLES)).unwrap_or_default();
    let texts = decoder.get_tag_ascii_string(Tag::Unknown(KEY_TEXTS)).unwrap_or_default();
    let keys = GeoKeys { directory, doubles, texts };
    // The tie point may be the centre of a cell instead of its corner.
    let half = if keys.is_of_points() { 0.5 * width } else { 0.0 };
    if width != height {
        return Err(Error::usage(format!("its cells are {width} by {height}, ours are square")));
    }
    let grid =
        Grid { left: x - column * width - half, top: y + row * width + half, step: width, columns, rows };
    Ok((grid, System { vertical: None, ..System::from(&keys) }))
}
