//! Balls in a periodic box: with the images that overlap them.

use super::{Balls, Cell, Cells, check, measure_first, tiles::TILE_MAX};
use crate::cells::SiteFace;
use crate::cells::images::Repeated;
use crate::cells::lattice::Lattice;
use spmesh_base::error::Result;
use spmesh_delaunay::predicates::Point3;
use spmesh_delaunay::vector::{difference, dot};
use std::num::NonZeroUsize;

/// The cells of balls in a box, and the faces between them and images.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PeriodicCells {
    /// The cells, one for each ball.
    pub cells: Vec<Cell>,
    /// The faces wanted, each once, in the order of balls and shifts.
    pub contacts: Vec<SiteFace>,
}

/// As [`super::measure`], for balls that a box of three vectors repeats in all directions.
///
/// A ball takes no part of the cell of another that it does not overlap. So all images that overlap a ball in
/// the box are enough. Balls may be outside of the box.
///
/// # Errors
/// As [`super::measure`] and [`crate::cells::cells`].
///
/// Cost and memory: those of [`super::measure`] for balls and images.
///
/// # Panics
/// If there are more or fewer radii than centres.
pub fn measure_in_box(
    balls: Balls<'_>,
    vectors: [Point3; 3],
    contacts_above: Option<f64>,
    threads: NonZeroUsize,
) -> Result<PeriodicCells> {
    assert_eq!(balls.centres.len(), balls.radii.len(), "a radius for each ball");
    check(balls)?;
    let count = balls.centres.len();
    let mut lattice = Lattice::new(vectors);
    // More than rounding, so that balls that touch are there.
    let reach = 2.0 * balls.radii.iter().fold(0.0, |most: f64, &radius| most.max(radius)) * (1.0 + 1e-9);
    lattice.put_on_grid(lattice.extents(reach));
    let repeated = Repeated::new(lattice, balls.centres)?;
    let images = repeated.images(repeated.lattice().extents(reach))?;
    let centres: Vec<Point3> =
        repeated.in_box().chain(images.iter().map(|&image| repeated.place(image))).collect();
    let of_images = images.iter().map(|image| balls.radii[image.point as usize]);
    let radii: Vec<f64> = balls.radii.iter().copied().chain(of_images).collect();
    let all = Balls { centres: &centres, radii: &radii };
    let Cells { cells, contacts } = measure_first(all, count, contacts_above, threads, TILE_MAX)?;
    let face = |contact: &super::Contact| {
        let [first, second] = contact.balls;
        let between = difference(centres[second as usize], centres[first as usize]);
        let (second, shift) = match images.get((second as usize).wrapping_sub(count)) {
            Some(&image) => (image.point, repeated.shift(first, image)),
            None => (second, repeated.shift_in_box(first, second)),
        };
        let distance = dot(between, between).sqrt();
        let face = SiteFace { sites: [first, second], shift, distance, area: contact.area };
        face.is_listed().then_some(face)
    };
    let mut contacts: Vec<SiteFace> = contacts.iter().filter_map(face).collect();
    contacts.sort_unstable_by_key(|face| (face.sites, face.shift));
    Ok(PeriodicCells { cells, contacts })
}
