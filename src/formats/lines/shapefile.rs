//! Shapefiles: the main file (`.shp`) has the geometry, files beside it have the
//! system (`.prj`) and the attributes (`.dbf`).
//!
//! Source: ESRI Shapefile Technical Description, 1998. Lengths in the file are not trusted: memory is taken
//! for bytes that have arrived.

use std::io::{ErrorKind, Read};
use std::path::Path;

use crate::lines::collect::Shape;
use crate::lines::dbase::Table;
use crate::lines::{Breaklines, Collector, Reading};
use spmesh_base::error::{Error, Result};
use spmesh_base::inputs;
use spmesh_base::limits::CRS_LEN_MAX;
use spmesh_stream::Crs;

const HEADER_LEN: usize = 100;
/// Values below this mean that there is none.
const NO_DATA: f64 = -1e38;

/// What the records of a type hold.
#[derive(Clone, Copy)]
struct Kind {
    shape: Shape,
    /// Whether a record is a single point, without a box and counts.
    is_point: bool,
    has_parts: bool,
    has_z: bool,
}

/// The kind of records of a type; `None` for records without geometry.
fn kind(code: i32) -> Result<Option<Kind>> {
    let shape = match code % 10 {
        0 => return Ok(None),
        1 | 8 => Shape::Points,
        3 => Shape::Line,
        5 => Shape::Ring,
        _ => return Err(unknown(code)),
    };
    if !(0..30).contains(&code) {
        return Err(unknown(code));
    }
    let has_parts = matches!(shape, Shape::Line | Shape::Ring);
    Ok(Some(Kind { shape, is_point: code % 10 == 1, has_parts, has_z: code / 10 == 1 }))
}

fn unknown(code: i32) -> Error {
    Error::malformed(format!(
        "found shapes of type {code}, expected points, lines or polygons: convert them first, for example with ogr2ogr"
    ))
}

/// Reads the main file, and the system beside it.
pub(crate) fn read(mut input: impl Read, path: &Path, reading: &Reading) -> Result<Breaklines> {
    let mut header = [0; HEADER_LEN];
    fill(&mut input, &mut header).map_err(|e| e.at("header"))?;
    kind(i32_le(&header[32..]))?;
    let mut lines = Collector::new(reading);
    let mut content = Vec::new();
    // The header states the length of the file in words of two bytes, itself included.
    let stated = 2 * i64::from(i32::from_be_bytes([header[24], header[25], header[26], header[27]]));
    let mut found = HEADER_LEN as i64;
    let mut table = Table::beside(path, lines.no_properties())?;
    let mut shapes = 0;
    for number in 1u64.. {
        if !next_record(&mut input, &mut content).map_err(|e| e.at(format!("record {number}")))? {
            // A file that was cut off behind a record.
            if found < stated {
                return Err(cut_off().at(format!("record {number}")));
            }
            break;
        }
        found += 8 + content.len() as i64;
        shapes = number;
        if let Some(table) = table.as_mut().filter(|table| number <= table.len) {
            let Some(properties) = table.next()? else { continue };
            lines.feature(properties);
        }
        record(&content, &mut lines, number).map_err(|e| e.at(format!("record {number}")))?;
    }
    let missing = missing(table.map(|table| table.len), shapes);
    Ok(Breaklines { missing, ..lines.finish(system(path)?)? })
}

/// What is wrong with a table of so many rows, if anything is.
fn missing(rows: Option<u64>, shapes: u64) -> Option<String> {
    let found = match rows {
        None => "no table of attributes beside it (.dbf)".to_string(),
        Some(rows) if rows != shapes => format!("{rows} rows of attributes (.dbf) for {shapes} shapes"),
        Some(_) => return None,
    };
    Some(format!("found {found}: attributes decide here, so copy all files of the Shapefile together"))
}

/// Reads the content of the next record; false at the end of the file.
fn next_record(input: &mut impl Read, content: &mut Vec<u8>) -> Result<bool> {
    let mut head = Vec::new();
    input.by_ref().take(8).read_to_end(&mut head).map_err(|e| Error::io("reading", e))?;
    if head.is_empty() {
        return Ok(false);
    }
    if head.len() < 8 {
        return Err(cut_off());
    }
    let words = i32::from_be_bytes([head[4], head[5], head[6], head[7]]);
    let len =
        u64::try_from(words).map_err(|_| Error::malformed(format!("found a length of {words} words")))? * 2;
    content.clear();
    input.by_ref().take(len).read_to_end(content).map_err(|e| Error::io("reading", e))?;
    if (content.len() as u64) < len { Err(cut_off()) } else { Ok(true) }
}

