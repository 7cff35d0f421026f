//! Writes UGRID, the convention for meshes in netCDF, in the classic format of netCDF.
//!
//! Sources: "UGRID Conventions" 1.0 (ugrid-conventions.github.io); "The NetCDF Classic Format Specification"
//! (Unidata); for the CRS, the attributes that MDAL reads, the library for meshes of QGIS. Numbers are
//! big-endian.

use std::io::Write;
use std::path::Path;

use crate::crs::{System, Unit, text};
use crate::sink::spool::{MeshSpool, place_of};
use crate::sink::{EventSink, expect_kind, lost_attributes, lost_where_crs_is_text, write_error};
use spmesh_base::error::{Error, Result};
use spmesh_stream::{Event, Header, Kind, Totals};

/// The numbers of netCDF for parts of the header and for types.
const DIMENSIONS: u32 = 10;
const VARIABLES: u32 = 11;
const ATTRIBUTES: u32 = 12;
const CHAR: u32 = 2;
const INT: u32 = 4;
const DOUBLE: u32 = 6;

/// The number of the dimension of nodes, and those of the corners of faces.
const OF_NODES: [u32; 1] = [0];
const OF_CORNERS: [u32; 2] = [1, 2];

/// Most nodes: a variable that is not the last has fewer than 4 GiB. Most faces: a dimension fits in an i32.
const NODES_MAX: u64 = (u32::MAX as u64 - 3) / 8;
const FACES_MAX: u64 = i32::MAX as u64;

/// The variable of the CRS: QGIS 3.22 looks for this name, later versions for that in `grid_mapping`.
const CRS: &str = "projected_coordinate_system";

enum Attribute {
    Text(String),
    Number(i32),
}

