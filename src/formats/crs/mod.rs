//! Coordinate reference systems: what well-known text and GeoTIFF keys mean, whether two systems mean the
//! same, and the keys of a GeoTIFF.
//!
//! [`System::of`] reads both encodings ([`Crs`]) into one [`System`]. Where a file states a code, the EPSG
//! dataset (crate `epsg-utils`) defines it; this crate does no geodesy.

mod compare;
mod epsg;
mod from_keys;
mod from_wkt;
mod keys;
mod methods;
mod names;
mod request;
mod system;
mod to_keys;
mod units;
mod wkt;

pub use compare::differences;
pub use keys::GeoKeys;
pub use request::requested;
pub use system::{Ellipsoid, Geographic, Horizontal, Kind, Projection, System, Vertical};
pub use to_keys::keys as geotiff_keys;
pub use units::Unit;

use spmesh_stream::Crs;

impl System {
    /// The system that `crs` encodes.
    pub fn of(crs: &Crs) -> System {
        match crs {
            Crs::Unknown => System::default(),
            Crs::Wkt(text) => from_wkt::system(text),
            Crs::GeoKeys { directory, doubles, ascii } => {
                from_keys::system(&GeoKeys::of_bytes(directory, doubles, ascii))
            }
        }
    }
}

impl From<&GeoKeys> for System {
    fn from(keys: &GeoKeys) -> System {
        from_keys::system(keys)
    }
}

/// A short name of `crs`: its EPSG codes ("EPSG:26910", "EPSG:2991+5703") where it states them, else the names
/// it gives itself.
pub fn name(crs: &Crs) -> Option<String> {
    System::of(crs).name()
}
