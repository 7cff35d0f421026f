//! Centroid triangulations: the points are k-sets, the triangles are configurations of two degrees (thesis
//! 7.3 and 7.4). The union map turns configurations into faces of k-set polytopes.

use super::knots::Knots;
use foldhash::{HashMap, HashMapExt};
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_delaunay::delaunay2::distinct;
use spmesh_delaunay::predicates::{FiniteFloatPredicates, Point2, Predicates2, Sign};
use spmesh_stream::model::configurations::Configurations;

/// A planar triangulation of the centroids of k-sets; with Delaunay configurations, the order-k Delaunay
/// triangulation.
#[derive(Debug, Clone, Default)]
pub struct CentroidMesh {
    pub(super) order: usize,
    /// The k-sets, each sorted, concatenated.
    pub(super) sets: Vec<u32>,
    /// Centroids of the k-sets, in lexicographic order of the sets. Coordinates are rounded.
    pub vertices: Vec<Point2>,
    /// Counterclockwise. First come those from the higher degree: a vertex is the interior set and one knot
    /// of the boundary. Then come those from the lower degree, with two knots of the boundary. Triangles of
    /// copies of a knot may be flat.
    pub triangles: Vec<[u32; 3]>,
    /// Number of triangles from the higher degree.
    pub from_upper: usize,
}

impl CentroidMesh {
    /// The centroid triangulation of order k, by the union map from the configurations of degrees k - 2 and
    /// k - 1.
    ///
    /// `lower` is `None` for order 1, which is the start triangulation itself.
    ///
    /// Shape: c_(k-1) + c_(k-2) triangles.
    ///
    /// Cost: little more than linear if no knot is in very many of the sets. Memory: 12 (k + 1) bytes per
    /// triangle, temporarily.
    ///
    /// # Errors
    /// Degrees that are not consecutive; too many triangles.
    pub fn of(knots: &Knots, lower: Option<&Configurations>, upper: &Configurations) -> Result<CentroidMesh> {
        let expected = upper.degree().checked_sub(1);
        if lower.map(Configurations::degree) != expected {
            let degree = upper.degree();
            let needed = expected.map_or(String::new(), |lower| format!("{lower} and "));
            let what = format!("centroids of order {} need degrees {needed}{degree}", degree + 1);
            return Err(Error::usage(what));
        }
        let lower_len = lower.map_or(0, Configurations::len);
        if upper.len() + lower_len > (u32::MAX / 3) as usize {
            return Err(Error::new(ErrorKind::Memory, "too many triangles for one mesh: use fewer knots"));
        }
        let order = upper.degree() + 1;
        let mut corners = Vec::with_capacity(3 * order * (upper.len() + lower_len));
        for ([a, b, c], interior) in upper.iter() {
            [[a], [b], [c]].iter().for_each(|some| push_set(&mut corners, interior, some));
        }
        for ([a, b, c], interior) in lower.into_iter().flat_map(Configurations::iter) {
            // Each centroid is the point reflection of the corner that its pair leaves out, so the pairs in
            // this order are counterclockwise, too.
            [[b, c], [c, a], [a, b]].iter().for_each(|some| push_set(&mut corners, interior, some));
        }
        let mut mesh = CentroidMesh { order, from_upper: upper.len(), ..CentroidMesh::default() };
        mesh.join(&corners, knots.len());
        mesh.vertices = mesh.sets.chunks_exact(order).map(|set| centroid(knots, set)).collect();
        Ok(mesh)
    }

    /// The order k.
    pub fn order(&self) -> usize {
        self.order
    }

    /// The k-set of a vertex, sorted.
    pub fn set(&self, vertex: u32) -> &[u32] {
        &self.sets[vertex as usize * self.order..][..self.order]
    }

    /// Numbers the distinct sets among the corners of triangles. All knots are below `knots`. A counting sort
    /// by least knot leaves small buckets, which are then sorted.
    fn join(&mut self, corners: &[u32], knots: usize) {
        let set = |at: u32| &corners[at as usize * self.order..][..self.order];
        let mut order = by_least(corners, self.order, knots);
        self.triangles = vec![[0; 3]; order.len() / 3];
        let mut vertex = 0;
        for bucket in order.chunk_by_mut(|&a, &b| set(a)[0] == set(b)[0]) {
            bucket.sort_unstable_by_key(|&at| &set(at)[1..]);
            for same in bucket.chunk_by(|&a, &b| set(a) == set(b)) {
                self.sets.extend_from_slice(set(same[0]));
                for &at in same {
                    self.triangles[at as usize / 3][at as usize % 3] = vertex;
                }
                vertex += 1;
            }
        }
    }
}

/// The indices of sets of one size, in the order of their first knots.
fn by_least(sets: &[u32], size: usize, knots: usize) -> Vec<u32> {
    let mut starts = vec![0u32; knots + 1];
    sets.chunks_exact(size).for_each(|set| starts[set[0] as usize + 1] += 1);
    for knot in 0..knots {
        starts[knot + 1] += starts[knot];
    }
    let mut order = vec![0; sets.len() / size];
    for (number, set) in (0..).zip(sets.chunks_exact(size)) {
        let start = &mut starts[set[0] as usize];
        order[*start as usize] = number;
        *start += 1;
    }
    order
}

fn push_set(sets: &mut Vec<u32>, interior: &[u32], some: &[u32]) {
    let start = sets.len();
    sets.extend_from_slice(interior);
    sets.extend_from_slice(some);
    sets[start..].sort_unstable();
}

