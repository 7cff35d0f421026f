//! Methods of map projections: their names, parameters, and GeoTIFF keys.
//!
//! Sources: EPSG Guidance Note 7-2; GeoTIFF 1.1, annexes B and C; for the keys that readers expect with each
//! method, the GeoTIFF pages on projections (geotiff.maptools.org/proj_list).

use crate::crs::names::letters;

/// What a parameter is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    Latitude,
    Longitude,
    FalseEasting,
    FalseNorthing,
    Scale,
    Parallel1,
    Parallel2,
    Azimuth,
    SkewAngle,
}

use Role::{
    Azimuth, FalseEasting, FalseNorthing, Latitude, Longitude, Parallel1, Parallel2, Scale, SkewAngle,
};

/// What the value of a parameter is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dimension {
    Angle,
    Length,
    Ratio,
}

/// A role, its names as letters, and the GeoTIFF keys that hold it.
type RoleNames = (Role, &'static [&'static str], &'static [u16]);

const ROLES: [RoleNames; 9] = [
    (
        Latitude,
        &[
            "latitudeoforigin",
            "latitudeofnaturalorigin",
            "latitudeoffalseorigin",
            "latitudeofcenter",
            "latitudeofcentre",
            "latitudeofprojectioncentre",
            "centralparallel",
        ],
        &[3081, 3085, 3089],
    ),
    (
        Longitude,
        &[
            "centralmeridian",
            "longitudeoforigin",
            "longitudeofnaturalorigin",
            "longitudeoffalseorigin",
            "longitudeofcenter",
            "longitudeofcentre",
            "longitudeofprojectioncentre",
        ],
        &[3080, 3084, 3088, 3095],
    ),
    (
        FalseEasting,
        &["falseeasting", "eastingatfalseorigin", "eastingatprojectioncentre"],
        &[3082, 3086, 3090],
    ),
    (
        FalseNorthing,
        &["falsenorthing", "northingatfalseorigin", "northingatprojectioncentre"],
        &[3083, 3087, 3091],
    ),
    (Scale, &["scalefactor", "scalefactoratnaturalorigin", "scalefactoratprojectioncentre"], &[3092, 3093]),
    (
        Parallel1,
        &["standardparallel1", "latitudeof1ststandardparallel", "latitudeofstandardparallel"],
        &[3078],
    ),
    (Parallel2, &["standardparallel2", "latitudeof2ndstandardparallel"], &[3079]),
    (Azimuth, &["azimuth", "azimuthofinitialline", "azimuthatprojectioncentre"], &[3094]),
    (SkewAngle, &["rectifiedgridangle", "anglefromrectifiedtoskewgrid"], &[3096]),
];

impl Role {
    pub(crate) fn of_name(name: &str) -> Option<Role> {
        let name = letters(name);
        ROLES.iter().find(|role| role.1.contains(&&name[..])).map(|role| role.0)
    }

    pub(crate) fn of_key(key: u16) -> Option<Role> {
        ROLES.iter().find(|role| role.2.contains(&key)).map(|role| role.0)
    }

    /// A name for messages.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Latitude => "latitude of origin",
            Longitude => "central meridian",
            FalseEasting => "false easting",
            FalseNorthing => "false northing",
            Scale => "scale factor",
            Parallel1 => "first standard parallel",
            Parallel2 => "second standard parallel",
            Azimuth => "azimuth",
            SkewAngle => "rectified grid angle",
        }
    }

    pub(crate) fn dimension(self) -> Dimension {
        match self {
            FalseEasting | FalseNorthing => Dimension::Length,
            Scale => Dimension::Ratio,
            _ => Dimension::Angle,
        }
    }

    pub(crate) fn default_value(self) -> f64 {
        if self == Scale { 1. } else { 0. }
    }
}

/// A method of projection.
#[derive(Debug, PartialEq)]
pub(crate) struct Method {
    /// Its name in the EPSG dataset.
    pub(crate) name: &'static str,
    /// Its other names, as letters.
    others: &'static [&'static str],
    /// Its number in GeoTIFF, if there is one.
    pub(crate) geotiff: Option<u16>,
    /// Its parameters, each with the key that readers of GeoTIFF expect.
    pub(crate) parameters: &'static [(Role, u16)],
}

