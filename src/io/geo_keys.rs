//! Reads the key directories of GeoTIFF, which LAS files and rasters contain.
//!
//! Source: OGC GeoTIFF 1.1, chapter 7. The directory has a header of four numbers, then four numbers per key:
//! the key's number, the tag that holds its value (0: the entry itself), a count, and the value or its index.

use byteorder::{ByteOrder, LittleEndian as LE};

/// Type of the model: projected or geographic.
pub(crate) const MODEL_TYPE: u16 = 1024;
/// Whether coordinates refer to cells as areas or to their centres.
pub(crate) const RASTER_TYPE: u16 = 1025;
/// Citation (name) of the whole definition.
pub(crate) const CITATION: u16 = 1026;
/// EPSG code of a geographic system.
pub(crate) const GEOGRAPHIC_TYPE: u16 = 2048;
/// EPSG code of a projected system.
pub(crate) const PROJECTED_TYPE: u16 = 3072;
/// The tag that holds the texts of keys.
pub(crate) const TEXTS_TAG: u16 = 34737;

/// The numbers of a directory as a LAS file holds it.
pub(crate) fn numbers(directory: &[u8]) -> Vec<u16> {
    directory.chunks_exact(2).map(LE::read_u16).collect()
}

/// The keys of a directory: number, tag, count, value.
pub(crate) fn keys(directory: &[u16]) -> impl Iterator<Item = [u16; 4]> {
    directory.as_chunks::<4>().0.iter().skip(1).copied()
}

/// The value of a key that is stored in its entry.
pub(crate) fn short(directory: &[u16], wanted: u16) -> Option<u16> {
    keys(directory).find(|&[key, tag, ..]| key == wanted && tag == 0).map(|[.., value]| value)
}

/// The text of a key, which is in `texts`.
pub(crate) fn text<'t>(directory: &[u16], texts: &'t [u8], wanted: u16) -> Option<&'t [u8]> {
    let [_, _, count, start] = keys(directory).find(|&[key, tag, ..]| key == wanted && tag == TEXTS_TAG)?;
    texts.get(usize::from(start)..)?.get(..usize::from(count))
}
