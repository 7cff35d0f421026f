//! Systems from the GeoTIFF keys of LAS files.
//!
//! Sources: OGC GeoTIFF 1.1; GeoTIFF 1.0, section 6.3, for codes of older files.

use crate::crs::epsg;
use crate::crs::keys::{self, GeoKeys};
use crate::crs::methods::{Dimension, Method, Role};
use crate::crs::system::{Ellipsoid, Geographic, Horizontal, Kind, Projection, System, Vertical};
use crate::crs::units::Unit;

/// Codes of ellipsoids that GeoTIFF 1.0 used for heights above them.
const ELLIPSOIDAL_HEIGHTS: std::ops::RangeInclusive<u16> = 5001..=5033;
/// Codes of datums that GeoTIFF 1.0 used for heights, with the codes of the EPSG dataset.
const OLD_HEIGHTS: [(u16, u16); 6] =
    [(5101, 5701), (5102, 5702), (5103, 5703), (5104, 5736), (5105, 5705), (5106, 5706)];

/// The system that `keys` define.
pub(crate) fn system(keys: &GeoKeys) -> System {
    let citations = [keys::PROJECTED_CITATION, keys::CITATION, keys::GEODETIC_CITATION];
    let title = citations.iter().find_map(|&key| keys.text(key));
    let mut system = System { title, ..System::default() };
    system.horizontal = system.horizontal_of(keys);
    if system.horizontal.is_none() && system.remarks.is_empty() {
        system.remarks.push("its GeoTIFF keys do not say what x and y are".to_string());
    }
    system.vertical = system.vertical.take().or_else(|| system.vertical_of(keys));
    system
}

impl System {
    fn horizontal_of(&mut self, keys: &GeoKeys) -> Option<Horizontal> {
        self.check_unit(keys);
        if let Some(code) = keys.code(keys::PROJECTED) {
            return Some(self.of_code(keys, code));
        }
        let method = keys.short(keys::METHOD);
        if keys.short(keys::PROJECTED).is_some() || method.is_some() {
            return self.user_defined(keys);
        }
        let model = keys.short(keys::MODEL_TYPE);
        if model == Some(keys::PROJECTED_MODEL) {
            return self.local(keys);
        }
        // Without a type, coordinates that have a unit of lengths are no degrees either.
        if !matches!(model, Some(keys::GEOGRAPHIC_MODEL | keys::GEOCENTRIC_MODEL))
            && length_unit(keys).is_some()
            && let Some(local) = self.local(keys)
        {
            return Some(local);
        }
        if let Some(code) = keys.code(keys::GEODETIC) {
            return Some(self.of_code(keys, code));
        }
        let base = geographic(keys)?;
        let unit = base.unit.clone();
        Some(Horizontal { name: base.name.clone(), code: None, kind: Kind::Geographic(base), unit })
    }

    /// The system of an EPSG code, which says more than the other keys.
    fn of_code(&mut self, keys: &GeoKeys, code: u16) -> Horizontal {
        let code = u32::from(code);
        let Some(known) = epsg::system(code) else {
            let is_geodetic = keys.code(keys::PROJECTED).is_none();
            let unit = if is_geodetic { Some(Unit::degree()) } else { length_unit(keys) };
            let unit = unit.unwrap_or_else(Unit::metre);
            self.remarks.push(format!("EPSG:{code} is not in the EPSG dataset that spmesh knows"));
            let name = self.title.clone().unwrap_or_else(|| format!("EPSG:{code}"));
            return Horizontal { name, code: Some(code), kind: Kind::Unresolved, unit };
        };
        self.vertical = known.vertical;
        let mut horizontal = known.horizontal.unwrap_or_else(|| Horizontal {
            name: format!("EPSG:{code}"),
            code: Some(code),
            kind: Kind::Unresolved,
            unit: Unit::metre(),
        });
        let is_geocentric = matches!(horizontal.kind, Kind::Geocentric(_));
        if keys.short(keys::MODEL_TYPE) == Some(keys::GEOCENTRIC_MODEL) && !is_geocentric {
            self.remarks.push(format!(
                "key 1024 calls the coordinates geocentric, but EPSG:{code} ({}) is not: taking the key",
                horizontal.name
            ));
            if let Some(base) = horizontal.base().cloned() {
                horizontal = Horizontal {
                    name: format!("{} (geocentric)", horizontal.name),
                    code: None,
                    kind: Kind::Geocentric(base),
                    unit: Unit::metre(),
                };
            }
        }
        if let Some(unit) = length_unit(keys)
            && matches!(horizontal.kind, Kind::Projected(..))
            && !unit.is_same(&horizontal.unit)
        {
            self.remarks.push(format!(
                "the unit of key 3076 is {unit}, that of EPSG:{code} is {}: taking the key",
                horizontal.unit
            ));
            horizontal.code = None;
            horizontal.unit = unit;
        }
        horizontal
    }

