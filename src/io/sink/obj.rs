//! Writes OBJ: `v` and `f` lines.

use std::io::Write;

use super::world::{world_of, write_numbers};
use super::{EventSink, expect_kind, lost_of_header, write_error};
use spmesh_core::error::Result;
use spmesh_stream::{Event, Header, Kind};

/// Writes a triangle mesh or points as OBJ. Vertices are counted from 1; finalization is not written.
pub struct ObjSink<W> {
    output: W,
    header: Header,
}

impl<W: Write> ObjSink<W> {
    /// Starts the output.
    ///
    /// # Errors
    /// Usage, if OBJ does not hold the kind of stream; or if writing fails.
    pub fn new(mut output: W, header: &Header) -> Result<Self> {
        expect_kind(header, "OBJ", &[Kind::Points, Kind::TriangleMesh])?;
        output.write_all(b"# OBJ written by spmesh\n").map_err(write_error)?;
        Ok(ObjSink { output, header: header.clone() })
    }
}

impl<W: Write> EventSink for ObjSink<W> {
    fn event(&mut self, event: &Event) -> Result<()> {
        let points = match event {
            Event::Points(points) => points,
            Event::Patch(patch) => &patch.new,
            Event::End(_) => return self.output.flush().map_err(write_error),
            _ => return Ok(()),
        };
        for &point in points {
            write_numbers(&mut self.output, "v", &world_of(&self.header, point))?;
        }
        if let Event::Patch(patch) = event {
            for triangle in patch.triangles() {
                let [a, b, c] = triangle.map(|local| patch.id(local) + 1);
                writeln!(self.output, "f {a} {b} {c}").map_err(write_error)?;
            }
        }
        Ok(())
    }

    fn notices(&self) -> Vec<String> {
        lost_of_header(&self.header, "OBJ")
    }
}
