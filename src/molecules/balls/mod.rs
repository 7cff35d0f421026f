//! Unions of balls: areas, volumes and contacts of their cells.
//!
//! The power diagram of the balls divides their union into one cell for each: the points of the ball whose
//! power distance from it is the least. A cell is convex; it is bounded by part of its sphere, which is
//! *exposed*, and by flat faces, its *contacts* with other cells: what a polygon of the power diagram and a
//! disk have in common. `face` measures one such face, as an area and as the solid angles under which the two
//! centres see it; everything else follows:
//!
//! * the solid angles of all faces of a cell and of its exposed part add up to 4 pi if the centre is in the
//!   cell, and to 0 if it is outside, faces that the centre sees from behind being negative;
//! * the volume is that of the cones over all parts, a third of height times area each.
//!
//! The face between two cells depends only on balls that overlap one of the two. So large sets are cut
//! into tiles, each triangulated with the balls around it ([`tiles`]).
//!
//! Source: the cells are those of Edelsbrunner, "The union of balls and its dual shape", 1995; his inclusion
//! and exclusion gives the same sums, of which the faces are the parts that users ask for.

mod buried;
pub(crate) mod dual;
pub(crate) mod face;
mod gradients;
mod molecular;
mod near;
mod periodic;
mod pockets;
mod shares;
mod surface;
mod tile;
mod tiles;

pub use buried::{Burial, buried};
pub use gradients::{Gradient, gradients};
pub use molecular::{molecular_mesh, molecular_surface, molecular_surface_in_tiles};
pub use near::nearest;
pub use periodic::{PeriodicCells, measure_in_box};
pub use pockets::{Mouth, Pocket, Spheres, pocket_spheres, pockets};
pub use surface::{FINEST, Faces, Surface, faces, linings, surface};
pub use tiles::Contacts;

use spmesh_base::error::{Error, Result};
use spmesh_delaunay::parallel;
use spmesh_delaunay::predicates::Point3;
use std::num::NonZeroUsize;
use tile::Tile;
use tiles::TILE_MAX;

/// Balls as their centres and radii, of the same number.
#[derive(Debug, Clone, Copy)]
pub struct Balls<'b> {
    /// Finite coordinates.
    pub centres: &'b [Point3],
    /// Radii in the same unit, finite and not negative. With coordinates and radii that are integers below
    /// 2^26, the power diagram is exact; else that of the squares of the radii, rounded.
    pub radii: &'b [f64],
}

/// Area and volume of the cell of a ball; zero if it is empty.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Cell {
    /// Area of the exposed part of the sphere.
    pub area: f64,
    /// Volume.
    pub volume: f64,
}

/// The face between two cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// The balls, the lesser index first.
    pub balls: [u32; 2],
    /// Its area.
    pub area: f64,
}

/// All cells of a union, and the faces between them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Cells {
    /// The cells, one for each ball.
    pub cells: Vec<Cell>,
    /// The faces wanted, in the order of their balls.
    pub contacts: Contacts,
}

/// Measures the cells of balls. Faces are listed if `contacts_above` is given and their area is greater.
///
/// Angles are rounded; areas and volumes have an error of about 1e-14 of their ball's, and more where
/// tetrahedra are nearly flat, or centres nearly coincide: 1e-8 of theirs at 1e-7 of their radii, 1e-3 at
/// 1e-12. Where a centre lies in the planes of two faces it is 1e-8. The result does not depend on the number
/// of threads.
///
/// # Errors
/// As [`spmesh_delaunay::delaunay3::Kernel::triangulate_weighted`]; usage, if a coordinate or radius is above
/// 1e60.
///
/// Cost: O(n) for atoms of molecules, about twice the time of the triangulation. Memory: 16 bytes per ball
/// and per contact, and for each thread that of a tile, 8 MB.
///
/// ```
/// use spmesh_molecules::balls::{Balls, measure};
/// use std::f64::consts::PI;
/// use std::num::NonZeroUsize;
///
/// let balls = Balls { centres: &[[0.0; 3], [1.0, 0.0, 0.0]], radii: &[1.0, 1.0] };
/// let cells = measure(balls, Some(0.0), NonZeroUsize::MIN)?;
/// assert!((cells.contacts.iter().map(|contact| contact.area).sum::<f64>() - 0.75 * PI).abs() < 1e-14);
/// assert!((cells.cells[0].area - 3.0 * PI).abs() < 1e-13);
/// assert!((cells.cells[0].volume + cells.cells[1].volume - 9.0 / 4.0 * PI).abs() < 1e-13);
/// # Ok::<(), spmesh_base::error::Error>(())
/// ```
pub fn measure(balls: Balls<'_>, contacts_above: Option<f64>, threads: NonZeroUsize) -> Result<Cells> {
    check(balls)?;
    measure_in_tiles(balls, contacts_above, threads, TILE_MAX)
}

