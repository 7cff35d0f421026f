//! The border of the red cells: its facets, and the ridges between them.

use foldhash::HashMap;

/// A facet between a red cell and a green or blue one.
#[derive(Debug)]
pub(super) struct Facet {
    pub(super) red: u32,
    /// Its vertices, increasing.
    pub(super) vertices: Vec<u32>,
    /// The cell that holds it when the point is inserted.
    pub(super) cell: u32,
}

/// Least number of vertices of a ridge: three or more points of a face, being cospherical, span two
/// dimensions (thesis, lemma 3.6.2). The faraway point is one like others here.
const RIDGE_MIN: usize = 3;

/// Numbers that two increasing lists have in common.
pub(super) fn in_common(a: &[u32], b: &[u32]) -> Vec<u32> {
    a.iter().copied().filter(|number| b.binary_search(number).is_ok()).collect()
}

/// Pairs of cells on both sides of a ridge of the horizon.
///
/// `around` gives the vertices of the neighbours of a red cell.
pub(super) fn neighbours<'a, I: Iterator<Item = &'a [u32]>>(
    facets: &[Facet],
    around: impl Fn(u32) -> I,
) -> Vec<[u32; 2]> {
    let mut open: HashMap<Vec<u32>, u32> = HashMap::default();
    let mut pairs = Vec::new();
    for facet in facets {
        for vertices in around(facet.red) {
            let ridge = in_common(&facet.vertices, vertices);
            // The neighbour across the facet itself has all of it.
            if ridge.len() < RIDGE_MIN || ridge.len() == facet.vertices.len() {
                continue;
            }
            match open.remove(&ridge) {
                None => {
                    open.insert(ridge, facet.cell);
                }
                Some(other) if other != facet.cell => pairs.push([other, facet.cell]),
                Some(_) => {}
            }
        }
    }
    debug_assert!(open.is_empty(), "each ridge of the horizon is between two facets");
    pairs
}
