//! `startin`, without snapping to near points.

use super::{Library, Order};
use startin::interpolation::{Interpolant, NNI, TIN};
use startin::{InsertionStrategy, StartinError, Triangulation};

pub struct Startin(Triangulation);

impl Startin {
    /// Jumps before each walk: without them, points in random order take O(sqrt n) steps each.
    pub fn new(points: &[[f64; 3]]) -> Startin {
        let mut triangulation = Triangulation::new();
        triangulation.set_snap_tolerance(f64::MIN_POSITIVE);
        triangulation.set_jump_and_walk(true);
        triangulation.insert(&points.to_vec(), InsertionStrategy::AsIs);
        Startin(triangulation)
    }
}

fn values(found: Vec<Result<f64, StartinError>>) -> Option<Vec<f64>> {
    Some(found.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect())
}

impl Library for Startin {
    fn triangles(&self) -> usize {
        self.0.number_of_triangles()
    }

    fn locate(&mut self, targets: &[[f64; 2]], order: Order) -> Option<usize> {
        self.0.set_jump_and_walk(order == Order::Random);
        Some(targets.iter().filter(|[x, y]| self.0.locate(*x, *y).is_ok()).count())
    }

    fn linear(&mut self, targets: &[[f64; 2]]) -> Option<Vec<f64>> {
        values(TIN {}.interpolate(&mut self.0, &targets.to_vec()))
    }

    fn natural(&mut self, targets: &[[f64; 2]], order: Order) -> Option<Vec<f64>> {
        self.0.set_jump_and_walk(order == Order::Random);
        // Areas of all cells beforehand pay off if there are about as many targets as points.
        let precompute = order == Order::Raster;
        values(NNI { precompute }.interpolate(&mut self.0, &targets.to_vec()))
    }

    fn insert(&mut self, points: &[[f64; 3]]) -> Option<()> {
        self.0.set_jump_and_walk(true);
        for &[x, y, height] in points {
            // An error tells of a duplicate.
            let _ = self.0.insert_one_pt(x, y, height);
        }
        Some(())
    }
}
