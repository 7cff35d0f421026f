//! The interface of the streaming point formats SPA and SPB; `formats/historical.md` describes both.

use crate::historical::sp_cells::{cell_of, check_end, tree_of};
use crate::source::pass::{BATCH_POINTS, Pass, Stated};
use crate::source::placement::Placement;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::{Coordinates, Crs, FinalizedCells};

/// How the file stores coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpDatatype {
    /// 32-bit floating point.
    Float,
    /// 32-bit integers.
    Int,
    /// 64-bit floating point.
    Double,
}

/// The space partition to which the cell indices of finalization tags refer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpFinalization {
    /// No tags.
    None,
    /// Cells of a quadtree over the bounding box.
    QuadTree,
    /// Cells of an octree over the bounding box.
    OctTree,
    /// Cells of a coarse triangulation, given in a file of its own.
    Clarkson2d,
    /// Cells of a coarse tetrahedralization, given in a file of its own.
    Clarkson3d,
}

/// The header of an SPA or SPB file.
#[derive(Debug, Clone, PartialEq)]
pub struct SpHeader {
    /// Comments in the file.
    pub comments: Vec<String>,
    /// How coordinates are stored.
    pub datatype: SpDatatype,
    /// The meaning of finalization tags.
    pub finalization: SpFinalization,
    /// Number of points, if stated.
    pub points: Option<u64>,
    /// Bounding box, if stated. SPA rounds it to six digits.
    pub bounds: Option<Bounds>,
}

/// A statement of such a file after its header.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SpEvent {
    /// A point. Single-precision and integer coordinates are exact in f64.
    Point(Point),
    /// No later point lies in the cell of this index.
    FinalizedCell(i32),
}

/// Reads an SPA or SPB file event by event.
pub trait SpReader {
    /// The header.
    fn header(&self) -> &SpHeader;

    /// The next event; `None` at the end.
    ///
    /// # Errors
    /// If reading fails, the file is damaged, or its number of points is not the stated one. Coordinates may
    /// be infinite or NaN.
    fn next_event(&mut self) -> Result<Option<SpEvent>>;

    /// Position of the last event read, for messages.
    fn position(&self) -> String;
}

impl SpHeader {
    /// Fails if `points`, counted at the end of the file, is not the stated number.
    pub(crate) fn check_count(&self, points: u64) -> Result<()> {
        match self.points {
            Some(stated) if stated != points => {
                Err(Error::malformed(format!("the header states {stated} points, the file has {points}")))
            }
            _ => Ok(()),
        }
    }

    pub(crate) fn state(&self, bounds: Option<Bounds>) -> Stated {
        let finite = |bounds: &Bounds| bounds.min.iter().chain(&bounds.max).all(|value| value.is_finite());
        Stated {
            coordinates: Coordinates::F64,
            has_z: Some(true),
            crs: Crs::Unknown.into(),
            bounds: bounds.filter(finite),
            points: self.points,
            offers: Vec::new().into(),
        }
    }
}

/// One pass over the points of such a file. Its tags only serve to notice that the file was cut.
pub(crate) struct SpPass<R> {
    reader: R,
    cells: Option<FinalizedCells>,
    last: Option<Point>,
}

impl<R: SpReader> SpPass<R> {
    pub(crate) fn new(reader: R) -> SpPass<R> {
        let cells = tree_of(reader.header()).map(FinalizedCells::new);
        SpPass { reader, cells, last: None }
    }

    /// Takes note of a tag. Wrong ones are of no concern here.
    fn finalize(&mut self, index: i32) {
        if let Some(cells) = &mut self.cells
            && let Ok(cell) = cell_of(index, cells.tree())
            && !cells.is_final_cell(cell)
        {
            let _ = cells.finalize(cell);
        }
    }
}

impl<R: SpReader + Send> Pass for SpPass<R> {
    fn next_batch(
        &mut self,
        placement: &mut Placement,
        batch: &mut Vec<Point>,
        _rows: &mut Vec<u8>,
    ) -> Result<bool> {
        for count in 0..BATCH_POINTS {
            match self.reader.next_event()? {
                Some(SpEvent::Point(point)) => {
                    self.last = Some(point);
                    placement.put(point, batch).map_err(|e| e.at(self.reader.position()))?;
                }
                Some(SpEvent::FinalizedCell(index)) => self.finalize(index),
                None => {
                    check_end(self.cells.as_ref(), self.last).map_err(|e| e.at(self.reader.position()))?;
                    return Ok(count > 0);
                }
            }
        }
        Ok(true)
    }
}
