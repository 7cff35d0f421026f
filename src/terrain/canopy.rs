//! `spcanopy`: the surfaces through the points above each threshold, and the highest of them.
//!
//! Each layer goes through the same steps as a pipe of programs, with temporary files for pipes:
//! finalization, triangulation, drawing.

use std::fs::File;
use std::io::{BufReader, BufWriter, Seek, Write};
use std::path::PathBuf;

use crate::dem::{Highest, Options};
use crate::height::HeightPoints;
use spmesh_base::error::{Error, Result};
use spmesh_base::temporary::TemporaryFile;
use spmesh_formats::raster::Grid;
use spmesh_formats::source::{Description, PointReader};
use spmesh_pipeline::finalize::{Budget, CELL_POINTS, InRegions, Leaves, Order, Passes, Spooling};
use spmesh_pipeline::reduce::Duplicates;
use spmesh_stream::StreamReader;

/// Bytes of the buffers of temporary files.
const BUFFER_LEN: usize = 1 << 18;

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
    /// Memory for points. Units: bytes.
    pub memory: u64,
    /// Threads that finalize and triangulate.
    pub threads: usize,
    /// Folder for temporary files; that of the system if `None`.
    pub temp_dir: Option<PathBuf>,
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
        let mut mesh = settings.triangulate(&Layer { points, threshold })?;
        triangles += highest.add(&mut mesh, &options)?.triangles;
        progress(done);
    }
    Ok((highest, triangles))
}

impl Settings {
    /// The mesh of a layer, as a stream.
    fn triangulate(&self, layer: &Layer) -> Result<StreamReader<BufReader<File>>> {
        let Settings { memory, threads, temp_dir, .. } = self;
        let leaves = Leaves::Collapsed { cell_points: CELL_POINTS, level_max: None };
        let options = spmesh_pipeline::finalize::Options {
            leaves,
            order: Order::Chunked,
            compress: false,
            thin: None,
            budget: Budget::of_process(*memory, *threads)?,
            temp_dir: temp_dir.clone(),
            spooling: Spooling::Never,
            regions: InRegions::NEVER,
            weighted: None,
        };
        let points =
            self.stream(|output| spmesh_pipeline::finalize::run(layer, &options, &mut (), output).map(drop))?;
        let options = spmesh_pipeline::reduce::Options {
            duplicates: Duplicates::Highest,
            threads: *threads,
            memory: Some(*memory),
            ..spmesh_pipeline::reduce::Options::default()
        };
        self.stream(move |output| {
            spmesh_pipeline::reduce::triangulate(points, output, &options, |_| {}).map(drop)
        })
    }

    /// What `write` writes, as a stream from a temporary file.
    fn stream(
        &self,
        write: impl FnOnce(&mut BufWriter<File>) -> Result<()>,
    ) -> Result<StreamReader<BufReader<File>>> {
        let failed = |e| Error::io("writing a temporary file", e);
        let file = TemporaryFile::create(self.temp_dir.as_deref())?.into_file();
        let mut output = BufWriter::with_capacity(BUFFER_LEN, file);
        write(&mut output)?;
        output.flush().map_err(failed)?;
        let mut file = output.into_inner().map_err(|e| failed(e.into_error()))?;
        file.rewind().map_err(failed)?;
        StreamReader::new(BufReader::with_capacity(BUFFER_LEN, file), "layer")
    }
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
