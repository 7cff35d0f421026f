//! The surfaces through the points above each threshold, and the highest of them.
//!
//! Each layer goes through the same steps as a pipe of programs, with temporary files for pipes:
//! finalization, triangulation, drawing.

use std::cell::Cell;
use std::fs::File;
use std::io::{BufReader, BufWriter, Seek, Write};
use std::path::PathBuf;

use crate::dem::{Highest, Options};
use crate::height::HeightPoints;
use spmesh_base::error::{Error, Result};
use spmesh_base::temporary::TemporaryFile;
use spmesh_formats::raster::Grid;
use spmesh_formats::source::{Description, PointReader};
use spmesh_pipeline::finalize::{Budget, CELL_POINTS, Leaves, Order, Passes, Spooling};
use spmesh_pipeline::reduce::Duplicates;
use spmesh_stream::StreamReader;

/// Bytes of the buffers of temporary files.
const BUFFER_LEN: usize = 1 << 18;

/// How layers are made.
pub(super) struct Settings {
    /// Longest edge of triangles in layers above 0.
    pub(super) edge_max: f64,
    /// Memory for points. Units: bytes.
    pub(super) memory: u64,
    pub(super) threads: usize,
    pub(super) temp_dir: Option<PathBuf>,
}

/// The layers of points with heights.
pub(super) struct Layers<'l> {
    pub(super) points: &'l HeightPoints,
    pub(super) grid: Grid,
    /// How the lowest layer is drawn.
    pub(super) bottom: &'l Options,
    pub(super) settings: &'l Settings,
    /// Triangles of all layers that were drawn.
    pub(super) triangles: Cell<u64>,
}

impl Layers<'_> {
    /// Draws all layers; calls `progress` with the number of layers done.
    pub(super) fn draw(&self, thresholds: &[f64], mut progress: impl FnMut(u64)) -> Result<Highest> {
        let mut highest = Highest::new(&self.grid, self.bottom)?;
        for (&threshold, done) in thresholds.iter().zip(1..) {
            let mut options = self.bottom.clone();
            if threshold > 0.0 {
                (options.kill, options.concave) = (Some(self.settings.edge_max), None);
            }
            let mut mesh = self.triangulate(&Layer { points: self.points, threshold })?;
            let stats = highest.add(&mut mesh, &options)?;
            self.triangles.set(self.triangles.get() + stats.triangles);
            progress(done);
        }
        Ok(highest)
    }

    /// The mesh of a layer, as a stream.
    fn triangulate(&self, layer: &Layer) -> Result<StreamReader<BufReader<File>>> {
        let Settings { memory, threads, temp_dir, .. } = self.settings;
        let leaves = Leaves::Collapsed { cell_points: CELL_POINTS, level_max: None };
        let options = spmesh_pipeline::finalize::Options {
            leaves,
            order: Order::Chunked,
            compress: false,
            thin: None,
            budget: Budget::of_process(*memory, *threads)?,
            temp_dir: temp_dir.clone(),
            spooling: Spooling::Never,
            weighted: None,
        };
        let points =
            self.stream(|output| spmesh_pipeline::finalize::run(layer, &options, &mut (), output).map(drop))?;
        let options = spmesh_pipeline::reduce::Options {
            duplicates: Duplicates::Highest,
            threads: *threads,
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
        let file = TemporaryFile::create(self.settings.temp_dir.as_deref())?.into_file();
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