fn fill(input: &mut impl Read, bytes: &mut [u8]) -> Result<()> {
    input.read_exact(bytes).map_err(|e| match e.kind() {
        ErrorKind::UnexpectedEof => cut_off(),
        _ => Error::io("reading", e),
    })
}

fn cut_off() -> Error {
    Error::malformed("the file is cut off here: copy it again")
}

fn record(content: &[u8], lines: &mut Collector, number: u64) -> Result<()> {
    let mut rest = content;
    let Some(kind) = kind(i32_le(take(&mut rest, 4)?))? else { return Ok(()) };
    let position = || format!("record {number}");
    if kind.is_point {
        let place = numbers(take(&mut rest, 16)?);
        let z = if kind.has_z { numbers(take(&mut rest, 8)?)[0] } else { f64::NAN };
        return lines.add(kind.shape, &[[place[0], place[1], known(z)]], position);
    }
    take(&mut rest, 32)?;
    let part_count = if kind.has_parts { count(&mut rest)? } else { 1 };
    let vertex_count = count(&mut rest)?;
    let starts = take(&mut rest, if kind.has_parts { 4 * part_count } else { 0 })?;
    let mut starts: Vec<usize> = starts.chunks_exact(4).map(|start| i32_le(start) as usize).collect();
    if !kind.has_parts {
        starts.push(0);
    }
    let places = numbers(take(&mut rest, 16 * vertex_count)?);
    // The range of elevations precedes them.
    let elevations = if kind.has_z {
        take(&mut rest, 16)?;
        numbers(take(&mut rest, 8 * vertex_count)?)
    } else {
        Vec::new()
    };
    let is_ordered = starts.first().is_none_or(|&first| first == 0) && starts.is_sorted();
    if !is_ordered || starts.iter().any(|&start| start > vertex_count) {
        return Err(Error::malformed("the starts of parts are not in order, or beyond the vertices"));
    }
    let vertex =
        |i: usize| [places[2 * i], places[2 * i + 1], elevations.get(i).map_or(f64::NAN, |&z| known(z))];
    if kind.shape == Shape::Ring {
        lines.polygon();
    }
    for (part, &start) in starts.iter().enumerate() {
        let end = starts.get(part + 1).copied().unwrap_or(vertex_count);
        let vertices: Vec<[f64; 3]> = (start..end).map(vertex).collect();
        lines.add(kind.shape, &vertices, position)?;
    }
    Ok(())
}

fn known(z: f64) -> f64 {
    if z < NO_DATA { f64::NAN } else { z }
}

/// The next bytes of a record.
fn take<'a>(rest: &mut &'a [u8], len: usize) -> Result<&'a [u8]> {
    let found = rest.len();
    let (taken, later) = rest
        .split_at_checked(len)
        .ok_or_else(|| Error::malformed(format!("the record has {found} bytes left, expected {len}")))?;
    *rest = later;
    Ok(taken)
}

fn count(rest: &mut &[u8]) -> Result<usize> {
    let count = i32_le(take(rest, 4)?);
    usize::try_from(count).map_err(|_| Error::malformed(format!("found a count of {count}")))
}

fn i32_le(bytes: &[u8]) -> i32 {
    i32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])
}

fn numbers(bytes: &[u8]) -> Vec<f64> {
    let number = |bytes: &[u8]| f64::from_le_bytes(bytes.try_into().expect("eight bytes"));
    bytes.chunks_exact(8).map(number).collect()
}

/// The system in the file beside a Shapefile.
fn system(path: &Path) -> Result<Crs> {
    let Some((file, beside)) = inputs::open_beside(path, &["prj", "PRJ"])? else { return Ok(Crs::Unknown) };
    let named = |e: Error| e.of_input(beside.display().to_string());
    let text = inputs::content(file, CRS_LEN_MAX as u64).map_err(named)?.ok_or_else(|| {
        let message = format!("more than {CRS_LEN_MAX} bytes, expected well-known text of a system");
        named(Error::malformed(message))
    })?;
    let text = String::from_utf8_lossy(&text);
    let text = text.trim_start_matches('\u{feff}').trim();
    Ok(if text.is_empty() { Crs::Unknown } else { Crs::Wkt(text.to_string()) })
}
