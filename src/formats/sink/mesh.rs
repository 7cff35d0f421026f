//! Writes meshes that are in memory, with attributes of vertices and of cells, as VTU or PLY.

use std::io::Write;

use crate::ply::properties::{self as properties, Properties};
use crate::sink::write_error;
use crate::vtk::vtu::{Cells, Content, Data, END, POLYGON, TETRAHEDRON, TRIANGLE, arrays, head};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::attributes::Attributes;
use spmesh_stream::model::bounds::Point;

/// Corners of a polygon that a byte can count.
const SHORT: usize = u8::MAX as usize;

/// The cells of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape<'m> {
    /// Three corners each.
    Triangles,
    /// Four corners each.
    Tetrahedra,
    /// Any number of corners: for each polygon the end of its corners.
    Polygons(&'m [usize]),
}

/// Attributes with a row for each vertex or cell.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// The attributes.
    pub attributes: Attributes,
    /// The rows, one after the other.
    pub rows: Vec<u8>,
}

/// A mesh with attributes.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh<'m> {
    /// World coordinates of the vertices.
    pub points: &'m [Point],
    /// What the cells are.
    pub shape: Shape<'m>,
    /// The corners of all cells.
    pub corners: &'m [u32],
    /// Attributes of the vertices.
    pub of_points: Table,
    /// Attributes of the cells.
    pub of_cells: Table,
}

impl Mesh<'_> {
    fn cells(&self) -> usize {
        match self.shape {
            Shape::Triangles => self.corners.len() / 3,
            Shape::Tetrahedra => self.corners.len() / 4,
            Shape::Polygons(ends) => ends.len(),
        }
    }

    /// The end of the corners of each cell.
    fn ends(&self) -> Box<dyn Iterator<Item = usize> + '_> {
        match self.shape {
            Shape::Triangles => Box::new((1..=self.cells()).map(|cell| 3 * cell)),
            Shape::Tetrahedra => Box::new((1..=self.cells()).map(|cell| 4 * cell)),
            Shape::Polygons(ends) => Box::new(ends.iter().copied()),
        }
    }

    /// Writes the mesh as VTU, and flushes.
    ///
    /// # Errors
    /// Usage, if there is not one row for each vertex and cell; I/O.
    pub fn write_vtu(&self, output: &mut impl Write) -> Result<()> {
        self.check()?;
        let code = match self.shape {
            Shape::Triangles => TRIANGLE,
            Shape::Tetrahedra => TETRAHEDRON,
            Shape::Polygons(_) => POLYGON,
        };
        let [vertices, count, corners] =
            [self.points.len(), self.cells(), self.corners.len()].map(|count| count as u64);
        let cells = Cells { vertices, cells: count, corners, code };
        let data = |table: &Table| table.attributes.iter().map(Data::of).collect::<Vec<_>>();
        let arrays = arrays(&cells, &data(&self.of_points), &data(&self.of_cells));
        let mut put = |bytes: &[u8]| output.write_all(bytes).map_err(write_error);
        put(head(&cells, &arrays).as_bytes())?;
        for array in &arrays {
            put(&array.len.to_le_bytes())?;
            match array.content {
                Content::Data(number) => self.of_points.column(number).try_for_each(&mut put)?,
                Content::CellData(number) => self.of_cells.column(number).try_for_each(&mut put)?,
                Content::Vertices => {
                    self.points.as_flattened().iter().try_for_each(|x| put(&x.to_le_bytes()))?;
                }
                Content::Connectivity => {
                    self.corners.iter().try_for_each(|&corner| put(&u64::from(corner).to_le_bytes()))?;
                }
                Content::Offsets => self.ends().try_for_each(|end| put(&(end as u64).to_le_bytes()))?,
                Content::Types => (0..count).try_for_each(|_| put(&[code]))?,
            }
        }
        put(END)?;
        output.flush().map_err(write_error)
    }

    /// Writes the mesh as binary PLY, with the attributes of cells as properties of faces, and flushes.
    ///
    /// # Errors
    /// Usage, if the cells are tetrahedra, there are more vertices than PLY can number, or there is not one
    /// row for each vertex and cell; I/O.
    pub fn write_ply(&self, output: &mut impl Write) -> Result<()> {
        self.check()?;
        if self.shape == Shape::Tetrahedra {
            return Err(Error::usage("PLY holds no tetrahedra: write them as VTU (.vtu)"));
        }
        if self.points.len() > i32::MAX as usize {
            return Err(Error::usage("more than 2^31 - 1 vertices: PLY cannot number them"));
        }
        let mut start = 0;
        let longest = self.ends().map(|end| end - std::mem::replace(&mut start, end)).max();
        let is_short = longest.is_none_or(|longest| longest <= SHORT);
        let mut put = |bytes: &[u8]| output.write_all(bytes).map_err(write_error);
        put(self.ply_header(is_short).as_bytes())?;
        let mut rows = self.of_points.rows();
        for point in self.points {
            point.iter().try_for_each(|x| put(&x.to_le_bytes()))?;
            properties::bytes(&self.of_points.attributes, rows.next().unwrap_or_default(), &mut put)?;
        }
        let (mut start, mut rows) = (0, self.of_cells.rows());
        for end in self.ends() {
            let corners = &self.corners[std::mem::replace(&mut start, end)..end];
            let count = (corners.len() as u32).to_le_bytes();
            put(if is_short { &count[..1] } else { &count })?;
            corners.iter().try_for_each(|corner| put(&corner.to_le_bytes()))?;
            properties::bytes(&self.of_cells.attributes, rows.next().unwrap_or_default(), &mut put)?;
        }
        output.flush().map_err(write_error)
    }

    fn ply_header(&self, is_short: bool) -> String {
        let [vertices, faces] =
            [&self.of_points, &self.of_cells].map(|table| Properties::of(&table.attributes));
        let (points, cells) = (self.points.len(), self.cells());
        let count = if is_short { "uchar" } else { "uint" };
        format!(
            "ply\nformat binary_little_endian 1.0\ncomment spmesh\nelement vertex {points}\n\
             property double x\nproperty double y\nproperty double z\n{}element face {cells}\n\
             property list {count} int vertex_indices\n{}end_header\n",
            vertices.lines(),
            faces.lines()
        )
    }

    fn check(&self) -> Result<()> {
        for (table, count) in [(&self.of_points, self.points.len()), (&self.of_cells, self.cells())] {
            let len = table.attributes.row_len();
            if table.rows.len() != len * count {
                let rows = table.rows.len() / len.max(1);
                return Err(Error::usage(format!("{rows} rows of attributes for {count} vertices or cells")));
            }
        }
        Ok(())
    }
}

impl Table {
    /// The rows; none without attributes.
    fn rows(&self) -> std::slice::ChunksExact<'_, u8> {
        self.rows.chunks_exact(self.attributes.row_len().max(1))
    }

    /// The bytes of an attribute in each row.
    fn column(&self, number: usize) -> impl Iterator<Item = &[u8]> {
        let place = self.attributes.places().nth(number).map(|(_, place)| place).unwrap_or_default();
        self.rows().map(move |row| &row[place.clone()])
    }
}