const EAST_NORTH: [(Role, u16); 2] = [(FalseEasting, 3082), (FalseNorthing, 3083)];

/// Parameters of methods around a natural origin.
const NATURAL: [(Role, u16); 5] =
    [(Latitude, 3081), (Longitude, 3080), (Scale, 3092), EAST_NORTH[0], EAST_NORTH[1]];
/// The same without a scale.
const PLAIN: [(Role, u16); 4] = [(Latitude, 3081), (Longitude, 3080), EAST_NORTH[0], EAST_NORTH[1]];
/// Parameters of azimuthal methods.
const CENTRAL: [(Role, u16); 4] = [(Latitude, 3089), (Longitude, 3088), EAST_NORTH[0], EAST_NORTH[1]];
/// Parameters of conic methods with two standard parallels and a false origin.
const CONIC: [(Role, u16); 6] = [
    (Parallel1, 3078),
    (Parallel2, 3079),
    (Latitude, 3085),
    (Longitude, 3084),
    (FalseEasting, 3086),
    (FalseNorthing, 3087),
];
/// Parameters of Albers' method, for which readers expect the keys of a natural origin.
const ALBERS: [(Role, u16); 6] =
    [(Parallel1, 3078), (Parallel2, 3079), (Latitude, 3081), (Longitude, 3080), EAST_NORTH[0], EAST_NORTH[1]];
/// Parameters of cylindrical methods with a standard parallel.
const CYLINDRICAL: [(Role, u16); 4] = [(Parallel1, 3078), (Longitude, 3080), EAST_NORTH[0], EAST_NORTH[1]];
/// Parameters of polar methods: the latitude is that of the pole or of true scale.
const POLAR: [(Role, u16); 5] =
    [(Latitude, 3081), (Longitude, 3095), (Scale, 3092), EAST_NORTH[0], EAST_NORTH[1]];
/// The same by the latitude of true scale, which readers of GeoTIFF expect in the key of the origin.
const POLAR_B: [(Role, u16); 4] = [(Parallel1, 3081), (Longitude, 3095), EAST_NORTH[0], EAST_NORTH[1]];
/// Parameters of oblique Mercator methods.
const OBLIQUE: [(Role, u16); 7] = [
    (Latitude, 3089),
    (Longitude, 3088),
    (Azimuth, 3094),
    (SkewAngle, 3096),
    (Scale, 3093),
    EAST_NORTH[0],
    EAST_NORTH[1],
];

const fn method(
    name: &'static str,
    others: &'static [&'static str],
    geotiff: u16,
    parameters: &'static [(Role, u16)],
) -> Method {
    Method { name, others, geotiff: if geotiff == 0 { None } else { Some(geotiff) }, parameters }
}

/// The methods that systems are compared by and written with.
const METHODS: [Method; 20] = [
    method("Transverse Mercator", &["gausskruger"], 1, &NATURAL),
    method("Transverse Mercator (South Orientated)", &["transversemercatorsouthoriented"], 27, &NATURAL),
    method("Lambert Conic Conformal (2SP)", &["lambertconformalconic2sp"], 8, &CONIC),
    method("Lambert Conic Conformal (1SP)", &["lambertconformalconic1sp"], 9, &NATURAL),
    method("Lambert Conic Conformal (2SP Belgium)", &["lambertconformalconic2spbelgium"], 0, &CONIC),
    method("Albers Equal Area", &["albersconicequalarea", "albers"], 11, &ALBERS),
    method("Lambert Azimuthal Equal Area", &[], 10, &CENTRAL),
    method("Azimuthal Equidistant", &[], 12, &CENTRAL),
    method("Mercator (variant A)", &["mercator1sp"], 7, &NATURAL),
    method("Mercator (variant B)", &["mercator2sp"], 7, &CYLINDRICAL),
    method("Popular Visualisation Pseudo Mercator", &["mercatorauxiliarysphere"], 0, &PLAIN),
    method("Polar Stereographic (variant A)", &[], 15, &POLAR),
    method(
        "Polar Stereographic (variant B)",
        &["stereographicnorthpole", "stereographicsouthpole"],
        15,
        &POLAR_B,
    ),
    method("Oblique Stereographic", &["doublestereographic"], 16, &NATURAL),
    method("Cassini-Soldner", &["cassini"], 18, &PLAIN),
    method("American Polyconic", &["polyconic"], 22, &PLAIN),
    method("New Zealand Map Grid", &[], 26, &PLAIN),
    method(
        "Hotine Oblique Mercator (variant A)",
        &["hotineobliquemercator", "rectifiedskeworthomorphicnaturalorigin"],
        3,
        &OBLIQUE,
    ),
    method(
        "Hotine Oblique Mercator (variant B)",
        &["hotineobliquemercatorazimuthcenter", "rectifiedskeworthomorphiccenter"],
        9815,
        &OBLIQUE,
    ),
    method("Equidistant Cylindrical", &["equirectangular", "platecarree"], 17, &CYLINDRICAL),
];

