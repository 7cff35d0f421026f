//! `spade`, whose walks start at the last vertex or at one that a hierarchy of triangulations finds.

use super::{Library, Order};
use spade::{
    DelaunayTriangulation, FloatTriangulation as _, HasPosition, HintGenerator, Point2,
    PositionInTriangulation, Triangulation as _,
};

pub struct Vertex {
    position: Point2<f64>,
    height: f64,
}

impl HasPosition for Vertex {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.position
    }
}

impl Vertex {
    fn new(&[x, y, height]: &[f64; 3]) -> Vertex {
        Vertex { position: Point2::new(x, y), height }
    }
}

/// A triangulation with its heights.
pub struct Spade<H: HintGenerator<f64>> {
    mesh: DelaunayTriangulation<Vertex, (), (), (), H>,
    /// Whether targets in no order take a few steps each; without a hierarchy they take O(sqrt n).
    has_hierarchy: bool,
}

impl<H: HintGenerator<f64>> Spade<H> {
    pub fn new(points: &[[f64; 3]], has_hierarchy: bool) -> Spade<H> {
        let vertices = points.iter().map(Vertex::new).collect();
        Spade { mesh: DelaunayTriangulation::bulk_load(vertices).expect("finite points"), has_hierarchy }
    }

    fn is_for(&self, order: Order) -> bool {
        self.has_hierarchy || order == Order::Raster
    }
}

impl<H: HintGenerator<f64>> Library for Spade<H> {
    fn triangles(&self) -> usize {
        self.mesh.num_inner_faces()
    }

    fn locate(&mut self, targets: &[[f64; 2]], order: Order) -> Option<usize> {
        if !self.is_for(order) {
            return None;
        }
        let is_inside = |&&[x, y]: &&[f64; 2]| {
            let position = self.mesh.locate(Point2::new(x, y));
            !matches!(
                position,
                PositionInTriangulation::OutsideOfConvexHull(_) | PositionInTriangulation::NoTriangulation
            )
        };
        Some(targets.iter().filter(is_inside).count())
    }

    fn linear(&mut self, targets: &[[f64; 2]]) -> Option<Vec<f64>> {
        if !self.is_for(Order::Random) {
            return None;
        }
        let linear = self.mesh.barycentric();
        let value = |&[x, y]: &[f64; 2]| linear.interpolate(|v| v.data().height, Point2::new(x, y));
        Some(targets.iter().map(|target| value(target).unwrap_or(f64::NAN)).collect())
    }

    fn natural(&mut self, targets: &[[f64; 2]], order: Order) -> Option<Vec<f64>> {
        if !self.is_for(order) {
            return None;
        }
        let natural = self.mesh.natural_neighbor();
        let value = |&[x, y]: &[f64; 2]| natural.interpolate(|v| v.data().height, Point2::new(x, y));
        Some(targets.iter().map(|target| value(target).unwrap_or(f64::NAN)).collect())
    }

    fn insert(&mut self, points: &[[f64; 3]]) -> Option<()> {
        if !self.is_for(Order::Random) {
            return None;
        }
        for point in points {
            self.mesh.insert(Vertex::new(point)).expect("a finite point");
        }
        Some(())
    }
}
