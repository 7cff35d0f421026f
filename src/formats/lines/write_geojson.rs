//! Writes the edges of a constrained mesh that are on lines as GeoJSON.

use std::io::Write;

use crate::crs::System;
use crate::sink::constrained::Surveyed;
use crate::sink::{EventSink, SinkOptions, expect_kind, write_error};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::decimal::Decimal;
use spmesh_stream::{Crs, Event, Header, Kind};

/// The start of a collection of features, up to the first of them. With an EPSG code, the collection has the
/// member `crs` of the 2008 specification. RFC 7946 removed it and, without prior arrangement, allows only
/// longitude and latitude in WGS 84; programs that know the member still read it.
pub fn collection_head(code: Option<u32>) -> String {
    let member = code.map_or_else(String::new, |code| {
        format!(r#""crs":{{"type":"name","properties":{{"name":"urn:ogc:def:crs:EPSG::{code}"}}}},"#)
    });
    format!(r#"{{"type":"FeatureCollection",{member}"features":["#)
}

/// The EPSG code of the system of x and y, if it has one.
pub fn epsg_code(crs: &Crs) -> Option<u32> {
    System::of(crs).horizontal?.code
}

/// Writes each edge on a line as a `LineString` with the property `line`, the number of the line in its file.
pub struct GeoJsonSink<W> {
    output: W,
    mesh: Surveyed,
    has_features: bool,
}

impl<W: Write> GeoJsonSink<W> {
    /// Starts the collection.
    ///
    /// # Errors
    /// Usage, if the stream is no constrained triangle mesh; or if writing fails.
    pub fn new(mut output: W, header: &Header) -> Result<Self> {
        expect_kind(header, "GeoJSON", &[Kind::TriangleMesh])?;
        if header.constrained.is_none() {
            return Err(Error::usage(
                "only the edges of a constrained mesh that are on lines become GeoJSON, and this mesh is not \
                 constrained",
            ));
        }
        output.write_all(collection_head(epsg_code(&header.crs)).as_bytes()).map_err(write_error)?;
        Ok(GeoJsonSink { output, mesh: Surveyed::new(header, &SinkOptions::default())?, has_features: false })
    }
}

impl<W: Write> EventSink for GeoJsonSink<W> {
    fn event(&mut self, event: &Event, _rows: &[u8]) -> Result<()> {
        if let Event::End(_) = event {
            self.output.write_all(b"\n]}\n").map_err(write_error)?;
            return self.output.flush().map_err(write_error);
        }
        let Some(patch) = self.mesh.event(event)? else { return Ok(()) };
        let axes = self.mesh.header().coordinates_per_point();
        for edge in &patch.edges {
            let places = patch.ends(edge).map(|place| {
                let numbers: Vec<String> = place[..axes].iter().map(|&x| Decimal(x).to_string()).collect();
                format!("[{}]", numbers.join(","))
            });
            let separator = if self.has_features { ",\n" } else { "\n" };
            self.has_features = true;
            write!(
                self.output,
                r#"{separator}{{"type":"Feature","properties":{{"line":{}}},"geometry":{{"type":"LineString","coordinates":[{}]}}}}"#,
                edge.line,
                places.join(",")
            )
            .map_err(write_error)?;
        }
        Ok(())
    }

    fn notices(&self) -> Vec<String> {
        vec!["GeoJSON gets the edges on lines only: triangles dropped".into()]
    }
}
