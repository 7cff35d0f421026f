//! Volumes: a value for each site of a grid.

use super::data::Data;
use super::lattice::{Frame, Lattice};
use spmesh_core::error::{Error, Result};
use spmesh_model::cells4::Point4;

/// A volume whose header is read.
#[derive(Debug)]
pub(super) struct Volume {
    pub lattice: Lattice,
    pub data: Data,
    /// Values are `slope * stored + intercept`, unless they are what is stored.
    pub scaling: Option<[f64; 2]>,
    /// Where sites are in the world, or why that is not known.
    pub world: std::result::Result<Frame, String>,
}

impl Volume {
    /// Gives every site and its value to `visit`.
    ///
    /// # Errors
    /// If the values cannot be read; or whatever `visit` returns.
    pub(super) fn scan(&self, visit: &mut dyn FnMut(Point4, Option<f64>) -> Result<()>) -> Result<()> {
        let mut sites = self.lattice.iter();
        self.data.scan(self.lattice.sites(), &mut |values| {
            for (&stored, site) in values.iter().zip(&mut sites) {
                let value = self.scaling.map_or(stored, |[slope, intercept]| slope * stored + intercept);
                visit(site, Some(value))?;
            }
            Ok(())
        })
    }

    /// Puts the sites where they are in the world.
    ///
    /// # Errors
    /// Usage, if that is not known or not along the axes.
    pub(super) fn place_in_world(&mut self) -> Result<()> {
        match &self.world {
            Ok(frame) => self.lattice.place(*frame),
            Err(reason) => Err(Error::usage(format!("{reason}: coordinates can only be grid indices"))),
        }
    }
}
