//! Writes binary STL.
//!
//! Source: M. Burns, "Automated Fabrication" (1993), section 6.5: 80 bytes of text, the number of triangles,
//! and for each its normal, its corners, and two bytes that are zero; numbers are little-endian.

use std::io::Write;
use std::path::Path;

use crate::sink::floats::Floats;
use crate::sink::spool::{Spool, place_of};
use crate::sink::world::world_of;
use crate::sink::{EventSink, expect_kind, lost_attributes, lost_of_header, write_error};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::{Event, Header, Kind, LiveVertices, Patch, Totals};

const TEXT_LEN: usize = 80;

/// Writes the triangles of a mesh as binary STL. Coordinates are differences from a local origin, where that
/// helps; the text at the start and a notice state it.
///
/// The origin and the count precede the triangles, which wait in an unnamed temporary file. Memory: the width
/// of the stream. Disk: 72 bytes per triangle.
pub struct StlSink<W> {
    output: W,
    header: Header,
    live: LiveVertices<Point>,
    /// The corners of each triangle.
    triangles: Spool,
    bounds: Option<Bounds>,
    notices: Vec<String>,
}

impl<W: Write> StlSink<W> {
    /// Opens the temporary file, in `temp_dir` or the system's folder for them.
    ///
    /// # Errors
    /// Usage, if the format does not hold the kind of stream; I/O, if there is no room for temporary files.
    pub fn new(output: W, header: &Header, temp_dir: Option<&Path>) -> Result<Self> {
        expect_kind(header, "STL", &[Kind::TriangleMesh])?;
        let mut notices = lost_of_header(header, "STL");
        notices.extend(lost_attributes(header, "STL"));
        let triangles = Spool::new(temp_dir)?;
        Ok(StlSink {
            output,
            header: header.clone(),
            live: LiveVertices::new(),
            triangles,
            bounds: None,
            notices,
        })
    }

    fn patch(&mut self, patch: &Patch) -> Result<()> {
        let local = self.live.enter(patch, |_, point| world_of(&self.header, point))?;
        for triangle in patch.triangles() {
            for (_, place) in triangle.map(|corner| local[corner as usize]) {
                self.bounds.get_or_insert(Bounds::of_point(place)).extend(place);
                self.triangles.bytes(place.map(f64::to_le_bytes).as_flattened())?;
            }
        }
        Ok(())
    }

    fn end(&mut self, totals: &Totals) -> Result<()> {
        let count = u32::try_from(totals.simplices)
            .map_err(|_| Error::usage("STL counts its triangles in 32 bits: make fewer with spsimplify"))?;
        let floats = Floats::of_box(&self.bounds.unwrap_or(Bounds::of_point([0.0; 3])))?;
        let mut text = b"spmesh".to_vec();
        if let Some(origin) = floats.origin_text() {
            self.notices
                .push(format!("STL has no place for an origin: coordinates are differences from {origin}"));
            text.extend(format!(", origin {origin}").bytes());
        }
        self.notices.push(floats.notice("STL"));
        // Half a number would be a wrong one.
        text.truncate(if text.len() > TEXT_LEN { 6 } else { TEXT_LEN });
        text.resize(TEXT_LEN, b' ');
        text.extend(count.to_le_bytes());
        self.output.write_all(&text).map_err(write_error)?;
        let mut corners = self.triangles.records::<24>()?;
        for _ in 0..count {
            let triangle =
                [place_of(&corners.next()?), place_of(&corners.next()?), place_of(&corners.next()?)];
            let [a, b, c] = triangle.map(|place| floats.of(place));
            let numbers = [normal(triangle), a, b, c].map(|row| row.map(f32::to_le_bytes));
            self.output.write_all(numbers.as_flattened().as_flattened()).map_err(write_error)?;
            self.output.write_all(&[0; 2]).map_err(write_error)?;
        }
        self.output.flush().map_err(write_error)
    }
}

/// The unit normal of a triangle; zero, as the format has it, where there is none.
pub(crate) fn normal([a, b, c]: [Point; 3]) -> [f32; 3] {
    let [u, v] = [b, c].map(|end| [0, 1, 2].map(|axis| end[axis] - a[axis]));
    let product = [0, 1, 2].map(|axis| {
        let [i, j] = [(axis + 1) % 3, (axis + 2) % 3];
        u[i] * v[j] - u[j] * v[i]
    });
    let length = product.iter().map(|x| x * x).sum::<f64>().sqrt();
    let is_usable = length.is_normal();
    product.map(|x| if is_usable { (x / length) as f32 } else { 0.0 })
}

impl<W: Write> EventSink for StlSink<W> {
    fn event(&mut self, event: &Event, _rows: &[u8]) -> Result<()> {
        match event {
            Event::Patch(patch) => self.patch(patch),
            Event::End(totals) => self.end(totals),
            _ => Ok(()),
        }
    }

    fn notices(&self) -> Vec<String> {
        self.notices.clone()
    }
}
