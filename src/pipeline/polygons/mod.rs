//! Where places lie among polygons: strictly inside of one, on a border, or outside of all.
//!
//! Cells of a grid without an edge are inside or outside as a whole, which is decided once. In the
//! others, each polygon that may have the place is tested exactly (`rows`).

mod cells;
mod rows;
mod triangle;

use spmesh_stream::model::points::Point2;

use cells::Cells;
use rows::Rows;

/// A polygon: its rings, by the even-odd rule. A ring does not repeat its first vertex at the end.
pub type Rings = Vec<Vec<Point2>>;

/// Where a place lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Side {
    /// Outside of all polygons.
    Outside = 1,
    /// On an edge of one of them, and strictly inside of none.
    Border = 2,
    /// Strictly inside of one at least: inside by the even-odd rule of its rings, and on no edge of it.
    Inside = 3,
}

/// Bytes of an edge, and of a polygon beside its edges, while polygons are read.
const EDGE_BYTES: usize = 130;
const POLYGON_BYTES: usize = 420;

/// The union of polygons.
///
/// Shape: about 150 bytes for an edge, and at most 32 MiB of cells.
///
/// Cost: a look at a cell for most places, and a few exact signs for those near edges.
#[derive(Debug)]
pub struct Polygons {
    rows: Rows,
    cells: Cells,
}

impl Polygons {
    /// The union of polygons. Polygons may overlap, lie in each other, and cross themselves.
    ///
    /// # Panics
    /// If there are 2^32 edges or more.
    ///
    /// Domain: coordinates are finite.
    pub fn new(polygons: &[Rings]) -> Polygons {
        let of_ring = |ring: &Vec<Point2>| {
            let ring = ring.clone();
            (0..ring.len()).map(move |from| [ring[from], ring[(from + 1) % ring.len()]])
        };
        let of_polygon = |(number, rings): (u32, &Rings)| {
            let edges: Vec<_> = rings.iter().flat_map(of_ring).map(|edge| (number, edge)).collect();
            edges
        };
        Polygons::of_edges((0..).zip(polygons).flat_map(of_polygon))
    }

    /// The union of polygons by their edges: the number of the polygon and the ends of each. The edges of a
    /// polygon come one after the other.
    ///
    /// # Panics
    /// As [`Polygons::new`].
    pub fn of_edges(edges: impl Iterator<Item = (u32, [Point2; 2])>) -> Polygons {
        let rows = Rows::new(edges);
        let cells = Cells::new(&rows.edges, |place| rows.side(place));
        Polygons { rows, cells }
    }

    /// Number of edges, and the bytes that they take.
    pub fn size(&self) -> (usize, u64) {
        let (edges, polygons) = (self.rows.edges.len(), self.rows.polygons());
        (edges, Polygons::bytes(edges, polygons) + self.cells.len() as u64)
    }

    /// Bytes for so many edges and polygons, beside those of cells.
    pub fn bytes(edges: usize, polygons: usize) -> u64 {
        (EDGE_BYTES * edges + POLYGON_BYTES * polygons) as u64
    }

    /// Where a place lies. Exact for all finite coordinates.
    pub fn side(&self, place: Point2) -> Side {
        self.cells.side(place).unwrap_or_else(|| self.rows.side(place))
    }

