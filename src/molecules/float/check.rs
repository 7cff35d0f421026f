//! Exact signs and values, to count the errors of rounded arithmetic and the tetrahedra that it made wrong.

use super::mesh::{faraway_corner, finite_facet};
use super::phase_timer::Stats;
use super::sphere::orientation;
use spmesh_delaunay::delaunay3::{Tetrahedralization, Vertex};
use spmesh_delaunay::order::Insertions;
use spmesh_delaunay::predicates::{
    FiniteFloatPredicates, FiniteFloatPredicates3, Point3, Predicates2, Predicates3, Sign,
};
use spmesh_delaunay::vector::difference;

/// Integer differences below this have in-sphere determinants below 2^125.
const INTEGER_LIMIT: f64 = 8_388_608.0;

/// Exact orientation of a tetrahedron.
pub fn orient3d(a: Point3, b: Point3, c: Point3, d: Point3) -> Sign {
    FiniteFloatPredicates3::default().orient3d(a, b, c, d)
}

/// Whether three points are on a line.
pub fn are_collinear(a: Point3, b: Point3, c: Point3) -> bool {
    [(0, 1), (1, 2), (2, 0)].into_iter().all(|(i, j)| {
        let [a, b, c] = [a, b, c].map(|p| [p[i], p[j]]);
        FiniteFloatPredicates::default().orient2d(a, b, c) == Sign::Zero
    })
}

/// Compares the value of a sphere, or half-space, at `p` with the exact one.
#[cold]
#[inline(never)]
pub fn check(vertices: &[Vertex], corners: &[u32; 4], p: Point3, value: f64, stats: &mut Stats) {
    let point = |corner: usize| vertices[corners[corner] as usize].at;
    let exact = if let Some(corner) = faraway_corner(corners) {
        let [o, a, b] = finite_facet(corner).map(point);
        orient3d(o, a, b, p)
    } else {
        let [a, b, c, d] = [0, 1, 2, 3].map(point);
        stats.rounded += u64::from(is_rounded([a, b, c, d], p, value));
        FiniteFloatPredicates3::default().insphere(a, b, c, d, p)
    };
    if exact == Sign::Zero {
        stats.wrong_zeros += u64::from(value != 0.0);
    } else {
        // A NaN has no right sign.
        stats.wrong_signs += u64::from(value.is_nan() || Sign::of(value) != exact);
    }
}

/// Whether `value` is not the in-sphere determinant of points with integer coordinates that are near each
/// other.
pub fn is_rounded([o, a, b, c]: [Point3; 4], p: Point3, value: f64) -> bool {
    let is_integer = |p: Point3| p.iter().all(|x| x.trunc() == *x);
    let differences = [a, b, c, p].map(|q| difference(q, o));
    let is_small = |d: &Point3| d.iter().all(|x| x.abs() < INTEGER_LIMIT);
    if ![o, a, b, c, p].into_iter().all(is_integer) || !differences.iter().all(is_small) {
        return false;
    }
    let [a, b, c, d] = differences.map(|d| d.map(|x| x as i128));
    let dot = |p: [i128; 3], q: [i128; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    let det = |p: [i128; 3], q: [i128; 3], r: [i128; 3]| {
        dot(p, [q[1] * r[2] - q[2] * r[1], q[2] * r[0] - q[0] * r[2], q[0] * r[1] - q[1] * r[0]])
    };
    let exact = dot(a, a) * det(d, b, c) + dot(b, b) * det(d, c, a) + dot(c, c) * det(d, a, b)
        - dot(d, d) * det(a, b, c);
    value as i128 != exact
}

/// Four vertices, positively oriented for exact arithmetic and for rounded arithmetic; none if all are in a
/// plane.
///
/// The first to be inserted, the second, the first that is not collinear with them, the first after that that
/// is not coplanar.
pub fn first_tetrahedron(vertices: &[Vertex], mut insertions: Insertions) -> Option<[u32; 4]> {
    let at = |v: u32| vertices[v as usize].at;
    let (a, b) = (insertions.next()?, insertions.next()?);
    let c = insertions.find(|&v| !are_collinear(at(a), at(b), at(v)))?;
    let is_positive = |a, b, c, d| {
        orient3d(at(a), at(b), at(c), at(d)) == Sign::Positive
            && orientation(at(a), at(b), at(c), at(d)) > 0.0
    };
    insertions.flat_map(|d| [[a, b, c, d], [b, a, c, d]]).find(|&[a, b, c, d]| is_positive(a, b, c, d))
}

/// The number of tetrahedra that are inverted or flat, or have a vertex of a neighbour inside of their
/// sphere, by exact arithmetic. Spheres of flat tetrahedra have no inside.
///
/// Cost: five exact signs per tetrahedron.
pub fn violations(mesh: &Tetrahedralization) -> u64 {
    let is_wrong = |number: &usize| is_inverted_or_flat(mesh, *number) || has_neighbour_inside(mesh, *number);
    (0..mesh.tetrahedra().len()).filter(is_wrong).count() as u64
}

fn is_inverted_or_flat(mesh: &Tetrahedralization, number: usize) -> bool {
    let [a, b, c, d] = mesh.tetrahedra()[number].vertices.map(|v| mesh.vertices()[v as usize].at);
    orient3d(a, b, c, d) != Sign::Positive
}

/// For a positive tetrahedron.
fn has_neighbour_inside(mesh: &Tetrahedralization, number: usize) -> bool {
    let tetrahedron = &mesh.tetrahedra()[number];
    let point = |v: u32| mesh.vertices()[v as usize].at;
    let [a, b, c, d] = tetrahedron.vertices.map(point);
    (0..4).filter_map(|side| tetrahedron.neighbour(side)).any(|beyond| {
        let apex = mesh.tetrahedra()[beyond.tetrahedron as usize].vertices[beyond.corner as usize];
        FiniteFloatPredicates3::default().insphere(a, b, c, d, point(apex)) == Sign::Positive
    })
}
