//! Another implementation of constrained Delaunay triangulations (`spade`) agrees, over random and degenerate
//! points. Ties of four points on a circle are free there, so edges are checked, and triangles only without ties.

use super::{Mesh, mesh, output};
use crate::programs::Folder;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};
use spmesh_reference::exact::{exact_points, incircle, orientation};
use spmesh_reference::segments::random_segments;
use spmesh_reference::sets::{self, Random};
use std::collections::BTreeMap;

type Place = [i64; 2];
type Peer = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// What two implementations must have in common.
#[derive(Debug, PartialEq)]
struct Agreed {
    triangles: usize,
    twice_area: i128,
    /// Ends of edges that are constraints, sorted.
    constrained: Vec<[Place; 2]>,
}

#[test]
fn random_points_with_lines_are_triangulated_as_by_spade() {
    let mut random = Random::new(41);
    let untied = (0..200).filter(|_| {
        let count = random.integer(5, 120) as usize;
        let points = sets::uniform(&mut random, count, 5_000);
        agrees(&mut random, sets::distinct(&mut Random::new(1), points))
    });
    assert!(untied.count() > 150);
}

#[test]
fn degenerate_points_with_lines_are_triangulated_as_by_spade() {
    let mut random = Random::new(42);
    let untied = (0..100).filter(|set| {
        let points = sets::degenerate(&mut random, set % sets::DEGENERATE_FAMILIES, 60);
        agrees(&mut random, points)
    });
    assert!(untied.count() < 90);
}

/// Compares the meshes of some points with random lines between them, of which some pass through other points.
/// Returns whether they have no ties.
fn agrees(random: &mut Random, points: Vec<Place>) -> bool {
    let most = random.integer(1, 30) as usize;
    let segments: Vec<[Place; 2]> = random_segments(random, &points, most, false)
        .into_iter()
        .map(|ends| ends.map(|end| points[end as usize]))
        .collect();
    let (found, peer) = (ours(&points, &segments), theirs(&points, &segments));
    assert_eq!(agreed(&found), agreed(&peer), "{points:?} {segments:?}");
    let is_tied = has_ties(&found).unwrap_or_else(|edge| panic!("{edge:?} in {points:?} {segments:?}"));
    if !is_tied {
        assert_eq!(found.triangles, peer.triangles, "{points:?} {segments:?}");
    }
    !is_tied
}

fn ours(points: &[Place], segments: &[[Place; 2]]) -> Mesh {
    let folder = Folder::new();
    let text: String = points.iter().map(|[x, y]| format!("{x} {y} 0\n")).collect();
    let lines: String = segments.iter().map(|[[a, b], [c, d]]| format!("soft {a} {b} {c} {d}\n")).collect();
    let (points, lines) = (folder.write("points.xyz", text), folder.write("lines.txt", lines));
    let points = output("spfinalize", &[&points], &[]);
    let lined = output("spconstrain", &["--lines", &lines], &output("spdelaunay2d", &[], &points));
    mesh(&lined)
}

fn theirs(points: &[Place], segments: &[[Place; 2]]) -> Mesh {
    let mut peer = Peer::new();
    let place = |at: Place| Point2::new(at[0] as f64, at[1] as f64);
    let handles: BTreeMap<Place, _> =
        points.iter().map(|&at| (at, peer.insert(place(at)).expect("a finite point"))).collect();
    for ends in segments {
        let [from, to] = ends.map(|end| handles[&end]);
        peer.add_constraint(from, to);
    }
    let at = |point: Point2<f64>| [point.x as i64, point.y as i64];
    let triangles = peer.inner_faces().map(|face| face.positions().map(at)).collect();
    let constrained = peer.undirected_edges().filter(|edge| edge.is_constraint_edge());
    Mesh::new(triangles, BTreeMap::new(), constrained.map(|edge| edge.positions().map(at)).collect())
}

fn agreed(mesh: &Mesh) -> Agreed {
    let twice_area = mesh.triangles.iter().map(|&[a, b, c]| turn(a, b, c).abs()).sum();
    // Edges without a triangle are no edges of a mesh.
    let sides = sides(mesh);
    let constrained = mesh.constrained.iter().filter(|ends| sides.contains_key(*ends)).copied().collect();
    Agreed { triangles: mesh.triangles.len(), twice_area, constrained }
}

/// For each side of triangles, the corners opposite to it.
fn sides(mesh: &Mesh) -> BTreeMap<[Place; 2], Vec<Place>> {
    let mut sides: BTreeMap<[Place; 2], Vec<Place>> = BTreeMap::new();
    for &[a, b, c] in &mesh.triangles {
        for (ends, opposite) in [([a, b], c), ([a, c], b), ([b, c], a)] {
            sides.entry(ends).or_default().push(opposite);
        }
    }
    sides
}

/// Whether some unconstrained edge could be flipped without harm. An error is an edge that must be flipped.
fn has_ties(mesh: &Mesh) -> Result<bool, [Place; 2]> {
    let mut has_ties = false;
    for (ends, opposite) in sides(mesh) {
        if let [c, d] = opposite[..]
            && mesh.constrained.binary_search(&ends).is_err()
        {
            match in_circle([ends[0], ends[1], c], d) {
                1 => return Err(ends),
                sign => has_ties |= sign == 0,
            }
        }
    }
    Ok(has_ties)
}

/// Twice the area of a triangle, above zero if it is counterclockwise.
fn turn(a: Place, b: Place, c: Place) -> i128 {
    let [u, v] = [b, c].map(|p| [0, 1].map(|axis| i128::from(p[axis] - a[axis])));
    u[0] * v[1] - u[1] * v[0]
}

/// One if a place is inside of the circle of a triangle, zero if it is on it.
fn in_circle([a, b, c]: [Place; 3], d: Place) -> i32 {
    let points = exact_points(&sets::as_floats(&[a, b, c, d]));
    let [a, b, c, d] = [0, 1, 2, 3].map(|place| &points[place]);
    incircle([a, b, c, d]) * orientation(a, b, c)
}
