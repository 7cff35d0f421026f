//! Writes SMB, Isenburg's streaming mesh in binary (`formats/historical_meshes.md`).

use std::io::Write;
use std::path::Path;

use crate::sink::elements::ElementBlocks;
use crate::sink::spool::Spool;
use crate::sink::triangles::{Corner, final_corners};
use crate::sink::world::{world_bounds, world_of};
use crate::sink::{EventSink, expect_kind, lost_attributes, lost_of_header, write_error};
use spmesh_base::error::{Error, Result, counted};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Event, Header, Kind, Patch};

/// Version, little-endian, no compression of connectivity and geometry, no comments.
const START: [u8; 8] = [0; 8];

/// Writes a triangle mesh as SMB, little-endian, vertices before their triangles.
///
/// SMB has 32-bit coordinates and 31-bit vertex numbers, and can finalize a vertex only at its last use;
/// notices report what that lost.
///
/// The header states the counts, by which a reader notices a truncated file. So the elements wait in an unnamed
/// temporary file until the end. Memory: buffers only. Disk: the size of the output.
pub struct SmbSink<W> {
    output: W,
    blocks: ElementBlocks<Spool>,
    header: Header,
    vertices: u64,
    triangles: u64,
    rounded: u64,
    open: u64,
}

impl<W: Write> SmbSink<W> {
    /// Opens the temporary file, in `temp_dir` or the system's folder for them.
    ///
    /// # Errors
    /// Usage, if SMB does not hold the kind of stream; I/O, if there is no room for the temporary file.
    pub fn new(output: W, header: &Header, temp_dir: Option<&Path>) -> Result<Self> {
        expect_kind(header, "SMB", &[Kind::TriangleMesh])?;
        let blocks = ElementBlocks::new(Spool::new(temp_dir)?);
        Ok(SmbSink { output, blocks, header: header.clone(), vertices: 0, triangles: 0, rounded: 0, open: 0 })
    }

    /// Writes the header and the elements.
    fn end(&mut self) -> Result<()> {
        self.blocks.end()?;
        let mut header = START.to_vec();
        for count in [self.vertices, self.triangles] {
            // -1 stands for an unknown count.
            header.extend(i32::try_from(count).unwrap_or(-1).to_le_bytes());
        }
        header.push(u8::from(self.header.bounds.is_some()));
        if let Some(stored) = &self.header.bounds {
            let world = world_bounds(&self.header, stored);
            header.extend(encode_point(world.min)?);
            header.extend(encode_point(world.max)?);
        }
        self.output.write_all(&header).map_err(write_error)?;
        self.blocks.output().copy_to(&mut self.output)?;
        self.output.flush().map_err(write_error)
    }

    fn patch(&mut self, patch: &Patch) -> Result<()> {
        for &point in &patch.new {
            let world = world_of(&self.header, point);
            self.rounded += u64::from(world.iter().any(|&x| f64::from(x as f32) != x));
            self.blocks.push(true, &encode_point(world)?)?;
        }
        self.vertices += patch.new.len() as u64;
        if self.vertices > i32::MAX as u64 {
            return Err(Error::usage("more than 2^31 - 1 vertices: SMB cannot number them"));
        }
        let (triangles, unused) = final_corners(patch);
        self.triangles += triangles.len() as u64;
        for triangle in triangles {
            let mut element = [0; 12];
            for (bytes, corner) in element.chunks_exact_mut(4).zip(triangle) {
                bytes.copy_from_slice(&self.index(corner).to_le_bytes());
            }
            self.blocks.push(false, &element)?;
        }
        self.open += unused.len() as u64;
        Ok(())
    }

    /// Number of a vertex from 1, or, at its last use, relative to the number of vertices so far.
    fn index(&self, corner: Corner) -> i32 {
        match corner.is_final {
            true => -((self.vertices - corner.id) as i32),
            false => (corner.id + 1) as i32,
        }
    }
}

impl<W: Write> EventSink for SmbSink<W> {
    fn event(&mut self, event: &Event, _rows: &[u8]) -> Result<()> {
        match event {
            Event::Patch(patch) => self.patch(patch),
            Event::End(_) => self.end(),
            _ => Ok(()),
        }
    }

    fn notices(&self) -> Vec<String> {
        let mut notices = lost_of_header(&self.header, "SMB");
        notices.extend(lost_attributes(&self.header, "SMB"));
        if self.rounded > 0 {
            notices.push(format!(
                "{} of {} vertices were rounded: SMB has coordinates of 32 bits",
                self.rounded, self.vertices
            ));
        }
        if self.open > 0 {
            notices.push(format!(
                "{} final only at the end: SMB finalizes a vertex with its last triangle",
                counted(self.open, "vertex is", "vertices are")
            ));
        }
        notices
    }
}

fn encode_point(world: Point) -> Result<[u8; 12]> {
    let mut bytes = [0; 12];
    for (bytes, x) in bytes.chunks_exact_mut(4).zip(world) {
        let single = x as f32;
        if single.is_infinite() {
            return Err(Error::usage(format!("coordinate {x} is out of the range of SMB")));
        }
        bytes.copy_from_slice(&single.to_le_bytes());
    }
    Ok(bytes)
}
