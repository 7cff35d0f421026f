//! Writes four-dimensional points, cells and simplices.

use std::io::Write;

use super::{POINTS_PAYLOAD, StreamWriter, Tag};
use crate::cell_words::INFINITE;
use crate::check_value;
use crate::model::cells4::{Cell4, Point4};
use spmesh_base::error::{Error, Result};

impl<W: Write> StreamWriter<W> {
    /// Appends points of four dimensions, with a value for each if the header says that points have one. Any
    /// NaN stands for an unknown value.
    ///
    /// # Errors
    /// If a coordinate or a value is infinite, a coordinate is NaN, the points of a stream of cells are not
    /// sorted, the number of values differs from the number of points, or writing fails.
    pub fn points4(&mut self, points: &[Point4], values: Option<&[f64]>) -> Result<()> {
        let value_count = self.header.has_elevation.then_some(points.len());
        if values.map(<[f64]>::len) != value_count {
            return Err(Error::usage(format!(
                "cannot write {} points of 4 dimensions: the header wants a value for {} of them",
                points.len(),
                if self.header.has_elevation { "each" } else { "none" }
            )));
        }
        self.start_records(Tag::Points4)?;
        for (number, &point) in points.iter().enumerate() {
            self.rules4.point(point)?;
            self.flush_if_full(self.header.point_len())?;
            point.iter().for_each(|x| self.points.extend_from_slice(&x.to_le_bytes()));
            if let Some(values) = values {
                let value = values[number];
                let value = if value.is_nan() { f64::NAN } else { value };
                check_value(value)?;
                self.points.extend_from_slice(&value.to_le_bytes());
            }
        }
        let has_vertices = self.header.kind.has_vertices();
        let count = if has_vertices { &mut self.totals.vertices } else { &mut self.totals.points };
        *count += points.len() as u64;
        Ok(())
    }

    /// Appends a cell; all points must have been written before. Neighbours may be written later.
    ///
    /// # Errors
    /// If its lists are not increasing, are too short, or name unknown points; or if writing fails.
    pub fn cell4(&mut self, cell: Cell4) -> Result<()> {
        self.start_records(Tag::Cells4)?;
        self.rules4.cell(cell, &mut self.totals)?;
        let mark = if cell.is_infinite { INFINITE } else { 0 };
        let counts = [cell.vertices.len() as u32 | mark, cell.neighbours.len() as u32];
        for word in counts.iter().chain(cell.vertices).chain(cell.neighbours) {
            self.flush_if_full(4)?;
            self.points.extend_from_slice(&word.to_le_bytes());
        }
        Ok(())
    }

    /// Appends simplices (a, b, c, d, e) with det(b - a, c - a, d - a, e - a) > 0, as numbers of points,
    /// which must all have been written before.
    ///
    /// # Errors
    /// If a simplex repeats a vertex or names an unknown point, or writing fails.
    pub fn simplices4(&mut self, simplices: &[[u32; 5]]) -> Result<()> {
        self.start_records(Tag::Simplices4)?;
        self.rules4.simplices(simplices, &mut self.totals)?;
        for simplex in simplices {
            self.flush_if_full(20)?;
            simplex.iter().for_each(|vertex| self.points.extend_from_slice(&vertex.to_le_bytes()));
        }
        Ok(())
    }

    /// Flushes records with another tag, so that the next records go to a block with this tag.
    fn start_records(&mut self, tag: Tag) -> Result<()> {
        if self.points_tag != tag {
            self.flush_points()?;
            self.points_tag = tag;
        }
        Ok(())
    }

    /// Flushes the block if a record of `len` bytes does not fit.
    fn flush_if_full(&mut self, len: usize) -> Result<()> {
        if self.points.len() + len > POINTS_PAYLOAD { self.flush_points() } else { Ok(()) }
    }
}
