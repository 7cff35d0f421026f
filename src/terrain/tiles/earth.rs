//! Places on the Earth: from the coordinates of a mesh to longitude, latitude and height on WGS 84, and to X,
//! Y and Z from its centre.

use proj4rs::Proj;
use proj4rs::transform::transform;

use super::scheme::Place;
use spmesh_base::error::{Error, Result};
use spmesh_formats::crs::{Kind, System, proj_string};
use spmesh_stream::model::bounds::Point;

/// The semi-major axis of WGS 84. Units: metres.
pub(super) const SEMI_MAJOR: f64 = 6_378_137.0;
/// The inverse of its flattening.
const INVERSE_FLATTENING: f64 = 298.257_223_563;

/// The semi-minor axis.
pub(super) const SEMI_MINOR: f64 = SEMI_MAJOR * (1.0 - 1.0 / INVERSE_FLATTENING);

/// What takes coordinates of a mesh to places.
pub(super) struct ToPlaces {
    /// The projection, and longitude and latitude on its ellipsoid; `None` if these are the coordinates.
    projection: Option<(Proj, Proj)>,
    /// Degrees, for coordinates that are angles.
    unit: f64,
    /// Longitude of the prime meridian.
    meridian: f64,
    /// Metres.
    height_unit: f64,
}

impl ToPlaces {
    /// From coordinates of a system, with a notice about what is taken for granted.
    ///
    /// # Errors
    /// Usage, if the system is not known, or is none that this is possible for.
    pub(super) fn of(system: &System) -> Result<(ToPlaces, Option<String>)> {
        let what = "the mesh does not say its coordinate reference system: give it with --crs, as EPSG:25832";
        let horizontal = system.horizontal.as_ref().ok_or_else(|| Error::usage(what))?;
        let refused = |why: String| {
            let name = system.name().unwrap_or_default();
            Error::usage(format!(
                "{name}: {why}: transform the points first, for example with pdal or gdalwarp"
            ))
        };
        let base = horizontal.base().ok_or_else(|| refused("its definition is not known".into()))?;
        let ellipsoid = &base.ellipsoid;
        let is_global = ellipsoid.semi_major == SEMI_MAJOR
            && (ellipsoid.inverse_flattening - INVERSE_FLATTENING).abs() < 1e-3;
        if !is_global {
            return Err(refused(format!("its datum {} is not near WGS 84", base.datum)));
        }
        let projection = match &horizontal.kind {
            Kind::Geographic(_) => None,
            Kind::Projected(..) => {
                let (from, to) = proj_string(horizontal)
                    .ok_or_else(|| refused("its projection is none that this program inverts".into()))?;
                let proj = |text: &str| Proj::from_proj_string(text).map_err(|e| refused(e.to_string()));
                Some((proj(&from)?, proj(&to)?))
            }
            _ => {
                return Err(refused(
                    "its coordinates are no map projection, nor longitude and latitude".into(),
                ));
            }
        };
        let vertical = system.vertical.as_ref();
        let height_unit = vertical
            .map_or(1.0, |vertical| if vertical.is_depth { -vertical.unit.size } else { vertical.unit.size });
        let unit = if projection.is_none() { horizontal.unit.size.to_degrees() } else { 1.0 };
        let is_wgs84 = system.is_wgs84() || base.datum_code == Some(6326);
        let datum = (!is_wgs84).then(|| {
            format!("the datum {} is taken as WGS 84, from which it may differ by up to 2 m", base.datum)
        });
        Ok((ToPlaces { projection, unit, meridian: base.meridian, height_unit }, datum))
    }

    /// Metres in a unit of heights; negative for depths.
    pub(super) fn height_unit(&self) -> f64 {
        self.height_unit
    }

    /// The place of a point of the world.
    ///
    /// # Errors
    /// Malformed, if there is none.
    pub(super) fn place(&self, [x, y, z]: Point) -> Result<Place> {
        let mut place = (x * self.unit, y * self.unit, 0.0);
        if let Some((from, to)) = &self.projection {
            place = (x, y, 0.0);
            transform(from, to, &mut place).map_err(|e| outside([x, y], &e.to_string()))?;
            (place.0, place.1) = (place.0.to_degrees(), place.1.to_degrees());
        }
        let (longitude, latitude) = (place.0 + self.meridian, place.1);
        if !(longitude.abs() <= 180.0 && latitude.abs() <= 90.0) {
            return Err(outside([x, y], "it is not on the Earth"));
        }
        Ok([longitude, latitude, z * self.height_unit])
    }
}

fn outside([x, y]: [f64; 2], why: &str) -> Error {
    Error::malformed(format!("the vertex at {x} {y} has no longitude and latitude: {why}; is the CRS right?"))
}

/// X, Y and Z from the centre of the Earth. Units: metres.
pub(super) fn geocentric([longitude, latitude, height]: Place) -> Point {
    let (longitude, latitude) = (longitude.to_radians(), latitude.to_radians());
    let squared = 1.0 - (SEMI_MINOR / SEMI_MAJOR).powi(2);
    let normal = SEMI_MAJOR / (1.0 - squared * latitude.sin().powi(2)).sqrt();
    let across = (normal + height) * latitude.cos();
    [across * longitude.cos(), across * longitude.sin(), (normal * (1.0 - squared) + height) * latitude.sin()]
}
