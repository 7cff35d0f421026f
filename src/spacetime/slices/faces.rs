//! Faces of cells from sets of vertices (thesis 3.6.4).

use spmesh_stream::model::cells4::Cells4;

/// A face of a cell, or a cell, with its faces of one dimension less. All lists of vertices are increasing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Faces {
    /// Dimension of the face: 4 for a cell.
    pub dimension: usize,
    /// Its vertices.
    pub vertices: Vec<u32>,
    /// Vertices of each face of one dimension less. May be empty for a simplex.
    pub lower: Vec<Vec<u32>>,
}

impl Faces {
    /// A finite cell with its facets, in the order of its neighbours.
    ///
    /// Cost: proportional to the vertices of the cell and of its neighbours.
    pub fn of_cell(cells: &Cells4, number: usize) -> Faces {
        let cell = cells.get(number);
        let facet = |&beyond: &u32| {
            // An infinite neighbour has just the vertices of the facet; a finite one shares them with this
            // cell.
            let other = cells.get(beyond as usize);
            if other.is_infinite { other.vertices.to_vec() } else { common(cell.vertices, other.vertices) }
        };
        Faces {
            dimension: 4,
            vertices: cell.vertices.to_vec(),
            lower: cell.neighbours.iter().map(facet).collect(),
        }
    }

    /// Whether the face is a simplex.
    pub fn is_simplex(&self) -> bool {
        self.vertices.len() == self.dimension + 1
    }

    /// A face of one dimension less with its own faces, which it shares with its siblings.
    ///
    /// Two faces of dimension d share a face of dimension d - 1 or less. All vertices are on a sphere, so no
    /// three are on a line (thesis, lemma 3.6.2). So d shared vertices imply dimension d - 1, for d up to 3.
    pub fn face(&self, number: usize) -> Faces {
        let (dimension, vertices) = (self.dimension - 1, self.lower[number].clone());
        let mut lower = Vec::new();
        if vertices.len() > dimension + 1 {
            let siblings = self.lower.iter().enumerate().filter(|&(other, _)| other != number);
            let shared = siblings.map(|(_, sibling)| common(&vertices, sibling));
            lower = shared.filter(|shared| shared.len() >= dimension).collect();
        }
        Faces { dimension, vertices, lower }
    }

    /// Four vertices of a facet of a cell that span its hyperplane, and a vertex of the cell that is not in
    /// it.
    pub(super) fn frame(&self, number: usize) -> Option<([u32; 4], u32)> {
        let facet = &self.lower[number];
        let apex = *self.vertices.iter().find(|vertex| facet.binary_search(vertex).is_err())?;
        if let Ok(four) = <[u32; 4]>::try_from(&facet[..]) {
            return Some((four, apex));
        }
        let siblings = self.lower.iter().enumerate().filter(|&(other, _)| other != number);
        let ridge = siblings.map(|(_, sibling)| common(facet, sibling)).find(|shared| shared.len() >= 3)?;
        let fourth = *facet.iter().find(|vertex| ridge.binary_search(vertex).is_err())?;
        Some(([ridge[0], ridge[1], ridge[2], fourth], apex))
    }
}

/// The common numbers of two increasing lists.
fn common(one: &[u32], other: &[u32]) -> Vec<u32> {
    let mut rest = other;
    let is_shared = |vertex: &&u32| {
        while rest.first().is_some_and(|first| first < vertex) {
            rest = &rest[1..];
        }
        rest.first() == Some(*vertex)
    };
    one.iter().filter(is_shared).copied().collect()
}
