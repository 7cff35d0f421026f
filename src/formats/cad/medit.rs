//! Writes Medit's mesh format as text.
//!
//! Source: P. Frey, "MEDIT: an interactive mesh visualization software", INRIA RT-0253 (2001), and what
//! libMeshb and Gmsh read: version 2 has doubles; entities are numbered from 1, and each ends with a
//! reference.

use std::io::Write;
use std::path::Path;

use crate::sink::spool::{MeshSpool, place_of};
use crate::sink::{EventSink, expect_kind, lost_attributes, lost_of_header, write_error};
use spmesh_base::error::{Error, Result};
use spmesh_stream::{Event, Header, Kind, Totals};

/// Greatest vertex number and greatest reference in version 2.
const NUMBER_MAX: u64 = i32::MAX as u64;

/// Writes points or a mesh as Medit's text. The labels of vertices become their references, if all of them
/// fit; other references are 0. World coordinates; finalization is not written.
///
/// The format states its counts first, so everything waits in unnamed temporary files until the end. Memory:
/// buffers only.
pub struct MeditSink<W> {
    output: W,
    mesh: MeshSpool,
}

impl<W: Write> MeditSink<W> {
    /// Opens the temporary files, in `temp_dir` or the system's folder for them.
    ///
    /// # Errors
    /// Usage, if the format does not hold the kind of stream; I/O, if there is no room for temporary files.
    pub fn new(output: W, header: &Header, temp_dir: Option<&Path>) -> Result<Self> {
        expect_kind(header, "Medit", &[Kind::Points, Kind::TriangleMesh, Kind::TetrahedralMesh])?;
        Ok(MeditSink { output, mesh: MeshSpool::new(header, temp_dir)? })
    }

    fn end(&mut self, totals: &Totals) -> Result<()> {
        let kind = self.mesh.header().kind;
        let vertices = if kind == Kind::Points { totals.points } else { totals.vertices };
        if vertices > NUMBER_MAX || totals.simplices > NUMBER_MAX {
            return Err(Error::usage("more than 2^31 - 1 vertices or simplices: Medit cannot number them"));
        }
        self.text(format_args!("MeshVersionFormatted 2\nDimension 3\nVertices\n{vertices}\n"))?;
        self.vertices(vertices)?;
        match kind {
            Kind::Points => {}
            Kind::TetrahedralMesh => self.simplices::<32>("Tetrahedra", totals.simplices)?,
            _ => self.simplices::<24>("Triangles", totals.simplices)?,
        }
        self.text(format_args!("End\n"))?;
        self.output.flush().map_err(write_error)
    }

    fn vertices(&mut self, count: u64) -> Result<()> {
        let has_references = self.has_labels() && self.labels_fit();
        let (mut vertices, mut labels) =
            (self.mesh.vertices.records::<24>()?, self.mesh.labels.records::<8>()?);
        for _ in 0..count {
            let [x, y, z] = place_of(&vertices.next()?);
            let reference = if has_references { u64::from_le_bytes(labels.next()?) } else { 0 };
            writeln!(self.output, "{x} {y} {z} {reference}").map_err(write_error)?;
        }
        Ok(())
    }

    /// Simplices of `N / 8` vertices.
    fn simplices<const N: usize>(&mut self, name: &str, count: u64) -> Result<()> {
        writeln!(self.output, "{name}\n{count}").map_err(write_error)?;
        let mut simplices = self.mesh.corners.records::<N>()?;
        for _ in 0..count {
            for id in simplices.next()?.chunks_exact(8) {
                let id = u64::from_le_bytes(id.try_into().expect("eight bytes"));
                write!(self.output, "{} ", id + 1).map_err(write_error)?;
            }
            self.output.write_all(b"0\n").map_err(write_error)?;
        }
        Ok(())
    }

    fn has_labels(&self) -> bool {
        self.mesh.label_count > 0
    }

    fn labels_fit(&self) -> bool {
        self.mesh.label_max <= NUMBER_MAX
    }

    fn text(&mut self, text: std::fmt::Arguments) -> Result<()> {
        self.output.write_fmt(text).map_err(write_error)
    }
}

impl<W: Write> EventSink for MeditSink<W> {
    fn event(&mut self, event: &Event, _rows: &[u8]) -> Result<()> {
        match event {
            Event::End(totals) => self.end(totals),
            event => self.mesh.event(event, &[]),
        }
    }

    fn notices(&self) -> Vec<String> {
        let mut notices = lost_of_header(self.mesh.header(), "Medit");
        notices.extend(lost_attributes(self.mesh.header(), "Medit"));
        if self.has_labels() && !self.labels_fit() {
            notices.push("a label is beyond 2^31 - 1, which Medit cannot say: all labels dropped".into());
        }
        notices
    }
}
