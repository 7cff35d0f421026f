//! GeoTIFF keys of a system.
//!
//! Source: OGC GeoTIFF 1.1. Systems with a code are written as their code, others with user-defined keys.
//! What keys cannot say is reported.

use crate::crs::compare::contradictions;
use crate::crs::epsg;
use crate::crs::keys::{self, GeoKeys, USER_DEFINED};
use crate::crs::methods::Dimension;
use crate::crs::system::{Geographic, Horizontal, Kind, Projection, System, Vertical};
use crate::crs::units::Unit;

/// The header of a directory: version, revision, minor revision. Readers such as GDAL take vertical keys into
/// account from minor revision 1 on.
const HEADER: [u16; 3] = [1, 1, 1];
/// Codes that keys can hold.
const CODES: std::ops::RangeInclusive<u32> = 1024..=32766;
const PIXEL_IS_AREA: u16 = 1;
/// EPSG code of the meridian of Greenwich.
const GREENWICH: u16 = 8901;

/// The keys of `system`, for cells as areas, with those of its vertical part if values are elevations and it
/// is more than a unit, which a raster states of its values; and what they leave out, each as a sentence for
/// users. There are no keys if they cannot hold the system of x and y.
pub fn keys(system: &System, are_elevations: bool) -> (GeoKeys, Vec<String>) {
    let mut writer = Writer::default();
    let is_stated = |vertical: &&Vertical| are_elevations && !vertical.is_only_unit();
    match (&system.horizontal, system.vertical.as_ref().filter(is_stated)) {
        (Some(horizontal), vertical) => writer.both(horizontal, vertical),
        (None, Some(vertical)) => writer.lose(format!(
            "a GeoTIFF cannot hold the system of elevations ({}) without that of x and y",
            vertical.name
        )),
        (None, None) => {}
    }
    (writer.keys, writer.losses)
}

#[derive(Default)]
struct Writer {
    keys: GeoKeys,
    losses: Vec<String>,
}

impl Writer {
    fn lose(&mut self, what: String) {
        self.losses.push(what);
    }

    fn both(&mut self, horizontal: &Horizontal, vertical: Option<&Vertical>) {
        self.horizontal(horizontal);
        // Without keys of a system, readers would take any other key for a local system.
        if self.keys.directory.is_empty() {
            return;
        }
        self.keys.add_short(keys::RASTER_TYPE, PIXEL_IS_AREA);
        self.citation(horizontal);
        if let Some(vertical) = vertical {
            self.vertical(vertical, horizontal);
        }
        self.keys.sort();
    }

    fn horizontal(&mut self, system: &Horizontal) {
        let model = match system.kind {
            Kind::Geographic(_) => keys::GEOGRAPHIC_MODEL,
            Kind::Geocentric(_) => keys::GEOCENTRIC_MODEL,
            Kind::Unresolved if system.is_angular() => keys::GEOGRAPHIC_MODEL,
            Kind::Projected(..) | Kind::Unresolved => keys::PROJECTED_MODEL,
        };
        if model == keys::GEOCENTRIC_MODEL {
            return self.lose(format!("a GeoTIFF cannot hold the geocentric system {:?}", system.name));
        }
        let contradictions = contradictions(system);
        if let Some(code) = system.code.filter(|code| CODES.contains(code) && contradictions.is_empty()) {
            let key = if model == keys::PROJECTED_MODEL { keys::PROJECTED } else { keys::GEODETIC };
            self.keys.add_short(keys::MODEL_TYPE, model);
            return self.keys.add_short(key, code as u16);
        }
        if let (Some(code), false) = (system.code, contradictions.is_empty()) {
            self.lose(format!(
                "its definition differs from EPSG:{code}, the code that it states, in {}: writing the definition \
                 without the code",
                contradictions.join(", ")
            ));
        }
        let name = &system.name;
        match &system.kind {
            Kind::Geographic(base) => {
                self.keys.add_short(keys::MODEL_TYPE, model);
                self.geographic(base);
            }
            Kind::Projected(base, projection) => self.projected(system, base, projection),
            // A local system, of which only the name is known.
            Kind::Unresolved if model == keys::PROJECTED_MODEL && system.code.is_none() => {
                self.keys.add_short(keys::MODEL_TYPE, model);
                self.keys.add_text(keys::CITATION, std::slice::from_ref(name));
                self.unit(&system.unit, keys::LENGTH_UNIT, keys::LENGTH_UNIT_SIZE);
            }
            Kind::Geocentric(_) | Kind::Unresolved => {
                self.lose(format!("a GeoTIFF cannot hold {name:?}, of which only the name is known"))
            }
        }
    }

    /// What people call the system, for programs that show it.
    fn citation(&mut self, system: &Horizontal) {
        let is_there = self.keys.directory.as_chunks::<4>().0.iter().any(|own| own[0] == keys::CITATION);
        if !is_there && !system.name.is_empty() {
            self.keys.add_text(keys::CITATION, std::slice::from_ref(&system.name));
        }
    }

