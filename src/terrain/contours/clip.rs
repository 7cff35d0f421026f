//! Cuts lines at the border of polygons.

use spmesh_delaunay::predicates::{FiniteFloatPredicates, Point2, Predicates2, Sign};
use spmesh_formats::source::Mask;

/// Mean number of entries of an edge in slabs.
const ENTRIES: usize = 4;
/// Crossings this near to the end of a segment count as being there. Units: lengths of the segment.
const NEAR: f64 = 1e-9;

/// Polygons, and an index of their edges by ordinates. Coordinates are those of the world.
///
/// Memory: some 60 bytes for each edge.
#[derive(Debug)]
pub(super) struct Clipper {
    /// Edges with the numbers of their polygons; those of one polygon in a row.
    edges: Vec<(u32, [Point2; 2])>,
    /// The edges that meet each slab between two ordinates; slabs have one height.
    slabs: Vec<Vec<u32>>,
    bottom: f64,
    height: f64,
}

impl Clipper {
    pub(super) fn new(mask: &Mask) -> Clipper {
        let edges: Vec<(u32, [Point2; 2])> = mask.edges().filter(|(_, [p, q])| p != q).collect();
        let ordinates = || edges.iter().map(|(_, [p, _])| p[1]);
        let [bottom, top] =
            [ordinates().fold(f64::INFINITY, f64::min), ordinates().fold(f64::NEG_INFINITY, f64::max)];
        let mut clipper = Clipper { edges, slabs: Vec::new(), bottom, height: f64::INFINITY };
        let mut count = clipper.edges.len().max(1);
        // Fewer slabs, until edges do not meet too many of them.
        loop {
            clipper.height = (top - bottom) / count as f64;
            let entries = |edge: &(u32, [Point2; 2])| clipper.slabs_of(edge.1, count).count();
            if count == 1 || clipper.edges.iter().map(entries).sum::<usize>() <= ENTRIES * clipper.edges.len()
            {
                break;
            }
            count /= 2;
        }
        let mut slabs = vec![Vec::new(); count];
        for (number, (_, edge)) in (0..).zip(&clipper.edges) {
            clipper.slabs_of(*edge, count).for_each(|slab| slabs[slab].push(number));
        }
        Clipper { slabs, ..clipper }
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
        let mut predicates = FiniteFloatPredicates::default();
        let polygon_of = |number: &u32| self.edges[*number as usize].0;
        let Some(slab) = self.slab(place[1]) else { return false };
        self.slabs[slab].chunk_by(|a, b| polygon_of(a) == polygon_of(b)).any(|edges| {
            let mut is_inside = false;
            for &number in edges {
                let [p, q] = self.edges[number as usize].1;
                let [low, high] = if p[1] <= q[1] { [p, q] } else { [q, p] };
                if !(low[1]..=high[1]).contains(&place[1]) {
                    continue;
                }
                match predicates.orient2d(low, high, place) {
                    Sign::Zero if (low[0].min(high[0])..=low[0].max(high[0])).contains(&place[0]) => {
                        return true;
                    }
                    Sign::Positive if place[1] < high[1] => is_inside = !is_inside,
                    _ => {}
                }
            }
            is_inside
        })
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
        for slab in self.slabs_of(segment, self.slabs.len()) {
            let edges = self.slabs[slab].iter().map(|&number| self.edges[number as usize].1);
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
        }
        hits.retain(|hit| (-NEAR..=1.0 + NEAR).contains(hit));
        hits.sort_unstable_by(f64::total_cmp);
        hits.dedup_by(|hit, last| *hit - *last <= NEAR);
        hits
    }

    /// The slab of an ordinate, unless no polygon reaches it.
    fn slab(&self, y: f64) -> Option<usize> {
        let slab = (y - self.bottom) / self.height;
        let count = self.slabs.len();
        // The top belongs to the last slab; all edges may be level.
        (slab >= 0.0 && slab <= count as f64 * (1.0 + f64::EPSILON)).then(|| (slab as usize).min(count - 1))
    }

    /// The slabs that a segment meets, of `count` slabs.
    fn slabs_of(&self, [p, q]: [Point2; 2], count: usize) -> impl Iterator<Item = usize> + use<> {
        let slab = |y: f64| (y - self.bottom) / self.height;
        let (low, high) = (slab(p[1].min(q[1])), slab(p[1].max(q[1])));
        // Conversion saturates.
        let range = (low as usize).min(count - 1)..=(high as usize).min(count - 1);
        range.filter(move |_| high >= 0.0 && low <= count as f64 * (1.0 + f64::EPSILON))
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
