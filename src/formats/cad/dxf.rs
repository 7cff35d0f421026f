//! Writes DXF, the exchange format of AutoCAD, in its version R12 (AC1009) as text, which all programs read.
//!
//! Source: Autodesk, "AutoCAD Release 12 Customization Manual", chapter 11. A file is pairs of lines: a group
//! code, and a value.

use std::io::Write;

use crate::sink::constrained::Surveyed;
use crate::sink::world::world_bounds;
use crate::sink::{EventSink, SinkOptions, expect_kind, lost_attributes, write_error};
use spmesh_base::error::Result;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::decimal::Decimal;
use spmesh_stream::{Crs, Event, Header, Kind};

/// The layers of triangles, and of edges on lines.
const FACES: &str = "TIN";
const EDGES: &str = "BREAKLINES";

/// Writes a triangle mesh as DXF: a `3DFACE` on the layer `TIN` for each triangle, and a `LINE` on the layer
/// `BREAKLINES` for each edge on a line. A comment states the local origin, if there is one.
pub struct DxfSink<W> {
    output: W,
    mesh: Surveyed,
}

impl<W: Write> DxfSink<W> {
    /// Writes the sections before the triangles.
    ///
    /// # Errors
    /// Usage, if DXF does not hold the kind of stream, or a local origin lacks its box; or if writing fails.
    pub fn new(output: W, header: &Header, options: &SinkOptions) -> Result<Self> {
        expect_kind(header, "DXF", &[Kind::TriangleMesh])?;
        let mut sink = DxfSink { output, mesh: Surveyed::new(header, options)? };
        if let Some([x, y, z]) = sink.mesh.places().origin() {
            let [x, y, z] = [x, y, z].map(Decimal);
            sink.text(&format!("999\norigin {x} {y} {z}\n"))?;
        }
        sink.text("0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n")?;
        if let Some(bounds) = &header.bounds {
            let bounds = world_bounds(header, bounds);
            for (name, corner) in [("$EXTMIN", bounds.min), ("$EXTMAX", bounds.max)] {
                sink.text(&format!("9\n{name}\n"))?;
                sink.point(0, sink.mesh.places().of_world(corner))?;
            }
        }
        sink.text("0\nENDSEC\n0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLAYER\n70\n2\n")?;
        for (layer, colour) in [(FACES, 8), (EDGES, 1)] {
            sink.text(&format!("0\nLAYER\n2\n{layer}\n70\n0\n62\n{colour}\n6\nCONTINUOUS\n"))?;
        }
        sink.text("0\nENDTAB\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n")?;
        Ok(sink)
    }

    fn text(&mut self, text: &str) -> Result<()> {
        self.output.write_all(text.as_bytes()).map_err(write_error)
    }

    /// The coordinates of point number `number` of an entity.
    fn point(&mut self, number: usize, [x, y, z]: Point) -> Result<()> {
        let [x, y, z] = [x, y, z].map(Decimal);
        writeln!(self.output, "{}\n{x}\n{}\n{y}\n{}\n{z}", 10 + number, 20 + number, 30 + number)
            .map_err(write_error)
    }

    fn entity(&mut self, name: &str, layer: &str, points: &[Point]) -> Result<()> {
        self.text(&format!("0\n{name}\n8\n{layer}\n"))?;
        points.iter().enumerate().try_for_each(|(number, &point)| self.point(number, point))
    }
}

impl<W: Write> EventSink for DxfSink<W> {
    fn event(&mut self, event: &Event, _rows: &[u8]) -> Result<()> {
        if let Event::End(_) = event {
            self.text("0\nENDSEC\n0\nEOF\n")?;
            return self.output.flush().map_err(write_error);
        }
        let Some(patch) = self.mesh.event(event)? else { return Ok(()) };
        for triangle in patch.patch.triangles() {
            let [a, b, c] = triangle.map(|local| patch.places[local as usize]);
            // A face of three corners states the last one twice.
            self.entity("3DFACE", FACES, &[a, b, c, c])?;
        }
        patch.edges.iter().try_for_each(|edge| self.entity("LINE", EDGES, &patch.ends(edge)))
    }

    fn notices(&self) -> Vec<String> {
        let header = self.mesh.header();
        let crs = (header.crs != Crs::Unknown).then(|| "DXF holds no CRS: dropped".to_string());
        crs.into_iter().chain(lost_attributes(header, "DXF")).collect()
    }
}