    fn projected(&mut self, system: &Horizontal, base: &Geographic, projection: &Projection) {
        let name = &system.name;
        let number = projection.method.and_then(|method| Some((method, method.geotiff?)));
        let Some((method, number)) = number else {
            let method = &projection.method_name;
            return self.lose(format!("a GeoTIFF cannot hold the projection {method:?} of {name:?}"));
        };
        if !projection.others.is_empty() {
            let others = projection.others.join(", ");
            self.lose(format!("a GeoTIFF cannot hold these parameters of {name:?}: {others}"));
        }
        self.keys.add_short(keys::MODEL_TYPE, keys::PROJECTED_MODEL);
        self.keys.add_short(keys::PROJECTED, USER_DEFINED);
        self.keys.add_text(keys::PROJECTED_CITATION, std::slice::from_ref(name));
        self.geographic(base);
        self.keys.add_short(keys::CONVERSION, USER_DEFINED);
        self.keys.add_short(keys::METHOD, number);
        self.unit(&system.unit, keys::LENGTH_UNIT, keys::LENGTH_UNIT_SIZE);
        for &(role, key) in method.parameters {
            let value = projection.value(role);
            self.keys.add_double(
                key,
                match role.dimension() {
                    Dimension::Angle => base.unit.of_degrees(value),
                    Dimension::Length => value / system.unit.size,
                    Dimension::Ratio => value,
                },
            );
        }
    }

    fn geographic(&mut self, base: &Geographic) {
        let code = base.code.or_else(|| epsg::geographic_code(base));
        if let Some(code) = code.filter(|code| CODES.contains(code)) {
            return self.keys.add_short(keys::GEODETIC, code as u16);
        }
        let (name, datum, ellipsoid) = (&base.name, &base.datum, &base.ellipsoid);
        let citation = [
            format!("GCS Name = {name}"),
            format!("Datum = {datum}"),
            format!("Ellipsoid = {}", ellipsoid.name),
            format!("Primem = {}", if base.meridian == 0. { "Greenwich" } else { "unknown" }),
        ];
        self.keys.add_short(keys::GEODETIC, USER_DEFINED);
        self.keys.add_text(keys::GEODETIC_CITATION, &citation);
        let datum_code = base.datum_code.filter(|code| CODES.contains(code)).map(|code| code as u16);
        self.keys.add_short(keys::DATUM, datum_code.unwrap_or(USER_DEFINED));
        self.keys.add_short(keys::ELLIPSOID, USER_DEFINED);
        self.keys.add_double(keys::SEMI_MAJOR, ellipsoid.semi_major);
        // A sphere has no inverse flattening; its other axis says so.
        match ellipsoid.inverse_flattening {
            0. => self.keys.add_double(keys::SEMI_MINOR, ellipsoid.semi_major),
            inverse => self.keys.add_double(keys::INVERSE_FLATTENING, inverse),
        }
        self.unit(&base.unit, keys::ANGLE_UNIT, keys::ANGLE_UNIT_SIZE);
        let meridian = if base.meridian == 0. { GREENWICH } else { USER_DEFINED };
        self.keys.add_short(keys::MERIDIAN, meridian);
        if base.meridian != 0. {
            self.keys.add_double(keys::MERIDIAN_LONGITUDE, base.unit.of_degrees(base.meridian));
        }
    }

    fn vertical(&mut self, system: &Vertical, horizontal: &Horizontal) {
        if system.is_ellipsoidal {
            return self.ellipsoidal(system, horizontal);
        }
        let code = system.code.or_else(|| epsg::vertical_code(system));
        if let Some(code) = code.filter(|code| CODES.contains(code)) {
            return self.keys.add_short(keys::VERTICAL, code as u16);
        }
        let name = &system.name;
        let Some(unit) = system.unit.code else {
            let unit = &system.unit;
            return self.lose(format!("a GeoTIFF cannot hold the unit of elevations ({unit}) of {name:?}"));
        };
        if system.is_depth {
            self.lose(format!("a GeoTIFF cannot say that {name:?} states depths"));
        }
        let datum = system.datum_code.filter(|code| CODES.contains(code));
        self.keys.add_short(keys::VERTICAL, USER_DEFINED);
        self.keys.add_text(keys::VERTICAL_CITATION, std::slice::from_ref(name));
        self.keys.add_short(keys::VERTICAL_DATUM, datum.map_or(USER_DEFINED, |code| code as u16));
        self.keys.add_short(keys::VERTICAL_UNIT, unit);
    }

    /// Heights above the ellipsoid: the code of a geographic system in three dimensions with the same datum.
    fn ellipsoidal(&mut self, system: &Vertical, horizontal: &Horizontal) {
        let is_metre = system.unit.is_same(&Unit::metre());
        let solid = horizontal.base().filter(|_| is_metre).and_then(epsg::solid_code);
        match (solid, &horizontal.kind) {
            (Some(code), Kind::Geographic(_)) => self.keys.replace(keys::GEODETIC, code as u16),
            (Some(code), _) => self.keys.add_short(keys::VERTICAL, code as u16),
            (None, _) => {
                let unit = &system.unit;
                self.lose(format!("a GeoTIFF cannot hold elevations above this ellipsoid, in {unit}"));
            }
        }
    }

    fn unit(&mut self, unit: &Unit, key: u16, size: u16) {
        self.keys.add_short(key, unit.code.unwrap_or(USER_DEFINED));
        if unit.code.is_none() {
            self.keys.add_double(size, unit.size);
        }
    }
}

impl GeoKeys {
    /// Sorts the keys by number, as the standard demands, and puts the header before them.
    fn sort(&mut self) {
        let mut keys = self.directory.as_chunks::<4>().0.to_vec();
        keys.sort_unstable();
        let header = [HEADER[0], HEADER[1], HEADER[2], keys.len() as u16];
        self.directory = [&header, keys.as_flattened()].concat();
    }

    fn replace(&mut self, key: u16, value: u16) {
        self.directory
            .as_chunks_mut::<4>()
            .0
            .iter_mut()
            .filter(|own| own[0] == key)
            .for_each(|own| own[3] = value);
    }
}
