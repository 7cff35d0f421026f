//! What a coordinate reference system means, whatever it is written in.

use crate::crs::methods::{Method, Role};
use crate::crs::names::{is_empty, is_same_datum};
use crate::crs::units::Unit;

/// The meaning of a coordinate reference system.
///
/// Coordinates are easting and northing, or longitude and latitude, in this order, as in LAS and GeoTIFF files.
/// The order of axes that a definition states is of no concern.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct System {
    /// What x and y are.
    pub horizontal: Option<Horizontal>,
    /// What z is.
    pub vertical: Option<Vertical>,
    /// The name of the whole definition, whatever it defines.
    pub title: Option<String>,
    /// What was strange where the system came from, each as a sentence for users.
    pub remarks: Vec<String>,
}

/// A system of x and y.
#[derive(Debug, Clone, PartialEq)]
pub struct Horizontal {
    /// Its name.
    pub name: String,
    /// Its EPSG code.
    pub code: Option<u32>,
    /// What kind it is, with its definition.
    pub kind: Kind,
    /// The unit of x and y.
    pub unit: Unit,
}

/// Kinds of horizontal systems.
#[derive(Debug, Clone, PartialEq)]
pub enum Kind {
    /// Longitude and latitude.
    Geographic(Geographic),
    /// Easting and northing of a map projection.
    Projected(Geographic, Projection),
    /// X, Y and Z from the centre of the Earth.
    Geocentric(Geographic),
    /// Only the EPSG code or a name is known.
    Unresolved,
}

/// A datum with its prime meridian.
#[derive(Debug, Clone, PartialEq)]
pub struct Geographic {
    /// Name of the geographic system.
    pub name: String,
    /// EPSG code of the geographic system.
    pub code: Option<u32>,
    /// Name of the datum.
    pub datum: String,
    /// EPSG code of the datum.
    pub datum_code: Option<u32>,
    /// Its ellipsoid.
    pub ellipsoid: Ellipsoid,
    /// Longitude of the prime meridian, in degrees from Greenwich.
    pub meridian: f64,
    /// Unit of longitude and latitude.
    pub unit: Unit,
}

/// An ellipsoid of revolution.
#[derive(Debug, Clone, PartialEq)]
pub struct Ellipsoid {
    /// Its name.
    pub name: String,
    /// Semi-major axis in metres.
    pub semi_major: f64,
    /// The inverse of the flattening; 0 for spheres.
    pub inverse_flattening: f64,
}

/// A map projection.
#[derive(Debug, Clone, PartialEq)]
pub struct Projection {
    /// The name of its method.
    pub method_name: String,
    /// Its method, if it is one of [`METHODS`](crate::crs::methods).
    pub(crate) method: Option<&'static Method>,
    /// Its parameters: in degrees, metres, or without a unit.
    pub(crate) parameters: Vec<(Role, f64)>,
    /// Names of parameters that no role is known for.
    pub(crate) others: Vec<String>,
}

/// A system of heights or depths.
#[derive(Debug, Clone, PartialEq)]
pub struct Vertical {
    /// Its name.
    pub name: String,
    /// Its EPSG code.
    pub code: Option<u32>,
    /// Name of its datum.
    pub datum: String,
    /// EPSG code of its datum.
    pub datum_code: Option<u32>,
    /// The unit of z.
    pub unit: Unit,
    /// Whether heights are above the ellipsoid of the horizontal system.
    pub is_ellipsoidal: bool,
    /// Whether z points down.
    pub is_depth: bool,
}

