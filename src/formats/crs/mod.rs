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
mod proj_string;
mod request;
mod system;
mod to_keys;
mod to_wkt1;
mod units;
mod wkt;

pub use compare::differences;
pub use keys::GeoKeys;
pub use proj_string::proj_string;
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

/// The definition of `crs` as well-known text: what it says, or what its EPSG codes say.
pub fn text(crs: &Crs) -> Option<String> {
    match crs {
        Crs::Unknown => None,
        Crs::Wkt(text) => Some(text.clone()),
        Crs::GeoKeys { .. } => {
            let system = System::of(crs);
            let horizontal =
                system.horizontal.filter(|known| compare::contradictions(known).is_empty())?.code?;
            match system.vertical.and_then(|heights| heights.code) {
                Some(vertical) => request::of_codes(&format!("{horizontal}+{vertical}")).ok(),
                None => epsg::text(horizontal).map(ToOwned::to_owned),
            }
        }
    }
}

/// The definition of `crs` as well-known text of version 1, if this can hold it.
pub fn text1(crs: &Crs) -> Option<String> {
    const WORDS: [&str; 3] = ["PROJCS[", "GEOGCS[", "COMPD_CS["];
    match crs {
        Crs::Wkt(text) if WORDS.iter().any(|word| text.starts_with(word)) => Some(text.clone()),
        _ => to_wkt1::text(&System::of(crs)),
    }
}

/// A short name of `crs`: its EPSG codes ("EPSG:26910", "EPSG:2991+5703") where it states them, else the
/// names it gives itself.
pub fn name(crs: &Crs) -> Option<String> {
    System::of(crs).name()
}
