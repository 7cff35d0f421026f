//! The EPSG dataset: definitions of codes, and codes of definitions.

use std::sync::LazyLock;

use crate::crs::from_wkt;
use crate::crs::names::{is_empty, is_same_datum};
use crate::crs::system::{Geographic, Kind, System, Vertical};
use crate::crs::units::Unit;

/// Codes of coordinate reference systems lie below.
const CODES: std::ops::Range<u32> = 1024..33_000;

/// The well-known text (WKT 2) of a code.
pub(crate) fn text(code: u32) -> Option<&'static str> {
    epsg_utils::epsg_to_wkt2(i32::try_from(code).ok()?).ok()
}

/// The system of a code.
pub(crate) fn system(code: u32) -> Option<System> {
    text(code).map(from_wkt::system)
}

/// Codes and texts of the systems that start with `keyword`, which is that of geographic or vertical systems,
/// in the order of the codes.
///
/// The first call reads the whole dataset, in some twenty milliseconds.
fn defined(keyword: &'static str) -> impl Iterator<Item = (u32, &'static str)> {
    static TEXTS: LazyLock<Vec<(u32, &'static str)>> = LazyLock::new(|| {
        let all = CODES.filter_map(|code| Some((code, text(code)?)));
        all.filter(|(_, text)| [GEOGRAPHIC, VERTICAL].iter().any(|word| text.starts_with(word))).collect()
    });
    TEXTS.iter().copied().filter(move |(_, text)| text.starts_with(keyword))
}

const GEOGRAPHIC: &str = "GEOGCRS";
const VERTICAL: &str = "VERTCRS";

/// The code of the heights or depths that `wanted` defines: with its datum, unit and direction.
pub(crate) fn vertical_code(wanted: &Vertical) -> Option<u32> {
    let is_wanted = |known: &Vertical| {
        let is_same = match (known.datum_code, wanted.datum_code) {
            (Some(known), Some(wanted)) => known == wanted,
            _ => !is_empty(&wanted.datum) && is_same_datum(&known.datum, &wanted.datum),
        };
        is_same && known.unit.is_same(&wanted.unit) && known.is_depth == wanted.is_depth
    };
    defined(VERTICAL).find_map(|(code, text)| from_wkt::system(text).vertical.filter(is_wanted).map(|_| code))
}

/// The code of longitude, latitude and ellipsoidal height on the datum of `base`.
pub(crate) fn solid_code(base: &Geographic) -> Option<u32> {
    defined(GEOGRAPHIC).filter(|(_, text)| text.contains("CS[ellipsoidal,3")).find_map(|(code, text)| {
        match from_wkt::system(text).horizontal?.kind {
            Kind::Geographic(known) if known.datum_code.is_some() && known.datum_code == datum_code(base) => {
                Some(code)
            }
            _ => None,
        }
    })
}

/// The code of longitude and latitude on the datum that `wanted` names, in degrees.
pub(crate) fn geographic_code(wanted: &Geographic) -> Option<u32> {
    if is_empty(&wanted.datum) || wanted.meridian != 0. || !wanted.unit.is_same(&Unit::degree()) {
        return None;
    }
    let mut flat = defined(GEOGRAPHIC).filter(|(_, text)| text.contains("CS[ellipsoidal,2"));
    flat.find_map(|(_, text)| match from_wkt::system(text).horizontal?.kind {
        Kind::Geographic(known)
            if is_same_datum(&known.datum, &wanted.datum) && known.ellipsoid.is_same(&wanted.ellipsoid) =>
        {
            known.code
        }
        _ => None,
    })
}

/// The code of the datum, taken from the geographic system where it has a code but its datum has none.
pub(crate) fn datum_code(base: &Geographic) -> Option<u32> {
    base.datum_code.or_else(|| system(base.code?)?.horizontal?.base()?.datum_code)
}

/// The geographic system in two dimensions on the datum of an EPSG code.
pub(crate) fn geographic_of_datum(datum: u32) -> Option<Geographic> {
    let named = format!(",{datum}]");
    let mut flat =
        defined(GEOGRAPHIC).filter(|(_, text)| text.contains("CS[ellipsoidal,2") && text.contains(&named));
    flat.find_map(|(_, text)| match from_wkt::system(text).horizontal?.kind {
        Kind::Geographic(known) if known.datum_code == Some(datum) => Some(known),
        _ => None,
    })
}
