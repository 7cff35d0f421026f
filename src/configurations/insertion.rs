//! Large links: vertices inserted in random order (Chew, "Building Voronoi diagrams for convex polygons in
//! linear expected time", 1990; Aggarwal, Guibas, Saxe and Shor, 1989, do the same for one cell of a
//! higher-order Voronoi diagram).
//!
//! Consider the planes that have the lifted knots of J on or below them, and the lifted vertices of the link
//! of J on or above them. In dual space they form a convex cell, with facets for knots of J and for vertices.
//! The corners of the cell where the facets of three vertices meet are the triangles of the link. The facet
//! of each vertex borders on facets of J in one stretch: these are its sides that are visible from the plane
//! which touches the lift at the vertex. All this holds for any subset of the vertices, too. So the vertices
//! of a subset form a polygon in the same cyclic order. The facet of one further vertex cuts off a tree of
//! triangles, which starts at the edge between the neighbours of the vertex. The neighbours are known:
//! vertices are removed from the polygon in random order, and inserted in reverse order.
//!
//! Triangles of a subset of the vertices may be clockwise or flat, because J need not lie within the subset.
//! Then their planes stand for the outside of a circle, or for a half-plane;
//! [`super::plane::Plane::is_beyond`] handles both. No lift decides whether a vertex is in conflict with
//! three others on its line. It counts as not in conflict, as if it were moved by less than all vertices
//! before it; the final triangulation has no such triangles.

use super::polygon::Triangulator;
use super::surface::Corner;
use spmesh_base::error::Result;
use spmesh_base::random::Random;
use spmesh_delaunay::predicates::Predicates2;

/// Links of at least this many vertices are triangulated by insertion; for smaller ones a search is faster.
pub(super) const LARGE: usize = 24;

/// The neighbour across the border of the polygon: no triangle.
const OUTSIDE: Corner = Corner::MAX;

/// The triangulation of a polygon into which vertices are inserted; vertices are numbered by place in the
/// whole polygon.
struct Ears {
    triangles: Vec<[u32; 3]>,
    /// For each half-edge, the opposite half-edge, or [`OUTSIDE`].
    neighbours: Vec<[Corner; 3]>,
    /// For each vertex, the half-edge to the next vertex of the polygon.
    edge_after: Vec<Corner>,
    /// A stack of edges to look across, with the cavity to the left.
    waiting: Vec<(u32, u32, Corner)>,
    /// Numbers of triangles that can be reused.
    free: Vec<u32>,
}

impl<P: Predicates2> Triangulator<'_, P> {
    /// Triangulates a polygon of at least three vertices, of which all triangles are those of the lift.
    ///
    /// Cost: O(m) predicates expected for m vertices.
    pub(super) fn insert_vertices(&mut self) -> Result<()> {
        let count = self.polygon.len();
        let mut order: Vec<u32> = (0..count as u32).collect();
        Random::new(count as u64).shuffle(&mut order);
        order[..3].sort_unstable();
        let neighbours = neighbours(&order);
        let mut ears = Ears::of_triangle([order[0], order[1], order[2]], count);
        for &place in &order[3..] {
            ears.insert(place, neighbours[place as usize], |triangle, place| {
                let knot = |place: u32| self.polygon[place as usize];
                let (triangle, place) = (triangle.map(knot), knot(place));
                self.plane.is_beyond(triangle, place)
            });
        }
        ears.triangles.iter().try_for_each(|triangle| {
            let [i, j, k] = triangle.map(|place| place as usize);
            self.emit(i, j, k)
        })
    }
}

/// For each place, its neighbours in the polygon of the places before it in `order`.
fn neighbours(order: &[u32]) -> Vec<[u32; 2]> {
    let count = order.len() as u32;
    let mut neighbours: Vec<[u32; 2]> =
        (0..count).map(|place| [(place + count - 1) % count, (place + 1) % count]).collect();
    for &place in order[3..].iter().rev() {
        let [before, after] = neighbours[place as usize];
        neighbours[before as usize][1] = after;
        neighbours[after as usize][0] = before;
    }
    neighbours
}

impl Ears {
    /// The first triangle, with capacity for `count` vertices.
    fn of_triangle(triangle: [u32; 3], count: usize) -> Ears {
        let mut edge_after = vec![OUTSIDE; count];
        for (i, place) in (0..3).zip(triangle) {
            edge_after[place as usize] = (i + 2) % 3;
        }
        let (triangles, neighbours) = (vec![triangle], vec![[OUTSIDE; 3]]);
        Ears { triangles, neighbours, edge_after, waiting: Vec::new(), free: Vec::new() }
    }