impl Method {
    /// The method of a name, and of the parameters where the name is that of two methods.
    pub(crate) fn of_name(name: &str, parameters: &[(Role, f64)]) -> Option<&'static Method> {
        let value = |role| parameters.iter().find(|parameter| parameter.0 == role).map(|found| found.1);
        let name = match &letters(name)[..] {
            "lambertconformalconic" if value(Parallel2).is_some() => "lambertconicconformal2sp".into(),
            "lambertconformalconic" => "lambertconicconformal1sp".into(),
            "mercator" if value(Parallel1).is_some() => "mercatorvariantb".into(),
            "mercator" => "mercatorvarianta".into(),
            "polarstereographic" if value(Latitude).is_some_and(|latitude| latitude.abs() == 90.) => {
                "polarstereographicvarianta".into()
            }
            "polarstereographic" => "polarstereographicvariantb".into(),
            name => name.to_string(),
        };
        let is_named = |method: &&Method| letters(method.name) == name || method.others.contains(&&name[..]);
        METHODS.iter().find(is_named)
    }

    /// The method of a number of GeoTIFF.
    pub(crate) fn of_geotiff(number: u16, parameters: &[(Role, f64)]) -> Option<&'static Method> {
        match number {
            7 => Method::of_name("Mercator", parameters),
            15 => Method::of_name("Polar_Stereographic", parameters),
            _ => METHODS.iter().find(|method| method.geotiff == Some(number)),
        }
    }

    /// The parameters in the roles that this method has: WKT 1 and GeoTIFF give the latitude of true scale of
    /// a polar method as that of the origin, and WKT 1 has no latitude for cones with one parallel.
    pub(crate) fn own_roles(&self, parameters: &mut [(Role, f64)]) {
        let has = |role| self.parameters.iter().any(|parameter| parameter.0 == role);
        for (missing, own) in [(Latitude, Parallel1), (Parallel1, Latitude)] {
            if !has(missing) && has(own) && !parameters.iter().any(|parameter| parameter.0 == own) {
                parameters.iter_mut().filter(|given| given.0 == missing).for_each(|given| given.0 = own);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_three_dialects() {
        let name = |name, parameters: &[_]| Method::of_name(name, parameters).map(|method| method.name);
        for dialect in ["Transverse_Mercator", "Transverse Mercator", "Gauss_Kruger"] {
            assert_eq!(name(dialect, &[]), Some("Transverse Mercator"));
        }
        let conic = "Lambert_Conformal_Conic";
        assert_eq!(name(conic, &[(Parallel1, 1.)]), Some("Lambert Conic Conformal (1SP)"));
        assert_eq!(name(conic, &[(Parallel2, 1.)]), Some("Lambert Conic Conformal (2SP)"));
        assert_eq!(name("Polar_Stereographic", &[(Latitude, -71.)]), Some("Polar Stereographic (variant B)"));
        assert_eq!(name("Winkel_Tripel", &[]), None);
    }

    #[test]
    fn a_parallel_of_true_scale_is_no_origin() {
        let mut given = [(Latitude, -71.), (Longitude, 0.)];
        Method::of_name("Polar_Stereographic", &given).unwrap().own_roles(&mut given);
        assert_eq!(given[0], (Parallel1, -71.));
    }
}
