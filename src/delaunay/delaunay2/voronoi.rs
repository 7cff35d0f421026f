//! Voronoi cells within a box.

use super::triangulation::Triangulation;
use crate::predicates::Point2;

impl Triangulation {
    /// The part of a box, from its lower to its upper corner, that is nearer to point `v` than to others:
    /// a convex polygon, counterclockwise, empty if there is none. Duplicates have the cell of their vertex.
    ///
    /// The cells of all vertices cover the box. Each border is off by a few units in the last place of the
    /// distances of the point from the corners of the box. Cells that are narrower than that may vanish.
    ///
    /// Domain: differences of coordinates, those of `bounds` included, do not overflow.
    ///
    /// Cost: O(1) for each neighbour and corner of the polygon before; more for duplicates, which are
    /// located.
    ///
    /// # Panics
    /// If there is no such point.
    pub fn voronoi_cell(&self, v: u32, bounds: [[f64; 2]; 2]) -> Vec<Point2> {
        let at = self.points[v as usize];
        let [low, high] = bounds.map(|corner| [corner[0] - at[0], corner[1] - at[1]]);
        if !(low[0] <= high[0] && low[1] <= high[1]) {
            return Vec::new();
        }
        let mut cell = vec![low, [high[0], low[1]], high, [low[0], high[1]]];
        let mut clipped = Vec::new();
        for neighbour in self.cell_neighbours(v) {
            let p = self.points[neighbour as usize];
            clip(&cell, [p[0] - at[0], p[1] - at[1]], &mut clipped);
            std::mem::swap(&mut cell, &mut clipped);
        }
        cell.iter_mut().for_each(|corner| *corner = [at[0] + corner[0], at[1] + corner[1]]);
        cell.dedup();
        if cell.len() > 1 && cell.first() == cell.last() {
            cell.pop();
        }
        cell
    }

    /// The vertices whose cells border on that of point `v`.
    fn cell_neighbours(&self, v: u32) -> Vec<u32> {
        let neighbours: Vec<u32> = self.star(v).collect();
        if !neighbours.is_empty() {
            return neighbours;
        }
        let at = self.points[v as usize];
        if !self.triangles.triangles().is_empty() {
            let vertex = self.nearest(at).expect("a vertex");
            return self.star(vertex).collect();
        }
        let place = self.place_on_line(at).expect("each point is at a vertex");
        let hull = &self.triangles.hull;
        let beside = [place.checked_sub(1), Some(place + 1)].into_iter().flatten();
        beside.filter_map(|place| hull.get(place).copied()).collect()
    }
}

/// Clips a convex polygon to the points that are nearer to the origin than to `other`.
///
/// Source: Sutherland and Hodgman, "Reentrant polygon clipping", 1974.
fn clip(polygon: &[[f64; 2]], other: [f64; 2], clipped: &mut Vec<[f64; 2]>) {
    let length = other[0].hypot(other[1]);
    let direction = other.map(|coordinate| coordinate / length);
    // How far beyond the bisector.
    let excess = |p: [f64; 2]| p[0] * direction[0] + p[1] * direction[1] - 0.5 * length;
    clipped.clear();
    for (place, &p) in polygon.iter().enumerate() {
        let q = polygon[(place + 1) % polygon.len()];
        let (of_p, of_q) = (excess(p), excess(q));
        if of_p <= 0.0 {
            clipped.push(p);
        }
        if (of_p < 0.0 && of_q > 0.0) || (of_p > 0.0 && of_q < 0.0) {
            let part = of_p / (of_p - of_q);
            clipped.push([0, 1].map(|axis| p[axis] + part * (q[axis] - p[axis])));
        }
    }
}
