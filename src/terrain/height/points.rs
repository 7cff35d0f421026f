//! Points with heights instead of elevations, in a temporary file, from which layers are read.

use std::num::NonZeroUsize;
use std::path::Path;

use super::ground::Ground;
use super::heights::{Heights, Outside, Unit};
use spmesh_base::error::{Error, Result};
use spmesh_base::temporary::TemporaryFile;
use spmesh_formats::source::{Alignment, Description, Input, PointReader};
use spmesh_stream::Coordinates;
use spmesh_stream::model::attributes::Attributes;
use spmesh_stream::model::bounds::Point;

/// Bytes of a point.
const POINT_LEN: usize = size_of::<Point>();
/// Points that heights are found for at once.
const BATCH_LEN: usize = 1 << 19;
/// Points read back at once.
const READ_LEN: usize = 1 << 14;

/// Points whose third stored coordinate is the height above a ground. Heights below zero are zero.
///
/// Memory: 68 bytes for each point of a batch of half a million, while points are read.
/// Disk: 24 bytes for each point.
#[derive(Debug)]
pub struct HeightPoints {
    file: TemporaryFile,
    description: Description,
    /// Number of points, and of those that were left out because they are outside of the ground.
    points: u64,
    outside: u64,
    below: u64,
    greatest: f64,
}

impl HeightPoints {
    /// Finds the heights of all points of an input, on `threads` threads; calls `progress` with the number of
    /// points done. Points outside of the ground are left out. The temporary file is in `temp_dir`, or in the
    /// system's folder for temporary files.
    ///
    /// # Errors
    /// If the input cannot be read, has no elevations, or a temporary file fails.
    pub fn read(
        ground: &Ground,
        input: &Input,
        temp_dir: Option<&Path>,
        threads: NonZeroUsize,
        mut progress: impl FnMut(u64),
    ) -> Result<HeightPoints> {
        let found = input.description();
        if !found.has_elevation {
            return Err(Error::usage("points have no elevation: give points x y z"));
        }
        let alignment = Alignment::between(&found.coordinates, ground.coordinates());
        // Heights have the scale of z, and count from zero.
        let (coordinates, per_unit) = match (found.coordinates, ground.coordinates()) {
            (Coordinates::I32 { scale, offset }, ground) => {
                let heights = Coordinates::I32 { scale, offset: [offset[0], offset[1], 0.0] };
                (heights, unit_of(ground) / scale[2])
            }
            (Coordinates::F64, ground) => (Coordinates::F64, unit_of(ground)),
        };
        let description = Description {
            coordinates,
            stated_bounds: None,
            attributes: Attributes::default(),
            stated_points: None,
            ..found.clone()
        };
        let file = TemporaryFile::create(temp_dir)?;
        let mut heights_above = Heights::new(ground, Unit::Stored, Outside::NoData, threads);
        let mut points = HeightPoints { file, description, points: 0, outside: 0, below: 0, greatest: 0.0 };
        let (mut done, mut heights) = (0, Vec::new());
        let mut reader = input.read()?;
        let (mut next, mut batch, mut placed) = (Vec::new(), Vec::new(), Vec::new());
        loop {
            reader.next_batch(&mut next)?;
            batch.extend_from_slice(&next);
            if batch.len() < BATCH_LEN && !next.is_empty() {
                continue;
            }
            placed.clear();
            placed.extend(batch.iter().map(|&point| alignment.place(point)));
            let outside = heights_above.of(&placed, &mut heights);
            points.outside += outside.map_err(|e| e.of_input(input.name()))?;
            points.add(&batch, &heights, per_unit)?;
            done += batch.len() as u64;
            progress(done);
            batch.clear();
            if next.is_empty() {
                return Ok(points);
            }
        }
    }

    /// Writes points with heights in units of the ground.
    fn add(&mut self, batch: &[Point], heights: &[f64], per_unit: f64) -> Result<()> {
        self.below += heights.iter().filter(|height| **height < 0.0).count() as u64;
        let known = batch.iter().zip(heights).filter(|(_, height)| !height.is_nan());
        let stored: Vec<Point> = known
            .map(|(&[x, y, _], height)| {
                [x, y, self.description.coordinates.rounded((height * per_unit).max(0.0))]
            })
            .collect();
        self.greatest = stored.iter().map(|point| point[2]).fold(self.greatest, f64::max);
        self.points += stored.len() as u64;
        let bytes = bytemuck::cast_slice(&stored);
        self.file.append("writing points", bytes)
    }

    /// Properties of the points; their third coordinate is the height.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// Number of points.
    pub fn points(&self) -> u64 {
        self.points
    }

    /// Number of points that were left out because they are outside of the ground.
    pub fn outside(&self) -> u64 {
        self.outside
    }

    /// Number of points with heights below zero, which became zero.
    pub fn below(&self) -> u64 {
        self.below
    }

    /// The greatest height, in the unit of the world.
    pub fn greatest(&self) -> f64 {
        self.description.coordinates.to_world([0.0, 0.0, self.greatest])[2]
    }

    /// Reads the points that are at least this high, in the unit of the world.
    pub fn layer(&self, threshold: f64) -> LayerReader<'_> {
        let least = match self.description.coordinates {
            Coordinates::F64 => threshold,
            // A height that is meant to be the threshold is not below it.
            Coordinates::I32 { scale, .. } => (threshold / scale[2] - 1e-6).ceil(),
        };
        LayerReader { points: self, least, read: 0, bytes: Vec::new() }
    }
}

/// What one unit of stored z is in the world.
pub(crate) fn unit_of(coordinates: &Coordinates) -> f64 {
    match coordinates {
        Coordinates::F64 => 1.0,
        Coordinates::I32 { scale, .. } => scale[2],
    }
}

/// The points of a layer, in their order.
#[derive(Debug)]
pub struct LayerReader<'p> {
    points: &'p HeightPoints,
    /// The least stored height.
    least: f64,
    /// Points read so far.
    read: u64,
    bytes: Vec<u8>,
}

impl PointReader for LayerReader<'_> {
    fn next_batch(&mut self, batch: &mut Vec<Point>) -> Result<()> {
        batch.clear();
        while batch.is_empty() && self.read < self.points.points {
            let count = (self.points.points - self.read).min(READ_LEN as u64);
            self.bytes.resize(count as usize * POINT_LEN, 0);
            self.points.file.read_at("reading points", &mut self.bytes, self.read * POINT_LEN as u64)?;
            self.read += count;
            let points = self.bytes.chunks_exact(POINT_LEN).map(bytemuck::pod_read_unaligned::<Point>);
            batch.extend(points.filter(|point| point[2] >= self.least));
        }
        Ok(())
    }

    fn invalid(&self) -> u64 {
        0
    }
}
