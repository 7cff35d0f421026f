//! Counts of the elements of a diagram.

use spmesh_stream::model::cells4::{Cell4, Cells4};

/// Counts of the elements of a diagram.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Finite cells.
    pub finite: u64,
    /// Finite cells of more than five vertices.
    pub not_simplices: u64,
    /// Infinite cells.
    pub infinite: u64,
    /// Pairs of neighbours, those of infinite cells included.
    pub facets: u64,
    /// Vertices of all cells, counted for each cell; the faraway point is not counted.
    pub vertex_references: u64,
    /// Most vertices of a finite cell.
    pub vertices_max: u64,
}

impl Counts {
    /// Counts cells.
    pub fn of(cells: &Cells4) -> Self {
        let mut counts = Counts::default();
        let neighbours = cells.iter().map(|cell| counts.add(cell)).sum::<u64>();
        counts.facets = neighbours / 2;
        counts
    }

    /// Counts a cell, but not its facets; returns the number of these.
    pub(super) fn add(&mut self, cell: Cell4) -> u64 {
        let vertices = cell.vertices.len() as u64;
        if cell.is_infinite {
            self.infinite += 1;
        } else {
            self.finite += 1;
            self.not_simplices += u64::from(vertices > 5);
            self.vertices_max = self.vertices_max.max(vertices);
        }
        self.vertex_references += vertices;
        cell.neighbours.len() as u64
    }

    /// Finite and infinite cells.
    pub fn cells(&self) -> u64 {
        self.finite + self.infinite
    }

    /// Share of the finite cells that are not simplices; 0 without cells.
    pub fn share_not_simplices(&self) -> f64 {
        self.not_simplices as f64 / self.finite.max(1) as f64
    }

    /// Cells, facets and vertex references together: figure 3.9 of the thesis shows this sum.
    pub fn elements(&self) -> u64 {
        self.cells() + self.facets + self.vertex_references
    }

    /// Size of the cells in bytes: two lists of 32-bit numbers each, preceded by their length. This is the
    /// size of the output in table 3.4 of the thesis.
    pub fn cell_bytes(&self) -> u64 {
        4 * (2 * self.cells() + self.vertex_references + 2 * self.facets)
    }
}
