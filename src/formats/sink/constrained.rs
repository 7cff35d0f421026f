//! What formats of surveyors take from a mesh: triangles with coordinates, and the edges on lines.

use crate::sink::SinkOptions;
use crate::sink::world::Places;
use spmesh_base::error::Result;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{ConstraintEdges, Event, Header, LiveVertices, Patch};

/// Vertices that are live, and the lines of segments.
///
/// Memory: the width of the stream, 4 bytes per segment, and the edges of the border on segments.
pub(crate) struct Surveyed {
    places: Places,
    live: LiveVertices<Point>,
    edges: ConstraintEdges,
    /// Number of the line of each segment.
    lines: Vec<u32>,
}

/// An edge on a line.
pub(crate) struct LineEdge {
    /// The number of the line in its file.
    pub(crate) line: u32,
    /// Local indices.
    pub(crate) ends: [u32; 2],
}

/// A patch with world coordinates.
pub(crate) struct SurveyedPatch<'a> {
    pub(crate) patch: &'a Patch,
    /// Coordinates of the local vertices.
    pub(crate) places: Vec<Point>,
    /// Edges on lines that no earlier triangle stated.
    pub(crate) edges: Vec<LineEdge>,
}

impl SurveyedPatch<'_> {
    /// The places of the ends of an edge.
    pub(crate) fn ends(&self, edge: &LineEdge) -> [Point; 2] {
        edge.ends.map(|local| self.places[local as usize])
    }
}

impl Surveyed {
    pub(crate) fn new(header: &Header, options: &SinkOptions) -> Result<Self> {
        Ok(Surveyed {
            places: Places::new(header, options)?,
            live: LiveVertices::new(),
            edges: ConstraintEdges::default(),
            lines: Vec::new(),
        })
    }

    pub(crate) fn header(&self) -> &Header {
        self.places.header()
    }

    /// Where coordinates go.
    pub(crate) fn places(&self) -> &Places {
        &self.places
    }

    /// Takes an event; a patch comes back with its coordinates.
    pub(crate) fn event<'a>(&mut self, event: &'a Event) -> Result<Option<SurveyedPatch<'a>>> {
        match event {
            Event::Segments(segments) => self.lines.extend(segments.iter().map(|segment| segment.line)),
            Event::Patch(patch) => {
                let local = self.live.enter(patch, |_, point| self.places.of(point))?;
                let places = local.iter().map(|&(_, place)| place).collect();
                let edges = self.edges.enter(patch).into_iter();
                let edges =
                    edges.map(|(ends, segment)| LineEdge { line: self.lines[segment as usize], ends });
                return Ok(Some(SurveyedPatch { patch, places, edges: edges.collect() }));
            }
            _ => {}
        }
        Ok(None)
    }
}
