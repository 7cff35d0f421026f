//! Passes over all points of an input.

use crate::volumes::lattice::Lattice;
use crate::volumes::orientation::Orientation;
use crate::volumes::stream::Stream;
use crate::volumes::text::Text;
use crate::volumes::volume::Volume;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::cells4::Point4;

/// A source of points that can be scanned any number of times.
#[derive(Debug)]
pub(crate) enum Supply {
    Grid(Lattice),
    Text(Text),
    Stream(Stream),
    Volume(Box<Volume>),
}

impl Supply {
    pub(crate) fn of_volume(volume: Volume) -> Supply {
        Supply::Volume(Box::new(volume))
    }

    /// The units of world coordinates, for a notice.
    pub(crate) fn units(&self) -> Option<String> {
        match self {
            Supply::Volume(volume) => volume.units.clone(),
            _ => None,
        }
    }

    /// Passes every point, with its value if there are values, to `visit`. Returns a warning if the input
    /// holds more than the points.
    pub(crate) fn scan(
        &self,
        visit: &mut dyn FnMut(Point4, Option<f64>) -> Result<()>,
    ) -> Result<Option<String>> {
        match self {
            Supply::Grid(lattice) => lattice.iter().try_for_each(|site| visit(site, None))?,
            Supply::Text(text) => text.scan(visit)?,
            Supply::Stream(stream) => stream.scan(visit)?,
            Supply::Volume(volume) => return volume.scan(visit),
        }
        Ok(None)
    }

    /// Whether points have values.
    pub(crate) fn has_values(&self) -> bool {
        match self {
            Supply::Grid(_) => false,
            Supply::Text(text) => text.has_values(),
            Supply::Stream(stream) => stream.has_values,
            Supply::Volume(_) => true,
        }
    }

    /// Gives the sites of a volume their world coordinates, or those along the axes of an oblique grid, and
    /// returns how that lies in the world. Coordinates of texts and streams stay unchanged.
    pub(crate) fn place_in_world(&mut self) -> Result<Option<Orientation>> {
        match self {
            Supply::Grid(_) => {
                Err(Error::usage("a grid without a file has no world units: leave --spacing away"))
            }
            Supply::Text(_) | Supply::Stream(_) => Ok(None),
            Supply::Volume(volume) => volume.place_in_world(),
        }
    }

    /// Whether rounding moves sites of a volume from the coordinates that its header states.
    pub(crate) fn is_rounded(&self) -> bool {
        matches!(self, Supply::Volume(volume) if !volume.lattice.is_exact())
    }
}
