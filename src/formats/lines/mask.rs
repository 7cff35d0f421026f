//! Masks: the union of polygons.

use crate::lines::rings::Polygon;
use spmesh_stream::model::bounds::Bounds;
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

    /// The box around all polygons, and `margin` beyond, infinitely high; none for polygons without corners.
    pub fn window(&self, margin: f64) -> Option<Bounds> {
        let corners = self.polygons.iter().flatten().flatten().map(|&[x, y]| Bounds::of_point([x, y, 0.0]));
        let Bounds { min, max } = corners.reduce(Bounds::union)?;
        let [x, y] = [0, 1].map(|axis| [min[axis] - margin, max[axis] + margin]);
        Some(Bounds::over([x[0], y[0]], [x[1], y[1]]))
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
