//! Coordinate reference systems: a short name for people, and the one that files share.

use super::input::Source;
use spmesh_core::error::{Error, Result};
use spmesh_core::limits::CRS_LEN_MAX;
use spmesh_stream::Crs;

/// GeoTIFF keys of a projected and a geographic system, and of citations in the order of preference.
const PROJECTED: u16 = 3072;
const GEOGRAPHIC: u16 = 2048;
const CITATIONS: [u16; 3] = [3073, 1026, 2049];

/// GeoTIFF's "defined by other keys".
const USER_DEFINED: u16 = 32767;

/// A short name of `crs`: its EPSG code ("EPSG:26910") where it states one, else the name it gives itself.
#[must_use]
pub fn crs_name(crs: &Crs) -> Option<String> {
    match crs {
        Crs::Unknown => None,
        Crs::Wkt(text) => wkt_code(text).or_else(|| quoted(text).map(str::to_string)),
        Crs::GeoKeys { directory, ascii, .. } => geo_keys_code(directory)
            .or_else(|| CITATIONS.iter().find_map(|&citation| geo_keys_text(directory, ascii, citation))),
    }
}

/// `crs`, unless it is too long for the header of a stream: then nothing, with a notice.
pub(super) fn fitting(crs: Crs, notices: &mut Vec<String>) -> Crs {
    let len = match &crs {
        Crs::Unknown => 0,
        Crs::Wkt(text) => text.len(),
        Crs::GeoKeys { directory, doubles, ascii } => directory.len() + doubles.len() + ascii.len(),
    };
    if len <= CRS_LEN_MAX {
        return crs;
    }
    notices.push(format!(
        "the coordinate reference system is {len} bytes long, a stream can hold {CRS_LEN_MAX}: leaving it out"
    ));
    Crs::Unknown
}

/// The system that all sources share. A file that states none takes that of the others.
pub(super) fn common_crs(sources: &[Source], notices: &mut Vec<String>) -> Result<Crs> {
    let mut known = sources.iter().filter(|source| source.stated.crs != Crs::Unknown);
    let Some(first) = known.next() else { return Ok(Crs::Unknown) };
    if let Some(other) = known.find(|other| !is_same(&first.stated.crs, &other.stated.crs)) {
        let name = |source: &Source| crs_name(&source.stated.crs).unwrap_or_else(|| "unnamed".to_string());
        return Err(Error::usage(format!(
            "the coordinate reference systems differ: {} in {}, {} in {}",
            name(first),
            first.name,
            name(other),
            other.name
        )));
    }
    if let Some(unknown) = sources.iter().find(|source| source.stated.crs == Crs::Unknown) {
        notices.push(format!(
            "{}: states no coordinate reference system, taking that of {}",
            unknown.name, first.name
        ));
    }
    Ok(first.stated.crs.clone())
}

fn is_same(a: &Crs, b: &Crs) -> bool {
    let code = |crs: &Crs| match crs {
        Crs::Unknown => None,
        Crs::Wkt(text) => wkt_code(text),
        Crs::GeoKeys { directory, .. } => geo_keys_code(directory),
    };
    a == b || code(a).is_some_and(|of_a| code(b) == Some(of_a))
}

/// The text between the first two quotation marks.
fn quoted(text: &str) -> Option<&str> {
    text.split('"').nth(1).filter(|name| !name.is_empty())
}

/// The code of the outermost AUTHORITY (or ID, as newer text calls it).
fn wkt_code(text: &str) -> Option<String> {
    let (mut depth, mut in_quotes) = (0, false);
    for (at, symbol) in text.char_indices() {
        match symbol {
            '"' => in_quotes = !in_quotes,
            _ if in_quotes => {}
            '[' | '(' => depth += 1,
            ']' | ')' => depth -= 1,
            'A' | 'I' | 'a' | 'i' if depth == 1 && text[..at].trim_end().ends_with(',') => {
                let inside = ["AUTHORITY", "ID"].iter().find_map(|word| arguments(&text[at..], word));
                if let Some(inside) = inside {
                    let mut parts = inside.split(',').map(|part| part.trim().trim_matches('"'));
                    return Some(format!("{}:{}", parts.next()?, parts.next()?));
                }
            }
            _ => {}
        }
    }
    None
}

/// What the brackets hold that follow `word` at the start of `text`.
fn arguments<'t>(text: &'t str, word: &str) -> Option<&'t str> {
    let found = text.get(..word.len())?;
    let rest = text[found.len()..].trim_start().strip_prefix(['[', '('])?;
    if found.eq_ignore_ascii_case(word) { rest.split([']', ')']).next() } else { None }
}

/// The entries of a key directory: key, location, count, value.
fn entries(directory: &[u8]) -> impl Iterator<Item = [u16; 4]> {
    directory
        .chunks_exact(8)
        .skip(1)
        .map(|entry| std::array::from_fn(|i| u16::from_le_bytes([entry[2 * i], entry[2 * i + 1]])))
}

fn geo_keys_code(directory: &[u8]) -> Option<String> {
    let code = |wanted| {
        entries(directory)
            .find(|&[key, location, ..]| key == wanted && location == 0)
            .map(|[.., value]| value)
            .filter(|&value| value != 0 && value != USER_DEFINED)
    };
    // A projected system defined by other keys is none of EPSG's, although its geographic base is.
    let is_projected = entries(directory).any(|[key, ..]| key == PROJECTED);
    let code = if is_projected { code(PROJECTED) } else { code(GEOGRAPHIC) };
    code.map(|code| format!("EPSG:{code}"))
}

fn geo_keys_text(directory: &[u8], ascii: &[u8], wanted: u16) -> Option<String> {
    let [_, _, count, start] =
        entries(directory).find(|&[key, location, ..]| key == wanted && location == 34737)?;
    let text = ascii.get(usize::from(start)..)?.get(..usize::from(count))?;
    let text = String::from_utf8_lossy(text);
    let text = text.trim_end_matches(['|', '\0']).trim();
    (!text.is_empty()).then(|| text.to_string())
}
