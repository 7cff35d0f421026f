//! Points with their heights above a ground, in a temporary file, from which layers are read.

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

/// Bytes of a point and its height.
const RECORD_LEN: usize = size_of::<Record>();
/// Points that heights are found for at once.
const BATCH_LEN: usize = 1 << 19;
/// Points read back at once.
const READ_LEN: usize = 1 << 14;

/// Roundings of limits in steps: a height that is meant to be a limit is neither below nor above it.
const NUDGE: f64 = 1e-6;

/// A point of the layers, and its stored height above the ground, not below zero.
type Record = [f64; 4];

/// What the points of layers are, and which ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// Whether their third coordinate is the elevation, and not the height above the ground.
    pub has_elevations: bool,
    /// The greatest height of a point, in the unit of the world.
    pub highest: f64,
}

/// Points with their heights above a ground. Heights below zero are zero.
///
/// Memory: 68 bytes for each point of a batch of half a million, while points are read.
/// Disk: 32 bytes for each point.
#[derive(Debug)]
pub struct HeightPoints {
    file: TemporaryFile,
    surface: Surface,
    description: Description,
    /// The coordinates of points with stored heights.
    heights: Coordinates,
    counts: HeightCounts,
    greatest: f64,
}

/// Numbers of points.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct HeightCounts {
    /// Those that have heights.
    pub points: u64,
    /// Those that were left out because they are outside of the ground.
    pub outside: u64,
    /// Those that were left out because they are too high.
    pub high: u64,
    /// Those with heights below zero, which became zero.
    pub below: u64,
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
        surface: Surface,
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
        let (of_heights, per_unit) = match (found.coordinates, ground.coordinates()) {
            (Coordinates::I32 { scale, offset }, ground) => {
                let heights = Coordinates::I32 { scale, offset: [offset[0], offset[1], 0.0] };
                (heights, unit_of(ground) / scale[2])
            }
            (Coordinates::F64, ground) => (Coordinates::F64, unit_of(ground)),
        };
        let description = Description {
            coordinates: if surface.has_elevations { found.coordinates } else { of_heights },
            stated_bounds: None,
            attributes: Attributes::default(),
            stated_points: None,
            ..found.clone()
        };
        let file = TemporaryFile::create(temp_dir)?;
        let mut heights_above = Heights::new(ground, Unit::Stored, Outside::NoData, threads);
        let counts = HeightCounts::default();
        let mut points =
            HeightPoints { file, surface, description, heights: of_heights, counts, greatest: 0.0 };
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
            points.counts.outside += outside.map_err(|e| e.of_input(input.name()))?;
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
        let highest = self.stored_below(self.surface.highest);
        let mut records = Vec::with_capacity(batch.len());
        for (&[x, y, z], height) in batch.iter().zip(heights).filter(|(_, height)| !height.is_nan()) {
            self.counts.below += u64::from(*height < 0.0);
            let height = self.heights.rounded((height * per_unit).max(0.0));
            if height > highest {
                self.counts.high += 1;
                continue;
            }
            self.greatest = self.greatest.max(height);
            records.push([x, y, if self.surface.has_elevations { z } else { height }, height]);
        }
        self.counts.points += records.len() as u64;
        self.file.append("writing points", bytemuck::cast_slice(&records))
    }

    /// The greatest stored height that is meant to be at most `height` in the world.
    fn stored_below(&self, height: f64) -> f64 {
        match self.heights {
            Coordinates::F64 => height,
            Coordinates::I32 { scale, .. } => (height / scale[2] + NUDGE).floor(),
        }
    }

    /// Properties of the points.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// Numbers of points.
    pub fn counts(&self) -> HeightCounts {
        self.counts
    }

    /// The greatest height, in the unit of the world.
    pub fn greatest(&self) -> f64 {
        self.heights.to_world([0.0, 0.0, self.greatest])[2]
    }

    /// Reads the points that are at least this high, in the unit of the world.
    pub fn layer(&self, threshold: f64) -> LayerReader<'_> {
        let least = match self.heights {
            Coordinates::F64 => threshold,
            Coordinates::I32 { scale, .. } => (threshold / scale[2] - NUDGE).ceil(),
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
        let points = self.points.counts.points;
        while batch.is_empty() && self.read < points {
            let count = (points - self.read).min(READ_LEN as u64);
            self.bytes.resize(count as usize * RECORD_LEN, 0);
            self.points.file.read_at("reading points", &mut self.bytes, self.read * RECORD_LEN as u64)?;
            self.read += count;
            let records = self.bytes.chunks_exact(RECORD_LEN).map(bytemuck::pod_read_unaligned::<Record>);
            batch.extend(records.filter(|record| record[3] >= self.least).map(|[x, y, z, _]| [x, y, z]));
        }
        Ok(())
    }

    fn invalid(&self) -> u64 {
        0
    }
}
