//! Volumes: a value for each site of a grid.

use crate::volumes::data::Data;
use crate::volumes::lattice::Lattice;
use crate::volumes::orientation::Orientation;
use crate::volumes::world::World;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::cells4::Point4;

/// A volume whose header has been read.
#[derive(Debug)]
pub(crate) struct Volume {
    pub lattice: Lattice,
    pub data: Data,
    /// Slope and intercept: values are `slope * stored + intercept`. `None` if values are stored directly.
    pub scaling: Option<[f64; 2]>,
    /// World coordinates of the sites, or why they are not known.
    pub world: std::result::Result<World, String>,
    /// The units of world coordinates, for a notice, if the header states any.
    pub units: Option<String>,
}

/// What to say about units, of lengths along several axes and of times.
pub(crate) fn units_of(mut lengths: Vec<String>, times: &[String]) -> Option<String> {
    lengths.dedup();
    let list = |units: &[String]| Some(units.join(", ")).filter(|units| !units.is_empty());
    let (lengths, times) = (list(&lengths), list(times));
    let lengths = lengths.map(|units| format!("lengths are in {units}"));
    let times = times.map(|units| format!("times are in {units}"));
    let both: Vec<String> = lengths.into_iter().chain(times).collect();
    (!both.is_empty())
        .then(|| format!("world coordinates are in the units of the header: {}", both.join(", ")))
}

impl Volume {
    /// Passes every site and its value to `visit`. Returns a warning if the file holds other bytes too.
    pub(crate) fn scan(
        &self,
        visit: &mut dyn FnMut(Point4, Option<f64>) -> Result<()>,
    ) -> Result<Option<String>> {
        let mut sites = self.lattice.iter();
        self.data.scan(self.lattice.sites(), &mut |values| {
            for (&stored, site) in values.iter().zip(&mut sites) {
                let value = self.scaling.map_or(stored, |[slope, intercept]| slope * stored + intercept);
                visit(site, Some(value))?;
            }
            Ok(())
        })
    }

    /// Gives the sites their world coordinates, or those along the axes of an oblique grid.
    pub(crate) fn place_in_world(&mut self) -> Result<Option<Orientation>> {
        match &self.world {
            Ok(world) => {
                self.lattice.place(world.coordinates, world.frame)?;
                Ok(world.orientation)
            }
            Err(reason) => Err(Error::usage(format!("{reason}: coordinates can only be grid indices"))),
        }
    }
}
