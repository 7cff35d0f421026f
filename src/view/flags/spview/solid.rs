//! Surfaces in PLY.

use std::io::Read;
use std::path::Path;

use super::{Flags, LIGHT};
use crate::{Picture, SolidOptions, When, draw_solid};
use spmesh_base::error::{Error, Result};
use spmesh_formats::source::read_ply_surface;
use spmesh_shell::parse_numbers;

/// The first bytes of PLY.
const MAGIC: &[u8] = b"ply";

/// The eye by default.
const EYE: [f64; 2] = [30.0, 20.0];

/// The first bytes of an input. Few, as a pipe may have no more yet.
pub(super) fn head(input: &mut impl Read) -> std::io::Result<Vec<u8>> {
    let mut head = Vec::new();
    input.take(MAGIC.len() as u64).read_to_end(&mut head)?;
    Ok(head)
}

/// Whether an input that starts with these bytes is PLY, and no stream.
pub(super) fn is_surface(head: &[u8]) -> bool {
    head == MAGIC
}

/// The picture of a surface.
pub(super) fn draw(flags: &Flags, input: impl Read, name: &str) -> Result<Picture> {
    check(flags).map_err(|e| e.of_input(name))?;
    let title = Path::new(name).file_name().map_or(name.into(), |name| name.to_string_lossy());
    let surface = read_ply_surface(input, name)?;
    let options =
        SolidOptions { name: title.into_owned(), width: flags.width, eye: flags.eye.unwrap_or(EYE) };
    draw_solid(&surface, &options).map_err(|e| e.of_input(name))
}

fn check(flags: &Flags) -> Result<()> {
    let of_streams = [
        ("--fill", flags.fill.is_some()),
        ("--colour-by", flags.colour_by.is_some()),
        ("--edges", flags.edges != When::Auto),
        ("--oblique", flags.oblique),
        ("--bounds", flags.bounds.is_some()),
        ("--vector", flags.vector),
        ("--at", flags.at.is_some()),
        ("--snapshot", flags.snapshot.is_some()),
        ("--tee", flags.tee),
        ("--order", flags.order.is_some()),
        ("--set", flags.set.is_some()),
        ("--apart", flags.apart),
        ("--no-cells", flags.no_cells),
        ("--stretch", flags.stretch.is_some()),
        ("--range", flags.range.is_some()),
        ("--middle", flags.middle.is_some()),
        ("--kill", flags.outline.kill()?.is_some()),
        ("--concave", flags.outline.concave()?.is_some()),
        ("--mask", flags.outline.mask_path().is_some()),
        ("--crs", flags.crs.system()?.is_some()),
        // Surfaces have their light at the eye.
        ("--light", parse_numbers(LIGHT) != Ok(flags.light)),
    ];
    match of_streams.into_iter().find(|(_, is_given)| *is_given) {
        Some((flag, _)) => Err(Error::usage(format!(
            "{flag} is for streams, this is a surface in PLY with colours of its own"
        ))),
        None if flags
            .eye
            .is_some_and(|[azimuth, altitude]| !(azimuth.is_finite() && altitude.abs() <= 90.0)) =>
        {
            Err(Error::usage("--eye takes two angles in degrees, the second from -90 to 90"))
        }
        None => Ok(()),
    }
}