/// The centroid of knots.
pub fn centroid(knots: &Knots, set: &[u32]) -> Point2 {
    let sum = set.iter().fold([0.0; 2], |sum, &id| [sum[0] + knots.at(id)[0], sum[1] + knots.at(id)[1]]);
    sum.map(|coordinate: f64| coordinate / set.len() as f64)
}

impl CentroidMesh {
    /// The same mesh with one vertex for all sets with the same places, and without flat triangles.
    ///
    /// Triangles whose boundary has two knots at one place shrink to edges, and their neighbours become
    /// adjacent. Other flat triangles have knots on a line, some of them moved symbolically. They lie on the
    /// border: inside the mesh, other triangles would end in the middle of an edge.
    pub fn without_flat(&self, knots: &Knots) -> CentroidMesh {
        let mut predicates = FiniteFloatPredicates::default();
        let firsts = distinct(knots.points());
        let mut numbers: HashMap<Vec<u32>, u32> = HashMap::new();
        let mut merged = CentroidMesh { order: self.order(), ..CentroidMesh::default() };
        for (number, corners) in self.triangles.iter().enumerate() {
            let different = self.different(*corners).map(|id| knots.at(id));
            let [a, b, c] = different;
            if predicates.orient2d(a, b, c) == Sign::Zero {
                continue;
            }
            merged.from_upper += usize::from(number < self.from_upper);
            let vertices = corners.map(|corner| {
                let mut places: Vec<u32> = self.set(corner).iter().map(|&id| firsts[id as usize]).collect();
                places.sort_unstable();
                *numbers.entry(places).or_insert_with(|| {
                    merged.sets.extend_from_slice(self.set(corner));
                    merged.vertices.push(centroid(knots, self.set(corner)));
                    merged.vertices.len() as u32 - 1
                })
            });
            merged.triangles.push(vertices);
        }
        merged
    }

    /// The three knots of the boundary that a triangle comes from: the knots that are not in all three sets.
    fn different(&self, corners: [u32; 3]) -> [u32; 3] {
        let [first, second, third] = corners.map(|corner| self.set(corner));
        let lacks = |set: &[u32], id: &u32| set.binary_search(id).is_err();
        let all = first.iter().filter(|id| lacks(second, id) || lacks(third, id));
        let others = second.iter().filter(|id| lacks(first, id));
        let rest = third.iter().filter(|id| lacks(first, id) && lacks(second, id));
        let mut found = all.chain(others).chain(rest).copied();
        std::array::from_fn(|_| found.next().expect("sets of a triangle differ by three knots"))
    }
}

/// All unions of I with `count` knots of B, each sorted, in lexicographic order.
///
/// Domain: disjoint sets; `count` from 1 to one less than the size of `boundary`, otherwise there are no
/// unions. (In the thesis the bound in equation 7.3 is one less than in theorem 7.1.2, which is right.)
pub fn union_map(boundary: &[u32], interior: &[u32], count: usize) -> Vec<Vec<u32>> {
    if count == 0 || count >= boundary.len() {
        return Vec::new();
    }
    let mut sets = Vec::new();
    choose(boundary, count, interior.to_vec(), &mut sets);
    sets.iter_mut().for_each(|set| set.sort_unstable());
    sets.sort_unstable();
    sets
}

/// Adds to `sets` all unions of `with` and `count` of `from`.
fn choose(from: &[u32], count: usize, with: Vec<u32>, sets: &mut Vec<Vec<u32>>) {
    if count == 0 {
        sets.push(with);
        return;
    }
    for (place, &knot) in from.iter().enumerate().take((from.len() + 1).saturating_sub(count)) {
        choose(&from[place + 1..], count - 1, [&with[..], &[knot]].concat(), sets);
    }
}

/// A configuration and the number of boundary knots that are taken at a time; sets are sorted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnionSource {
    /// The boundary set B.
    pub boundary: Vec<u32>,
    /// The interior set I.
    pub interior: Vec<u32>,
    /// The number of knots of B in each set.
    pub count: usize,
}

/// The preimage of `sets` under the union map; `None` if there is none.
///
/// I is the intersection of the sets, and B is their union without I.
pub fn inverse_union_map(sets: &[Vec<u32>]) -> Option<UnionSource> {
    let first = sets.first()?;
    let interior: Vec<u32> =
        first.iter().copied().filter(|v| sets.iter().all(|set| set.contains(v))).collect();
    let mut boundary: Vec<u32> = sets.iter().flatten().copied().filter(|v| !interior.contains(v)).collect();
    boundary.sort_unstable();
    boundary.dedup();
    let mut source = UnionSource { count: first.len() - interior.len(), boundary, interior };
    source.interior.sort_unstable();
    let mut given: Vec<Vec<u32>> = sets.to_vec();
    given.iter_mut().for_each(|set| set.sort_unstable());
    given.sort_unstable();
    // If the number of unions differs, the sets are not an image. Compare numbers before computing all
    // unions.
    let expected = binomial(source.boundary.len(), source.count)?;
    let is_image =
        expected == given.len() && union_map(&source.boundary, &source.interior, source.count) == given;
    is_image.then_some(source)
}

fn binomial(n: usize, k: usize) -> Option<usize> {
    (0..k).try_fold(1usize, |product, i| Some(product.checked_mul(n.checked_sub(i)?)? / (i + 1)))
}