    fn user_defined(&mut self, keys: &GeoKeys) -> Option<Horizontal> {
        let base = keys.code(keys::GEODETIC).and_then(|code| epsg::system(code.into()));
        let base = base.and_then(|system| system.horizontal?.base().cloned()).or_else(|| geographic(keys));
        let angles = keys.code(keys::ANGLE_UNIT).and_then(Unit::of_code);
        let base = base.map(|base| Geographic { unit: angles.unwrap_or(base.unit.clone()), ..base });
        let name = keys.text(keys::PROJECTED_CITATION).or_else(|| keys.text(keys::CITATION));
        let name = name.unwrap_or_else(|| "unnamed".into());
        let (Some(base), Some(number)) = (base, keys.code(keys::METHOD)) else {
            self.remarks.push(format!("the keys of {name:?} define no projection on a datum"));
            return None;
        };
        let unit = length_unit(keys).unwrap_or_else(Unit::metre);
        let in_base_unit = |role: Role, value: f64| match role.dimension() {
            Dimension::Angle => base.unit.degrees(value),
            Dimension::Length => value * unit.size,
            Dimension::Ratio => value,
        };
        let mut parameters: Vec<(Role, f64)> = keys
            .keys()
            .filter_map(|[key, ..]| Some((Role::of_key(key)?, keys.double(key)?)))
            .map(|(role, value)| (role, in_base_unit(role, value)))
            .collect();
        let method = Method::of_geotiff(number, &parameters);
        if let Some(method) = method {
            method.own_roles(&mut parameters);
        }
        let method_name =
            method.map_or_else(|| format!("method {number} of GeoTIFF"), |method| method.name.into());
        let projection = Projection { method_name, method, parameters, others: Vec::new() };
        Some(Horizontal { name, code: None, kind: Kind::Projected(base, projection), unit })
    }

    /// A projected system of which no projection is known, as GDAL takes it: with a name and a unit.
    fn local(&mut self, keys: &GeoKeys) -> Option<Horizontal> {
        let name = keys.text(keys::PROJECTED_CITATION).or_else(|| keys.text(keys::CITATION))?;
        self.remarks
            .push(format!("its GeoTIFF keys name the projected system {name:?}, but do not define it"));
        let unit = length_unit(keys).unwrap_or_else(Unit::metre);
        Some(Horizontal { name, code: None, kind: Kind::Unresolved, unit })
    }

    fn vertical_of(&mut self, keys: &GeoKeys) -> Option<Vertical> {
        let unit = keys.code(keys::VERTICAL_UNIT).and_then(Unit::of_code);
        let name = keys.text(keys::VERTICAL_CITATION);
        let Some(code) = keys.code(keys::VERTICAL) else {
            let datum_code = keys.code(keys::VERTICAL_DATUM).map(u32::from);
            let name = name.unwrap_or_else(|| "unknown".into());
            return Some(Vertical {
                datum: name.clone(),
                name,
                code: None,
                datum_code,
                unit: unit?,
                is_ellipsoidal: false,
                is_depth: false,
            });
        };
        let code = OLD_HEIGHTS.iter().find(|old| old.0 == code).map_or(code, |old| old.1);
        if ELLIPSOIDAL_HEIGHTS.contains(&code) {
            return Some(Vertical::ellipsoidal(unit.unwrap_or_else(Unit::metre)));
        }
        let Some(mut known) = epsg::system(code.into()).and_then(|system| system.vertical) else {
            self.remarks.push(format!("EPSG:{code} in key 4096 is no system of heights that spmesh knows"));
            let unit = unit.unwrap_or_else(Unit::metre);
            let name = name.unwrap_or_else(|| format!("EPSG:{code}"));
            return Some(Vertical { name, code: Some(code.into()), unit, ..Vertical::unnamed() });
        };
        if let Some(unit) = unit.filter(|unit| !unit.is_same(&known.unit)) {
            self.remarks.push(format!(
                "the unit of key 4099 is {unit}, that of EPSG:{code} ({}) is {}: taking the key",
                known.name, known.unit
            ));
            known = Vertical { unit, code: None, ..known };
            known.code = epsg::vertical_code(&known);
        }
        Some(known)
    }

