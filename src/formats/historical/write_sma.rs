//! Writes SMA, Isenburg's streaming mesh as text (`formats/historical_meshes.md`).

use std::io::Write;

use crate::sink::triangles::final_corners;
use crate::sink::world::{world_bounds, world_of, write_numbers};
use crate::sink::{EventSink, expect_kind, lost_attributes, lost_of_header, write_error};
use spmesh_base::error::Result;
use spmesh_stream::{Event, Header, Kind, Patch};

/// Writes a triangle mesh as SMA, vertices before their triangles. The last use of a vertex is written as a
/// negative index, relative to the number of vertices so far; a vertex that is final without being used by
/// a triangle of its patch gets an `x` line.
pub struct SmaSink<W> {
    output: W,
    header: Header,
    vertices: u64,
}

impl<W: Write> SmaSink<W> {
    /// Writes the header lines.
    ///
    /// # Errors
    /// Usage, if SMA does not hold the kind of stream; or if writing fails.
    pub fn new(mut output: W, header: &Header) -> Result<Self> {
        expect_kind(header, "SMA", &[Kind::TriangleMesh])?;
        output.write_all(b"# SMA written by spmesh\n").map_err(write_error)?;
        if let Some(bounds) = &header.bounds {
            let bounds = world_bounds(header, bounds);
            write_numbers(&mut output, "# bb_min", &bounds.min)?;
            write_numbers(&mut output, "# bb_max", &bounds.max)?;
        }
        Ok(SmaSink { output, header: header.clone(), vertices: 0 })
    }

    fn patch(&mut self, patch: &Patch) -> Result<()> {
        for &point in &patch.new {
            write_numbers(&mut self.output, "v", &world_of(&self.header, point))?;
        }
        self.vertices += patch.new.len() as u64;
        let (triangles, unused) = final_corners(patch);
        for triangle in triangles {
            self.output.write_all(b"f").map_err(write_error)?;
            for corner in triangle {
                let written = match corner.is_final {
                    true => write!(self.output, " -{}", self.vertices - corner.id),
                    false => write!(self.output, " {}", corner.id + 1),
                };
                written.map_err(write_error)?;
            }
            self.output.write_all(b"\n").map_err(write_error)?;
        }
        unused.iter().try_for_each(|id| writeln!(self.output, "x {}", id + 1)).map_err(write_error)
    }
}

impl<W: Write> EventSink for SmaSink<W> {
    fn event(&mut self, event: &Event, _rows: &[u8]) -> Result<()> {
        match event {
            Event::Patch(patch) => self.patch(patch),
            Event::End(_) => self.output.flush().map_err(write_error),
            _ => Ok(()),
        }
    }

    fn notices(&self) -> Vec<String> {
        let lost = lost_of_header(&self.header, "SMA");
        lost.into_iter().chain(lost_attributes(&self.header, "SMA")).collect()
    }
}
