//! Points in a periodic box, and their images around it.

use super::lattice::{Lattice, Wrapped};
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::images_max;
use spmesh_delaunay::predicates::Point3;

/// Images this far beyond a margin are taken, too, in fractional coordinates: more than rounding.
const SLACK: f64 = 1e-7;

/// Points that a lattice repeats.
#[derive(Debug)]
pub(crate) struct Repeated {
    lattice: Lattice,
    points: Vec<Wrapped>,
}

/// An image of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Image {
    /// Index of the point.
    pub(crate) point: u32,
    /// Where it is, in vectors of the reduced basis from the point in the box.
    boxes: [i16; 3],
}

impl Repeated {
    /// Moves points into the box of a lattice.
    ///
    /// # Errors
    /// As [`Lattice::wrap`].
    pub(crate) fn new(lattice: Lattice, points: &[Point3]) -> Result<Repeated> {
        let points = points.iter().map(|&point| lattice.wrap(point)).collect::<Result<_>>()?;
        Ok(Repeated { lattice, points })
    }

    pub(crate) fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// The points in the box.
    pub(crate) fn in_box(&self) -> impl Iterator<Item = Point3> {
        self.points.iter().map(|point| point.at)
    }

    /// All images but the points themselves that lie in the box or at most `margins` beyond it, in fractional
    /// coordinates.
    ///
    /// # Errors
    /// Usage, if there are too many.
    pub(crate) fn images(&self, margins: Point3) -> Result<Vec<Image>> {
        let most = images_max(self.points.len());
        let copies: f64 = margins.iter().map(|margin| 1.0 + 2.0 * margin).product();
        let is_huge = margins.iter().any(|&margin| margin > f64::from(i16::MAX / 2));
        if is_huge || copies * self.points.len() as f64 > 2.0 * most as f64 {
            return Err(too_many(most));
        }
        let mut images = Vec::new();
        for (point, wrapped) in (0..).zip(&self.points) {
            let fraction = self.lattice.fraction(wrapped.at);
            let [i, j, k] = [0, 1, 2].map(|axis| {
                let margin = margins[axis] + SLACK;
                let (first, last) = (-margin - fraction[axis], 1.0 + margin - fraction[axis]);
                first.ceil() as i16..=last.floor() as i16
            });
            for boxes in i.flat_map(|i| {
                let k = k.clone();
                j.clone().flat_map(move |j| k.clone().map(move |k| [i, j, k]))
            }) {
                if boxes != [0; 3] {
                    images.push(Image { point, boxes });
                }
            }
            if images.len() > most {
                return Err(too_many(most));
            }
        }
        Ok(images)
    }

    /// Where an image is.
    pub(crate) fn place(&self, image: Image) -> Point3 {
        self.lattice.shifted(self.points[image.point as usize].at, image.boxes.map(i32::from))
    }

    /// How an image next to a point in the box differs from the points as they were stated: the image of
    /// point j next to point i is point j and so many of the stated vectors, next to point i.
    pub(crate) fn shift(&self, of: u32, image: Image) -> [i64; 3] {
        let [own, other] = [of, image.point].map(|point| self.points[point as usize].boxes);
        let boxes = [0, 1, 2].map(|axis| i64::from(image.boxes[axis]) - other[axis] + own[axis]);
        self.lattice.in_stated(boxes)
    }

    /// As [`Repeated::shift`], for a point in the box.
    pub(crate) fn shift_in_box(&self, of: u32, point: u32) -> [i64; 3] {
        self.shift(of, Image { point, boxes: [0; 3] })
    }
}

fn too_many(most: usize) -> Error {
    Error::usage(format!(
        "the box is so small or elongated that more than {most} images of its points would be needed: \
         repeat it along its short sides"
    ))
}
