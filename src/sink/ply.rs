//! Writes PLY: doubles for the vertices, lists of three indices for the faces.

use std::fs::File;
use std::io::{BufReader, BufWriter, Seek, Write};
use std::path::Path;

use super::world::world_of;
use super::{EventSink, expect_kind, lost_of_header, write_error};
use crate::bounds::Point;
use crate::error::{Error, Result};
use crate::stream::{Event, Header, Kind, Patch, Totals};

/// How the elements are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlyEncoding {
    /// `binary_little_endian`
    Binary,
    /// `ascii`
    Ascii,
}

/// Writes a triangle mesh or points as PLY.
///
/// PLY states its counts first and holds all vertices before all faces, so both wait in unnamed temporary
/// files until the end. Memory: buffers only. Disk: the size of the output.
pub struct PlySink<W> {
    output: W,
    header: Header,
    encoding: PlyEncoding,
    vertices: BufWriter<File>,
    faces: BufWriter<File>,
}

impl<W: Write> PlySink<W> {
    /// Opens the temporary files, in `temp_dir` or the system's folder for them.
    ///
    /// # Errors
    /// Usage, if PLY does not hold the kind of stream; I/O, if there is no room for temporary files.
    pub fn new(output: W, header: &Header, encoding: PlyEncoding, temp_dir: Option<&Path>) -> Result<Self> {
        expect_kind(header, "PLY", &[Kind::Points, Kind::TriangleMesh])?;
        let (vertices, faces) = (spool(temp_dir)?, spool(temp_dir)?);
        Ok(PlySink { output, header: header.clone(), encoding, vertices, faces })
    }

    fn vertex(&mut self, point: Point) -> Result<()> {
        let [x, y, z] = world_of(&self.header, point);
        let written = match self.encoding {
            PlyEncoding::Ascii => writeln!(self.vertices, "{x} {y} {z}"),
            PlyEncoding::Binary => {
                [x, y, z].iter().try_for_each(|x| self.vertices.write_all(&x.to_le_bytes()))
            }
        };
        written.map_err(spool_error)
    }

    fn patch(&mut self, patch: &Patch) -> Result<()> {
        patch.new.iter().try_for_each(|&point| self.vertex(point))?;
        if patch.first_id + patch.new.len() as u64 > i32::MAX as u64 {
            return Err(Error::usage("more than 2^31 - 1 vertices: PLY cannot number them"));
        }
        for triangle in patch.triangles() {
            let ids = triangle.map(|local| patch.id(local) as i32);
            let written = match self.encoding {
                PlyEncoding::Ascii => writeln!(self.faces, "3 {} {} {}", ids[0], ids[1], ids[2]),
                PlyEncoding::Binary => {
                    let mut face = [3; 13];
                    for (bytes, id) in face[1..].chunks_exact_mut(4).zip(ids) {
                        bytes.copy_from_slice(&id.to_le_bytes());
                    }
                    self.faces.write_all(&face)
                }
            };
            written.map_err(spool_error)?;
        }
        Ok(())
    }

    fn end(&mut self, totals: &Totals) -> Result<()> {
        let format = match self.encoding {
            PlyEncoding::Ascii => "ascii",
            PlyEncoding::Binary => "binary_little_endian",
        };
        let is_mesh = self.header.kind == Kind::TriangleMesh;
        let vertices = if is_mesh { totals.vertices } else { totals.points };
        let mut header = format!("ply\nformat {format} 1.0\ncomment spmesh\nelement vertex {vertices}\n");
        header += "property double x\nproperty double y\nproperty double z\n";
        if is_mesh {
            header += &format!("element face {}\n", totals.simplices);
            header += "property list uchar int vertex_indices\n";
        }
        header += "end_header\n";
        self.output.write_all(header.as_bytes()).map_err(write_error)?;
        copy(&mut self.vertices, &mut self.output)?;
        copy(&mut self.faces, &mut self.output)?;
        self.output.flush().map_err(write_error)
    }
}

impl<W: Write> EventSink for PlySink<W> {
    fn event(&mut self, event: &Event) -> Result<()> {
        match event {
            Event::Points(points) => points.iter().try_for_each(|&point| self.vertex(point)),
            Event::Patch(patch) => self.patch(patch),
            Event::End(totals) => self.end(totals),
            _ => Ok(()),
        }
    }

    fn notices(&self) -> Vec<String> {
        lost_of_header(&self.header, "PLY")
    }
}

/// A temporary file that has no name, so that nothing stays behind whatever happens.
fn spool(temp_dir: Option<&Path>) -> Result<BufWriter<File>> {
    let file = match temp_dir {
        Some(folder) => tempfile::tempfile_in(folder),
        None => tempfile::tempfile(),
    };
    let file = file.map_err(|e| Error::io("creating a temporary file", e))?;
    Ok(BufWriter::with_capacity(1 << 16, file))
}

fn spool_error(cause: std::io::Error) -> Error {
    Error::io("writing a temporary file", cause)
}

/// Copies a temporary file from its start.
fn copy(spool: &mut BufWriter<File>, output: &mut impl Write) -> Result<()> {
    spool.flush().map_err(spool_error)?;
    spool.rewind().map_err(spool_error)?;
    let mut input = BufReader::with_capacity(1 << 16, spool.get_ref());
    std::io::copy(&mut input, output).map_err(|e| Error::io("copying a temporary file to the output", e))?;
    Ok(())
}
