//! Coordinate reference systems: short names, and the system that files share.

use crate::geo_keys::{self, CITATION, GEOGRAPHIC_TYPE, PROJECTED_TYPE};
use spmesh_core::error::{Error, Result};
use spmesh_core::limits::CRS_LEN_MAX;
use spmesh_stream::Crs;

/// Keys of citations, in the order of preference.
const CITATIONS: [u16; 3] = [3073, CITATION, 2049];

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

/// `crs`, or [`Crs::Unknown`] with a notice if it is too long for the header of a stream.
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

/// The system that all `files`, given as (name, system), share. A file that states none takes the system of
/// the others.
///
/// # Errors
/// Usage, if two systems differ.
pub(super) fn common<'s>(
    files: impl Iterator<Item = (&'s str, &'s Crs)> + Clone,
    notices: &mut Vec<String>,
) -> Result<Crs> {
    let mut known = files.clone().filter(|(_, crs)| **crs != Crs::Unknown);
    let Some((first, crs)) = known.next() else { return Ok(Crs::Unknown) };
    if let Some((other, other_crs)) = known.find(|(_, other)| !is_same(crs, other)) {
        let name = |crs: &Crs| crs_name(crs).unwrap_or_else(|| "unnamed".to_string());
        return Err(Error::usage(format!(
            "the coordinate reference systems differ: {} in {first}, {} in {other}",
            name(crs),
            name(other_crs)
        )));
    }
    if let Some((unknown, _)) = files.clone().find(|(_, crs)| **crs == Crs::Unknown) {
        notices.push(format!("{unknown}: states no coordinate reference system, taking that of {first}"));
    }
    Ok(crs.clone())
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

/// The code of the outermost AUTHORITY (WKT 1) or ID (WKT 2).
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

/// The text in the brackets after `word`, if `text` starts with `word`.
fn arguments<'t>(text: &'t str, word: &str) -> Option<&'t str> {
    let found = text.get(..word.len())?;
    let rest = text[found.len()..].trim_start().strip_prefix(['[', '('])?;
    if found.eq_ignore_ascii_case(word) { rest.split([']', ')']).next() } else { None }
}

fn geo_keys_code(directory: &[u8]) -> Option<String> {
    let numbers = geo_keys::numbers(directory);
    let code =
        |wanted| geo_keys::short(&numbers, wanted).filter(|&value| value != 0 && value != USER_DEFINED);
    // A projected system defined by other keys has no EPSG code, even if its geographic base has one.
    let is_projected = geo_keys::keys(&numbers).any(|[key, ..]| key == PROJECTED_TYPE);
    let code = if is_projected { code(PROJECTED_TYPE) } else { code(GEOGRAPHIC_TYPE) };
    code.map(|code| format!("EPSG:{code}"))
}

fn geo_keys_text(directory: &[u8], ascii: &[u8], wanted: u16) -> Option<String> {
    let text = String::from_utf8_lossy(geo_keys::text(&geo_keys::numbers(directory), ascii, wanted)?);
    let text = text.trim_end_matches(['|', '\0']).trim();
    (!text.is_empty()).then(|| text.to_string())
}
