//! How large a diagram is.

use spmesh_model::cells4::Cells4;

/// Sizes of a diagram.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Figures {
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

impl Figures {
    /// Counts cells.
    #[must_use]
    pub fn of(cells: &Cells4) -> Self {
        let mut figures = Figures::default();
        let mut neighbours = 0;
        for cell in cells.iter() {
            let vertices = cell.vertices.len() as u64;
            if cell.is_infinite {
                figures.infinite += 1;
            } else {
                figures.finite += 1;
                figures.not_simplices += u64::from(vertices > 5);
                figures.vertices_max = figures.vertices_max.max(vertices);
            }
            figures.vertex_references += vertices;
            neighbours += cell.neighbours.len() as u64;
        }
        figures.facets = neighbours / 2;
        figures
    }

    /// Finite and infinite cells.
    #[must_use]
    pub fn cells(&self) -> u64 {
        self.finite + self.infinite
    }

    /// Share of the finite cells that are not simplices; 0 of none.
    #[must_use]
    pub fn share_not_simplices(&self) -> f64 {
        self.not_simplices as f64 / self.finite.max(1) as f64
    }

    /// Cells, facets and vertex references together: what figure 3.9 of the thesis shows.
    #[must_use]
    pub fn elements(&self) -> u64 {
        self.cells() + self.facets + self.vertex_references
    }

    /// Bytes of the cells: two lists each, of 32-bit numbers behind their length. This is the size of the
    /// output in table 3.4 of the thesis.
    #[must_use]
    pub fn cell_bytes(&self) -> u64 {
        4 * (2 * self.cells() + self.vertex_references + 2 * self.facets)
    }
}