    /// Remarks on a code of a unit that is none.
    fn check_unit(&mut self, keys: &GeoKeys) {
        let is_unit = |code| Unit::of_code(code).is_some() || (9000..9300).contains(&code);
        if let Some(code) = keys.code(keys::LENGTH_UNIT).filter(|&code| !is_unit(code)) {
            let known = epsg::system(code.into()).and_then(|system| system.name());
            let advice = known.map_or(String::new(), |name| format!("; {name} is a system: --crs {name}"));
            self.remarks.push(format!("key 3076 holds {code}, which is no unit{advice}"));
        }
    }
}

impl Vertical {
    fn unnamed() -> Vertical {
        Vertical {
            name: String::new(),
            code: None,
            datum: String::new(),
            datum_code: None,
            unit: Unit::metre(),
            is_ellipsoidal: false,
            is_depth: false,
        }
    }
}

/// The geographic system that keys define by the code of a datum or the axes of an ellipsoid.
fn geographic(keys: &GeoKeys) -> Option<Geographic> {
    let citation = keys.text(keys::GEODETIC_CITATION).unwrap_or_else(|| "unknown".into());
    let part = |title: &str| {
        let rest = citation.split('|').find_map(|part| part.trim().strip_prefix(title))?;
        Some(rest.trim_start_matches([' ', '=']).to_string())
    };
    let size = keys.double(keys::ANGLE_UNIT_SIZE).map(|size| Unit::angle("unknown", size));
    let unit = keys.code(keys::ANGLE_UNIT).and_then(Unit::of_code).or(size).unwrap_or_else(Unit::degree);
    let known = keys.code(keys::DATUM).and_then(|code| epsg::geographic_of_datum(code.into()));
    let semi_major = keys.double(keys::SEMI_MAJOR);
    let inverse = keys.double(keys::INVERSE_FLATTENING).or_else(|| {
        let (a, b) = (semi_major?, keys.double(keys::SEMI_MINOR)?);
        Some(if a == b { 0. } else { a / (a - b) })
    });
    let ellipsoid = match (&known, semi_major, inverse) {
        (Some(known), ..) => known.ellipsoid.clone(),
        (None, Some(semi_major), Some(inverse_flattening)) => Ellipsoid {
            name: part("Ellipsoid").unwrap_or_else(|| "unknown".into()),
            semi_major,
            inverse_flattening,
        },
        _ => return None,
    };
    let name = part("GCS Name").unwrap_or_else(|| citation.split('|').next().unwrap_or_default().to_string());
    Some(Geographic {
        name,
        code: known.as_ref().and_then(|known| known.code),
        datum: part("Datum")
            .or(known.as_ref().map(|known| known.datum.clone()))
            .unwrap_or_else(|| "unknown".into()),
        datum_code: known.and_then(|known| known.datum_code),
        ellipsoid,
        meridian: unit.degrees(keys.double(keys::MERIDIAN_LONGITUDE).unwrap_or(0.)),
        unit,
    })
}

fn length_unit(keys: &GeoKeys) -> Option<Unit> {
    let size = keys.double(keys::LENGTH_UNIT_SIZE).filter(|&size| size > 0.);
    keys.code(keys::LENGTH_UNIT).and_then(Unit::of_code).or(size.map(|size| Unit::length("unknown", size)))
}
