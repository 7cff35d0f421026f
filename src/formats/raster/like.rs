//! The grid of an existing GeoTIFF.

use std::path::Path;

use crate::crs::{GeoKeys, System, differences};
use crate::raster::Grid;
use crate::raster::geotiff::{KEY_DIRECTORY, KEY_DOUBLES, KEY_TEXTS, PIXEL_SCALE, TIEPOINT};
use crate::raster::tags::{HEIGHT, Tags, WIDTH};
use spmesh_base::error::{Error, Result};
use spmesh_base::inputs;
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
        let message = format!(
            "its cells are in {}, the data in {} ({}): warp it first, for example with gdalwarp -t_srs{}",
            name(&of_file),
            name(&of_data),
            found.join(", "),
            of_data.argument()
        );
        located(path, Err(Error::usage(message)))
    }
}

fn located<T>(path: &Path, result: Result<T>) -> Result<T> {
    result.map_err(|error| error.of_input(path.display().to_string()))
}

/// The cells, and what x and y are.
fn read(path: &Path) -> Result<(Grid, System)> {
    let file = inputs::open(path)?;
    let malformed = |fault| Error::malformed(format!("this cannot be read as TIFF: {fault}"));
    let tags = Tags::read(&file).map_err(malformed)?;
    let (Some(columns), Some(rows)) = (tags.integer(WIDTH), tags.integer(HEIGHT)) else {
        return Err(malformed("it has no image of one width and height".to_string()));
    };
    let (scale, tie) = (tags.numbers(PIXEL_SCALE), tags.numbers(TIEPOINT));
    let (&[width, height, ..], &[column, row, _, x, y, ..]) = (&scale[..], &tie[..]) else {
        let what =
            "it does not say where its cells are by their size and one place: warp it to a plain grid first";
        return Err(Error::malformed(what));
    };
    if !(width > 0.0 && width.is_finite() && [column, row, x, y].iter().all(|number| number.is_finite())) {
        return Err(Error::malformed(format!("cells of size {width} at {x}, {y} cannot be")));
    }
    let keys = GeoKeys {
        directory: tags.shorts(KEY_DIRECTORY),
        doubles: tags.numbers(KEY_DOUBLES),
        texts: tags.text(KEY_TEXTS),
    };
    // The tie point may be the centre of a cell instead of its corner.
    let half = if keys.is_of_points() { 0.5 * width } else { 0.0 };
    if width != height {
        return Err(Error::usage(format!("its cells are {width} by {height}, ours are square")));
    }
    let grid =
        Grid { left: x - column * width - half, top: y + row * width + half, step: width, columns, rows };
    Ok((grid, System { vertical: None, ..System::from(&keys) }))
}
