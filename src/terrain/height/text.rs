//! Text with the heights of its points.

use std::io::Write;
use std::num::NonZeroUsize;

use super::files::{BATCH_MAX, Counts, FileOptions, HeightPlace, POINT_LEN};
use super::ground::Ground;
use super::heights::{Heights, Unit};
use super::points::unit_of;
use spmesh_base::error::{Error, Result};
use spmesh_formats::source::{Alignment, TextFile};
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
    ground.check_system(crs).map_err(of_file)?;
    let HeightPlace::Field(name) = &options.place else {
        let message = "heights do not replace z in text: leave out --replace-z, they are one more column";
        return Err(of_file(Error::usage(message)));
    };
    if name.contains('"') {
        return Err(of_file(Error::usage("--name takes no quotation marks where the name goes to text")));
    }
    let alignment = Alignment::between(&Coordinates::F64, ground.coordinates());
    let per_unit = unit_of(ground.coordinates());
    let threads = NonZeroUsize::new(options.threads).unwrap_or(NonZeroUsize::MIN);
    let mut heights_above = Heights::new(ground, Unit::Stored, options.outside, threads);
    let most = (options.memory / (POINT_LEN + 3 * LINE_LEN)).clamp(1, BATCH_MAX);
    let (mut counts, mut placed) = (Counts::default(), Vec::new());
    file.write_with((name, None), most as usize, &mut output, |points, heights| {
        placed.clear();
        placed.extend(points.iter().map(|&point| alignment.place(point)));
        counts.outside += heights_above.of(&placed, heights)?;
        for height in heights {
            *height *= per_unit;
            counts.without += u64::from(height.is_nan());
            counts.below += u64::from(*height < 0.0);
        }
        counts.points += points.len() as u64;
        progress(counts.points);
        Ok(())
    })?;
    Ok((output, counts))
}
