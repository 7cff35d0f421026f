//! Large links: vertices inserted in random order (Chew, "Building Voronoi diagrams for convex polygons in
//! linear expected time", 1990; as for one cell of a higher-order Voronoi diagram by Aggarwal, Guibas, Saxe
//! and Shor, 1989).
//!
//! Planes that have the lifted knots of J below them or on them, and the lifted vertices of the link of J
//! above or on them, are a convex cell of the dual space. Its corners at three facets of vertices are the
//! triangles of the link, and the facet of each vertex borders on those of J in one stretch: they are its
//! sides that are seen from the plane which touches the lift at the vertex. Nothing of this needs all
//! vertices. So those of any part are a polygon in the same cyclic order, and the facet of one vertex more
//! cuts off a tree of triangles that starts at the edge between its neighbours, which are known: vertices are
//! taken out of the polygon in random order, and come back the other way around.
//!
//! Triangles of a part of the vertices may be clockwise, or flat: J is not within the vertices then, and
//! their planes stand for the outside of a circle, or a half-plane. [`super::plane::Plane::is_beyond`] takes
//! them as they are. No lift decides whether a vertex is in conflict with three others on its line. It is
//! taken not to be, as if it was moved by less than all vertices before, and such triangles are gone in the
//! end.

use super::polygon::Triangulator;
use super::surface::Corner;
use crate::predicates::Predicates2;
use spmesh_core::error::Result;
use spmesh_core::random::Random;

/// Links of at least that many vertices are triangulated so; less are faster without.
pub(super) const LARGE: usize = 24;

/// No triangle is there.
const OUTSIDE: Corner = Corner::MAX;

/// The triangulation of a polygon whose vertices come one by one; they are places in the whole polygon.
struct Ears {
    triangles: Vec<[u32; 3]>,
    /// The half-edge on the other side of each, or [`OUTSIDE`].
    across: Vec<[Corner; 3]>,
    /// The half-edge from each vertex to the next of the polygon.
    edge_after: Vec<Corner>,
    /// Edges to look across, the cavity to the left of them; the last comes first.
    waiting: Vec<(u32, u32, Corner)>,
    /// Triangles that are no more.
    free: Vec<u32>,
}

impl<P: Predicates2> Triangulator<'_, P> {
    /// Triangulates a polygon of at least three vertices whose triangles are all those of the lift.
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

/// For each place the one before and the one after it among those that come before it in `order`.
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
    /// Room for `count` vertices, of which three are there.
    fn of_triangle(triangle: [u32; 3], count: usize) -> Ears {
        let mut edge_after = vec![OUTSIDE; count];
        for (i, place) in (0..3).zip(triangle) {
            edge_after[place as usize] = (i + 2) % 3;
        }
        let (triangles, across) = (vec![triangle], vec![[OUTSIDE; 3]]);
        Ears { triangles, across, edge_after, waiting: Vec::new(), free: Vec::new() }
    }

    /// Inserts a vertex between its neighbours: a star around it replaces the triangles in conflict, none of
    /// which is met twice, as all triangles are a tree.
    fn insert(
        &mut self,
        place: u32,
        [before, after]: [u32; 2],
        mut is_in_conflict: impl FnMut([u32; 3], u32) -> bool,
    ) {
        self.waiting.push((after, before, self.edge_after[before as usize]));
        let mut last = OUTSIDE;
        while let Some((from, to, beyond)) = self.waiting.pop() {
            let (t, i) = (beyond as usize / 3, beyond as usize % 3);
            if beyond != OUTSIDE && is_in_conflict(self.triangles[t], place) {
                let tip = self.triangles[t][i];
                self.waiting.push((tip, to, self.across[t][(i + 2) % 3]));
                self.waiting.push((from, tip, self.across[t][(i + 1) % 3]));
                self.free.push(t as u32);
                continue;
            }
            let fresh = self.put([place, from, to]);
            self.join(3 * fresh, beyond, from);
            self.join(3 * fresh + 2, last, place);
            last = 3 * fresh + 1;
        }
        self.edge_after[before as usize] = last;
    }

    /// Writes a triangle to a free number.
    fn put(&mut self, triangle: [u32; 3]) -> u32 {
        if let Some(free) = self.free.pop() {
            self.triangles[free as usize] = triangle;
            self.across[free as usize] = [OUTSIDE; 3];
            return free;
        }
        self.triangles.push(triangle);
        self.across.push([OUTSIDE; 3]);
        self.triangles.len() as u32 - 1
    }

    /// Makes two half-edges one edge, or the one that starts at `from` an edge of the polygon.
    fn join(&mut self, here: Corner, there: Corner, from: u32) {
        if there == OUTSIDE {
            self.edge_after[from as usize] = here;
            return;
        }
        self.across[here as usize / 3][here as usize % 3] = there;
        self.across[there as usize / 3][there as usize % 3] = here;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::configurations::gathering::for_each_link;
    use crate::configurations::knots::Knots;
    use crate::configurations::rule::Rule;
    use crate::configurations::special::Diagonals;
    use crate::configurations::{Lift, Start, generate};
    use crate::predicates::FiniteFloatPredicates;
    use spmesh_model::configurations::FARAWAY;
    use spmesh_model::configurations::{Claim, Configurations};

    /// The triangles that one of the ways gives, in an order of their own.
    fn sorted(out: &[[u32; 3]]) -> Vec<[u32; 3]> {
        let mut all = out.to_vec();
        for triangle in &mut all {
            let least = (0..3).min_by_key(|&i| triangle[i]).unwrap_or(0);
            triangle.rotate_left(least);
        }
        all.sort_unstable();
        all
    }

    /// Triangulates all links that are bounded in both ways; the number of those with more than four
    /// vertices.
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
        // All knots of the line are in the link of the knot next to it, and any four of them may come first.
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