    /// Inserts a vertex between its neighbours: a star around it replaces the triangles in conflict. These
    /// form a tree, so none is visited twice.
    fn insert(
        &mut self,
        place: u32,
        [before, after]: [u32; 2],
        mut is_in_conflict: impl FnMut([u32; 3], u32) -> bool,
    ) {
        self.waiting.push((after, before, self.edge_after[before as usize]));
        let mut last = OUTSIDE;
        while let Some((from, to, neighbour)) = self.waiting.pop() {
            let (t, i) = (neighbour as usize / 3, neighbour as usize % 3);
            if neighbour != OUTSIDE && is_in_conflict(self.triangles[t], place) {
                let tip = self.triangles[t][i];
                self.waiting.push((tip, to, self.neighbours[t][(i + 2) % 3]));
                self.waiting.push((from, tip, self.neighbours[t][(i + 1) % 3]));
                self.free.push(t as u32);
                continue;
            }
            let fresh = self.put([place, from, to]);
            self.join(3 * fresh, neighbour, from);
            self.join(3 * fresh + 2, last, place);
            last = 3 * fresh + 1;
        }
        self.edge_after[before as usize] = last;
    }

    /// Stores a triangle, under a reused number if there is one.
    fn put(&mut self, triangle: [u32; 3]) -> u32 {
        if let Some(free) = self.free.pop() {
            self.triangles[free as usize] = triangle;
            self.neighbours[free as usize] = [OUTSIDE; 3];
            return free;
        }
        self.triangles.push(triangle);
        self.neighbours.push([OUTSIDE; 3]);
        self.triangles.len() as u32 - 1
    }

