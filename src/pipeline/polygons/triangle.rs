//! Whether a triangle lies in one of the polygons, exactly.

use super::{Polygons, Side};
use num_bigint::BigInt;
use spmesh_delaunay::predicates::exact_integers::integers_of;
use spmesh_delaunay::predicates::{FiniteFloatPredicates, Predicates2, Sign};
use spmesh_stream::model::points::Point2;
use std::collections::BTreeMap;

impl Polygons {
    /// Whether a counterclockwise triangle is inside of a polygon.
    ///
    /// A corner that is on no border decides, or a place inside of the triangle. A triangle may be so thin
    /// that no numbers are inside of it; then all edges are looked at, in integers of any size.
    ///
    /// Domain: coordinates are finite, and no edge of a polygon meets the interior of the triangle.
    pub fn has_triangle(&self, corners: [Point2; 3]) -> bool {
        for corner in corners {
            match self.side(corner) {
                Side::Inside => return true,
                Side::Outside => return false,
                Side::Border => {}
            }
        }
        let mut predicates = FiniteFloatPredicates::default();
        let mut inner = (0..3).map(|first| inner_place(corners, first));
        let place = inner.find(|&place| is_strictly_in(corners, place, &mut predicates));
        place.map_or_else(|| self.has_exact_middle(corners), |place| self.side(place) == Side::Inside)
    }

    /// Whether the middle of a triangle is inside of a polygon. It is on no edge. Cost: all edges.
    fn has_exact_middle(&self, corners: [Point2; 3]) -> bool {
        let edges = &self.rows.edges;
        let places: Vec<Point2> =
            corners.into_iter().chain(edges.iter().flat_map(|edge| edge.ends)).collect();
        let integers = integers_of(&places);
        // Three times the middle, and three times all ends.
        let [x, y] = [0, 1].map(|axis| integers[..3].iter().map(|corner| &corner[axis]).sum::<BigInt>());
        let mut crossings: BTreeMap<u32, u32> = BTreeMap::new();
        for (edge, ends) in edges.iter().zip(integers[3..].chunks_exact(2)) {
            let [[ax, ay], [bx, by]] = [&ends[0], &ends[1]].map(|end| [&end[0] * 3, &end[1] * 3]);
            let is_level = ay <= y && y < by;
            // The edge leads upwards, and the ray from the middle to the right.
            if is_level && (&bx - &ax) * (&y - &ay) - (&by - &ay) * (&x - &ax) > BigInt::ZERO {
                *crossings.entry(edge.polygon).or_default() += 1;
            }
        }
        crossings.values().any(|count| count % 2 == 1)
    }
}

/// A place near the middle, nearer to one corner. Of integers, it is exact.
fn inner_place(corners: [Point2; 3], first: usize) -> Point2 {
    let [a, b, c] = [0, 1, 2].map(|turn| corners[(first + turn) % 3]);
    [0, 1].map(|axis| 0.5 * a[axis] + (0.25 * b[axis] + 0.25 * c[axis]))
}

fn is_strictly_in([a, b, c]: [Point2; 3], place: Point2, predicates: &mut FiniteFloatPredicates) -> bool {
    [[a, b], [b, c], [c, a]].iter().all(|&[u, v]| predicates.orient2d(u, v, place) == Sign::Positive)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_without_numbers_inside_are_decided() {
        let mut predicates = FiniteFloatPredicates::default();
        let (mut thin, mut exact) = (0, 0);
        for i in 0..200 {
            // In binary, the middle of the first side may be beside the line of its ends.
            let [x, y] = [3.1 + 0.1 * f64::from(i % 20), 2.3 + 0.1 * f64::from(i / 20)];
            let [a, b, c, d] = [[x, y], [x + 0.8, y + 0.1], [x + 1.6, y + 0.2], [x + 0.2, y + 5.0]];
            let polygons = Polygons::new(&[vec![vec![a, b, c, d]]]);
            let turn = predicates.orient2d(a, b, c);
            assert!(!polygons.has_triangle([c, [x + 9.0, y + 9.0], d]));
            if turn == Sign::Zero {
                continue;
            }
            let sliver = if turn == Sign::Positive { [a, b, c] } else { [a, c, b] };
            // To the left of the border is the inside.
            assert_eq!(polygons.has_triangle(sliver), turn == Sign::Positive, "{a:?}");
            assert_eq!(polygons.has_exact_middle(sliver), turn == Sign::Positive, "{a:?}");
            let is_in = |first| is_strictly_in(sliver, inner_place(sliver, first), &mut predicates);
            (thin, exact) = (thin + 1, exact + i32::from(!(0..3).any(is_in)));
        }
        assert!(thin > 50 && exact > 5, "{thin}, {exact}");
        // Corners alone.
        let square = Polygons::new(&[vec![vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]]]);
        assert!(square.has_triangle([[0.0, 0.0], [4.0, 0.0], [2.0, 1.0]]));
        assert!(square.has_triangle([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]]));
        assert!(!square.has_triangle([[4.0, 0.0], [5.0, 2.0], [4.0, 4.0]]));
        for corners in [[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]], [[4.0, 0.0], [5.0, 2.0], [4.0, 4.0]]] {
            assert_eq!(square.has_exact_middle(corners), square.has_triangle(corners));
        }
    }
}
