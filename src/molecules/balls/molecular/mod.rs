//! The molecular surface: the boundary of what a rolling probe cannot reach.
//!
//! Let the radii of the balls include that of the probe. The probe's centre can reach what the union of the
//! balls does not cover, and the *excluded* body is what is at least the probe's radius away from there. So
//! it is the union without a *layer* along its boundary. Each point of the layer belongs to the nearest point
//! of the boundary: on a sphere, on an arc of two spheres, or at a corner of three. The layers next to these
//! are bounded by convex patches, saddles and concave patches; `cone` and `concave` have their measures.
//!
//! Source: Connolly, "Analytical molecular surface calculation", 1983. That other probes at rest are all that
//! cuts a concave patch: Quan and Stamm, "Mathematical analysis and calculation of molecular surfaces", 2016.

mod concave;
mod cone;
mod mesh;
mod probe;
mod reach;

pub use mesh::molecular_mesh;

use std::num::NonZeroUsize;

use super::shares::Measure;
use super::tile::Tile;
use super::tiles::{self, Members, TILE_MAX};
use super::{Balls, Cell};
use probe::{Neighbours, Probe, probes};
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::parallel;

/// Probes that a thread measures at a time.
const BLOCK: usize = 1024;

/// Area of the molecular (solvent-excluded) surface and volume of the body inside it, for each ball. The
/// radii of the balls include that of the probe.
///
/// A ball has the part of the body in its cell, and the patches at this part. A concave patch counts for the
/// three balls that its probe touches, also where it reaches into other cells: with a large probe, or in thin
/// layers, the volume of a ball may be negative. Sums are exact. With a probe of radius 0 the result is that
/// of [`super::measure`].
///
/// # Errors
/// As [`super::measure`]; usage, if the radius of the probe is negative or greater than that of a ball.
///
/// Cost: for molecules 1.5 to 2.5 times that of [`super::measure`]; k² for each probe that has k others at
/// rest within its diameter, so that a large probe inside of a shell of small balls takes long. Memory: 150
/// bytes more for each place where the probe touches three balls.
///
/// ```
/// use spmesh_molecules::balls::{Balls, molecular_surface};
/// use std::f64::consts::PI;
/// use std::num::NonZeroUsize;
///
/// // The probe of radius 1 around a ball of radius 2.
/// let balls = Balls { centres: &[[0.0; 3]], radii: &[3.0] };
/// let cells = molecular_surface(balls, 1.0, NonZeroUsize::MIN)?;
/// assert!((cells[0].area - 16.0 * PI).abs() < 1e-12);
/// # Ok::<(), spmesh_base::error::Error>(())
/// ```
pub fn molecular_surface(balls: Balls<'_>, probe: f64, threads: NonZeroUsize) -> Result<Vec<Cell>> {
    super::check(balls)?;
    check_probe(balls, probe)?;
    molecular_surface_in_tiles(balls, probe, threads, TILE_MAX)
}

fn check_probe(balls: Balls<'_>, probe: f64) -> Result<()> {
    let least = balls.radii.iter().copied().fold(f64::INFINITY, f64::min);
    if (0.0..=least).contains(&probe) {
        return Ok(());
    }
    Err(Error::usage(format!(
        "{probe} is no radius of a probe: expected 0 to {least}, the least of the balls"
    )))
}

/// [`molecular_surface`] with at most `tile_max` balls in a tile, for a `probe` in its domain. This changes
/// no more than rounding.
///
/// # Errors
/// As [`super::measure_in_tiles`].
pub fn molecular_surface_in_tiles(
    balls: Balls<'_>,
    probe: f64,
    threads: NonZeroUsize,
    tile_max: usize,
) -> Result<Vec<Cell>> {
    let tiles = tiles::cut(balls, tile_max);
    let parts = parallel::map(threads, tiles.iter(), |members| {
        let tile = Tile::new(balls, members)?;
        let probes = if probe > 0.0 { probes(&tile) } else { Vec::new() };
        Ok((without_probes(&tile, balls, members, probe), probes))
    })?;
    let mut cells = vec![Cell::default(); balls.centres.len()];
    let mut probes = Vec::new();
    for (members, (part, own)) in tiles.iter().zip(parts) {
        for (&ball, cell) in members.core.iter().zip(part) {
            cells[ball as usize] = cell;
        }
        probes.extend(own);
    }
    add_probes(balls, probe, &probes, threads, &mut cells)?;
    Ok(cells)
}

/// The cells of a tile's core, less the layers next to spheres and arcs; with the areas of convex patches and
/// saddles.
fn without_probes(tile: &Tile<'_>, balls: Balls<'_>, members: &Members, probe: f64) -> Vec<Cell> {
    let mut saddles = vec![Measure::default(); members.core.len()];
    let part = tile.measure(None, |ends, pair, face| {
        if face.arc == 0.0 || probe == 0.0 {
            return;
        }
        for (v, layer) in ends.into_iter().zip(cone::layer(pair.heights, pair.disk(), probe)) {
            if let Some(place) = tile.place_in_core(v) {
                saddles[place].add(face.arc, layer);
            }
        }
    });
    let cells = part.cells.into_iter().zip(saddles).zip(&members.core);
    cells
        .map(|((cell, saddle), &ball)| {
            let radius = balls.radii[ball as usize];
            let share = if radius > 0.0 { (radius - probe) / radius } else { 1.0 };
            let layer = cell.area * radius * (1.0 - share.powi(3)) / 3.0;
            Cell {
                area: cell.area * share * share + saddle.area,
                volume: cell.volume - layer - saddle.volume,
            }
        })
        .collect()
}

/// Adds concave patches, and subtracts their layers.
fn add_probes(
    balls: Balls<'_>,
    radius: f64,
    probes: &[Probe],
    threads: NonZeroUsize,
    cells: &mut [Cell],
) -> Result<()> {
    if probes.is_empty() {
        return Ok(());
    }
    let neighbours = Neighbours::new(probes, 2.0 * radius);
    let layers = parallel::map(threads, probes.chunks(BLOCK), |block| {
        let centres = |probe: &Probe| probe.balls.map(|ball| balls.centres[ball as usize]);
        let layers = block.iter().map(|probe| concave::layers(probe, centres(probe), radius, &neighbours));
        Ok(layers.collect::<Vec<_>>())
    })?;
    for (probe, layers) in probes.iter().zip(layers.iter().flatten()) {
        for (&ball, layer) in probe.balls.iter().zip(layers) {
            let cell = &mut cells[ball as usize];
            cell.area += layer.area;
            cell.volume -= layer.volume;
        }
    }
    Ok(())
}