    /// Makes two half-edges opposite to each other. At the border, makes the first one the edge of the
    /// polygon after `from`.
    fn join(&mut self, here: Corner, there: Corner, from: u32) {
        if there == OUTSIDE {
            self.edge_after[from as usize] = here;
            return;
        }
        self.neighbours[here as usize / 3][here as usize % 3] = there;
        self.neighbours[there as usize / 3][there as usize % 3] = here;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gathering::for_each_link;
    use crate::knots::Knots;
    use crate::rule::Rule;
    use crate::special::Diagonals;
    use crate::{Lift, Start, generate};
    use spmesh_delaunay::predicates::FiniteFloatPredicates;
    use spmesh_stream::model::configurations::FARAWAY;
    use spmesh_stream::model::configurations::{Claim, Configurations};

    /// The triangles that one of the two methods yields, in a canonical order.
    fn sorted(out: &[[u32; 3]]) -> Vec<[u32; 3]> {
        let mut all = out.to_vec();
        for triangle in &mut all {
            let least = (0..3).min_by_key(|&i| triangle[i]).unwrap_or(0);
            triangle.rotate_left(least);
        }
        all.sort_unstable();
        all
    }

    /// Triangulates all bounded links by both methods and compares them; returns the number of links with
    /// more than four vertices.
    fn compare(knots: &Knots, start: Configurations, rule: &Rule, degree: usize) -> usize {
        let (claim, diagonals) = (start.claim(), Diagonals::default());
        let order: Vec<u32> = (0..knots.len() as u32).collect();
        let mut predicates = FiniteFloatPredicates::default();
        let mut triangulator = Triangulator::new(knots, (rule, &diagonals), claim, &mut predicates);
        let mut compared = 0;
        for configurations in generate(knots, start, rule, degree).expect("degrees") {
            let compare = |set: &[u32], link: &[u32]| {
                if link.len() > 3 && !link.contains(&FARAWAY) {
                    triangulator.polygon = link.to_vec();
                    triangulator.out.clear();
                    triangulator.split(Triangulator::empty_apex)?;
                    let expected = sorted(&triangulator.out);
                    triangulator.out.clear();
                    triangulator.insert_vertices()?;
                    assert_eq!(sorted(&triangulator.out), expected, "{set:?}: {:?}", knots.points());
                    compared += usize::from(link.len() > 4);
                }
                Ok(())
            };
            for_each_link(knots, &configurations, &order, compare).expect("links");
        }
        compared
    }

    fn random_points(random: &mut Random, count: usize, side: u64) -> Vec<[f64; 2]> {
        (0..count).map(|_| [random.below(side), random.below(side)].map(|c| c as f64)).collect()
    }

    fn circle(count: usize, radius: f64) -> Vec<[f64; 2]> {
        let angle = |i: usize| std::f64::consts::TAU * i as f64 / count as f64;
        (0..count).map(|i| [radius * angle(i).cos(), radius * angle(i).sin()]).collect()
    }

    #[test]
    fn random_order_and_a_search_for_each_triangle_agree() {
        let mut random = Random::new(5);
        let mut compared = 0;
        for (count, side) in [(60, 1 << 30), (60, 9), (30, 6), (24, 3)] {
            for _ in 0..6 {
                let knots = Knots::new(random_points(&mut random, count, side)).expect("knots");
                let start = Start::delaunay(&knots).expect("triangles").configurations();
                compared += compare(&knots, start, &Rule::Delaunay, 4);
            }
        }
        assert!(compared > 3000, "{compared}");
    }

    #[test]
    fn they_agree_amid_lines_and_circles() {
        let square = (0..10).flat_map(|i| {
            let c = f64::from(i);
            [[c, 0.0], [10.0, c], [10.0 - c, 10.0], [0.0, 10.0 - c]]
        });
        for around in [square.collect(), circle(40, 7.0)] {
            for inside in [vec![[5.0, 5.0]], vec![[4.0, 5.0], [5.0, 5.0], [5.0, 5.0], [6.0, 3.0]]] {
                let knots = Knots::new([around.clone(), inside].concat()).expect("knots");
                let start = Start::delaunay(&knots).expect("triangles").configurations();
                assert!(compare(&knots, start, &Rule::Delaunay, 3) > 10);
            }
        }
    }

    #[test]
    fn they_agree_along_a_line() {
        // All knots of the line are in the link of the knot next to it, and any four of them may be inserted
        // first.
        let turns: [fn([f64; 2]) -> [f64; 2]; 4] =
            [|p| p, |[x, y]| [y, x], |[x, y]| [y, -x], |[x, y]| [x + y, x - 2.0 * y]];
        for turn in turns {
            for count in 6..24 {
                let line = (0..count).map(|i| [f64::from(i), 0.0]);
                let others = [[5.0, 1.0], [-4000.0, 4000.0], [4000.0, 5000.0]];
                let points: Vec<[f64; 2]> = line.chain(others).map(turn).collect();
                let lift = Lift::Heights(points.iter().map(|p| p[0] * p[0] + p[1] * p[1]).collect());
                let knots = Knots::new(points).expect("knots");
                let start = Start::delaunay(&knots).expect("triangles").configurations();
                assert!(compare(&knots, start, &Rule::Delaunay, 1) > 0);
                let start = Start::lifted(&knots, &lift).expect("convex").configurations();
                assert!(compare(&knots, start, &Rule::Lifted(lift), 1) > 0);
            }
        }
    }

    #[test]
    fn they_agree_for_other_lifts() {
        let mut random = Random::new(8);
        for side in [1 << 20, 12] {
            let mut points = random_points(&mut random, 60, side);
            points.sort_by(|p, q| p.partial_cmp(q).expect("numbers"));
            points.dedup();
            let height = |p: &[f64; 2]| p[0] * p[0] + 3.0 * p[1] * p[1] + p[0] * p[1];
            let lift = Lift::Heights(points.iter().map(height).collect());
            let knots = Knots::new(points).expect("knots");
            let start = Start::lifted(&knots, &lift).expect("convex").configurations();
            assert!(compare(&knots, start, &Rule::Lifted(lift), 3) > 100);
        }
    }

    #[test]
    fn decisions_grow_with_vertices_and_no_faster() {
        let hub = [circle(4000, 1000.0), vec![[0.0, 0.0]]].concat();
        let parabola = (0..4000).map(|i| [f64::from(i), f64::from(i * i)]).collect();
        for points in [hub, parabola] {
            let knots = Knots::new(points).expect("knots");
            let start = Start::delaunay(&knots).expect("triangles").configurations();
            let order: Vec<u32> = (0..knots.len() as u32).collect();
            let (mut predicates, diagonals) = (FiniteFloatPredicates::default(), Diagonals::default());
            let rule = (&Rule::Delaunay, &diagonals);
            let mut triangulator = Triangulator::new(&knots, rule, Claim::Delaunay, &mut predicates);
            let mut largest = 0;
            for_each_link(&knots, &start, &order, |set, link| {
                largest = largest.max(link.len());
                triangulator.triangulate(set, link)
            })
            .expect("links");
            let decisions = predicates.counts().total();
            assert!(largest >= 3999 && decisions < 60 * knots.len() as u64, "{largest}: {decisions}");
        }
    }
}
