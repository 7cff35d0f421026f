//! Well-known text of version 1 of a system, which programs read beside ESRI grids.
//!
//! Source: OGC 01-009, section 7; names of methods and parameters as GDAL writes them.

use crate::crs::compare::contradictions;
use crate::crs::methods::{Dimension, Method, Role};
use crate::crs::names::is_same_datum;
use crate::crs::system::{Geographic, Horizontal, Kind, Projection, System, Vertical};
use crate::crs::units::Unit;

/// The methods that version 1 has a name for: that of the EPSG dataset, its own, and whether parameters are
/// those of a centre and not of an origin.
const METHODS: [(&str, &str, bool); 17] = [
    ("Transverse Mercator", "Transverse_Mercator", false),
    ("Transverse Mercator (South Orientated)", "Transverse_Mercator_South_Orientated", false),
    ("Lambert Conic Conformal (2SP)", "Lambert_Conformal_Conic_2SP", false),
    ("Lambert Conic Conformal (1SP)", "Lambert_Conformal_Conic_1SP", false),
    ("Lambert Conic Conformal (2SP Belgium)", "Lambert_Conformal_Conic_2SP_Belgium", false),
    ("Albers Equal Area", "Albers_Conic_Equal_Area", true),
    ("Lambert Azimuthal Equal Area", "Lambert_Azimuthal_Equal_Area", true),
    ("Azimuthal Equidistant", "Azimuthal_Equidistant", true),
    ("Mercator (variant A)", "Mercator_1SP", false),
    ("Mercator (variant B)", "Mercator_2SP", false),
    ("Polar Stereographic (variant A)", "Polar_Stereographic", false),
    ("Polar Stereographic (variant B)", "Polar_Stereographic", false),
    ("Oblique Stereographic", "Oblique_Stereographic", false),
    ("Cassini-Soldner", "Cassini_Soldner", false),
    ("New Zealand Map Grid", "New_Zealand_Map_Grid", false),
    ("Hotine Oblique Mercator (variant A)", "Hotine_Oblique_Mercator", true),
    ("Hotine Oblique Mercator (variant B)", "Hotine_Oblique_Mercator_Azimuth_Center", true),
];

/// The text of `system`, without elevations that version 1 cannot hold; `None` if it cannot hold x and y.
pub(super) fn text(system: &System) -> Option<String> {
    let horizontal = system.horizontal.as_ref()?;
    let plane = match &horizontal.kind {
        Kind::Geographic(base) => geographic(base, code(horizontal)),
        Kind::Projected(base, projection) => projected(horizontal, base, projection)?,
        Kind::Geocentric(_) | Kind::Unresolved => return None,
    };
    let heights = system.vertical.as_ref().filter(|heights| !heights.is_only_unit());
    Some(heights.and_then(|heights| compound(horizontal, &plane, heights)).unwrap_or(plane))
}

fn compound(horizontal: &Horizontal, plane: &str, heights: &Vertical) -> Option<String> {
    if heights.is_ellipsoidal || heights.is_depth {
        return None;
    }
    let (name, unit) = (quoted(&heights.name), unit(&heights.unit));
    let datum = format!("VERT_DATUM[{},2005{}]", quoted(&heights.datum), authority(heights.datum_code));
    let axis = "AXIS[\"Gravity-related height\",UP]";
    let both = quoted(&format!("{} + {}", horizontal.name, heights.name));
    Some(format!("COMPD_CS[{both},{plane},VERT_CS[{name},{datum},{unit},{axis}{}]]", authority(heights.code)))
}

fn projected(system: &Horizontal, base: &Geographic, projection: &Projection) -> Option<String> {
    let method = projection.method.filter(|_| projection.others.is_empty())?;
    let &(_, name, is_central) = METHODS.iter().find(|(known, ..)| *known == method.name)?;
    let parameter = |&(role, _): &(Role, u16)| {
        let value = projection.value(role);
        let value = match role.dimension() {
            Dimension::Angle => base.unit.of_degrees(value),
            Dimension::Length => value / system.unit.size,
            Dimension::Ratio => value,
        };
        format!("PARAMETER[\"{}\",{value}],", parameter_name(method, role, is_central))
    };
    let parameters: String = method.parameters.iter().map(parameter).collect();
    Some(format!(
        "PROJCS[{},{},PROJECTION[\"{name}\"],{parameters}{}{}]",
        quoted(&system.name),
        geographic(base, base.code),
        unit(&system.unit),
        authority(code(system))
    ))
}

