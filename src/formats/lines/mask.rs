//! Masks: the union of polygons.

use crate::lines::rings::Polygon;
use spmesh_stream::model::points::Point2;

/// An area of the plane: everything inside or on the border of one of its polygons, in world coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Mask {
    /// The polygons, at least one.
    pub polygons: Vec<Polygon>,
}

impl Mask {
    /// All edges, with the number of their polygon; those of one polygon in a row.
    pub fn edges<'a>(&'a self) -> impl Iterator<Item = (u32, [Point2; 2])> + 'a {
        (0..).zip(&self.polygons).flat_map(|(number, polygon)| {
            let ends = move |ring: &'a Vec<Point2>| {
                let next = ring.iter().cycle().skip(1);
                ring.iter().zip(next).map(move |(&from, &to)| (number, [from, to]))
            };
            polygon.iter().flat_map(ends)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_go_around_each_ring() {
        let corner = vec![[1.0, 1.0], [2.0, 1.0], [1.0, 2.0]];
        let mask = Mask { polygons: vec![vec![corner]] };
        let edges: Vec<_> = mask.edges().collect();
        let [a, b, c] = [[1.0, 1.0], [2.0, 1.0], [1.0, 2.0]];
        assert_eq!(edges, [(0, [a, b]), (0, [b, c]), (0, [c, a])]);
    }
}
