//! Text and streams with the heights of their points.

use std::io::Write;
use std::num::NonZeroUsize;

use super::files::{BATCH_MAX, Counts, FileOptions, HeightPlace, POINT_LEN};
use super::ground::Ground;
use super::heights::{Heights, Unit};
use super::points::unit_of;
use spmesh_base::error::{Error, Result};
use spmesh_formats::source::{Alignment, StreamFile, TextFile};
use spmesh_stream::model::attributes::{Attribute, NumberType};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, Crs};

/// Bytes of a line, about.
const LINE_LEN: u64 = 64;

/// Writes the lines of `file` again, each point with its height above `ground` in one more column; calls
/// `progress` with the number of points written. The points are in the system `crs`.
///
/// Heights have the decimals of the elevation of the first point, but from 3 to 9. A point without a height
/// has NaN.
///
/// Memory: `options.memory`, and that of [`Ground`].
///
/// # Errors
/// Usage, if the coordinate reference systems differ, or heights should replace z; malformed, if the file is; if
/// reading or writing fails.
pub fn write_text_heights<W: Write>(
    ground: &Ground,
    file: &TextFile,
    crs: &Crs,
    mut output: W,
    options: &FileOptions,
    mut progress: impl FnMut(u64),
) -> Result<(W, Counts)> {
    let of_file = |e: Error| e.of_input(file.name());
    let name = checked_name(ground, crs, options).map_err(of_file)?;
    if name.contains('"') {
        return Err(of_file(Error::usage("--name takes no quotation marks where the name goes to text")));
    }
    let most = (options.memory / (POINT_LEN + 3 * LINE_LEN)).clamp(1, BATCH_MAX);
    let mut finder = WorldHeights::new(ground, &Coordinates::F64, options);
    file.write_with((name, None), most as usize, &mut output, |points, heights| {
        finder.of(points, heights)?;
        progress(finder.counts.points);
        Ok(())
    })?;
    let counts = finder.counts;
    Ok((output, counts))
}

/// Writes the stream `file` again, each point with its height above `ground` as one more attribute; calls
/// `progress` with the number of points written. A point without a height has NaN.
///
/// Memory: `options.memory`, and that of [`Ground`].
///
/// # Errors
/// Usage, if the coordinate reference systems differ, points have such an attribute, or heights should
/// replace z; malformed, if the stream is; if reading or writing fails.
pub fn write_stream_heights<W: Write>(
    ground: &Ground,
    file: &StreamFile,
    output: W,
    options: &FileOptions,
    mut progress: impl FnMut(u64),
) -> Result<(W, Counts)> {
    let header = file.header();
    let name = checked_name(ground, &header.crs, options).map_err(|e| e.of_input(file.name()))?;
    let attribute =
        Attribute { unknown: Some(f64::NAN.to_le_bytes().to_vec()), ..Attribute::new(name, NumberType::F64) };
    let row_len = header.attributes.row_len() as u64;
    let most = (options.memory / (POINT_LEN + 3 * row_len + LINE_LEN)).clamp(1, BATCH_MAX);
    let mut finder = WorldHeights::new(ground, &header.coordinates, options);
    let mut heights = Vec::new();
    let output = file.write_with(attribute, most as usize, output, |points, numbers| {
        finder.of(points, &mut heights)?;
        numbers.clear();
        heights.iter().for_each(|height: &f64| numbers.extend_from_slice(&height.to_le_bytes()));
        progress(finder.counts.points);
        Ok(())
    })?;
    Ok((output, finder.counts))
}

/// The name of what heights are written to.
fn checked_name<'o>(ground: &Ground, crs: &Crs, options: &'o FileOptions) -> Result<&'o str> {
    ground.check_system(crs)?;
    match &options.place {
        HeightPlace::Field(name) => Ok(name),
        HeightPlace::Z => Err(Error::usage(
            "heights replace z in LAS files alone: leave out --replace-z, they are one more column or attribute",
        )),
    }
}

/// Finds heights in units of the world, and counts them.
struct WorldHeights<'g> {
    heights_above: Heights<'g>,
    alignment: Alignment,
    per_unit: f64,
    placed: Vec<Point>,
    counts: Counts,
}

impl<'g> WorldHeights<'g> {
    fn new(ground: &'g Ground, coordinates: &Coordinates, options: &FileOptions) -> WorldHeights<'g> {
        let threads = NonZeroUsize::new(options.threads).unwrap_or(NonZeroUsize::MIN);
        WorldHeights {
            heights_above: Heights::new(ground, Unit::Stored, options.outside, threads),
            alignment: Alignment::between(coordinates, ground.coordinates()),
            per_unit: unit_of(ground.coordinates()),
            placed: Vec::new(),
            counts: Counts::default(),
        }
    }

    /// Replaces `heights` with those of stored points, NaN where there is none.
    fn of(&mut self, points: &[Point], heights: &mut Vec<f64>) -> Result<()> {
        self.placed.clear();
        self.placed.extend(points.iter().map(|&point| self.alignment.place(point)));
        self.counts.outside += self.heights_above.of(&self.placed, heights)?;
        for height in heights {
            // One NaN stands for all.
            *height = if height.is_nan() { f64::NAN } else { *height * self.per_unit };
            self.counts.without += u64::from(height.is_nan());
            self.counts.below += u64::from(*height < 0.0);
        }
        self.counts.points += points.len() as u64;
        Ok(())
    }
}
