//! Writes the text twin of a stream (`formats/text.md`).

use std::io::Write;

use crate::sink::rows::Rows;
use crate::sink::world::{world_of, write_numbers};
use crate::sink::{EventSink, write_error};
use crate::twin::regions::region_fields;
use crate::twin::write_configurations::OpenGroup;
use crate::twin::{write_constraints, write_functions, write4};
use spmesh_base::error::Result;
use spmesh_stream::model::attributes::{Attribute, Attributes};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::decimal::Decimal;
use spmesh_stream::{
    Constrained, Coordinates, Crs, Event, Header, PartName, Patch, Totals, VERSION, Weighted,
};

/// Writes the text twin.
pub struct TwinSink<W> {
    output: W,
    header: Header,
    open: OpenGroup,
    /// Number of triangles or tetrahedra written.
    simplices: u64,
}

impl<W: Write> TwinSink<W> {
    /// Writes the header.
    ///
    /// # Errors
    /// If writing fails.
    pub fn new(mut output: W, header: &Header) -> Result<Self> {
        write_header(&mut output, header)?;
        Ok(TwinSink { output, header: header.clone(), open: OpenGroup::default(), simplices: 0 })
    }

    fn point(&mut self, start: &str, point: Point, row: &[u8]) -> Result<()> {
        write_numbers(&mut self.output, start, &world_of(&self.header, point))?;
        write_row(&mut self.output, &self.header.attributes, row)
    }

    fn vertices(&mut self, points: &[Point], rows: &[u8]) -> Result<()> {
        let mut rows = Rows::new(&self.header, rows);
        points.iter().try_for_each(|&point| self.point("v", point, rows.next()))
    }

    fn residual_points(&mut self, points: &[(Option<u64>, Point)], rows: &[u8]) -> Result<()> {
        let mut rows = Rows::new(&self.header, rows);
        points.iter().try_for_each(|&(id, point)| match id {
            Some(id) => self.point(&format!("r {}", id + 1), point, rows.next()),
            None => self.point("r -", point, rows.next()),
        })
    }

    fn line(&mut self, line: std::fmt::Arguments) -> Result<()> {
        writeln!(self.output, "{line}").map_err(write_error)
    }

    fn patch(&mut self, patch: &Patch, rows: &[u8]) -> Result<()> {
        self.line(format_args!("# patch"))?;
        self.vertices(&patch.new, rows)?;
        for origin in &patch.origins {
            let (vertex, id) = (patch.id(origin.local) + 1, origin.id.0 + 1);
            self.line(format_args!("from {vertex} {id}"))?;
        }
        if self.header.kind.vertices_per_simplex() == 4 {
            for tetrahedron in patch.tetrahedra() {
                let [a, b, c, d] = tetrahedron.map(|local| patch.id(local) + 1);
                self.line(format_args!("c {a} {b} {c} {d}"))?;
            }
        } else {
            for triangle in patch.triangles() {
                let [a, b, c] = triangle.map(|local| patch.id(local) + 1);
                self.line(format_args!("f {a} {b} {c}"))?;
            }
        }
        write_constraints::sides(&mut self.output, self.simplices, &patch.sides)?;
        self.simplices += (patch.simplices.len() / self.header.kind.vertices_per_simplex()) as u64;
        patch.finalized.iter().try_for_each(|&local| self.line(format_args!("x {}", patch.id(local) + 1)))?;
        patch.kept.iter().try_for_each(|&local| self.line(format_args!("kept {}", patch.id(local) + 1)))
    }

    fn walls(&mut self, walls: &[u32]) -> Result<()> {
        for wall in walls.chunks_exact(self.header.kind.vertices_per_wall()) {
            let corners: Vec<String> =
                wall.iter().map(|&corner| (u64::from(corner) + 1).to_string()).collect();
            self.line(format_args!("w {}", corners.join(" ")))?;
        }
        Ok(())
    }

    fn end(&mut self, totals: &Totals) -> Result<()> {
        let Totals { points, cells, vertices, simplices, merged, residual_points, walls } = totals;
        self.line(format_args!(
            "# end points {points} cells {cells} vertices {vertices} simplices {simplices} merged {merged} \
             residual {residual_points} walls {walls}"
        ))?;
        self.output.flush().map_err(write_error)
    }
}