/// The faces between balls of different parts, as [`measure`] lists them: `parts` has the part of each ball.
/// Balls that no such face depends on are left out of the power diagram.
///
/// # Errors
/// As [`measure`].
pub fn contacts_between(balls: Balls<'_>, parts: &[u32], threads: NonZeroUsize) -> Result<Vec<Contact>> {
    check(balls)?;
    let kept = near::between_parts(balls, parts);
    let centres: Vec<Point3> = kept.iter().map(|&ball| balls.centres[ball as usize]).collect();
    let radii: Vec<f64> = kept.iter().map(|&ball| balls.radii[ball as usize]).collect();
    let found = measure(Balls { centres: &centres, radii: &radii }, Some(0.0), threads)?;
    let named = found
        .contacts
        .iter()
        .map(|&Contact { balls, area }| Contact { balls: balls.map(|ball| kept[ball as usize]), area });
    Ok(named
        .filter(|contact| contact.balls.map(|ball| parts[ball as usize]).windows(2).all(|p| p[0] != p[1]))
        .collect())
}

/// Greatest magnitude of coordinates and radii: squares and products of squares stay finite.
const GREATEST: f64 = 1e60;

fn check(balls: Balls<'_>) -> Result<()> {
    check_numbers(balls.centres, balls.radii)
}

/// Refuses numbers that are too large, or none.
pub(crate) fn check_numbers(points: &[Point3], radii: &[f64]) -> Result<()> {
    let is_fit = |number: &&f64| number.abs() <= GREATEST;
    match points.as_flattened().iter().chain(radii).find(|number| !is_fit(number)) {
        Some(number) if number.is_nan() => Err(Error::usage("a coordinate or radius is NaN, not a number")),
        Some(number) => {
            Err(Error::usage(format!("{number:e} is too large: balls are measured up to {GREATEST:e}")))
        }
        None => Ok(()),
    }
}

/// [`measure`] with at most `tile_max` balls in a tile, for those around it. This changes no more than
/// rounding.
///
/// # Errors
/// As [`measure`]; too large numbers give infinite results.
pub fn measure_in_tiles(
    balls: Balls<'_>,
    contacts_above: Option<f64>,
    threads: NonZeroUsize,
    tile_max: usize,
) -> Result<Cells> {
    measure_first(balls, balls.centres.len(), contacts_above, threads, tile_max)
}

/// The cells of the first `count` balls among all, and their contacts.
fn measure_first(
    balls: Balls<'_>,
    count: usize,
    contacts_above: Option<f64>,
    threads: NonZeroUsize,
    tile_max: usize,
) -> Result<Cells> {
    let tiles = tiles::cut_first(balls, count, tile_max);
    let measured = parallel::map(threads, tiles.iter(), |members| {
        let tile = Tile::new(balls, members)?;
        Ok(tile.measure(contacts_above, |_, _, _| ()))
    })?;
    let mut cells = vec![Cell::default(); count];
    let mut parts = Vec::with_capacity(tiles.len());
    for (members, part) in tiles.iter().zip(measured) {
        for (&ball, cell) in members.core.iter().zip(part.cells) {
            cells[ball as usize] = cell;
        }
        parts.push(part.contacts);
    }
    Ok(Cells { cells, contacts: Contacts::of_tiles(count, &tiles, parts) })
}
