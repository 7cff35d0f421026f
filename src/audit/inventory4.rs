//! Counts the content of a stream of four dimensions.

use spmesh_stream::Event;
use spmesh_stream::model::cells4::Point4;

/// Counts of a stream of four dimensions, gathered event by event.
#[derive(Debug, Default)]
pub struct Inventory4 {
    /// Smallest and largest x, y, z, t.
    pub found_bounds: Option<[Point4; 2]>,
    /// Points whose value is known.
    pub values_known: u64,
    /// Finite cells.
    pub finite: u64,
    /// Finite cells of five vertices.
    pub simplices: u64,
    /// Infinite cells.
    pub infinite: u64,
    /// Most vertices of a cell.
    pub vertices_max: usize,
    /// Most neighbours of a cell.
    pub neighbours_max: usize,
}

impl Inventory4 {
    /// Adds an event with content of four dimensions.
    pub(super) fn event(&mut self, event: &Event) {
        match event {
            Event::Points4(block) => {
                block.points.iter().for_each(|&point| self.extend(point));
                let values = block.values.iter().flatten();
                self.values_known += values.filter(|value| !value.is_nan()).count() as u64;
            }
            Event::Cells4(cells) => {
                for cell in cells.iter() {
                    self.finite += u64::from(!cell.is_infinite);
                    self.simplices += u64::from(!cell.is_infinite && cell.vertices.len() == 5);
                    self.infinite += u64::from(cell.is_infinite);
                    self.vertices_max = self.vertices_max.max(cell.vertices.len());
                    self.neighbours_max = self.neighbours_max.max(cell.neighbours.len());
                }
            }
            _ => {}
        }
    }

    fn extend(&mut self, point: Point4) {
        let [min, max] = self.found_bounds.get_or_insert([point; 2]);
        for axis in 0..4 {
            min[axis] = min[axis].min(point[axis]);
            max[axis] = max[axis].max(point[axis]);
        }
    }
}
