//! Keys of GeoTIFF for coordinate reference systems.

use byteorder::{ByteOrder, LittleEndian as LE};

use crate::geo_keys::{self, CITATION, GEOGRAPHIC_TYPE, MODEL_TYPE, PROJECTED_TYPE, RASTER_TYPE, TEXTS_TAG};
use crate::source::crs_name;
use spmesh_stream::Crs;

/// Values of keys.
const PROJECTED: u16 = 1;
const GEOGRAPHIC: u16 = 2;
const PIXEL_IS_AREA: u16 = 1;
const PIXEL_IS_POINT: u16 = 2;
/// Numbers of the keys of the vertical coordinate system.
const OF_ELEVATIONS: std::ops::RangeInclusive<u16> = 4096..=4099;
/// The first three numbers of a directory: directory version, key revision, minor revision.
const VERSION: [u16; 3] = [1, 1, 0];

/// The GeoTIFF records of a coordinate reference system.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct GeoKeys {
    /// The key directory: a header of four numbers, then four numbers per key.
    pub(super) directory: Vec<u16>,
    pub(super) doubles: Vec<f64>,
    pub(super) texts: String,
}

impl GeoKeys {
    /// The records for `crs`. Keys of a LAS file are kept, except that the raster type is replaced and
    /// vertical keys are dropped unless cells hold elevations. Well-known text becomes its EPSG code or,
    /// without one, its name.
    pub(super) fn of(crs: &Crs, are_elevations: bool) -> GeoKeys {
        match crs {
            Crs::Unknown => GeoKeys::new(&[]),
            Crs::Wkt(text) => GeoKeys::of_text(text, crs),
            Crs::GeoKeys { directory, doubles, ascii } => {
                let is_kept = |key: &[u16; 4]| are_elevations || !OF_ELEVATIONS.contains(&key[0]);
                let keys: Vec<[u16; 4]> =
                    geo_keys::keys(&geo_keys::numbers(directory)).filter(is_kept).collect();
                GeoKeys {
                    doubles: doubles.chunks_exact(8).map(LE::read_f64).collect(),
                    texts: String::from_utf8_lossy(ascii).trim_end_matches('\0').to_string(),
                    ..GeoKeys::new(&keys)
                }
            }
        }
    }

    fn of_text(text: &str, crs: &Crs) -> GeoKeys {
        let is_projected =
            ["PROJCS", "PROJCRS", "COMPD"].iter().any(|word| text.trim_start().starts_with(word));
        let (model, key) =
            if is_projected { (PROJECTED, PROJECTED_TYPE) } else { (GEOGRAPHIC, GEOGRAPHIC_TYPE) };
        let model = [MODEL_TYPE, 0, 1, model];
        let name = crs_name(crs).unwrap_or_default();
        match name.strip_prefix("EPSG:").and_then(|code| code.parse().ok()) {
            Some(code) => GeoKeys::new(&[model, [key, 0, 1, code]]),
            None => {
                let texts: String = name.chars().filter(char::is_ascii).chain(['|']).collect();
                let citation = [CITATION, TEXTS_TAG, texts.len() as u16, 0];
                GeoKeys { texts, ..GeoKeys::new(&[model, citation]) }
            }
        }
    }

    /// The directory of `keys`, sorted, with the raster type PixelIsArea.
    fn new(keys: &[[u16; 4]]) -> GeoKeys {
        let others = keys.iter().copied().filter(|key| key[0] != RASTER_TYPE);
        let mut all: Vec<[u16; 4]> = others.chain([[RASTER_TYPE, 0, 1, PIXEL_IS_AREA]]).collect();
        all.sort_unstable();
        let head = [VERSION[0], VERSION[1], VERSION[2], all.len() as u16];
        GeoKeys { directory: [&head, all.as_flattened()].concat(), ..GeoKeys::default() }
    }
}

/// Whether a key directory says that coordinates refer to the centres of cells.
pub(in crate::raster) fn is_of_points(directory: &[u16]) -> bool {
    geo_keys::short(directory, RASTER_TYPE) == Some(PIXEL_IS_POINT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_with_a_code_is_its_code() {
        let keys = |text: &str| GeoKeys::of(&Crs::Wkt(text.into()), true);
        let utm = keys(r#"PROJCS["UTM",GEOGCS["x",AUTHORITY["EPSG","4326"]],AUTHORITY["EPSG","32633"]]"#);
        assert_eq!(utm.directory, [1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 32633]);
        let plain = keys(r#"GEOGCS["WGS 84",AUTHORITY["EPSG","4326"]]"#);
        assert_eq!(plain.directory, [1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, 1, 2048, 0, 1, 4326]);
        let local = keys(r#"PROJCS["my grid"]"#);
        assert_eq!((&local.directory[12..], &local.texts[..]), (&[1026, 34737, 8, 0][..], "my grid|"));
    }

    #[test]
    fn keys_of_files_stay() {
        let directory: Vec<u8> =
            [1u16, 1, 0, 2, 1025, 0, 1, 2, 3072, 0, 1, 26910].iter().flat_map(|n| n.to_le_bytes()).collect();
        assert!(is_of_points(&[1, 1, 0, 1, 1025, 0, 1, 2]) && !is_of_points(&[1, 1, 0, 1, 1025, 0, 1, 1]));
        let crs = Crs::GeoKeys { directory, doubles: 2.5f64.to_le_bytes().into(), ascii: b"a|\0".into() };
        let keys = GeoKeys::of(&crs, true);
        let expected = GeoKeys {
            directory: vec![1, 1, 0, 2, 1025, 0, 1, 1, 3072, 0, 1, 26910],
            doubles: vec![2.5],
            texts: "a|".into(),
        };
        assert_eq!(keys, expected);
        assert_eq!(GeoKeys::of(&Crs::Unknown, true).directory, [1, 1, 0, 1, 1025, 0, 1, 1]);
    }
}
