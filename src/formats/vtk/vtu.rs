//! Writes VTU, the XML format of VTK for unstructured grids, with the arrays appended as raw bytes.
//!
//! Source: "VTK XML file formats" (docs.vtk.org). An array in the appended data is its length in bytes, here
//! a u64, then its values; `offset` counts from the byte after the underscore that starts the appended data.

use std::io::Write;
use std::path::Path;

use crate::sink::spool::MeshSpool;
use crate::sink::{EventSink, expect_kind, lost_of_attributes, lost_of_header, write_error};
use spmesh_base::error::Result;
use spmesh_stream::model::attributes::{Attribute, NumberType};
use spmesh_stream::{Event, Header, Kind, Totals};

const START: &str = "\
<?xml version=\"1.0\"?>
<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">
<UnstructuredGrid>
";

pub(crate) const END: &[u8] = b"\n</AppendedData>\n</VTKFile>\n";

/// VTK's numbers of types of cells.
const VERTEX: u8 = 1;
pub(crate) const TRIANGLE: u8 = 5;
pub(crate) const POLYGON: u8 = 7;
pub(crate) const TETRAHEDRON: u8 = 10;

/// Writes points or a mesh as VTU: the vertices with their labels as the point data `label` and their
/// attributes under their names, the simplices as cells, points as cells of one vertex. World coordinates as
/// doubles; finalization is not written.
///
/// VTU states its counts first, so everything waits in unnamed temporary files until the end. Memory: buffers
/// only.
pub struct VtuSink<W> {
    output: W,
    mesh: MeshSpool,
}

/// What an array holds.
#[derive(Clone, Copy)]
pub(crate) enum Content {
    /// Data of the vertices: labels, values or an attribute, by their number.
    Data(usize),
    /// An attribute of the cells, by its number.
    CellData(usize),
    Vertices,
    Connectivity,
    Offsets,
    Types,
}

/// One array of the appended data.
pub(crate) struct Array {
    pub(crate) content: Content,
    /// Attributes of its element, and the tags before and after it.
    attributes: String,
    open: String,
    close: &'static str,
    /// Length of the values in bytes.
    pub(crate) len: u64,
}

/// Counts and type of the cells.
pub(crate) struct Cells {
    pub(crate) vertices: u64,
    pub(crate) cells: u64,
    /// Corners of all cells.
    pub(crate) corners: u64,
    /// VTK's number of the cell type.
    pub(crate) code: u8,
}

/// Data of the vertices: name, type and components of its array, and bytes per vertex.
pub(crate) struct Data {
    name: String,
    number: &'static str,
    components: u8,
    width: u64,
}

impl Data {
    fn labels() -> Self {
        Data { name: "label".into(), number: "UInt64", components: 1, width: 8 }
    }

    pub(crate) fn of(attribute: &Attribute) -> Self {
        let number = match attribute.number {
            NumberType::U8 => "UInt8",
            NumberType::I8 => "Int8",
            NumberType::U16 => "UInt16",
            NumberType::I16 => "Int16",
            NumberType::U32 => "UInt32",
            NumberType::I32 => "Int32",
            NumberType::U64 => "UInt64",
            NumberType::I64 => "Int64",
            NumberType::F32 => "Float32",
            NumberType::F64 => "Float64",
        };
        let (name, components) = (escaped(&attribute.name), attribute.components);
        Data { name, number, components, width: attribute.width() as u64 }
    }

    fn attributes(&self) -> String {
        let Data { name, number, components, .. } = self;
        let several = format!(" NumberOfComponents=\"{components}\"");
        format!("type=\"{number}\" Name=\"{name}\"{}", if *components > 1 { &several } else { "" })
    }
}

/// Text in an attribute of XML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

impl<W: Write> VtuSink<W> {
    /// Opens the temporary files, in `temp_dir` or the system's folder for them.
    ///
    /// # Errors
    /// Usage, if VTU does not hold the kind of stream; I/O, if there is no room for temporary files.
    pub fn new(output: W, header: &Header, temp_dir: Option<&Path>) -> Result<Self> {
        expect_kind(header, "VTU", &[Kind::Points, Kind::TriangleMesh, Kind::TetrahedralMesh])?;
        Ok(VtuSink { output, mesh: MeshSpool::new(header, temp_dir)?.with_attributes(temp_dir)? })
    }

    fn end(&mut self, totals: &Totals) -> Result<()> {
        let cells = Cells::of(self.mesh.header().kind, totals);
        let labels = (self.mesh.label_count > 0).then(Data::labels);
        let attributes = self.mesh.header().attributes.iter().map(Data::of);
        let arrays = arrays(&cells, &attributes.chain(labels).collect::<Vec<_>>(), &[]);
        self.put(head(&cells, &arrays).as_bytes())?;
        for array in &arrays {
            self.put(&array.len.to_le_bytes())?;
            self.values(array.content, &cells)?;
        }
        self.put(END)?;
        self.output.flush().map_err(write_error)
    }

