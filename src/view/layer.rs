//! Things that are drawn as they are as long as they are few, and painted when they are many.

use super::Form;
use super::canvas::Canvas;
use super::look::Look;
use super::stage::Stage;
use spmesh_core::error::{Error, Result};
use spmesh_model::bounds::{Bounds, Point};

/// More triangles or points than these are painted, unless it is said how: an SVG of as many triangles has 2 MB.
const VECTORS_MAX: usize = 20_000;

/// What can be painted.
pub(super) trait Thing {
    /// Its corners in the world.
    fn corners(&self) -> &[Point];

    /// Paints it.
    fn paint(&self, canvas: &mut Canvas, stage: &Stage, look: &Look);
}

/// Things of one sort.
///
/// Memory: the things that are kept, or the pixels.
#[derive(Debug)]
pub(super) struct Layer<T> {
    form: Form,
    pub(super) kept: Vec<T>,
    pub(super) canvas: Option<Canvas>,
    /// How many came that are shown beside others.
    count: usize,
    /// The box of all that came.
    pub(super) bounds: Option<Bounds>,
}

impl<T: Thing> Layer<T> {
    pub(super) fn new(form: Form) -> Layer<T> {
        Layer { form, kept: Vec::new(), canvas: None, count: 0, bounds: None }
    }

    /// Takes a thing; the stage is `None` as long as it is not known where all of them are.
    ///
    /// # Errors
    /// Usage, if there are too many to be kept until that is known.
    pub(super) fn push(&mut self, thing: T, stage: Option<&Stage>, look: &Look) -> Result<()> {
        for &corner in thing.corners() {
            self.bounds.get_or_insert(Bounds::of_point(corner)).extend(corner);
        }
        if stage.is_some_and(|stage| !stage.may_show(thing.corners())) {
            return Ok(());
        }
        if let (Some(canvas), Some(stage)) = (&mut self.canvas, stage) {
            thing.paint(canvas, stage, look);
            return Ok(());
        }
        self.kept.push(thing);
        let most = match self.form {
            Form::Auto => VECTORS_MAX,
            Form::Vector => usize::MAX,
            Form::Raster if stage.is_some() => 0,
            // Painted at the end, when it is known where they are.
            Form::Raster => VECTORS_MAX,
        };
        if self.kept.len() > most { self.paint_kept(stage, look) } else { Ok(()) }
    }

    /// Takes a thing that is shown beside others, as long as there are few.
    pub(super) fn push_few(&mut self, thing: T, stage: &Stage) {
        self.count += 1;
        if self.count > VECTORS_MAX {
            self.kept = Vec::new();
        } else if stage.may_show(thing.corners()) {
            self.kept.push(thing);
        }
    }

    /// The pixels of what was painted; with [`Form::Raster`], of what was kept.
    pub(super) fn painted(&self, stage: &Stage, look: &Look) -> Option<Canvas> {
        if self.canvas.is_some() || self.form != Form::Raster {
            return None;
        }
        Some(paint(&self.kept, stage, look))
    }

    fn paint_kept(&mut self, stage: Option<&Stage>, look: &Look) -> Result<()> {
        let Some(stage) = stage else {
            return Err(Error::usage(format!(
                "the header does not say where the stream lies, and there are more than {VECTORS_MAX} triangles or \
                 points: give --bounds, or a file instead of a pipe"
            )));
        };
        self.canvas = Some(paint(&self.kept, stage, look));
        self.kept = Vec::new();
        Ok(())
    }
}

fn paint<T: Thing>(things: &[T], stage: &Stage, look: &Look) -> Canvas {
    let sheet = &stage.sheet;
    let mut canvas = Canvas::new(sheet.corner, sheet.size, stage.view.frame().is_none());
    things.iter().for_each(|thing| thing.paint(&mut canvas, stage, look));
    canvas
}
