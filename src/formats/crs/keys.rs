//! Key directories of GeoTIFF, which LAS files and rasters contain.
//!
//! Source: OGC GeoTIFF 1.1, chapter 7. The directory has a header of four numbers, then four numbers per key:
//! the key's number, the tag that holds its value (0: the entry itself), a count, and the value or its index.

use byteorder::{ByteOrder, LittleEndian as LE};

/// Type of the model: projected, geographic or geocentric.
pub(crate) const MODEL_TYPE: u16 = 1024;
/// Whether coordinates refer to cells as areas or to their centres.
pub const RASTER_TYPE: u16 = 1025;
/// Citation (name) of the whole definition.
pub(crate) const CITATION: u16 = 1026;
/// EPSG code of a geographic or geocentric system, and its citation.
pub(crate) const GEODETIC: u16 = 2048;
pub(crate) const GEODETIC_CITATION: u16 = 2049;
/// EPSG code of the geodetic datum.
pub(crate) const DATUM: u16 = 2050;
/// EPSG code and longitude of the prime meridian.
pub(crate) const MERIDIAN: u16 = 2051;
pub(crate) const MERIDIAN_LONGITUDE: u16 = 2061;
/// EPSG code and size in radians of the unit of angles.
pub(crate) const ANGLE_UNIT: u16 = 2054;
pub(crate) const ANGLE_UNIT_SIZE: u16 = 2055;
/// EPSG code of the ellipsoid, its axes and its inverse flattening.
pub(crate) const ELLIPSOID: u16 = 2056;
pub(crate) const SEMI_MAJOR: u16 = 2057;
pub(crate) const SEMI_MINOR: u16 = 2058;
pub(crate) const INVERSE_FLATTENING: u16 = 2059;
/// EPSG code of a projected system, and its citation.
pub(crate) const PROJECTED: u16 = 3072;
pub(crate) const PROJECTED_CITATION: u16 = 3073;
/// EPSG code of the conversion, and GeoTIFF's number of its method.
pub(crate) const CONVERSION: u16 = 3074;
pub(crate) const METHOD: u16 = 3075;
/// EPSG code and size in metres of the unit of x and y.
pub(crate) const LENGTH_UNIT: u16 = 3076;
pub(crate) const LENGTH_UNIT_SIZE: u16 = 3077;
/// EPSG code of a vertical system, its citation, the code of its datum, the code of its unit.
pub(crate) const VERTICAL: u16 = 4096;
pub(crate) const VERTICAL_CITATION: u16 = 4097;
pub(crate) const VERTICAL_DATUM: u16 = 4098;
pub(crate) const VERTICAL_UNIT: u16 = 4099;

/// The values of [`MODEL_TYPE`] of projected, geographic and geocentric systems.
pub(crate) const PROJECTED_MODEL: u16 = 1;
pub(crate) const GEOGRAPHIC_MODEL: u16 = 2;
pub(crate) const GEOCENTRIC_MODEL: u16 = 3;

/// The value of a key for what other keys define.
pub(crate) const USER_DEFINED: u16 = 32767;
/// The value of [`RASTER_TYPE`] for cells whose coordinates are those of their centres.
const PIXEL_IS_POINT: u16 = 2;

/// The tags of TIFF, and numbers of records of LAS files, that hold doubles and texts.
pub(crate) const DOUBLES_TAG: u16 = 34736;
pub(crate) const TEXTS_TAG: u16 = 34737;

/// The three records of a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GeoKeys {
    /// The key directory: a header of four numbers, then four numbers per key.
    pub directory: Vec<u16>,
    /// Numbers of keys.
    pub doubles: Vec<f64>,
    /// Texts of keys.
    pub texts: String,
}

impl GeoKeys {
    /// The records as LAS files hold them.
    pub(crate) fn of_bytes(directory: &[u8], doubles: &[u8], texts: &[u8]) -> GeoKeys {
        GeoKeys {
            directory: directory.chunks_exact(2).map(LE::read_u16).collect(),
            doubles: doubles.chunks_exact(8).map(LE::read_f64).collect(),
            texts: texts.iter().map(|&byte| char::from(byte)).collect(),
        }
    }

    /// The keys of the directory: number, tag, count, value. Some files fill the directory with keys of
    /// number 0.
    pub(crate) fn keys(&self) -> impl Iterator<Item = [u16; 4]> {
        self.directory.as_chunks::<4>().0.iter().skip(1).copied().filter(|key| key[0] != 0)
    }

    /// The value of a key that is stored in its entry.
    pub(crate) fn short(&self, wanted: u16) -> Option<u16> {
        self.keys().find(|&[key, tag, ..]| key == wanted && tag == 0).map(|[.., value]| value)
    }

    /// The value of a key that is a code: neither "undefined" nor "user-defined".
    pub(crate) fn code(&self, wanted: u16) -> Option<u16> {
        self.short(wanted).filter(|&code| code != 0 && code != USER_DEFINED)
    }

    /// The value of a key that is a number with fractions.
    pub(crate) fn double(&self, wanted: u16) -> Option<f64> {
        let [.., at] = self.keys().find(|&[key, tag, ..]| key == wanted && tag == DOUBLES_TAG)?;
        self.doubles.get(usize::from(at)).copied().filter(|value| value.is_finite())
    }

    /// The text of a key; empty texts count as none.
    pub(crate) fn text(&self, wanted: u16) -> Option<String> {
        let [_, _, len, start] = self.keys().find(|&[key, tag, ..]| key == wanted && tag == TEXTS_TAG)?;
        let text: String = self.texts.chars().skip(usize::from(start)).take(usize::from(len)).collect();
        let text = text.trim_end_matches(['|', '\0']).trim();
        (!text.is_empty()).then(|| text.to_string())
    }

    /// Whether coordinates refer to the centres of cells.
    pub fn is_of_points(&self) -> bool {
        self.short(RASTER_TYPE) == Some(PIXEL_IS_POINT)
    }

    /// Adds a key whose value is in its entry.
    pub(crate) fn add_short(&mut self, key: u16, value: u16) {
        self.directory.extend([key, 0, 1, value]);
    }

    /// Adds a key with a number.
    pub(crate) fn add_double(&mut self, key: u16, value: f64) {
        self.directory.extend([key, DOUBLES_TAG, 1, self.doubles.len() as u16]);
        self.doubles.push(value);
    }

    /// Adds a key with a text: the printable ASCII characters of its parts, each with the mark that ends
    /// texts.
    pub(crate) fn add_text(&mut self, key: u16, parts: &[String]) {
        let is_kept = |c: &char| (c.is_ascii_graphic() || *c == ' ') && *c != '|';
        let text: String = parts.iter().flat_map(|part| part.chars().filter(is_kept).chain(['|'])).collect();
        self.directory.extend([key, TEXTS_TAG, text.len() as u16, self.texts.len() as u16]);
        self.texts += &text;
    }
}
