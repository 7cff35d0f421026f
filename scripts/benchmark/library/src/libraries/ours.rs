//! This project's library.

use super::{Library, Order};
use spmesh_delaunay::Location;
use spmesh_delaunay::delaunay2::interpolation::{Linear, NaturalNeighbours};
use spmesh_delaunay::delaunay2::{NONE, Triangulation, triangulate};
use std::num::NonZeroUsize;

/// A triangulation, and heights by index.
pub struct Ours {
    mesh: Triangulation,
    heights: Vec<f64>,
}

impl Ours {
    pub fn new(points: &[[f64; 3]]) -> Ours {
        let places: Vec<[f64; 2]> = points.iter().map(|&[x, y, _]| [x, y]).collect();
        let mesh = triangulate(&places).expect("finite points");
        Ours { mesh, heights: points.iter().map(|point| point[2]).collect() }
    }
}

impl Library for Ours {
    fn triangles(&self) -> usize {
        self.mesh.triangles().len()
    }

    fn locate(&mut self, targets: &[[f64; 2]], order: Order) -> Option<usize> {
        let starts = (order == Order::Random).then(|| self.mesh.starts());
        let mut last = 0;
        let is_inside = |&&target: &&[f64; 2]| {
            let start = starts.as_ref().map_or(last, |starts| starts.near(target));
            let location = self.mesh.locate_from(target, start);
            if let Location::Simplex(number) = location {
                last = number;
            }
            location != Location::Outside
        };
        Some(targets.iter().filter(is_inside).count())
    }

    fn locate_all(&mut self, targets: &[[f64; 2]]) -> Option<usize> {
        let found = self.mesh.locate_all(targets, NonZeroUsize::MIN);
        Some(found.iter().filter(|&&number| number != NONE).count())
    }

    fn linear(&mut self, targets: &[[f64; 2]]) -> Option<Vec<f64>> {
        let mut linear = Linear::new(&self.mesh);
        let value = |&target| linear.interpolate(&self.heights, target).unwrap_or(f64::NAN);
        Some(targets.iter().map(value).collect())
    }

    fn natural(&mut self, targets: &[[f64; 2]], _: Order) -> Option<Vec<f64>> {
        let mut natural = NaturalNeighbours::new(&self.mesh);
        let value = |&target| natural.interpolate(&self.heights, target).unwrap_or(f64::NAN);
        Some(targets.iter().map(value).collect())
    }

    fn insert(&mut self, points: &[[f64; 3]]) -> Option<()> {
        for &[x, y, _] in points {
            self.mesh.insert([x, y]).expect("a finite point");
        }
        Some(())
    }
}
