//! Names in different words.

/// Letters and digits of `name`, in lower case: `Transverse_Mercator` and `Transverse Mercator` agree.
pub(crate) fn letters(name: &str) -> String {
    let name = name.replace('+', "plus");
    name.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect()
}

/// Whether `name` says nothing.
pub(crate) fn is_empty(name: &str) -> bool {
    ["", "unknown", "unnamed", "undefined", "none", "userdefined"].contains(&&letters(name)[..])
}

/// Whether two names of geodetic or vertical datums can mean the same.
pub(crate) fn is_same_datum(a: &str, b: &str) -> bool {
    is_empty(a) || is_empty(b) || datum(a) == datum(b)
}

/// What EPSG (WKT 2), OGC (WKT 1) and ESRI call the same datum, as its letters. The first name of a row stands
/// for the others. Names that differ in nothing but marks, a leading `D_` or a trailing "ensemble" need no
/// row.
const ALIASES: &[&[&str]] = &[
    &["worldgeodeticsystem1984", "wgs1984", "wgs84"],
    &["worldgeodeticsystem1972", "wgs1972", "wgs72"],
    &["northamericandatum1983", "northamerican1983", "nad83"],
    &["northamericandatum1927", "northamerican1927", "nad27"],
    &["nad83highaccuracyreferencenetwork", "nad83highaccuracyregionalnetwork", "northamerican1983harn"],
    &["nad83nationalspatialreferencesystem2007", "nad1983nsrs2007"],
    &["nad83nationalspatialreferencesystem2011", "nad19832011"],
    &["nad83canadianspatialreferencesystem", "northamerican1983csrs"],
    &["europeanterrestrialreferencesystem1989", "etrs1989", "etrs89"],
    &["europeandatum1950", "european1950"],
    &["reseaugeodesiquefrancais1993v1", "reseaugeodesiquefrancais1993", "rgf1993", "rgf1993v1"],
    &["reseaugeodesiquedelareunion1992", "rgr1992"],
    &["osgbgreatbritain1936", "osgb1936", "ordnancesurveyofgreatbritain1936"],
    &["geocentricdatumofaustralia1994", "gda1994"],
    &["geocentricdatumofaustralia2020", "gda2020"],
    &["newzealandgeodeticdatum2000", "nzgd2000"],
    &["sistemadereferenciageocentricoparalasamericas2000", "sirgas2000"],
    &["northamericanverticaldatum1988", "navd88", "navd1988"],
    &["nationalgeodeticverticaldatum1929", "ngvd29", "ngvd1929"],
    &["canadiangeodeticverticaldatum1928", "canadiangeodeticverticaldatumof1928", "cgvd28", "cgvd1928"],
    &["canadiangeodeticverticaldatum2013", "canadiangeodeticverticaldatumof2013", "cgvd2013"],
    &["normaalamsterdamspeil", "nap"],
    &["nivellementgeneraldelafranceign69", "ngfign69", "ign69", "ign1969"],
    &["egm2008geoid", "egm2008", "egm08geoid"],
    &["egm1996geoid", "egm96geoid", "egm96", "egm1996"],
    &["meansealevel", "msl"],
];

fn datum(name: &str) -> String {
    let letters = letters(name.strip_prefix("D_").unwrap_or(name));
    let bare = letters.strip_suffix("ensemble").unwrap_or(&letters);
    let row = ALIASES.iter().find(|row| row.contains(&bare));
    row.map_or(bare, |row| row[0]).to_string()
}

#[cfg(test)]
mod tests {
    use super::is_same_datum;

    #[test]
    fn dialects_of_datums() {
        for (a, b) in [
            ("North_American_Datum_1983", "D_North_American_1983"),
            ("World Geodetic System 1984 ensemble", "WGS_1984"),
            ("NAD83 (High Accuracy Reference Network)", "D_North_American_1983_HARN"),
            ("unknown", "WGS_1984"),
        ] {
            assert!(is_same_datum(a, b) && is_same_datum(b, a), "{a} {b}");
        }
        assert!(!is_same_datum("North American Datum 1983", "NAD83 (High Accuracy Reference Network)"));
    }
}
