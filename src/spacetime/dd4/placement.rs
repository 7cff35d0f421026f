//! Between the coordinates of an input and those of its diagram.

use std::str::FromStr;

use crate::slices::{Slice, Surface};
use spmesh_base::error::{Error, Result};
use spmesh_formats::volumes::Orientation;
use spmesh_stream::model::cells4::Point4;

/// The factor that scales times against space: positive and finite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeScale(f64);

impl Default for TimeScale {
    fn default() -> Self {
        TimeScale(1.0)
    }
}

impl FromStr for TimeScale {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let scale = text.parse().ok().filter(|scale: &f64| scale.is_normal() && *scale > 0.0);
        scale.map(TimeScale).ok_or_else(|| format!("{text:?} is not a number above 0, like 2.5"))
    }
}

/// How the coordinates of a diagram follow from those of the input: times are scaled, and an oblique grid has
/// distances along its axes. Sites, times of slices, and meshes in space are in coordinates of the input;
/// streams hold those of the diagram, of which it is exact.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Placement {
    /// Where an oblique grid lies in the world.
    pub orientation: Option<Orientation>,
    /// The factor of times.
    pub time_scale: TimeScale,
}

impl Placement {
    /// Scales the times of points.
    pub(super) fn scale(&self, points: &mut [Point4]) -> Result<()> {
        let TimeScale(scale) = self.time_scale;
        for point in points {
            let time = point[3] * scale;
            if !time.is_finite() {
                let message = format!("the time {} times {scale} is beyond all numbers", point[3]);
                return Err(Error::usage(message));
            }
            // Adding 0.0 turns -0.0 into 0.0: a negative time may be scaled to nothing.
            point[3] = time + 0.0;
        }
        Ok(())
    }

    /// The time of the diagram at a time of the input.
    pub(super) fn time(&self, time: f64) -> f64 {
        time * self.time_scale.0
    }

    /// The site of the diagram at a site of the input.
    pub(super) fn site(&self, site: Point4) -> Point4 {
        let [x, y, z, t] = self.orientation.map_or(site, |orientation| orientation.point_to_grid(site));
        [x, y, z, self.time(t)]
    }

    /// Moves a slice of the diagram to the coordinates of the input.
    pub(super) fn place_slice(&self, slice: &mut Slice, time: f64) {
        slice.time = time;
        let Some(orientation) = self.orientation else { return };
        slice.points.iter_mut().for_each(|point| *point = orientation.to_world(*point));
        if orientation.is_mirrored() {
            slice.tetrahedra.iter_mut().for_each(|corners| corners.swap(2, 3));
        }
    }

    /// Moves a surface of the diagram likewise; it still faces lower values.
    pub(super) fn place_surface(&self, surface: &mut Surface) {
        let Some(orientation) = self.orientation else { return };
        surface.points.iter_mut().for_each(|point| *point = orientation.to_world(*point));
        if orientation.is_mirrored() {
            surface.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
    }

    /// Notices about a stream, which holds the coordinates of the diagram.
    pub(super) fn stream_notices(&self) -> Vec<String> {
        let TimeScale(scale) = self.time_scale;
        let scaled =
            (scale != 1.0).then(|| format!("times in the stream are {scale} times those of the input"));
        let oblique = self.orientation.map(|_| {
            "the grid is oblique in the world: x, y and z in the stream are distances from the first voxel along \
             the axes of the grid. Slices, surfaces and values that are made of the volume itself are in world \
             coordinates"
                .to_string()
        });
        oblique.into_iter().chain(scaled).collect()
    }
}