impl<W: Write> EventSink for TwinSink<W> {
    fn event(&mut self, event: &Event, rows: &[u8]) -> Result<()> {
        match event {
            Event::Points(points) => self.vertices(points, rows),
            Event::Cells(cells) => {
                cells.iter().try_for_each(|cell| self.line(format_args!("x cell {}", cell.0)))
            }
            Event::Region(region) => self.line(format_args!("region {}", region_fields(region))),
            Event::Patch(patch) => self.patch(patch, rows),
            Event::Labels(labels) => {
                labels.iter().try_for_each(|label| self.line(format_args!("label {label}")))
            }
            Event::ResidualPoints(points) => self.residual_points(points, rows),
            Event::Walls(walls) => self.walls(walls),
            Event::Points4(points) => write4::points(&mut self.output, points),
            Event::Cells4(cells) => write4::cells(&mut self.output, cells),
            Event::Simplices4(simplices) => write4::simplices(&mut self.output, simplices),
            Event::Configurations(block) => self.open.write(&mut self.output, block),
            Event::Functions(functions) => write_functions::functions(&mut self.output, functions),
            Event::Coefficients(coefficients) => {
                write_functions::coefficients(&mut self.output, coefficients)
            }
            Event::Segments(segments) => {
                write_constraints::segments(&mut self.output, &self.header.coordinates, segments)
            }
            Event::OpenSegments(segments) => write_constraints::open_segments(&mut self.output, segments),
            Event::End(totals) => self.end(totals),
        }
    }

    fn notices(&self) -> Vec<String> {
        Vec::new()
    }
}

fn write_header(output: &mut impl Write, header: &Header) -> Result<()> {
    let yes_no = |yes: bool| if yes { "yes" } else { "no" };
    let mut line = |line: std::fmt::Arguments| writeln!(output, "#spmesh {line}").map_err(write_error);
    line(format_args!("version {VERSION}"))?;
    line(format_args!("kind {}", header.kind.name()))?;
    match &header.coordinates {
        Coordinates::F64 => line(format_args!("coordinates f64"))?,
        Coordinates::I32 { scale, offset } => {
            line(format_args!("coordinates i32"))?;
            line(format_args!("scale {}", numbers(scale)))?;
            line(format_args!("offset {}", numbers(offset)))?;
        }
    }
    line(format_args!("dims {}", header.dims))?;
    line(format_args!("elevation {}", yes_no(header.has_elevation)))?;
    if let Some(bounds) = &header.bounds {
        line(format_args!("bounds {} {}", numbers(&bounds.min), numbers(&bounds.max)))?;
    }
    if let Some(points) = header.points {
        line(format_args!("points {points}"))?;
    }
    if let Some(tree) = &header.tree {
        line(format_args!("tree {} {} {}", tree.depth(), numbers(&tree.origin()), Decimal(tree.side())))?;
    }
    if let Some(region) = &header.region {
        let dims = usize::from(header.dims);
        line(format_args!("region {} {}", numbers(&region.min[..dims]), numbers(&region.max[..dims])))?;
    }
    line(format_args!("chunked {}", yes_no(header.chunked)))?;
    match &header.crs {
        Crs::Unknown => {}
        Crs::Wkt(text) => line(format_args!("wkt {}", string(text)))?,
        Crs::GeoKeys { directory, doubles, ascii } => {
            line(format_args!("geokeys {} {} {}", hex(directory), hex(doubles), hex(ascii)))?;
        }
    }
    for attribute in &header.attributes {
        line(format_args!("attribute {}", attribute_fields(attribute)))?;
    }
    if let Some(Constrained { is_cut, kill }) = header.constrained {
        line(format_args!("constrained {} {}", yes_no(is_cut), Decimal(kill)))?;
    }
    if let Some(Weighted { greatest }) = header.weighted {
        line(format_args!("weighted {}", Decimal(greatest)))?;
    }
    if let Some(PartName { node, below }) = header.part {
        line(format_args!("part {node} {below}"))?;
    }
    line(format_args!("producer {}", string(&header.producer)))
}

/// The fields of the line of an attribute.
fn attribute_fields(attribute: &Attribute) -> String {
    let Attribute { name, number, components, unit, las_name, scale, unknown } = attribute;
    let scale = scale.map_or("- -".to_string(), |scale| numbers(&scale));
    let unknown = unknown.as_ref().map_or("-".to_string(), |bytes| number.read(bytes).to_string());
    let (name, unit, las_name) = (string(name), string(unit), string(las_name));
    format!("{name} {} {components} {unit} {las_name} {scale} {unknown}", number.name())
}

/// The line of a row, if there are attributes.
fn write_row(output: &mut impl Write, attributes: &Attributes, row: &[u8]) -> Result<()> {
    if attributes.is_empty() {
        return Ok(());
    }
    output.write_all(b"a").map_err(write_error)?;
    for (attribute, place) in attributes.places() {
        for number in attribute.numbers(&row[place]) {
            write!(output, " {number}").map_err(write_error)?;
        }
    }
    output.write_all(b"\n").map_err(write_error)
}

pub(crate) fn numbers(numbers: &[f64]) -> String {
    let texts: Vec<String> = numbers.iter().map(|&number| Decimal(number).to_string()).collect();
    texts.join(" ")
}

fn string(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

fn hex(bytes: &[u8]) -> String {
    if bytes.is_empty() {
        return "-".into();
    }
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
