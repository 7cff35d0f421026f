//! The part of the world that a picture shows, and the view of it.

use super::projection::{PAD, View};
use super::sheet::Sheet;
use spmesh_base::error::Result;
use spmesh_formats::raster::Window;
use spmesh_stream::model::bounds::{Bounds, Point};

/// A sheet, and the view of the world on it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scene {
    pub(super) sheet: Sheet,
    pub(super) view: View,
    /// The part of the plane that is visible; all of it if `None`.
    window: Option<Window>,
    /// The margin inside the map. Units: lengths of the picture.
    pad: f64,
}

impl Scene {
    /// A box of the world from above, with a margin of `pad` around it; or just the window, if there is one.
    pub(super) fn plan(bounds: &Bounds, window: Option<Window>, pad: f64, width: u32) -> Result<Scene> {
        let [min, max] = [bounds.min, bounds.max].map(|[x, y, _]| [x, y]);
        let (min, max, pad) = window.map_or((min, max, pad), |Window { min, max }| (min, max, 0.0));
        let (sheet, view) = View::plan(min, max, pad, width)?;
        Ok(Scene { sheet, view, window, pad })
    }

    /// An oblique view with room for all of a box of the world.
    pub(super) fn oblique(bounds: &Bounds, width: u32) -> Result<Scene> {
        let corner = |number: usize| {
            [0, 1, 2].map(|axis| if number >> axis & 1 == 0 { bounds.min[axis] } else { bounds.max[axis] })
        };
        Scene::oblique_of(bounds, (0..8).map(corner), width)
    }

    /// An oblique view of a box, with room for the given points in it.
    pub(super) fn oblique_of(
        bounds: &Bounds,
        points: impl Iterator<Item = Point>,
        width: u32,
    ) -> Result<Scene> {
        let (sheet, view) = View::oblique(bounds, points, width)?;
        Ok(Scene { sheet, view, window: None, pad: PAD })
    }

    /// The left, upper, right and lower side of the map on the sheet, without its margin.
    pub(super) fn sides(&self) -> [f64; 4] {
        let ([x, y], [width, height]) = (self.sheet.corner, self.sheet.size.map(|size| size as f64));
        [x + self.pad, y + self.pad, x + width - self.pad, y + height - self.pad]
    }

    /// Whether something with these corners may be visible.
    pub(super) fn may_show(&self, corners: &[Point]) -> bool {
        let Some(Window { min, max }) = self.window else { return true };
        (0..2).all(|axis| {
            corners.iter().any(|corner| corner[axis] >= min[axis])
                && corners.iter().any(|corner| corner[axis] <= max[axis])
        })
    }
}
