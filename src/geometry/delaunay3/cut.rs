//! The complex cut into parts, each a range of vertices along the curve: see [`super::parts`].

use super::complex::{Complex, DELETED, Facet};
use super::slots::Slots;
use super::tetrahedralization::{NONE, Tetrahedron, Vertex, WORDS};
use foldhash::{HashMap, HashMapExt};
use std::ops::Range;

/// Greatest number of parts.
pub(super) const PARTS_MAX: usize = 1024;

/// The part of a frozen tetrahedron, and that of a deleted one.
const FROZEN: u16 = u16::MAX;
const GONE: u16 = FROZEN - 1;

/// Parts are cut at borders of bins of vertices, at most 2^16.
const BITS_OF_BINS: u32 = 16;

/// A cut may be off the even one by one of so many vertices of a part.
const SLACK: usize = 16;

/// A complex cut into parts.
pub(super) struct Cut<'c> {
    tetrahedra: &'c [Tetrahedron],
    vertices: &'c [Vertex],
    /// The first vertex of each part but the first; behind them the vertex at infinity.
    ends: Vec<u32>,
    places: Vec<Place>,
    /// Number of tetrahedra of each part.
    pub(super) sizes: Vec<usize>,
    /// Number of frozen tetrahedra.
    pub(super) frozen: usize,
}

/// The part of a tetrahedron, and its number there.
#[derive(Debug, Clone, Copy)]
struct Place {
    part: u16,
    number: u32,
}

impl<'c> Cut<'c> {
    /// Cuts a complex of these tetrahedra and vertices, that at infinity last.
    pub(super) fn new(tetrahedra: &'c [Tetrahedron], vertices: &'c [Vertex], parts: usize) -> Cut<'c> {
        let ends = ends(tetrahedra, vertices.len() - 1, parts);
        let mut sizes = vec![0; ends.len()];
        let mut frozen = 0;
        let place = |tetrahedron: &Tetrahedron| {
            let part = part_of_tetrahedron(tetrahedron, &ends);
            let count = match part {
                GONE => return Place { part, number: NONE },
                FROZEN => &mut frozen,
                _ => &mut sizes[usize::from(part)],
            };
            *count += 1;
            Place { part, number: *count as u32 - 1 }
        };
        let places = tetrahedra.iter().map(place).collect();
        Cut { tetrahedra, vertices, ends, places, sizes, frozen }
    }

    /// Number of parts.
    pub(super) fn parts(&self) -> usize {
        self.ends.len()
    }

    /// The vertex at infinity.
    pub(super) fn infinite(&self) -> u32 {
        self.vertices.len() as u32 - 1
    }

    /// The part of a finite vertex.
    pub(super) fn part_of(&self, vertex: u32) -> u16 {
        part_of_vertex(vertex, &self.ends)
    }

    /// The vertices of a part.
    pub(super) fn vertices_of(&self, part: u16) -> Range<u32> {
        let part = usize::from(part);
        let start = part.checked_sub(1).map_or(0, |before| self.ends[before]);
        start..self.ends[part]
    }

    /// The part as a complex of its own: first copies of the frozen tetrahedra next to it, whose numbers are
    /// returned, then its own ones. Copies have neighbours in the part only; elsewhere the word is arbitrary.
    pub(super) fn copy<'s>(&self, part: u16, mut room: Slots<'s>) -> (Complex<'s>, Vec<u32>) {
        let of_part = || self.tetrahedra.iter().zip(&self.places).filter(|(_, place)| place.part == part);
        let mut slots = vec![NONE; self.frozen];
        let mut rim = Vec::new();
        for facet in of_part().flat_map(|(tetrahedron, _)| tetrahedron.neighbours) {
            let place = self.place(facet);
            if place.part == FROZEN && slots[place.number as usize] == NONE {
                slots[place.number as usize] = rim.len() as u32;
                rim.push(facet / WORDS as u32);
            }
        }
        let own = self.vertices_of(part);
        let mut vertices = self.vertices[own.start as usize..own.end as usize].to_vec();
        let numbers = self.add_foreign(&rim, &own, &mut vertices);
        let infinite = vertices.len() as u32;
        vertices.push(Vertex::default());
        let vertex = |v: u32| match v {
            _ if own.contains(&v) => v - own.start,
            _ if v == self.infinite() => infinite,
            _ => numbers[&v],
        };
        let neighbour = |facet: Facet| match self.place(facet) {
            Place { part: of, number } if of == part => word(rim.len() as u32 + number, facet),
            Place { part: FROZEN, number } if slots[number as usize] != NONE => {
                word(slots[number as usize], facet)
            }
            _ => 0,
        };
        let all = rim.iter().map(|&t| &self.tetrahedra[t as usize]).chain(of_part().map(|(t, _)| t));
        for &Tetrahedron { vertices, neighbours } in all {
            room.push(Tetrahedron { vertices: vertices.map(vertex), neighbours: neighbours.map(neighbour) });
        }
        let frozen = word(rim.len() as u32, 0);
        let numbers = rim.iter().map(|&t| self.places[t as usize].number).collect();
        (Complex { vertices, tetrahedra: room, free: Vec::new(), frozen }, numbers)
    }

    /// Adds the vertices of other parts that tetrahedra have; returns their numbers.
    fn add_foreign(&self, rim: &[u32], own: &Range<u32>, vertices: &mut Vec<Vertex>) -> HashMap<u32, u32> {
        let mut numbers = HashMap::new();
        for v in rim.iter().flat_map(|&t| self.tetrahedra[t as usize].vertices) {
            if !own.contains(&v) && v != self.infinite() {
                numbers.entry(v).or_insert_with(|| {
                    vertices.push(self.vertices[v as usize]);
                    vertices.len() as u32 - 1
                });
            }
        }
        numbers
    }

    /// The frozen tetrahedra, in the order of their numbers.
    pub(super) fn frozen_tetrahedra(&self) -> Frozen {
        let frozen = self.tetrahedra.iter().zip(&self.places).filter(|(_, place)| place.part == FROZEN);
        let copy = |(&Tetrahedron { vertices, neighbours }, _)| {
            let places = neighbours.map(|facet| self.place(facet));
            let neighbours = [0, 1, 2, 3].map(|side| word(places[side].number, neighbours[side]));
            (Tetrahedron { vertices, neighbours }, places.map(|place| place.part))
        };
        Frozen(frozen.map(copy).collect())
    }

    fn place(&self, facet: Facet) -> Place {
        self.places[facet as usize / WORDS]
    }
}

