//! What a picture shows of the world, and from where.

use super::projection::View;
use super::sheet::Sheet;
use crate::bounds::{Bounds, Point};
use crate::error::Result;
use crate::raster::Window;

/// The sheet, and the view of the world on it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stage {
    pub(super) sheet: Sheet,
    pub(super) view: View,
    /// What of the plane is seen, if not all of it.
    window: Option<Window>,
}

impl Stage {
    /// For what lies in a box of the world, seen from above, with so much around it; of a window, if there is one, just that.
    ///
    /// # Errors
    /// Usage, if coordinates are out of the range of numbers.
    pub(super) fn plan(bounds: &Bounds, window: Option<Window>, pad: f64, width: u32) -> Result<Stage> {
        let [min, max] = [bounds.min, bounds.max].map(|[x, y, _]| [x, y]);
        let (sheet, view) = match window {
            Some(Window { min, max }) => View::plan(min, max, 0.0, width)?,
            None => View::plan(min, max, pad, width)?,
        };
        Ok(Stage { sheet, view, window })
    }

    /// For what lies in a box of the world, seen from one side, wherever in the box it is.
    ///
    /// # Errors
    /// Usage, if coordinates are out of the range of numbers.
    pub(super) fn oblique(bounds: &Bounds, width: u32) -> Result<Stage> {
        let corner = |number: usize| {
            [0, 1, 2].map(|axis| if number >> axis & 1 == 0 { bounds.min[axis] } else { bounds.max[axis] })
        };
        Stage::oblique_of(bounds, (0..8).map(corner), width)
    }

    /// The same for some points in the box.
    ///
    /// # Errors
    /// Usage, if coordinates are out of the range of numbers.
    pub(super) fn oblique_of(
        bounds: &Bounds,
        points: impl Iterator<Item = Point>,
        width: u32,
    ) -> Result<Stage> {
        let (sheet, view) = View::oblique(bounds, points, width)?;
        Ok(Stage { sheet, view, window: None })
    }

    /// Whether something with these corners may be seen.
    pub(super) fn may_show(&self, corners: &[Point]) -> bool {
        let Some(Window { min, max }) = self.window else { return true };
        (0..2).all(|axis| {
            corners.iter().any(|corner| corner[axis] >= min[axis])
                && corners.iter().any(|corner| corner[axis] <= max[axis])
        })
    }
}
