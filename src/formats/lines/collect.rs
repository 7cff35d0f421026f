//! Lines as they are read, with their limits.

use std::sync::Arc;

use crate::lines::systems::LineSystem;
use crate::lines::{Breakline, Breaklines, Properties, Reading};
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::check_line_vertices;
use spmesh_stream::Crs;

/// What the parts of a geometry are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shape {
    /// Each vertex is a line of its own.
    Points,
    Line,
    /// A ring of the polygon that [`Collector::polygon`] has started.
    Ring,
}

/// Collects lines.
pub(crate) struct Collector {
    lines: Vec<Breakline>,
    polygons: u32,
    vertices: usize,
    reading: Reading,
    /// Those of the feature whose lines are entered.
    properties: Arc<Properties>,
}

impl Collector {
    /// No lines yet.
    pub(crate) fn new(reading: &Reading) -> Collector {
        let properties = Arc::new(reading.properties());
        Collector { lines: Vec::new(), polygons: 0, vertices: 0, reading: reading.clone(), properties }
    }

    /// The properties of a feature that states none.
    pub(crate) fn no_properties(&self) -> Properties {
        self.reading.properties()
    }

    /// Starts a feature.
    pub(crate) fn feature(&mut self, properties: Properties) {
        let Properties { elevation_name, label_name, .. } = self.reading.properties();
        let properties = Properties { elevation_name, label_name, ..properties };
        // Most features have the properties of the one before.
        if *self.properties != properties {
            self.properties = Arc::new(properties);
        }
    }

    /// Starts a polygon.
    pub(crate) fn polygon(&mut self) {
        self.polygons += 1;
    }

    /// Enters a part of a geometry: x, y and z of each vertex; a z that is not finite is unknown, and
    /// that of the feature takes its place. `position` is asked for once a line.
    pub(crate) fn add(
        &mut self,
        shape: Shape,
        vertices: &[[f64; 3]],
        position: impl Fn() -> String,
    ) -> Result<()> {
        self.vertices += vertices.len();
        check_line_vertices(self.vertices, self.reading.vertices_max)
            .map_err(|error| error.at(position()))?;
        if let Some(index) = vertices.iter().position(|[x, y, _]| !(x.is_finite() && y.is_finite())) {
            let [x, y, _] = vertices[index];
            let message = format!("vertex {index} is at {x}, {y}, expected finite coordinates");
            return Err(Error::malformed(message).at(position()));
        }
        let elevation = self.properties.elevation().map_err(|error| error.at(position()))?;
        let raised = elevation.map(|z| vertices.iter().map(|&[x, y, _]| [x, y, z]).collect::<Vec<_>>());
        let vertices = raised.as_deref().unwrap_or(vertices);
        if shape == Shape::Points {
            let position = position().into();
            vertices.chunks(1).for_each(|vertex| self.push(shape, vertex, &position));
        } else if !vertices.is_empty() {
            self.push(shape, vertices, &position().into());
        }
        Ok(())
    }

    fn push(&mut self, shape: Shape, vertices: &[[f64; 3]], position: &Arc<str>) {
        self.lines.push(Breakline {
            vertices: vertices.iter().map(|&[x, y, _]| [x, y]).collect(),
            elevations: vertices.iter().map(|&[_, _, z]| Some(z).filter(|z| z.is_finite())).collect(),
            is_point: shape == Shape::Points,
            polygon: (shape == Shape::Ring).then(|| self.polygons - 1),
            properties: Arc::clone(&self.properties),
            position: Arc::clone(position),
        });
    }

    /// The lines.
    pub(crate) fn finish(self, crs: Crs) -> Result<Breaklines> {
        if self.lines.is_empty() {
            return Err(Error::malformed("found no lines"));
        }
        let system = LineSystem { crs, may_be_degrees: false };
        Ok(Breaklines { lines: self.lines, system, ..Breaklines::default() })
    }
}
