//! `spcanopy`: the surfaces through the points above each threshold, and the highest of them.
//!
//! Each layer is triangulated as a pipe of programs would ([`Meshing`]), and drawn.

use crate::dem::{Highest, Options};
use crate::height::HeightPoints;
use crate::meshing::Meshing;
use spmesh_base::error::{Error, Result};
use spmesh_formats::raster::Grid;
use spmesh_formats::source::{Description, PointReader};
use spmesh_pipeline::finalize::Passes;

/// Thresholds of layers below the regular ones, and the distance of these.
const LOW_LAYERS: [f64; 3] = [0.0, 2.0, 5.0];
const LAYER_STEP: f64 = 5.0;
/// The most layers: those of trees of half a kilometre.
const LAYERS_MAX: usize = 102;

/// How layers are made.
#[derive(Debug, Clone)]
pub struct Settings {
    /// Longest edge of triangles in layers above 0, in world units.
    pub edge_max: f64,
    /// How points are triangulated.
    pub meshing: Meshing,
}

/// The thresholds of layers that have points up to `greatest`, ascending from 0; without `layers`, regular
/// ones.
///
/// # Errors
/// Usage, if one of `layers` is negative or not finite.
pub fn thresholds(layers: &[f64], greatest: f64) -> Result<Vec<f64>> {
    if let Some(wrong) = layers.iter().find(|height| !(height.is_finite() && **height >= 0.0)) {
        return Err(Error::usage(format!("--layers takes heights from 0 on, not {wrong}")));
    }
    let mut thresholds = layers.to_vec();
    if thresholds.is_empty() {
        let regular = (2..).map(|number| f64::from(number) * LAYER_STEP);
        thresholds = LOW_LAYERS.into_iter().chain(regular).take(LAYERS_MAX).collect();
    }
    thresholds.push(0.0);
    thresholds.sort_by(f64::total_cmp);
    thresholds.dedup();
    thresholds.retain(|&height| height == 0.0 || height <= greatest);
    Ok(thresholds)
}

/// Draws the layers of all thresholds, the lowest of them as `bottom` says; calls `progress` with the number
/// of layers done. Returns the highest surface, and the number of triangles of all layers.
///
/// # Errors
/// Those of finalizing, triangulating and drawing.
pub fn draw(
    points: &HeightPoints,
    grid: &Grid,
    bottom: &Options,
    settings: &Settings,
    thresholds: &[f64],
    mut progress: impl FnMut(u64),
) -> Result<(Highest, u64)> {
    let (mut highest, mut triangles) = (Highest::new(grid, bottom)?, 0);
    for (&threshold, done) in thresholds.iter().zip(1..) {
        let mut options = bottom.clone();
        if threshold > 0.0 {
            (options.kill, options.concave) = (Some(settings.edge_max), None);
        }
        let mut mesh = settings.meshing.mesh(&Layer { points, threshold }, "layer")?;
        triangles += highest.add(&mut mesh, &options)?.triangles;
        progress(done);
    }
    Ok((highest, triangles))
}

/// The points above a threshold, as an input of the finalization.
struct Layer<'p> {
    points: &'p HeightPoints,
    threshold: f64,
}

impl Passes for Layer<'_> {
    fn description(&self) -> &Description {
        self.points.description()
    }

    fn read(&self) -> Result<Box<dyn PointReader + '_>> {
        Ok(Box::new(self.points.layer(self.threshold)))
    }
}