/// What version 1 calls a parameter.
fn parameter_name(method: &Method, role: Role, is_central: bool) -> &'static str {
    match role {
        // The latitude of true scale of polar methods.
        Role::Parallel1 if method.name.starts_with("Polar") => "latitude_of_origin",
        Role::Latitude if is_central => "latitude_of_center",
        Role::Latitude => "latitude_of_origin",
        Role::Longitude if is_central => "longitude_of_center",
        Role::Longitude => "central_meridian",
        Role::FalseEasting => "false_easting",
        Role::FalseNorthing => "false_northing",
        Role::Scale => "scale_factor",
        Role::Parallel1 => "standard_parallel_1",
        Role::Parallel2 => "standard_parallel_2",
        Role::Azimuth => "azimuth",
        Role::SkewAngle => "rectified_grid_angle",
    }
}

fn geographic(base: &Geographic, code: Option<u32>) -> String {
    let ellipsoid = &base.ellipsoid;
    let datum = if is_same_datum(&base.datum, "WGS_1984") {
        "WGS_1984".to_string()
    } else {
        base.datum.chars().map(|c| if c.is_alphanumeric() || c == '+' { c } else { '_' }).collect()
    };
    format!(
        "GEOGCS[{},DATUM[{},SPHEROID[{},{},{}]{}],PRIMEM[\"{}\",{}],{}{}]",
        quoted(&base.name),
        quoted(&datum),
        quoted(&ellipsoid.name),
        ellipsoid.semi_major,
        ellipsoid.inverse_flattening,
        authority(base.datum_code),
        if base.meridian == 0.0 { "Greenwich" } else { "unknown" },
        // In degrees, whatever the unit of the system is: so do GDAL and ESRI.
        base.meridian,
        unit(&base.unit),
        authority(code)
    )
}

/// The code of a system, unless its definition differs from it.
fn code(system: &Horizontal) -> Option<u32> {
    system.code.filter(|_| contradictions(system).is_empty())
}

fn unit(unit: &Unit) -> String {
    format!("UNIT[{},{}{}]", quoted(&unit.name), unit.size, authority(unit.code.map(u32::from)))
}

fn authority(code: Option<u32>) -> String {
    code.map_or(String::new(), |code| format!(",AUTHORITY[\"EPSG\",\"{code}\"]"))
}

fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crs::{differences, epsg, from_wkt};

    /// All systems of the dataset, without their codes, so that definitions alone are compared.
    #[test]
    fn definitions_stay_the_same() {
        let (mut written, mut refused) = (0, 0);
        for code in (2000..33_000).step_by(7) {
            let Some(system) = epsg::system(code).filter(|system| system.horizontal.is_some()) else {
                continue;
            };
            let Some(text) = text(&system) else {
                refused += 1;
                continue;
            };
            let mut bare = String::new();
            for (number, part) in text.split(",AUTHORITY[\"EPSG\",\"").enumerate() {
                bare += if number == 0 { part } else { part.split_once("\"]").expect("a code").1 };
            }
            let found = differences(&from_wkt::system(&bare), &system);
            assert!(found.is_empty(), "EPSG:{code}: {found:?}\n{bare}");
            written += 1;
        }
        assert!(written > 500 && refused < written / 4, "{written} written, {refused} not");
    }

    #[test]
    fn heights_make_a_compound() {
        let text = text(&from_wkt::system(&crate::crs::request::of_codes("25832+7837").unwrap())).unwrap();
        assert!(text.starts_with("COMPD_CS[\"ETRS89 / UTM zone 32N + "), "{text}");
        let found = from_wkt::system(&text);
        assert_eq!(found.vertical.and_then(|heights| heights.code), Some(7837));
    }
}
