//! LAS and LAZ files with the heights of their points.

use std::io::{Seek, Write};
use std::num::NonZeroUsize;

use super::ground::Ground;
use super::heights::{Heights, Outside, Unit};
use spmesh_base::error::{Error, Result};
use spmesh_formats::las::{Changes, ExtraField, LasCopy, LasFile};
use spmesh_formats::source::Alignment;
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::Point;

/// Most points of a batch.
pub(super) const BATCH_MAX: u64 = 1 << 20;
/// Bytes of memory for each point of a batch, beside two records.
pub(super) const POINT_LEN: u64 = 112;
/// Records that are written at once.
const PIECE_LEN: usize = 1 << 12;

/// Where heights are written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum HeightPlace {
    /// To a new field of extra bytes of this name.
    Field(String),
    /// To z.
    Z,
}

/// How files are written.
#[derive(Debug, Clone)]
pub struct FileOptions {
    /// Where heights are written.
    pub place: HeightPlace,
    /// The heights of points outside of the mesh.
    pub outside: Outside,
    /// Whether points are compressed; as in the input if `None`.
    pub is_compressed: Option<bool>,
    /// Memory for points under way. Units: bytes.
    pub memory: u64,
    /// Threads that decompress, as many that compress, and as many that find heights.
    pub threads: usize,
}

/// Counts of a file.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Counts {
    /// Points of the file.
    pub points: u64,
    /// Those that are outside of the mesh.
    pub outside: u64,
    /// Those without a height.
    pub without: u64,
    /// Those with a height below zero.
    pub below: u64,
    /// What of the file could not be kept.
    pub notices: Vec<String>,
}

/// Writes `file` again with the heights of its points above `ground`; calls `progress` with the number of points
/// written. All else stays as it is, also the order of the points.
///
/// A height is an integer, in steps of the file's z. It is rounded once, half away from zero; exactly, if the file is
/// on the grid of the ground.
///
/// Memory: `options.memory`, and that of [`Ground`].
///
/// # Errors
/// Usage, if the coordinate reference systems differ, the field exists already, or a height needs more than 32
/// bits; malformed, if the file is; if reading or writing fails.
pub fn write_heights<W: Write + Seek>(
    ground: &Ground,
    file: &LasFile,
    output: W,
    options: &FileOptions,
    mut progress: impl FnMut(u64),
) -> Result<(W, Counts)> {
    ground.check_system(file.crs()).map_err(|e| e.of_input(file.name()))?;
    let Coordinates::I32 { scale, .. } = *file.coordinates() else { unreachable!("LAS files have a grid") };
    let field = |name: &String| ExtraField {
        name: name.clone(),
        text: "height above the ground".into(),
        scale: scale[2],
    };
    let changes = Changes {
        field: match &options.place {
            HeightPlace::Field(name) => Some(field(name)),
            HeightPlace::Z => None,
        },
        has_new_z: options.place == HeightPlace::Z,
        is_compressed: options.is_compressed.unwrap_or(file.is_compressed()),
    };
    let of_file = |e: Error| e.of_input(file.name());
    let mut counts = Counts::default();
    let mut finder = Finder::new(ground, file, scale[2], options);
    let (record_len, mut piece) = (file.record_len(), Vec::new());
    let (output, notices) =
        rewrite(file, output, &changes, options.memory, options.threads, |batch, copy| {
            counts.outside += finder.find(batch, record_len).map_err(of_file)?;
            for (records, heights) in
                batch.chunks(PIECE_LEN * record_len).zip(finder.heights.chunks(PIECE_LEN))
            {
                piece.clear();
                for (record, &height) in records.chunks_exact(record_len).zip(heights) {
                    let index = counts.points;
                    counts.points += 1;
                    counts.without += u64::from(height.is_nan());
                    counts.below += u64::from(height < 0.0);
                    let stored = stored(height, &options.place);
                    let stored = stored.map_err(|e| of_file(e.at(format!("record {index}"))))?;
                    match options.place {
                        HeightPlace::Field(_) => {
                            piece.extend_from_slice(record);
                            piece.extend_from_slice(&stored.to_le_bytes());
                        }
                        HeightPlace::Z => {
                            piece.extend_from_slice(&record[..8]);
                            piece.extend_from_slice(&stored.to_le_bytes());
                            piece.extend_from_slice(&record[12..]);
                        }
                    }
                }
                copy.write(&piece)?;
            }
            progress(counts.points);
            Ok(())
        })?;
    counts.notices = notices;
    Ok((output, counts))
}

