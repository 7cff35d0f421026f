//! Walls: facets between closed cells and open ones.

use crate::diagram4::side::orient4d;
use crate::diagram4::simplices::spanning;
use crate::diagram4::sites::Sites;
use foldhash::{HashMap, HashMapExt};
use spmesh_delaunay::predicates::Sign;
use spmesh_stream::model::cells4::Lists4;

/// Facets by their vertices.
pub(super) struct Walls {
    /// The vertices of each wall, in increasing order.
    vertices: Lists4,
    owners: Vec<Owner>,
}

/// The closed cell at a wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Owner {
    pub(super) number: u32,
    /// Its first vertex.
    pub(super) first: u32,
    /// On which side of the wall it is: see [`side`].
    pub(super) side: Sign,
}

impl Default for Walls {
    fn default() -> Walls {
        Walls { vertices: Lists4::with_capacity(0, 0), owners: Vec::new() }
    }
}

impl Walls {
    pub(super) fn push(&mut self, facet: &[u32], owner: Owner) {
        facet.iter().for_each(|&vertex| self.vertices.extend([vertex]));
        self.vertices.end();
        self.owners.push(owner);
    }

    pub(super) fn len(&self) -> usize {
        self.owners.len()
    }

    pub(super) fn owner(&self, wall: usize) -> Owner {
        self.owners[wall]
    }

    pub(super) fn facet(&self, wall: usize) -> &[u32] {
        self.vertices.get(wall)
    }
}

/// Finds walls by their vertices.
pub(super) struct WallIndex<'a> {
    numbers: HashMap<&'a [u32], u32>,
    /// A bit for each site: whether it is a vertex of a wall.
    marks: Vec<u64>,
}

impl<'a> WallIndex<'a> {
    pub(super) fn of(walls: &'a Walls, sites: usize) -> WallIndex<'a> {
        let mut index =
            WallIndex { numbers: HashMap::with_capacity(walls.len()), marks: vec![0; sites / 64 + 1] };
        for wall in 0..walls.len() {
            let facet = walls.facet(wall);
            facet.iter().for_each(|&vertex| index.marks[vertex as usize / 64] |= 1 << (vertex % 64));
            index.numbers.insert(facet, wall as u32);
        }
        index
    }

    /// Whether a cell has as many vertices of walls as it needs if one of its facets is a wall.
    #[inline(always)]
    pub(super) fn may_have(&self, vertices: &[u32]) -> bool {
        let mark = |vertex: u32| self.marks[vertex as usize / 64] >> (vertex % 64) & 1;
        vertices.iter().map(|&vertex| mark(vertex)).sum::<u64>() >= 4
    }

    /// The wall with these vertices.
    #[inline(always)]
    pub(super) fn find(&self, facet: &[u32]) -> Option<usize> {
        self.numbers.get(facet).map(|&wall| wall as usize)
    }
}

/// The side of its facet on which a finite cell is. Which side is positive depends on the vertices of the
/// facet alone.
pub(super) fn side(sites: &Sites, facet: &[u32], cell: &[u32]) -> Sign {
    let point = |vertex: u32| sites.points[vertex as usize];
    let apex = cell.iter().find(|vertex| facet.binary_search(vertex).is_err());
    let apex = point(*apex.expect("a cell has vertices beside those of a facet"));
    let places =
        if facet.len() == 4 { vec![0, 1, 2, 3] } else { spanning(facet.iter().map(|&v| point(v)), 3) };
    let [a, b, c, d] = places[..] else { unreachable!("a facet spans three dimensions") };
    orient4d([point(facet[a]), point(facet[b]), point(facet[c]), point(facet[d]), apex])
}

/// Puts the common vertices of two cells into `common`, in increasing order.
#[inline(always)]
pub(super) fn intersect(a: &[u32], b: &[u32], common: &mut Vec<u32>) {
    common.clear();
    let mut rest = b;
    for &vertex in a {
        while let [first, others @ ..] = rest
            && *first < vertex
        {
            rest = others;
        }
        if rest.first() == Some(&vertex) {
            common.push(vertex);
        }
    }
}
