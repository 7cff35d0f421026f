//! Writes PLY: doubles for the vertices, lists of three indices for the faces.

use std::io::Write;

use crate::crs;
use crate::ply::properties::{self as properties, Properties};
use crate::sink::rows::Rows;
use crate::sink::spool::Spool;
use crate::sink::world::world_of;
use crate::sink::{
    EventSink, SinkOptions, expect_kind, lost_of_attributes, lost_where_crs_is_text, write_error,
};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Event, Header, Kind, Patch, Totals};

/// Writes a triangle mesh or points as PLY.
///
/// PLY states its counts first and holds all vertices before all faces, so both wait in unnamed temporary
/// files until the end. Memory: buffers only. Disk: the size of the output.
pub struct PlySink<W> {
    output: W,
    header: Header,
    is_text: bool,
    properties: Properties,
    vertices: Spool,
    faces: Spool,
}

impl<W: Write> PlySink<W> {
    /// Opens the temporary files.
    ///
    /// # Errors
    /// Usage, if PLY does not hold the kind of stream; I/O, if there is no room for temporary files.
    pub fn new(output: W, header: &Header, options: &SinkOptions) -> Result<Self> {
        let temp_dir = options.temp_dir.as_deref();
        expect_kind(header, "PLY", &[Kind::Points, Kind::TriangleMesh])?;
        let (vertices, faces) = (Spool::new(temp_dir)?, Spool::new(temp_dir)?);
        let properties = Properties::of(&header.attributes);
        let (header, is_text) = (header.clone(), options.ascii);
        Ok(PlySink { output, header, is_text, properties, vertices, faces })
    }

    fn points(&mut self, points: &[Point], rows: &[u8]) -> Result<()> {
        let mut rows = Rows::new(&self.header, rows);
        points.iter().try_for_each(|&point| self.vertex(point, rows.next()))
    }

    fn vertex(&mut self, point: Point, row: &[u8]) -> Result<()> {
        let [x, y, z] = world_of(&self.header, point);
        let (attributes, vertices) = (&self.header.attributes, &mut self.vertices);
        match self.is_text {
            true => {
                vertices.text(format_args!("{x} {y} {z}"))?;
                properties::text(attributes, row, |number| vertices.text(format_args!(" {number}")))?;
                vertices.text(format_args!("\n"))
            }
            false => {
                [x, y, z].iter().try_for_each(|x| vertices.bytes(&x.to_le_bytes()))?;
                properties::bytes(attributes, row, |bytes| vertices.bytes(bytes))
            }
        }
    }

    fn patch(&mut self, patch: &Patch, rows: &[u8]) -> Result<()> {
        self.points(&patch.new, rows)?;
        if patch.first_id + patch.new.len() as u64 > i32::MAX as u64 {
            return Err(Error::usage("more than 2^31 - 1 vertices: PLY cannot number them"));
        }
        for triangle in patch.triangles() {
            let ids = triangle.map(|local| patch.id(local) as i32);
            match self.is_text {
                true => self.faces.text(format_args!("3 {} {} {}\n", ids[0], ids[1], ids[2]))?,
                false => {
                    let mut face = [3; 13];
                    for (bytes, id) in face[1..].chunks_exact_mut(4).zip(ids) {
                        bytes.copy_from_slice(&id.to_le_bytes());
                    }
                    self.faces.bytes(&face)?;
                }
            }
        }
        Ok(())
    }

    /// The comment that MDAL, the library for meshes of QGIS, takes the CRS from.
    fn crs(&self) -> String {
        crs::text(&self.header.crs).map_or(String::new(), |text| {
            let words: Vec<&str> = text.split_ascii_whitespace().collect();
            format!("comment crs {}\n", words.join(" "))
        })
    }

    fn end(&mut self, totals: &Totals) -> Result<()> {
        let format = if self.is_text { "ascii" } else { "binary_little_endian" };
        let is_mesh = self.header.kind == Kind::TriangleMesh;
        let vertices = if is_mesh { totals.vertices } else { totals.points };
        let mut header =
            format!("ply\nformat {format} 1.0\ncomment spmesh\n{}element vertex {vertices}\n", self.crs());
        header += "property double x\nproperty double y\nproperty double z\n";
        header += self.properties.lines();
        if is_mesh {
            header += &format!("element face {}\n", totals.simplices);
            header += "property list uchar int vertex_indices\n";
        }
        header += "end_header\n";
        self.output.write_all(header.as_bytes()).map_err(write_error)?;
        self.vertices.copy_to(&mut self.output)?;
        self.faces.copy_to(&mut self.output)?;
        self.output.flush().map_err(write_error)
    }
}

impl<W: Write> EventSink for PlySink<W> {
    fn event(&mut self, event: &Event, rows: &[u8]) -> Result<()> {
        match event {
            Event::Points(points) => self.points(points, rows),
            Event::Patch(patch) => self.patch(patch, rows),
            Event::End(totals) => self.end(totals),
            _ => Ok(()),
        }
    }

    fn notices(&self) -> Vec<String> {
        let mut lost = lost_where_crs_is_text(&self.header, "PLY");
        lost.extend(lost_of_attributes(&self.header, "PLY"));
        lost.extend(self.properties.rounded());
        lost
    }
}
