//! Cuts lines at the border of polygons.

use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_base::limits::LINE_VERTEX_BYTES;
use spmesh_delaunay::cell_tree::{CellTree, Fineness, Item};
use spmesh_delaunay::predicates::Point2;
use spmesh_formats::source::Mask;
use spmesh_pipeline::polygons::{Polygons, Side};

/// A cell for each edge, about.
const FINENESS: Fineness = Fineness {
    items_per_cell: 1.0,
    cells: [1.0, 4_194_304.0],
    entries: [8, 1 << 10],
    crowd: 16,
    reach: 0.0,
    is_whole: false,
};

/// Bytes of an edge, and of its entries in cells.
const EDGE_BYTES: u64 = 60;

/// Crossings this near to the end of a segment count as being there. Units: lengths of the segment.
const NEAR: f64 = 1e-9;

/// Polygons, and their edges by cells. Coordinates are those of the world.
///
/// Memory: that of [`Polygons`], and some 60 bytes for each edge.
#[derive(Debug)]
pub(super) struct Clipper {
    edges: Vec<[Point2; 2]>,
    cells: CellTree,
    polygons: Polygons,
}

impl Clipper {
    /// Checks that a mask fits `memory`, in bytes.
    ///
    /// # Errors
    /// [`ErrorKind::Memory`], if it does not.
    pub(super) fn check(mask: &Mask, memory: u64) -> Result<()> {
        let edges = mask.edges().count();
        let bytes =
            (LINE_VERTEX_BYTES + EDGE_BYTES) * edges as u64 + Polygons::bytes(edges, mask.polygons.len());
        if bytes <= memory {
            return Ok(());
        }
        let (needed, left) = (bytes.div_ceil(1 << 20), memory >> 20);
        let message = format!("{edges} edges of polygons take {needed} MiB, and --memory leaves {left}");
        Err(Error::new(ErrorKind::Memory, format!("{message}: raise it, or give simpler polygons")))
    }

    pub(super) fn new(mask: &Mask) -> Clipper {
        let of_polygons: Vec<(u32, [Point2; 2])> = mask.edges().filter(|(_, [p, q])| p != q).collect();
        let edges: Vec<[Point2; 2]> = of_polygons.iter().map(|(_, edge)| *edge).collect();
        let polygons = Polygons::of_edges(of_polygons.into_iter());
        let item = |edge: u32| Item::Segment(edges[edge as usize]);
        let cells = CellTree::new(edges.len() as u32, item, &FINENESS);
        Clipper { edges, cells, polygons }
    }

    /// What it takes in memory with its mask.
    pub(super) fn bytes(&self) -> u64 {
        (LINE_VERTEX_BYTES + EDGE_BYTES) * self.edges.len() as u64 + self.polygons.size().1
    }

    /// The parts of a line inside of the polygons, and whether they are closed. A ring does not repeat its first
    /// point.
    pub(super) fn clip(&self, points: &[Point2], is_closed: bool) -> Vec<(Vec<Point2>, bool)> {
        let count = if is_closed { points.len() } else { points.len() - 1 };
        let mut parts: Vec<Vec<Point2>> = Vec::new();
        // Whether the end of the last segment is inside, if that is certain.
        let (mut state, mut is_open, mut is_cut, mut starts_inside) = (None, false, false, false);
        for i in 0..count {
            let segment = [points[i], points[(i + 1) % points.len()]];
            let hits = self.hits(segment);
            let mut shares = vec![0.0];
            shares.extend(hits.iter().copied().filter(|hit| (NEAR..1.0 - NEAR).contains(hit)));
            shares.push(1.0);
            for ends in shares.windows(2) {
                let is_inside = match state {
                    Some(is_inside) if hits.is_empty() => is_inside,
                    _ => self.contains(at(segment, 0.5 * (ends[0] + ends[1]))),
                };
                state = Some(is_inside);
                is_cut |= !is_inside;
                starts_inside |= is_inside && i == 0 && ends[0] == 0.0;
                match parts.last_mut().filter(|_| is_open && is_inside) {
                    // The place of a mere touch is no point of the line.
                    Some(part) if ends[0] > 0.0 => {
                        part.pop();
                        part.push(at(segment, ends[1]));
                    }
                    Some(part) => part.push(at(segment, ends[1])),
                    None if is_inside => parts.push(ends.iter().map(|&share| at(segment, share)).collect()),
                    None => {}
                }
                is_open = is_inside;
            }
            state = state.filter(|_| hits.last().is_none_or(|&hit| hit < 1.0 - NEAR));
        }
        if is_closed && !is_cut {
            return vec![(points.to_vec(), true)];
        }
        if is_closed && is_open && starts_inside && parts.len() > 1 {
            // The last part leads to the start of the first one.
            let first = parts.swap_remove(0);
            if let Some(last) = parts.first_mut() {
                last.extend(first.into_iter().skip(1));
            }
        }
        parts.into_iter().map(|part| (part, false)).collect()
    }

