//! Reads the vertices of OFF files; their faces are ignored.

use std::io::Read;

use crate::detect::is_off;
use crate::text::lines::Lines;
use crate::twin::tokens::{fields, next_field, parse_decimals, parse_integer, unexpected};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Point;

/// Reads the vertices.
pub(crate) fn read(lines: &mut Lines<impl Read>) -> Result<Vec<Point>> {
    let vertices = read_count(lines).map_err(|e| lines.locate(e))?;
    let mut points = Vec::new();
    for vertex in 1..=vertices {
        if !next_content(lines)? {
            let reason = format!("truncated: expected vertex {vertex} of {vertices}");
            return Err(lines.locate(Error::malformed(reason)));
        }
        let point = parse_decimals(&mut content(lines.current()));
        points.push(point.map_err(|e| lines.locate(e))?);
    }
    Ok(points)
}

/// The number of vertices, which follows the file's first word on its line or on the next.
fn read_count(lines: &mut Lines<impl Read>) -> Result<u64> {
    next_content(lines)?;
    let mut words = content(lines.current());
    let kind = next_field(&mut words)?;
    if !is_off(kind) {
        return Err(unexpected(kind, "OFF"));
    }
    if let Some(count) = words.next() {
        return match count {
            b"BINARY" => Err(Error::malformed("is binary OFF, expected the text form: convert it first")),
            _ => parse_integer(count),
        };
    }
    drop(words);
    next_content(lines)?;
    parse_integer(next_field(&mut content(lines.current()))?)
}

/// Goes to the next line that is not blank or a comment; false at the end.
fn next_content(lines: &mut Lines<impl Read>) -> Result<bool> {
    while let Some(line) = lines.next_line()? {
        if content(line).next().is_some() {
            return Ok(true);
        }
    }
    Ok(false)
}

/// The fields of a line up to a comment.
fn content(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    let end = line.iter().position(|&byte| byte == b'#').unwrap_or(line.len());
    fields(&line[..end])
}
