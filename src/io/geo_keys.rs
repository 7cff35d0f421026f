//! Reads the key directories of GeoTIFF, which LAS files and rasters have.
//!
//! Source: OGC GeoTIFF 1.1, chapter 7: four numbers for the directory, then four for each key: its number,
//! the tag that holds its value (0: the key itself), a count, and the value or its place.

use byteorder::{ByteOrder, LittleEndian as LE};

/// Type of the model: projected or geographic.
pub(crate) const MODEL_TYPE: u16 = 1024;
/// Whether places are those of cells or of their centres.
pub(crate) const RASTER_TYPE: u16 = 1025;
/// Name of the whole.
pub(crate) const CITATION: u16 = 1026;
/// EPSG code of a geographic system.
pub(crate) const GEOGRAPHIC_TYPE: u16 = 2048;
/// EPSG code of a projected system.
pub(crate) const PROJECTED_TYPE: u16 = 3072;
/// The tag with the texts of keys.
pub(crate) const TEXTS_TAG: u16 = 34737;

/// The numbers of a directory as a LAS file holds it.
pub(crate) fn numbers(directory: &[u8]) -> Vec<u16> {
    directory.chunks_exact(2).map(LE::read_u16).collect()
}

/// The keys of a directory: number, tag, count, value.
pub(crate) fn keys(directory: &[u16]) -> impl Iterator<Item = [u16; 4]> {
    directory.as_chunks::<4>().0.iter().skip(1).copied()
}

/// The value of a key that holds it itself.
pub(crate) fn short(directory: &[u16], wanted: u16) -> Option<u16> {
    keys(directory).find(|&[key, tag, ..]| key == wanted && tag == 0).map(|[.., value]| value)
}

/// The text of a key, which is in `texts`.
pub(crate) fn text<'t>(directory: &[u16], texts: &'t [u8], wanted: u16) -> Option<&'t [u8]> {
    let [_, _, count, start] = keys(directory).find(|&[key, tag, ..]| key == wanted && tag == TEXTS_TAG)?;
    texts.get(usize::from(start)..)?.get(..usize::from(count))
}