struct Variable {
    name: &'static str,
    dimensions: &'static [u32],
    attributes: Vec<(&'static str, Attribute)>,
    number: u32,
    len: u64,
}

/// The header of a netCDF file.
struct NetCdf {
    dimensions: [(&'static str, u64); 3],
    attributes: Vec<(&'static str, Attribute)>,
    /// In the order of their data; all but the last have fewer than 4 GiB.
    variables: Vec<Variable>,
}

impl NetCdf {
    /// Offsets have 32 bits if they fit, else 64.
    fn bytes(&self) -> Vec<u8> {
        let data: u64 = self.variables.iter().map(|variable| variable.len).sum();
        let is_wide = data + (1 << 20) > i32::MAX as u64;
        let start = self.with_start(0, is_wide).len() as u64;
        self.with_start(start, is_wide)
    }

    fn with_start(&self, start: u64, is_wide: bool) -> Vec<u8> {
        let mut bytes = [b"CDF", &[if is_wide { 2 } else { 1 }][..]].concat();
        // No records.
        put(&mut bytes, &[0, DIMENSIONS, self.dimensions.len() as u32]);
        for (name, len) in &self.dimensions {
            put_text(&mut bytes, name);
            put(&mut bytes, &[*len as u32]);
        }
        put_attributes(&mut bytes, &self.attributes);
        put(&mut bytes, &[VARIABLES, self.variables.len() as u32]);
        let mut offset = start;
        for variable in &self.variables {
            put_text(&mut bytes, variable.name);
            put(&mut bytes, &[variable.dimensions.len() as u32]);
            put(&mut bytes, variable.dimensions);
            put_attributes(&mut bytes, &variable.attributes);
            // The last variable may be longer than its length can say.
            put(&mut bytes, &[variable.number, u32::try_from(variable.len).unwrap_or(u32::MAX)]);
            if is_wide {
                bytes.extend(offset.to_be_bytes());
            } else {
                put(&mut bytes, &[offset as u32]);
            }
            offset += variable.len;
        }
        bytes
    }
}

fn put(bytes: &mut Vec<u8>, numbers: &[u32]) {
    numbers.iter().for_each(|number| bytes.extend(number.to_be_bytes()));
}

fn put_text(bytes: &mut Vec<u8>, text: &str) {
    put(bytes, &[text.len() as u32]);
    bytes.extend(text.bytes());
    bytes.resize(bytes.len() + text.len().next_multiple_of(4) - text.len(), 0);
}

fn put_attributes(bytes: &mut Vec<u8>, attributes: &[(&str, Attribute)]) {
    // A list without elements is two zeros.
    let tag = if attributes.is_empty() { 0 } else { ATTRIBUTES };
    put(bytes, &[tag, attributes.len() as u32]);
    for (name, attribute) in attributes {
        put_text(bytes, name);
        match attribute {
            Attribute::Text(text) => {
                put(bytes, &[CHAR]);
                put_text(bytes, text);
            }
            Attribute::Number(number) => put(bytes, &[INT, 1, *number as u32]),
        }
    }
}

/// Writes a triangle mesh as UGRID: the nodes with their elevations, and the faces.
///
/// The format states its counts first, so everything waits in unnamed temporary files until the end. Memory:
/// buffers only.
pub struct UgridSink<W> {
    output: W,
    mesh: MeshSpool,
}

impl<W: Write> UgridSink<W> {
    /// Opens the temporary files, in `temp_dir` or the system's folder for them.
    ///
    /// # Errors
    /// Usage, if the format does not hold the kind of stream; I/O, if there is no room for temporary files.
    pub fn new(output: W, header: &Header, temp_dir: Option<&Path>) -> Result<Self> {
        expect_kind(header, "UGRID", &[Kind::TriangleMesh])?;
        Ok(UgridSink { output, mesh: MeshSpool::new(header, temp_dir)? })
    }

    fn end(&mut self, totals: &Totals) -> Result<()> {
        if totals.simplices == 0 {
            return Err(Error::usage(
                "a mesh without triangles cannot be written as UGRID: netCDF has no empty dimensions",
            ));
        }
        if totals.vertices > NODES_MAX || totals.simplices > FACES_MAX {
            return Err(Error::usage(format!(
                "UGRID in classic netCDF holds at most {NODES_MAX} nodes and {FACES_MAX} faces: make fewer with spsimplify"
            )));
        }
        let head = layout(self.mesh.header(), totals).bytes();
        self.put(&head)?;
        // The variables without dimensions.
        self.put(&[0; 8])?;
        for axis in 0..3 {
            let mut places = self.mesh.vertices.records::<24>()?;
            for _ in 0..totals.vertices {
                let place = place_of(&places.next()?);
                self.output.write_all(&place[axis].to_be_bytes()).map_err(write_error)?;
            }
        }
        let mut corners = self.mesh.corners.records::<8>()?;
        for _ in 0..3 * totals.simplices {
            let id = u64::from_le_bytes(corners.next()?) as u32;
            self.output.write_all(&id.to_be_bytes()).map_err(write_error)?;
        }
        self.output.flush().map_err(write_error)
    }

    fn put(&mut self, bytes: &[u8]) -> Result<()> {
        self.output.write_all(bytes).map_err(write_error)
    }
}

fn layout(header: &Header, totals: &Totals) -> NetCdf {
    let word = |text: &str| Attribute::Text(text.into());
    let system = System::of(&header.crs);
    let is_angular = system.horizontal.as_ref().is_some_and(|horizontal| horizontal.is_angular());
    let unit = unit_of(system.horizontal.as_ref().map(|horizontal| &horizontal.unit));
    let axis = |name, standard, angle: &str| {
        let mut attributes = vec![("standard_name", word(standard))];
        attributes.extend(if is_angular { Some(angle) } else { unit }.map(|unit| ("units", word(unit))));
        Variable { name, dimensions: &OF_NODES, attributes, number: DOUBLE, len: 8 * totals.vertices }
    };
    let [x, y] = match is_angular {
        true => ["longitude", "latitude"],
        false => ["projection_x_coordinate", "projection_y_coordinate"],
    };
    let mut heights = axis("mesh2d_node_z", "altitude", "m");
    heights.attributes = vec![
        ("standard_name", word("altitude")),
        ("mesh", word("mesh2d")),
        ("location", word("node")),
        ("coordinates", word("mesh2d_node_x mesh2d_node_y")),
        ("grid_mapping", word(CRS)),
    ];
    let unit = unit_of(system.vertical.as_ref().map(|vertical| &vertical.unit)).or(unit);
    heights.attributes.extend(unit.map(|unit| ("units", word(unit))));
    let topology = vec![
        ("cf_role", word("mesh_topology")),
        ("topology_dimension", Attribute::Number(2)),
        ("node_coordinates", word("mesh2d_node_x mesh2d_node_y")),
        ("face_node_connectivity", word("mesh2d_face_nodes")),
        ("face_dimension", word("mesh2d_face")),
    ];
    let faces = vec![
        ("cf_role", word("face_node_connectivity")),
        ("start_index", Attribute::Number(0)),
        // Without a value, MDAL takes 0 for one.
        ("_FillValue", Attribute::Number(-1)),
    ];
    let scalar = |name, attributes| Variable { name, dimensions: &[], attributes, number: INT, len: 4 };
    NetCdf {
        dimensions: [
            ("mesh2d_node", totals.vertices),
            ("mesh2d_face", totals.simplices),
            ("mesh2d_corner", 3),
        ],
        attributes: vec![("Conventions", word("CF-1.8 UGRID-1.0")), ("source", word("spmesh"))],
        variables: vec![
            scalar("mesh2d", topology),
            scalar(CRS, crs(header, &system)),
            axis("mesh2d_node_x", x, "degrees_east"),
            axis("mesh2d_node_y", y, "degrees_north"),
            heights,
            Variable {
                name: "mesh2d_face_nodes",
                dimensions: &OF_CORNERS,
                attributes: faces,
                number: INT,
                len: 12 * totals.simplices,
            },
        ],
    }
}

/// The CRS as CF has it, and as MDAL looks for it.
fn crs(header: &Header, system: &System) -> Vec<(&'static str, Attribute)> {
    let code = system.horizontal.as_ref().and_then(|horizontal| horizontal.code);
    let mut attributes = Vec::new();
    if let Some(text) = text(&header.crs) {
        attributes.push(("crs_wkt", Attribute::Text(text.clone())));
        attributes.push(("wkt", Attribute::Text(text)));
    }
    attributes.extend(code.map(|code| ("epsg", Attribute::Number(code as i32))));
    attributes
}

/// The name of a unit of lengths in UDUNITS.
fn unit_of(unit: Option<&Unit>) -> Option<&'static str> {
    match unit?.code? {
        9001 => Some("m"),
        9002 => Some("international_foot"),
        9003 => Some("US_survey_foot"),
        _ => None,
    }
}

impl<W: Write> EventSink for UgridSink<W> {
    fn event(&mut self, event: &Event, _rows: &[u8]) -> Result<()> {
        match event {
            Event::End(totals) => self.end(totals),
            event => self.mesh.event(event, &[]),
        }
    }

    fn notices(&self) -> Vec<String> {
        let header = self.mesh.header();
        let mut notices = lost_where_crs_is_text(header, "UGRID");
        notices.extend(lost_attributes(header, "UGRID"));
        notices
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_stream::Coordinates;

    #[test]
    fn offsets_have_64_bits_where_they_need_them() {
        let header = Header::new(Kind::TriangleMesh, Coordinates::F64, 2, true);
        let ends = |vertices, simplices| {
            let bytes = layout(&header, &Totals { vertices, simplices, ..Totals::default() }).bytes();
            let width = if bytes[3] == 2 { 8 } else { 4 };
            let [len, offset] = [&bytes[bytes.len() - width - 4..][..4], &bytes[bytes.len() - width..]];
            (bytes[3], bytes.len() as u64, len.to_vec(), offset.to_vec())
        };
        let (version, start, len, offset) = ends(1000, 2000);
        assert_eq!((version, len), (1, 24_000u32.to_be_bytes().to_vec()));
        assert_eq!(offset, (start as u32 + 8 + 24_000).to_be_bytes());
        let (version, start, len, offset) = ends(NODES_MAX, FACES_MAX);
        assert_eq!((version, len), (2, vec![255; 4]));
        assert_eq!(offset, (start + 8 + 24 * NODES_MAX).to_be_bytes());
    }
}
