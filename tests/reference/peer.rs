//! Constrained Delaunay triangulations of integer points, checked with the crate `spade` and exactly.

use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};
use std::collections::{BTreeSet, HashMap};

type Place = [i64; 2];
type Triangle = [Place; 3];

/// Points, and segments between them that have nothing in common but points or overlaps between points.
pub struct Peer {
    points: Vec<Place>,
    segments: Vec<[Place; 2]>,
}

/// Twice the area of a triangle, positive if it is counterclockwise.
fn area([a, b, c]: Triangle) -> i128 {
    let [[ux, uy], [vx, vy]] = [b, c].map(|p| [0, 1].map(|axis| i128::from(p[axis] - a[axis])));
    ux * vy - uy * vx
}

/// Positive if a place is inside of the circle of a counterclockwise triangle, and 0 if it is on it.
fn incircle(corners: Triangle, d: Place) -> i128 {
    let [a, b, c] = corners.map(|p| [0, 1].map(|axis| i128::from(p[axis] - d[axis])));
    let lifted =
        |p: [i128; 2], q: [i128; 2], r: [i128; 2]| (p[0] * p[0] + p[1] * p[1]) * (q[0] * r[1] - q[1] * r[0]);
    lifted(a, b, c) + lifted(b, c, a) + lifted(c, a, b)
}

/// The triangle with its corners counterclockwise.
fn oriented([a, b, c]: Triangle) -> Triangle {
    assert_ne!(area([a, b, c]), 0, "the triangle {:?} is flat", [a, b, c]);
    if area([a, b, c]) > 0 { [a, b, c] } else { [a, c, b] }
}

/// Triangles as a sorted set.
fn as_set(triangles: &[Triangle]) -> BTreeSet<Triangle> {
    let sorted = |mut corners: Triangle| {
        corners.sort_unstable();
        corners
    };
    triangles.iter().map(|&corners| sorted(corners)).collect()
}

impl Peer {
    /// Points in any order, also several times.
    pub fn new(points: &[Place], segments: &[[Place; 2]]) -> Peer {
        let points: BTreeSet<Place> = points.iter().copied().collect();
        Peer { points: points.into_iter().collect(), segments: segments.to_vec() }
    }

    /// The parts of segments between consecutive points on them, each with its lesser end first.
    pub fn links(&self) -> BTreeSet<[Place; 2]> {
        let mut links = BTreeSet::new();
        for &segment in &self.segments {
            // Points are in lexicographic order, and so are those on a segment.
            let on: Vec<Place> =
                self.points.iter().copied().filter(|&x| super::segments::is_on(segment, x)).collect();
            links.extend(on.windows(2).map(|pair| [pair[0], pair[1]]));
        }
        links
    }

    /// Checks that `triangles` are a constrained Delaunay triangulation, and as many as those of `spade`; if
    /// there is only one such triangulation, the same ones. Returns whether there is only one.
    pub fn check(&self, triangles: &[Triangle]) -> bool {
        let peer = self.triangles();
        assert_eq!(triangles.len(), peer.len(), "triangles");
        if peer.is_empty() {
            return true;
        }
        let apexes = apexes(triangles);
        self.check_extent(triangles, &apexes);
        let links = self.links();
        let has_edge = |&[a, b]: &[Place; 2]| apexes.contains_key(&[a, b]) || apexes.contains_key(&[b, a]);
        links.iter().for_each(|link| assert!(has_edge(link), "no edge {link:?}"));
        let is_unique = !has_ties(&apexes, &links);
        if is_unique {
            assert_eq!(as_set(triangles), as_set(&peer), "triangles");
        }
        is_unique
    }

    /// Checks that the triangles cover the convex hull once and that all points are vertices.
    fn check_extent(&self, triangles: &[Triangle], apexes: &HashMap<[Place; 2], Place>) {
        let vertices: BTreeSet<Place> = triangles.iter().flatten().copied().collect();
        assert!(vertices.iter().eq(&self.points), "vertices");
        for &[a, b] in apexes.keys().filter(|&&[a, b]| !apexes.contains_key(&[b, a])) {
            let is_hull = self.points.iter().all(|&x| area([a, b, x]) >= 0);
            assert!(is_hull, "the edge {a:?} to {b:?} is on the border, but not on the hull");
        }
        let covered: i128 = triangles.iter().map(|&corners| area(oriented(corners))).sum();
        assert_eq!(covered, hull_area(&self.points), "twice the area");
    }

    /// The triangles of `spade`.
    fn triangles(&self) -> Vec<Triangle> {
        let mut mesh = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
        let at = |[x, y]: Place| Point2::new(x as f64, y as f64);
        self.points.iter().for_each(|&place| {
            mesh.insert(at(place)).expect("finite");
        });
        for &ends in &self.segments {
            let [from, to] = ends.map(|end| mesh.insert(at(end)).expect("finite"));
            if from != to {
                mesh.add_constraint(from, to);
            }
        }
        let corners = mesh.inner_faces().map(|face| face.positions());
        corners.map(|corners| corners.map(|p| [p.x as i64, p.y as i64])).collect()
    }
}

/// For each edge of a counterclockwise triangle the corner opposite to it.
fn apexes(triangles: &[Triangle]) -> HashMap<[Place; 2], Place> {
    let mut apexes = HashMap::new();
    for &corners in triangles {
        let [a, b, c] = oriented(corners);
        for (edge, apex) in [([a, b], c), ([b, c], a), ([c, a], b)] {
            let other = apexes.insert(edge, apex);
            assert_eq!(other, None, "two triangles on one side of {edge:?}");
        }
    }
    apexes
}

/// Checks that all edges but links are locally Delaunay, and returns whether a circle has four vertices.
fn has_ties(apexes: &HashMap<[Place; 2], Place>, links: &BTreeSet<[Place; 2]>) -> bool {
    let mut ties = 0;
    for (&[a, b], &c) in apexes {
        let Some(&d) = apexes.get(&[b, a]) else { continue };
        if links.contains(&[a.min(b), a.max(b)]) {
            continue;
        }
        let side = incircle([a, b, c], d);
        assert!(side <= 0, "the edge {a:?} to {b:?} is not Delaunay: {d:?} is in the circle with {c:?}");
        ties += usize::from(side == 0);
    }
    ties > 0
}

/// Twice the area of the convex hull of points in lexicographic order.
fn hull_area(points: &[Place]) -> i128 {
    let half = |points: &mut dyn Iterator<Item = Place>| {
        let mut chain: Vec<Place> = Vec::new();
        for point in points {
            while chain.len() > 1 && area([chain[chain.len() - 2], chain[chain.len() - 1], point]) <= 0 {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut hull = half(&mut points.iter().copied());
    hull.extend(half(&mut points.iter().rev().copied()));
    hull.windows(2).map(|edge| area([hull[0], edge[0], edge[1]])).sum()
}