/// The frozen tetrahedra, and the parts of their neighbours. They know as neighbours only each other.
pub(super) struct Frozen(Vec<(Tetrahedron, [u16; 4])>);

impl Frozen {
    /// Writes the tetrahedra. Each part tells, by their numbers, which of its facets are next to them.
    pub(super) fn write<'r>(
        self,
        room: &mut Slots<'_>,
        rims: impl Iterator<Item = (u16, &'r [(u32, [Facet; 4])])>,
    ) {
        self.0.iter().for_each(|&(tetrahedron, _)| room.push(tetrahedron));
        for (part, rim) in rims {
            for &(number, neighbours) in rim {
                let parts = self.0[number as usize].1;
                for side in (0..4).filter(|&side| parts[side] == part) {
                    room[number as usize].neighbours[side] = neighbours[side];
                }
            }
        }
    }
}

/// The same facet of the tetrahedron with another number.
fn word(number: u32, facet: Facet) -> Facet {
    number.wrapping_mul(WORDS as u32) | facet & 3
}

fn part_of_vertex(vertex: u32, ends: &[u32]) -> u16 {
    ends.partition_point(|&end| end <= vertex) as u16
}

/// The part that all finite vertices belong to. Behind the last part there is only the vertex at infinity.
fn part_of_tetrahedron(tetrahedron: &Tetrahedron, ends: &[u32]) -> u16 {
    if tetrahedron.vertices[0] >= DELETED {
        return GONE;
    }
    let (least, greatest) = range(tetrahedron, ends[ends.len() - 1]);
    let part = part_of_vertex(least, ends);
    if greatest < ends[usize::from(part)] { part } else { FROZEN }
}

/// The least and the greatest finite vertex.
fn range(tetrahedron: &Tetrahedron, infinite: u32) -> (u32, u32) {
    let [a, b, c, d] = tetrahedron.vertices;
    let finite = tetrahedron.vertices.map(|v| if v == infinite { 0 } else { v });
    (a.min(b).min(c.min(d)), finite.into_iter().fold(0, u32::max))
}

/// Where to cut `count` vertices into parts of almost the same size: where the fewest tetrahedra are cut.
fn ends(tetrahedra: &[Tetrahedron], count: usize, parts: usize) -> Vec<u32> {
    let shift = (usize::BITS - count.leading_zeros()).saturating_sub(BITS_OF_BINS);
    // Before each bin, how many more tetrahedra are cut than before the last one.
    let mut cuts = vec![0i64; (count >> shift) + 2];
    for tetrahedron in tetrahedra.iter().filter(|tetrahedron| tetrahedron.vertices[0] < DELETED) {
        let (least, greatest) = range(tetrahedron, count as u32);
        cuts[(least >> shift) as usize + 1] += 1;
        cuts[(greatest >> shift) as usize + 1] -= 1;
    }
    let mut sum = 0;
    for cut in &mut cuts {
        sum += *cut;
        *cut = sum;
    }
    let slack = count / parts / SLACK;
    let mut ends: Vec<u32> = (1..parts)
        .map(|part| {
            let even = (count as u64 * part as u64 / parts as u64) as usize;
            let bins = (even - slack) >> shift..=(even + slack) >> shift;
            let best = bins.min_by_key(|&bin| cuts[bin]).unwrap_or(even >> shift);
            (best << shift) as u32
        })
        .collect();
    ends.push(count as u32);
    ends
}
