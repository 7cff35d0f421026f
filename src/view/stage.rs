//! What a picture shows of the world, and from where.

use super::projection::{PAD, View};
use super::sheet::Sheet;
use spmesh_core::error::Result;
use spmesh_io::raster::Window;
use spmesh_model::bounds::{Bounds, Point};

/// The sheet, and the view of the world on it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stage {
    pub(super) sheet: Sheet,
    pub(super) view: View,
    /// What of the plane is seen, if not all of it.
    window: Option<Window>,
    /// What is left free around all that is seen. Units: those of the picture.
    pad: f64,
}

impl Stage {
    /// For what lies in a box of the world, seen from above, with so much around it; of a window, if there is one, just that.
    ///
    /// # Errors
    /// Usage, if coordinates are out of the range of numbers.
    pub(super) fn plan(bounds: &Bounds, window: Option<Window>, pad: f64, width: u32) -> Result<Stage> {
        let [min, max] = [bounds.min, bounds.max].map(|[x, y, _]| [x, y]);
        let (min, max, pad) = window.map_or((min, max, pad), |Window { min, max }| (min, max, 0.0));
        let (sheet, view) = View::plan(min, max, pad, width)?;
        Ok(Stage { sheet, view, window, pad })
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
        Ok(Stage { sheet, view, window: None, pad: PAD })
    }

    /// Left, upper, right and lower side of where things are on the sheet.
    pub(super) fn sides(&self) -> [f64; 4] {
        let ([x, y], [width, height]) = (self.sheet.corner, self.sheet.size.map(|size| size as f64));
        [x + self.pad, y + self.pad, x + width - self.pad, y + height - self.pad]
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
