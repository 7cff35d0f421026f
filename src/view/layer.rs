//! Triangles or points that are drawn one by one while they are few, and painted as pixels when they are
//! many.

use super::canvas::Canvas;
use super::options::Form;
use super::projection::Scene;
use super::style::Style;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::{Bounds, Point};

/// Above this many triangles or points, they are painted by default. An SVG of this many triangles has 2 MB.
const VECTORS_MAX: usize = 20_000;

/// A triangle or a point.
pub(super) trait Drawable {
    /// Its corners, in world coordinates.
    fn corners(&self) -> &[Point];

    fn paint(&self, canvas: &mut Canvas, scene: &Scene, style: &Style);
}

/// All triangles, or all points.
///
/// Memory: the items that are kept, or the pixels.
#[derive(Debug)]
pub(super) struct Layer<T> {
    form: Form,
    pub(super) kept: Vec<T>,
    pub(super) canvas: Option<Canvas>,
    /// The number of items that [`Layer::push_few`] took.
    count: usize,
    /// The box of all items.
    pub(super) bounds: Option<Bounds>,
}

impl<T: Drawable> Layer<T> {
    pub(super) fn new(form: Form) -> Layer<T> {
        Layer { form, kept: Vec::new(), canvas: None, count: 0, bounds: None }
    }

    /// Takes an item; the scene is `None` as long as the box of all items is unknown.
    pub(super) fn push(&mut self, item: T, scene: Option<&Scene>, style: &Style) -> Result<()> {
        for &corner in item.corners() {
            self.bounds.get_or_insert(Bounds::of_point(corner)).extend(corner);
        }
        if scene.is_some_and(|scene| !scene.may_show(item.corners())) {
            return Ok(());
        }
        if let (Some(canvas), Some(scene)) = (&mut self.canvas, scene) {
            item.paint(canvas, scene, style);
            return Ok(());
        }
        self.kept.push(item);
        let most = match self.form {
            Form::Auto => VECTORS_MAX,
            Form::Vector => usize::MAX,
            Form::Raster if scene.is_some() => 0,
            // Painted at the end, when the box is known.
            Form::Raster => VECTORS_MAX,
        };
        if self.kept.len() > most { self.paint_kept(scene, style) } else { Ok(()) }
    }

    /// Takes an item that decorates a picture of something else; drops all of them when there are many.
    pub(super) fn push_few(&mut self, item: T, scene: &Scene) {
        self.count += 1;
        if self.count > VECTORS_MAX {
            self.kept = Vec::new();
        } else if scene.may_show(item.corners()) {
            self.kept.push(item);
        }
    }

    /// The pixels of the kept items, if [`Form::Raster`] asks for pixels and none were painted yet.
    pub(super) fn painted(&self, scene: &Scene, style: &Style) -> Option<Canvas> {
        if self.canvas.is_some() || self.form != Form::Raster {
            return None;
        }
        Some(paint(&self.kept, scene, style))
    }

    fn paint_kept(&mut self, scene: Option<&Scene>, style: &Style) -> Result<()> {
        let Some(scene) = scene else {
            return Err(Error::usage(format!(
                "the header does not state the bounds of the stream, and there are more than {VECTORS_MAX} \
                 triangles or points: give --bounds, or a file instead of a pipe"
            )));
        };
        self.canvas = Some(paint(&self.kept, scene, style));
        self.kept = Vec::new();
        Ok(())
    }
}

fn paint<T: Drawable>(items: &[T], scene: &Scene, style: &Style) -> Canvas {
    let sheet = &scene.sheet;
    let mut canvas = Canvas::new(sheet.corner, sheet.size, scene.view.frame().is_none());
    items.iter().for_each(|item| item.paint(&mut canvas, scene, style));
    canvas
}