    fn values(&mut self, content: Content, cells: &Cells) -> Result<()> {
        match content {
            Content::Data(number) => {
                let columns = &mut self.mesh.columns;
                columns.get_mut(number).unwrap_or(&mut self.mesh.labels).copy_to(&mut self.output)
            }
            Content::Vertices => self.mesh.vertices.copy_to(&mut self.output),
            // The points of a points stream are in no simplex.
            Content::Connectivity if cells.code == VERTEX => {
                (0..cells.cells).try_for_each(|id| self.put(&id.to_le_bytes()))
            }
            Content::Connectivity => self.mesh.corners.copy_to(&mut self.output),
            Content::Offsets => {
                let corners = cells.corners / cells.cells.max(1);
                (1..=cells.cells).try_for_each(|cell| self.put(&(cell * corners).to_le_bytes()))
            }
            // A stream has no data of cells.
            Content::CellData(_) => Ok(()),
            Content::Types => (0..cells.cells).try_for_each(|_| self.put(&[cells.code])),
        }
    }

    fn put(&mut self, bytes: &[u8]) -> Result<()> {
        self.output.write_all(bytes).map_err(write_error)
    }
}

/// Everything before the appended data.
pub(crate) fn head(cells: &Cells, arrays: &[Array]) -> String {
    let Cells { vertices, cells: count, .. } = cells;
    let mut text = format!("{START}<Piece NumberOfPoints=\"{vertices}\" NumberOfCells=\"{count}\">\n");
    let mut offset = 0;
    for Array { attributes, open, close, len, .. } in arrays {
        text += &format!("{open}<DataArray {attributes} format=\"appended\" offset=\"{offset}\"/>\n{close}");
        offset += 8 + len;
    }
    text + "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_"
}

/// The arrays in the order of the appended data.
pub(crate) fn arrays(cells: &Cells, of_points: &[Data], of_cells: &[Data]) -> Vec<Array> {
    let array = |content, attributes: &str, open: &str, close, len| Array {
        content,
        attributes: attributes.to_string(),
        open: open.to_string(),
        close,
        len,
    };
    let point = "type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"";
    let corner = "type=\"Int64\" Name=\"connectivity\"";
    let offset = "type=\"Int64\" Name=\"offsets\"";
    let code = "type=\"UInt8\" Name=\"types\"";
    let &Cells { vertices, cells, corners, .. } = cells;
    let mut arrays = Vec::new();
    for (block, data, rows) in [("Point", of_points, vertices), ("Cell", of_cells, cells)] {
        let is_of_points = block == "Point";
        for (number, one) in data.iter().enumerate() {
            let content = if is_of_points { Content::Data(number) } else { Content::CellData(number) };
            let start = format!("<{block}Data Scalars=\"{}\">\n", one.name);
            let open = if number == 0 { start.as_str() } else { "" };
            let close = if is_of_points { "</PointData>\n" } else { "</CellData>\n" };
            let close = if number + 1 == data.len() { close } else { "" };
            arrays.push(array(content, &one.attributes(), open, close, one.width * rows));
        }
    }
    arrays.extend([
        array(Content::Vertices, point, "<Points>\n", "</Points>\n", 24 * vertices),
        array(Content::Connectivity, corner, "<Cells>\n", "", 8 * corners),
        array(Content::Offsets, offset, "", "", 8 * cells),
        array(Content::Types, code, "", "</Cells>\n", cells),
    ]);
    arrays
}

impl Cells {
    fn of(kind: Kind, totals: &Totals) -> Self {
        let &Totals { points, vertices, simplices, .. } = totals;
        match kind {
            Kind::Points => Cells { vertices: points, cells: points, corners: points, code: VERTEX },
            Kind::TetrahedralMesh => {
                Cells { vertices, cells: simplices, corners: 4 * simplices, code: TETRAHEDRON }
            }
            _ => Cells { vertices, cells: simplices, corners: 3 * simplices, code: TRIANGLE },
        }
    }
}

impl<W: Write> EventSink for VtuSink<W> {
    fn event(&mut self, event: &Event, rows: &[u8]) -> Result<()> {
        match event {
            Event::End(totals) => self.end(totals),
            event => self.mesh.event(event, rows),
        }
    }

    fn notices(&self) -> Vec<String> {
        let header = self.mesh.header();
        lost_of_header(header, "VTU").into_iter().chain(lost_of_attributes(header, "VTU")).collect()
    }
}
