//! Weighted points in streams, and what becomes of them.

use spmesh_audit::{Audit, Standard};
use spmesh_delaunay::delaunay3::triangulate_weighted;
use spmesh_pipeline::reduce::Options;
use spmesh_stream::model::attributes::{Attribute, Attributes, NumberType};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Event, Header, StreamReader, StreamWriter, Weighted};

use super::solids::{Corners, bits, every_node};

/// Points with their weights in the order of a stream, and the stream.
pub struct Balls {
    pub points: Vec<Point>,
    pub weights: Vec<f64>,
    pub stream: Vec<u8>,
}

/// The points of a stream with the weights that `weigh` gives them, behind another attribute.
pub fn weighted(stream: &[u8], mut weigh: impl FnMut(Point) -> f64) -> Balls {
    let mut reader = StreamReader::new(stream, "points").unwrap();
    let (mut events, mut points) = (Vec::new(), Vec::new());
    while let Some(event) = reader.next_event().unwrap() {
        if let Event::Points(block) = &event {
            points.extend(block.iter().copied());
        }
        events.push(event);
    }
    let weights: Vec<f64> = points.iter().map(|&point| weigh(point)).collect();
    let list = vec![Attribute::new("class", NumberType::U8), Weighted::attribute()];
    let header = Header {
        attributes: Attributes::new(list).unwrap(),
        weighted: Some(Weighted { greatest: weights.iter().copied().fold(0.0, f64::max) }),
        ..reader.header().clone()
    };
    let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
    let mut rest = weights.iter();
    for event in events {
        match event {
            Event::Points(points) => {
                let row = |weight: &f64| [&[7][..], &weight.to_le_bytes()].concat();
                let rows: Vec<u8> = rest.by_ref().take(points.len()).flat_map(row).collect();
                writer.points_with_rows(&points, &rows).unwrap();
            }
            Event::Cells(cells) => writer.cells(&cells).unwrap(),
            _ => {}
        }
    }
    Balls { points, weights, stream: writer.end(0, 0).unwrap() }
}

pub fn options(threads: usize) -> Options<3> {
    Options { weighted: true, ..every_node(threads) }
}

/// The kernel's regular tetrahedra of all points at once, and the number of hidden ones.
pub fn expected(Balls { points, weights, .. }: &Balls) -> (Vec<Corners>, usize) {
    let mesh = triangulate_weighted(points, weights).unwrap();
    let corner = |v: u32| bits(mesh.vertices()[v as usize].at);
    let mut set: Vec<Corners> = mesh
        .tetrahedra()
        .iter()
        .map(|t| {
            let mut corners = t.vertices.map(corner);
            corners.sort_unstable();
            corners
        })
        .collect();
    set.sort_unstable();
    (set, mesh.hidden.len())
}

/// The verdict of the audit, which uses neither the predicates nor the kernels.
pub fn audit(mesh: &[u8]) -> Result<(), String> {
    let mut reader = StreamReader::new(mesh, "mesh").unwrap();
    let mut audit = Audit::new(reader.header(), Standard::Canonical, None).unwrap();
    while let Some(event) = reader.next_event().unwrap() {
        audit.event_with_rows(&event, reader.rows()).map_err(|violation| violation.message)?;
    }
    Ok(())
}