    /// Calls `found` with the numbers of the polygons that have a place strictly inside, in increasing order.
    pub fn for_each_around(&self, place: Point2, mut found: impl FnMut(u32)) {
        if self.cells.side(place) == Some(Side::Outside) {
            return;
        }
        let inside = self.rows.at(place).filter(|(_, side)| *side == Side::Inside);
        inside.for_each(|(polygon, _)| found(polygon));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(low: f64, high: f64) -> Vec<Point2> {
        vec![[low, low], [high, low], [high, high], [low, high]]
    }

    #[test]
    fn borders_holes_and_islands_are_told_apart() {
        let nested = vec![square(0.0, 10.0), square(2.0, 8.0), square(4.0, 6.0)];
        let polygons = Polygons::new(&[nested, vec![square(20.0, 30.0)], vec![square(25.0, 35.0)]]);
        for (place, side) in [
            ([1.0, 1.0], Side::Inside),
            ([0.0, 0.0], Side::Border),
            ([2.0, 5.0], Side::Border),
            ([3.0, 5.0], Side::Outside),
            ([5.0, 5.0], Side::Inside),
            ([10.0, 5.0], Side::Border),
            ([5.0, 8.0], Side::Border),
            ([10.000_000_000_000_002, 5.0], Side::Outside),
            ([25.0, 27.0], Side::Inside),
            ([30.0, 30.0], Side::Inside),
            ([20.0, 22.0], Side::Border),
            ([36.0, 22.0], Side::Outside),
            ([1e308, -1e308], Side::Outside),
        ] {
            assert_eq!(polygons.side(place), side, "{place:?}");
        }
        let mut around = Vec::new();
        polygons.for_each_around([26.0, 26.0], |polygon| around.push(polygon));
        assert_eq!(around, [1, 2]);
    }

    #[test]
    fn extreme_coordinates_are_exact() {
        for size in [1e-320, 1e-300, 1.0, 1e300, 1.5e308] {
            let ring = vec![[-size, -size], [size, -size], [size, size]];
            let polygons = Polygons::new(&[vec![ring]]);
            assert_eq!(polygons.side([size * 0.5, size * 0.5]), Side::Border, "{size}");
            assert_eq!(polygons.side([size * 0.5, size * 0.25]), Side::Inside, "{size}");
            assert_eq!(polygons.side([size * 0.25, size * 0.5]), Side::Outside, "{size}");
        }
        // A ring without area has a border alone.
        let polygons =
            Polygons::new(&[vec![vec![[1.0, 1.0], [3.0, 1.0], [2.0, 1.0]]], vec![vec![[5.0, 5.0]]]]);
        assert_eq!(polygons.side([2.5, 1.0]), Side::Border);
        assert_eq!(polygons.side([2.5, 1.5]), Side::Outside);
        assert_eq!(polygons.side([5.0, 5.0]), Side::Border);
        assert_eq!(Polygons::new(&[]).side([0.0, 0.0]), Side::Outside);
    }

    /// Squares that cover a fifth of the unit square, in rows and columns of `side`.
    fn squares(side: usize) -> Vec<Rings> {
        let length = 1.0 / side as f64;
        let corner = |at: usize| [(at % side) as f64 * length, (at / side) as f64 * length];
        let ring = |[x, y]: Point2| {
            [[0.0, 0.0], [0.45, 0.0], [0.45, 0.4], [0.0, 0.4]].map(|[u, v]| [x + length * u, y + length * v])
        };
        (0..side * side).map(|at| vec![ring(corner(at)).to_vec()]).collect()
    }

    /// The polygons that tests of places in the unit square look at.
    fn work(polygons: &[Rings]) -> usize {
        let polygons = Polygons::new(polygons);
        let places =
            (0..10_000).map(|i| f64::from(i) * 0.618_034).map(|x| [x.fract(), (x * 0.754_877).fract()]);
        let one = |place: Point2| {
            1 + if polygons.cells.side(place).is_some() { 0 } else { polygons.rows.work(place) }
        };
        places.map(one).sum()
    }

    #[test]
    fn far_vertices_at_most_triple_the_work() {
        let near = squares(40);
        let ordinary = work(&near);
        assert!(work(&squares(57)) < 2 * ordinary);
        for far in [-1e12, -30.0, 3.0, 1e3, 1e6, 1e9, 1e12] {
            let triangle = |a: f64| vec![[a, 0.3 * a], [a + 1.0, 0.3 * a], [a, 0.3 * a + 1.0]];
            // A polygon of its own, and a vertex of one nearby.
            let thorn = vec![[0.9, 0.99], [far, 0.5 + far], [0.95, 0.99]];
            for ring in [triangle(far), thorn] {
                let with = work(&[&near[..], &[vec![ring.clone()]]].concat());
                assert!(with < 3 * ordinary, "{far} {ring:?}: {with} instead of {ordinary}");
            }
        }
    }
}