/// Writes `file` again: `edit` gets its records in batches, and writes what becomes of them. Returns the
/// output, and what could not be kept.
///
/// Memory: `memory`.
///
/// # Errors
/// As [`LasCopy::start`]; malformed, if the file is; those of `edit`; if writing fails.
pub(crate) fn rewrite<W: Write + Seek>(
    file: &LasFile,
    output: W,
    changes: &Changes,
    memory: u64,
    threads: usize,
    mut edit: impl FnMut(&mut [u8], &mut LasCopy<W>) -> Result<()>,
) -> Result<(W, Vec<String>)> {
    let record_len = file.record_len();
    let point_len = 2 * record_len as u64 + POINT_LEN;
    let batch_len = (memory / point_len).clamp(1, BATCH_MAX) as usize * record_len;
    let of_file = |e: Error| e.of_input(file.name());
    let mut copy = LasCopy::start(file, output, changes, threads, batch_len as u64).map_err(of_file)?;
    let notices = copy.notices().to_vec();
    let mut records = file.records(threads)?;
    let (mut next, mut batch) = (Vec::new(), Vec::new());
    loop {
        batch.clear();
        // A pool of decoders hands over more than one record at once, so a batch may exceed its length by that.
        while batch.len() < batch_len {
            records.next(&mut next)?;
            if next.is_empty() {
                break;
            }
            batch.extend_from_slice(&next);
        }
        if batch.is_empty() {
            return Ok((copy.finish().map_err(of_file)?, notices));
        }
        edit(&mut batch, &mut copy)?;
    }
}

/// The integer that stands for a height.
fn stored(height: f64, place: &HeightPlace) -> Result<i32> {
    if height.is_nan() {
        return match place {
            HeightPlace::Field(_) => Ok(ExtraField::NO_DATA),
            HeightPlace::Z => Err(Error::usage(
                "points have no heights: the ground has no triangles, or they are too far away from it",
            )),
        };
    }
    let stored = height as i32;
    if f64::from(stored) == height && stored != ExtraField::NO_DATA {
        return Ok(stored);
    }
    Err(Error::usage(format!("a height of {height:?} steps of z needs more than 32 bits")))
}

/// Heights of the points of records, in steps of the file's z.
struct Finder<'g> {
    heights_above: Heights<'g>,
    alignment: Alignment,
    /// Steps of the file's z for each stored unit of the ground's z, if heights come in these.
    steps_per_unit: Option<f64>,
    points: Vec<Point>,
    heights: Vec<f64>,
}

impl<'g> Finder<'g> {
    fn new(ground: &'g Ground, file: &LasFile, scale_z: f64, options: &FileOptions) -> Finder<'g> {
        let alignment = Alignment::between(file.coordinates(), ground.coordinates());
        let (unit, steps_per_unit) = match (alignment, ground.coordinates()) {
            (Alignment::Whole { factor, .. }, _) => (Unit::Steps(factor[2]), None),
            (_, Coordinates::I32 { scale, .. }) => (Unit::Stored, Some(scale[2] / scale_z)),
            (_, Coordinates::F64) => (Unit::Stored, Some(1.0 / scale_z)),
        };
        let (points, heights) = (Vec::new(), Vec::new());
        let threads = NonZeroUsize::new(options.threads).unwrap_or(NonZeroUsize::MIN);
        let heights_above = Heights::new(ground, unit, options.outside, threads);
        Finder { heights_above, alignment, steps_per_unit, points, heights }
    }

    /// Replaces `heights` with those of the points of `records`. Returns the number of points outside of the mesh.
    fn find(&mut self, records: &[u8], record_len: usize) -> Result<u64> {
        self.points.clear();
        let points =
            records.chunks_exact(record_len).map(|record| self.alignment.place(stored_point(record)));
        self.points.extend(points);
        let outside = self.heights_above.of(&self.points, &mut self.heights)?;
        if let Some(steps) = self.steps_per_unit {
            self.heights.iter_mut().for_each(|height| *height = (*height * steps).round());
        }
        Ok(outside)
    }
}

/// The stored integers of a record.
pub(crate) fn stored_point(record: &[u8]) -> Point {
    [0, 4, 8]
        .map(|at| f64::from(i32::from_le_bytes(*record[at..].first_chunk().expect("records are longer"))))
}
