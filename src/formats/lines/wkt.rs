//! Polygons as text (WKT, well-known text).

use std::io::Read;

use crate::detect::BYTE_ORDER_MARK;
use crate::lines::collect::Shape;
use crate::lines::geojson_polygons::read_rest;
use crate::lines::wkt_polygons::polygons;
use crate::lines::{Breaklines, Collector};
use spmesh_base::error::Result;
use spmesh_stream::Crs;

/// Whether a file that starts with `head` is well-known text of polygons.
pub(crate) fn is_wkt(head: &[u8]) -> bool {
    let text = head.strip_prefix(BYTE_ORDER_MARK).unwrap_or(head).trim_ascii_start();
    let starts = |word: &[u8]| text.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word));
    starts(b"POLYGON") || starts(b"MULTIPOLYGON") || starts(b"SRID=")
}

/// Reads polygons.
pub(crate) fn read(head: Vec<u8>, input: impl Read) -> Result<Breaklines> {
    let text = read_rest(input, head, "simplify the polygons")?;
    let mut lines = Collector::default();
    for (number, rings) in polygons(&text)?.into_iter().enumerate() {
        lines.polygon();
        for ring in rings {
            let closed = ring.iter().chain(ring.first());
            let vertices: Vec<[f64; 3]> = closed.map(|&[x, y]| [x, y, f64::NAN]).collect();
            lines.add(Shape::Ring, &vertices, || format!("polygon {number}"))?;
        }
    }
    lines.finish(Crs::Unknown)
}
