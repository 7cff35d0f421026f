//! Diagrams in bounded memory: cells wait in temporary files.

use std::io::Write;
use std::path::Path;
use std::time::Instant;

use super::shelves::Shelves;
use super::write::write_cells;
use super::{Counts, Options, Placement, Product, Report, checked};
use crate::diagram4::{Room, sweep};
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_formats::volumes::Selected4;

/// Bytes of a point, from the first to the last stage.
const POINT_BYTES: u64 = 96;

/// Bytes of a process without points, and of buffers.
const PROCESS_BYTES: u64 = 8 << 20;

/// Shelves per stage, of equally many points. To sort a shelf takes as much memory as its cells, and the
/// places of all cells take memory, too. A cell is on the shelf of its first vertex, and if points are thin
/// along the first axis, most cells have a first vertex among the first few points.
const SHELVES: usize = 8;

/// Bytes per random point of a stage, which has about 32 simplices, for the size of the first stage. One that
/// takes too much is begun again with half of its points.
const STAGE_POINT_BYTES: usize = 32 * 112;

/// Fewer bytes are not worth a stage.
const STAGE_BYTES_MIN: u64 = 1 << 17;

/// Computes the diagram of points in stages of about `memory` bytes, by estimate, and writes its cells as
/// [`super::write_diagram`] does. Cells wait in temporary files in a folder, or in that of the system.
/// Returns notices for the user.
///
/// # Errors
/// As [`super::make`]; memory, if that is too little; I/O.
pub fn write_streamed(
    points: Selected4,
    options: &Options,
    memory: u64,
    temp_dir: Option<&Path>,
    compress: bool,
    output: &mut impl Write,
) -> Result<(Vec<String>, Report)> {
    let name = points.name.clone();
    let placement = Placement { orientation: points.orientation, time_scale: options.time_scale };
    let started = Instant::now();
    let count = points.points.len();
    let mut report = Report { points: count as u64, ..Report::default() };
    let room = room(count as u64, memory).map_err(|e| e.of_input(&name))?;
    let swept = checked(points, &Product::Cells, options, &placement).and_then(|(points, values)| {
        let mut shelves = Shelves::new(count, room.points / SHELVES, temp_dir);
        let (diagram, stats) = sweep(points, values, room, options.threads, &mut shelves)?;
        Ok((diagram, stats, shelves))
    });
    let (diagram, stats, shelves) = swept.map_err(|e| e.of_input(name))?;
    (report.merged, report.stats) = (diagram.merged, stats);
    let sorted = shelves.sorted()?;
    report.diagram_time = started.elapsed();
    let mut counts = Counts::default();
    let mut neighbours = 0;
    write_cells(&diagram, compress, output, |give| {
        sorted.each(|cell| {
            neighbours += counts.add(cell);
            give(cell)
        })
    })?;
    counts.facets = neighbours / 2;
    report.counts = counts;
    Ok((placement.stream_notices(), report))
}

/// The room of a stage for so many points in all.
fn room(points: u64, memory: u64) -> Result<Room> {
    let fixed = PROCESS_BYTES + points * POINT_BYTES;
    let bytes = memory.saturating_sub(fixed);
    if bytes < STAGE_BYTES_MIN {
        let least = (fixed + STAGE_BYTES_MIN).div_ceil(1 << 20);
        let message = format!("{points} points need more memory than that: give --memory {least}M or more");
        return Err(Error::new(ErrorKind::Memory, message));
    }
    let bytes = usize::try_from(bytes).unwrap_or(usize::MAX);
    Ok(Room { points: bytes / STAGE_POINT_BYTES, bytes })
}
