//! Map projections as strings of PROJ, for programs that compute with them.

use crate::crs::methods::Role;
use crate::crs::system::{Horizontal, Kind};

/// The projection of a system, and longitude and latitude on its ellipsoid, as strings of PROJ, without
/// changes of datum and without the prime meridian; `None` where PROJ 4 has no such projection.
pub fn proj_string(system: &Horizontal) -> Option<(String, String)> {
    let Kind::Projected(base, projection) = &system.kind else { return None };
    let value = |role| projection.value(role);
    let latitude = value(Role::Latitude);
    let lambert = format!("+proj=lcc +lat_0={latitude}");
    let method = match projection.method?.name {
        "Transverse Mercator" => format!("+proj=etmerc +lat_0={latitude}"),
        "Lambert Conic Conformal (2SP)" => {
            format!("{lambert} +lat_1={} +lat_2={}", value(Role::Parallel1), value(Role::Parallel2))
        }
        "Lambert Conic Conformal (1SP)" => format!("{lambert} +lat_1={latitude}"),
        "Albers Equal Area" => {
            let [first, second] = [value(Role::Parallel1), value(Role::Parallel2)];
            format!("+proj=aea +lat_0={latitude} +lat_1={first} +lat_2={second}")
        }
        "Lambert Azimuthal Equal Area" => format!("+proj=laea +lat_0={latitude}"),
        "Mercator (variant A)" => "+proj=merc".to_string(),
        "Mercator (variant B)" => format!("+proj=merc +lat_ts={}", value(Role::Parallel1)),
        "Polar Stereographic (variant A)" => format!("+proj=stere +lat_0={latitude}"),
        "Polar Stereographic (variant B)" => {
            let parallel = value(Role::Parallel1);
            format!("+proj=stere +lat_0={} +lat_ts={parallel}", 90_f64.copysign(parallel))
        }
        "Oblique Stereographic" => format!("+proj=sterea +lat_0={latitude}"),
        "Popular Visualisation Pseudo Mercator" => "+proj=merc".to_string(),
        _ => return None,
    };
    let is_spherical = projection.method?.name == "Popular Visualisation Pseudo Mercator";
    let [axis, flattening] = [base.ellipsoid.semi_major, base.ellipsoid.inverse_flattening];
    let ellipsoid = match is_spherical || flattening == 0.0 {
        true => format!("+a={axis} +b={axis}"),
        false => format!("+a={axis} +rf={flattening}"),
    };
    let meridian = value(Role::Longitude);
    let [scale, east, north] = [Role::Scale, Role::FalseEasting, Role::FalseNorthing].map(value);
    // Parameters of lengths are in metres, coordinates in the unit of the system.
    let unit = system.unit.size;
    Some((
        format!(
            "{method} +lon_0={meridian} +k_0={scale} +x_0={east} +y_0={north} {ellipsoid} +to_meter={unit}"
        ),
        format!("+proj=longlat {ellipsoid}"),
    ))
}