    /// Whether a place is in a polygon, or on the border of one.
    fn contains(&self, place: Point2) -> bool {
        self.polygons.side(place) != Side::Outside
    }

    /// Where a segment meets edges, in increasing order, as shares of its length.
    fn hits(&self, segment: [Point2; 2]) -> Vec<f64> {
        let [a, b] = segment;
        let mut hits = Vec::new();
        let is_apart = |[p, q]: [Point2; 2]| {
            (0..2).any(|axis| {
                p[axis].max(q[axis]) < a[axis].min(b[axis]) || p[axis].min(q[axis]) > a[axis].max(b[axis])
            })
        };
        // Some edges are met several times.
        let reach = 2.0 * NEAR * (b[0] - a[0]).abs().max((b[1] - a[1]).abs());
        self.cells.for_each_beside(segment, reach, &mut |numbers| {
            let edges = numbers.iter().map(|&number| self.edges[number as usize]);
            for edge in edges.filter(|edge| !is_apart(*edge)) {
                let [p, q] = edge;
                let side = |[from, to]: [Point2; 2], at: Point2| {
                    (to[0] - from[0]) * (at[1] - from[1]) - (to[1] - from[1]) * (at[0] - from[0])
                };
                let [from, to] = [side(edge, a), side(edge, b)];
                if from == to {
                    // Along the edge, or parallel to it.
                    if from == 0.0 {
                        hits.extend([p, q].map(|end| share(segment, end)));
                    }
                } else if side(segment, p).signum() * side(segment, q).signum() <= 0.0
                    || side(segment, p) == 0.0
                    || side(segment, q) == 0.0
                {
                    hits.push(from / (from - to));
                }
            }
        });
        hits.retain(|hit| (-NEAR..=1.0 + NEAR).contains(hit));
        hits.sort_unstable_by(f64::total_cmp);
        hits.dedup_by(|hit, last| *hit - *last <= NEAR);
        hits
    }
}

/// The place at a share of a segment; its ends are exact.
fn at([from, to]: [Point2; 2], share: f64) -> Point2 {
    if share == 1.0 { to } else { [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis])) }
}

/// The share of a segment at which a place on it lies.
fn share([from, to]: [Point2; 2], place: Point2) -> f64 {
    let along = [to[0] - from[0], to[1] - from[1]];
    let way = [place[0] - from[0], place[1] - from[1]];
    (way[0] * along[0] + way[1] * along[1]) / (along[0] * along[0] + along[1] * along[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(min: f64, max: f64) -> Vec<Point2> {
        vec![[min, min], [max, min], [max, max], [min, max]]
    }

    fn clip(polygons: Vec<Vec<Vec<Point2>>>, points: &[Point2], is_closed: bool) -> Vec<(Vec<Point2>, bool)> {
        let mut parts = Clipper::new(&Mask { polygons }).clip(points, is_closed);
        parts.sort_by(|a, b| a.partial_cmp(b).unwrap());
        parts
    }

    #[test]
    fn lines_end_at_borders_and_holes() {
        let with_hole = vec![vec![square(0.0, 10.0), square(4.0, 6.0)]];
        let line = [[-2.0, 5.0], [1.0, 5.0], [12.0, 5.0]];
        let expected =
            vec![(vec![[0.0, 5.0], [1.0, 5.0], [4.0, 5.0]], false), (vec![[6.0, 5.0], [10.0, 5.0]], false)];
        assert_eq!(clip(with_hole.clone(), &line, false), expected);
        assert_eq!(clip(with_hole.clone(), &square(1.0, 2.0), true), [(square(1.0, 2.0), true)]);
        assert_eq!(clip(with_hole.clone(), &square(11.0, 12.0), true), []);
        // Around the corner of the polygon, so that the start of the ring is inside.
        let ring = clip(with_hole, &[[9.0, 9.0], [11.0, 9.0], [11.0, 11.0], [9.0, 11.0]], true);
        assert_eq!(ring, [(vec![[9.0, 10.0], [9.0, 9.0], [10.0, 9.0]], false)]);
    }

    #[test]
    fn common_borders_do_not_cut() {
        let pair = vec![vec![square(0.0, 5.0)], vec![vec![[5.0, 0.0], [9.0, 0.0], [9.0, 5.0], [5.0, 5.0]]]];
        assert_eq!(
            clip(pair.clone(), &[[1.0, 1.0], [8.0, 2.0]], false),
            [(vec![[1.0, 1.0], [8.0, 2.0]], false)]
        );
        // Along a border, and through a vertex.
        assert_eq!(
            clip(pair.clone(), &[[0.0, 0.0], [9.0, 0.0]], false),
            [(vec![[0.0, 0.0], [9.0, 0.0]], false)]
        );
        assert_eq!(clip(pair, &[[-1.0, -1.0], [1.0, 1.0]], false), [(vec![[0.0, 0.0], [1.0, 1.0]], false)]);
    }
}