impl System {
    /// A short name: codes as in `EPSG:2991+5703` where they are known, else names.
    pub fn name(&self) -> Option<String> {
        let horizontal = self.horizontal.as_ref().map(Horizontal::short_name);
        let says_more = |vertical: &&Vertical| !vertical.is_part_of(self) && !vertical.is_only_unit();
        let Some(vertical) = self.vertical.as_ref().filter(says_more) else {
            return horizontal.or_else(|| self.title.clone());
        };
        Some(match (self.horizontal.as_ref().and_then(|known| known.code), vertical.code) {
            (Some(_), Some(code)) => format!("{}+{code}", horizontal.unwrap_or_default()),
            _ => match horizontal {
                Some(horizontal) => format!("{horizontal} + {}", vertical.short_name()),
                None => vertical.short_name(),
            },
        })
    }

    /// A space and the codes, as an argument of commands of GDAL; nothing without a code of x and y.
    pub(crate) fn argument(&self) -> String {
        let Some(code) = self.horizontal.as_ref().and_then(|horizontal| horizontal.code) else {
            return String::new();
        };
        let vertical = self.vertical.as_ref().and_then(|vertical| vertical.code);
        format!(" EPSG:{code}{}", vertical.map_or(String::new(), |code| format!("+{code}")))
    }

    /// Whether x and y are degrees of longitude and latitude on WGS 84.
    pub fn is_wgs84(&self) -> bool {
        let Some(Horizontal { kind: Kind::Geographic(base), unit, .. }) = &self.horizontal else {
            return false;
        };
        unit.is_same(&Unit::degree())
            && base.meridian == 0.0
            && !is_empty(&base.datum)
            && is_same_datum(&base.datum, "WGS_1984")
    }

    /// How many units of x and y one unit of z is, where both are lengths or x and y are degrees on the
    /// ellipsoid (`None`). A slope is z over x times this.
    pub fn vertical_ratio(&self) -> Option<f64> {
        let horizontal = self.horizontal.as_ref().filter(|known| !known.is_angular())?;
        Some(self.vertical.as_ref()?.unit.size / horizontal.unit.size)
    }
}

impl Horizontal {
    /// Whether x and y are angles.
    pub fn is_angular(&self) -> bool {
        matches!(self.kind, Kind::Geographic(_))
            || matches!(self.kind, Kind::Unresolved) && self.unit.is_same(&Unit::degree())
    }

    /// The geodetic part of the definition.
    pub fn base(&self) -> Option<&Geographic> {
        match &self.kind {
            Kind::Geographic(base) | Kind::Projected(base, _) | Kind::Geocentric(base) => Some(base),
            Kind::Unresolved => None,
        }
    }

    pub(crate) fn short_name(&self) -> String {
        self.code.map_or_else(|| self.name.clone(), |code| format!("EPSG:{code}"))
    }
}

impl Vertical {
    /// Heights above the ellipsoid, in `unit`.
    pub(crate) fn ellipsoidal(unit: Unit) -> Vertical {
        Vertical {
            name: "ellipsoidal height".into(),
            code: None,
            datum: "ellipsoid".into(),
            datum_code: None,
            unit,
            is_ellipsoidal: true,
            is_depth: false,
        }
    }

    /// Whether the code of the horizontal system states these heights, as that of a geographic system in
    /// three dimensions does.
    fn is_part_of(&self, system: &System) -> bool {
        self.is_ellipsoidal && system.horizontal.as_ref().is_some_and(Horizontal::is_angular)
    }

    /// Whether nothing but the unit of z is known.
    pub fn is_only_unit(&self) -> bool {
        let has_code = self.code.is_some() || self.datum_code.is_some();
        let has_name = !is_empty(&self.name) || !is_empty(&self.datum);
        !(has_code || has_name || self.is_ellipsoidal || self.is_depth)
    }

    fn short_name(&self) -> String {
        self.code.map_or_else(|| self.name.clone(), |code| format!("EPSG:{code}"))
    }
}

impl Projection {
    /// The value of a parameter; what it is by default if the definition has none.
    pub(crate) fn value(&self, role: Role) -> f64 {
        let stated = self.parameters.iter().find(|parameter| parameter.0 == role);
        stated.map_or(role.default_value(), |parameter| parameter.1)
    }
}
