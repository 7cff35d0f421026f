//! Passes over all points of an input.

use super::lattice::Lattice;
use super::stream::Stream;
use super::text::Text;
use super::volume::Volume;
use spmesh_core::error::{Error, Result};
use spmesh_model::cells4::Point4;

/// What gives points, as often as wanted.
#[derive(Debug)]
pub(super) enum Supply {
    Grid(Lattice),
    Text(Text),
    Stream(Stream),
    Volume(Volume),
}

impl Supply {
    /// Gives every point, and its value if there are values, to `visit`.
    ///
    /// # Errors
    /// If the input cannot be read or is malformed; or whatever `visit` returns.
    pub(super) fn scan(&self, visit: &mut dyn FnMut(Point4, Option<f64>) -> Result<()>) -> Result<()> {
        match self {
            Supply::Grid(lattice) => lattice.iter().try_for_each(|site| visit(site, None)),
            Supply::Text(text) => text.scan(visit),
            Supply::Stream(stream) => stream.scan(visit),
            Supply::Volume(volume) => volume.scan(visit),
        }
    }

    /// Whether points have values.
    pub(super) fn has_values(&self) -> bool {
        match self {
            Supply::Grid(_) => false,
            Supply::Text(text) => text.has_values(),
            Supply::Stream(stream) => stream.has_values,
            Supply::Volume(_) => true,
        }
    }

    /// Puts the sites of a volume where they are in the world.
    ///
    /// # Errors
    /// Usage, if that is not known or not along the axes. The coordinates of texts and streams are what they
    /// are.
    pub(super) fn place_in_world(&mut self) -> Result<()> {
        match self {
            Supply::Grid(_) => {
                Err(Error::usage("a grid without a file has no world units: leave --spacing away"))
            }
            Supply::Text(_) | Supply::Stream(_) => Ok(()),
            Supply::Volume(volume) => volume.place_in_world(),
        }
    }

    /// Whether coordinates are not exactly where the header of a volume states that they are.
    pub(super) fn is_rounded(&self) -> bool {
        matches!(self, Supply::Volume(volume) if !volume.lattice.is_exact())
    }
}
