//! Diagrams in bounded memory: cells wait in temporary files.

use std::io::Write;
use std::path::Path;
use std::time::Instant;

use super::shelves::Shelves;
use super::write::write_cells;
use super::{Counts, Options, Placement, Product, Report, checked};
use spmesh_core::error::{Error, ErrorKind, Result};
use spmesh_geometry::diagram4::{Room, sweep};
use spmesh_io::source::points4::Selected4;

/// Bytes of a simplex of a stage, with what cells and walls take.
const SIMPLEX_BYTES: u64 = 112;

/// Bytes of a point, from the first to the last stage.
const POINT_BYTES: u64 = 64;

/// Bytes of a process without points, and of buffers.
const PROCESS_BYTES: u64 = 16 << 20;

/// Shelves per stage: to sort a shelf takes as much memory as the simplices of its points, and the places of
/// all cells take memory, too, so a shelf has half the points of a stage.
const SHELVES: usize = 2;

/// Simplices per random point, for the size of the first stage. A stage with too many is begun again with
/// half of its points.
const POINT_SIMPLICES: usize = 32;

/// Fewer simplices are not worth a stage.
const SIMPLICES_MIN: u64 = 1 << 10;

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
    let simplices = memory.saturating_sub(fixed) / SIMPLEX_BYTES;
    if simplices < SIMPLICES_MIN {
        let least = (fixed + SIMPLICES_MIN * SIMPLEX_BYTES).div_ceil(1 << 20);
        let message = format!("{points} points need more memory than that: give --memory {least}M or more");
        return Err(Error::new(ErrorKind::Memory, message));
    }
    let simplices = usize::try_from(simplices).unwrap_or(usize::MAX);
    Ok(Room { points: simplices / POINT_SIMPLICES, simplices })
}
