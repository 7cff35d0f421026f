//! Reads SMA, Isenburg's streaming mesh as text (`formats/historical_meshes.md`).

use crate::drivers::{AnyInput, Events};
use crate::source::mesh_events::{Element, Elements, MeshEvents, resolve};
use crate::source::patches::Order;
use crate::text::lines::Lines;
use crate::twin::tokens::{expect_no_field, fields, next_field, parse_decimals, parse_signed, unexpected};
use spmesh_base::error::{Error, Result};

/// Opens an SMA mesh, pre-order or post-order, and reads up to its first element. Messages call the input
/// `name`.
///
/// Verifies the counts that the header states. Without them, a mesh that declares some vertices final is
/// truncated if it leaves others open.
///
/// # Errors
/// If the lines before the first element are not a header of SMA. This and every later error is
/// [`spmesh_base::error::ErrorKind::Malformed`] (or I/O) and names input and line.
pub fn open_sma(input: AnyInput, name: &str) -> Result<Events> {
    let lines = Lines::new(input, name);
    let mut elements =
        SmaElements { lines, order: Order::Stated, held: false, vertices: None, triangles: None };
    elements.read_header().map_err(|e| elements.locate(e))?;
    Ok(Box::new(MeshEvents::new(elements)))
}

struct SmaElements {
    lines: Lines<AnyInput>,
    order: Order,
    /// The current line ended the header and is still to be parsed.
    held: bool,
    vertices: Option<u64>,
    triangles: Option<u64>,
}

impl SmaElements {
    /// Reads comments up to the first element, whose type decides the order of the mesh.
    fn read_header(&mut self) -> Result<()> {
        while let Some(line) = self.lines.next_line()? {
            let mut fields = fields(line);
            match (fields.next(), fields.next(), fields.next()) {
                (Some(b"#"), Some(b"nverts"), Some(count)) => self.vertices = parse_count(count)?,
                (Some(b"#"), Some(b"nfaces"), Some(count)) => self.triangles = parse_count(count)?,
                (None, ..) => {}
                (Some(first), ..) if first[0] == b'#' => {}
                (Some(first), ..) => {
                    self.order = if first == b"f" { Order::OnArrival } else { Order::Stated };
                    self.held = true;
                    return Ok(());
                }
            }
        }
        Ok(())
    }
}

impl Elements for SmaElements {
    fn order(&self) -> Order {
        self.order
    }

    fn next_element(&mut self, vertices: u64) -> Result<Option<Element>> {
        loop {
            if !std::mem::take(&mut self.held) && self.lines.next_line()?.is_none() {
                return Ok(None);
            }
            if !self.lines.is_ended() {
                return Err(Error::malformed("truncated: the last line has no end"));
            }
            if let Some(element) = parse_element(self.lines.current(), vertices)? {
                return Ok(Some(element));
            }
        }
    }

    fn check_counts(&self, vertices: u64, triangles: u64) -> Result<bool> {
        check_count("vertices", self.vertices, vertices)?;
        check_count("triangles", self.triangles, triangles)?;
        Ok(self.vertices.is_some() && self.triangles.is_some())
    }

    fn locate(&self, error: Error) -> Error {
        self.lines.locate(error)
    }
}

/// Checks the count that the header states, if any, against the mesh.
pub(crate) fn check_count(what: &str, stated: Option<u64>, found: u64) -> Result<()> {
    match stated {
        Some(stated) if stated != found => Err(Error::malformed(format!(
            "the header states {stated} {what}, the mesh has {found}: truncated?"
        ))),
        _ => Ok(()),
    }
}

/// A count of the header; -1 stands for an unknown one.
pub(crate) fn parse_count(field: &[u8]) -> Result<Option<u64>> {
    Ok(u64::try_from(parse_signed(field)?).ok())
}

/// The element of a line; `None` for comments and empty lines.
fn parse_element(line: &[u8], vertices: u64) -> Result<Option<Element>> {
    let mut fields = fields(line);
    let element = match fields.next() {
        None => return Ok(None),
        Some(first) if first[0] == b'#' => return Ok(None),
        Some(b"v") => Element::Vertex(parse_decimals(&mut fields)?),
        Some(b"f") => {
            let (mut ids, mut finals) = ([0; 3], [false; 3]);
            for (id, is_final) in ids.iter_mut().zip(&mut finals) {
                let number = parse_signed(next_field(&mut fields)?)?;
                (*id, *is_final) = (resolve(number, vertices)?, number < 0);
            }
            Element::Triangle(ids, finals)
        }
        Some(b"x") => Element::Final(resolve(parse_signed(next_field(&mut fields)?)?, vertices)?),
        Some(other) => return Err(unexpected(other, "v, f, x or a comment")),
    };
    expect_no_field(&mut fields)?;
    Ok(Some(element))
}
