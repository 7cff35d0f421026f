//! The header of an array of numpy: a dictionary of Python with the keys descr, fortran_order and shape.

use crate::source::origin::FileView;
use crate::text::lines::quote;
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::NPY_HEADER_MAX;

/// What a header states.
#[derive(Debug, PartialEq)]
pub(crate) struct NpyHeader {
    /// The type of numbers, such as `<f8`.
    pub(crate) dtype: String,
    /// Whether the first index runs fastest.
    pub(crate) is_by_columns: bool,
    pub(crate) shape: Vec<u64>,
    /// Offset of the first number.
    pub(crate) start: u64,
}

impl NpyHeader {
    /// Reads the header of a file.
    pub(crate) fn read(view: &FileView) -> Result<NpyHeader> {
        let read = |start: u64, bytes: &mut [u8]| {
            let end = start + bytes.len() as u64;
            if view.len() < end {
                let what = format!("truncated: the header ends at byte {end}");
                return Err(Error::malformed(what).at(format!("byte {}", view.len())));
            }
            view.read_at(start, bytes).map_err(|e| Error::io("reading", e))
        };
        let mut start = [0; 12];
        read(0, &mut start[..10])?;
        let (len, at) = match start[6] {
            1 => (u32::from(u16::from_le_bytes([start[8], start[9]])), 10),
            2 | 3 => {
                read(0, &mut start)?;
                (u32::from_le_bytes([start[8], start[9], start[10], start[11]]), 12)
            }
            major => {
                let what = format!("version {major}.{} of the format, expected 1 to 3", start[7]);
                return Err(Error::malformed(what).at("byte 6"));
            }
        };
        if len > NPY_HEADER_MAX {
            let what = format!("a header of {len} bytes; headers of arrays have at most {NPY_HEADER_MAX}");
            return Err(Error::malformed(what).at("byte 8"));
        }
        let mut text = vec![0; len as usize];
        read(at, &mut text)?;
        let header = parse(&text).map_err(|error| error.at(format!("byte {at}")))?;
        Ok(NpyHeader { start: at + u64::from(len), ..header })
    }
}

/// Parses the dictionary. No recursion: a hostile header must not overflow the stack.
fn parse(text: &[u8]) -> Result<NpyHeader> {
    let bad = |what: &str| Error::malformed(format!("the header {what}: {}", quote(text)));
    let entries = str::from_utf8(text).ok().and_then(entries).ok_or_else(|| bad("is no dictionary"))?;
    let value = |key: &str| {
        let mut values = entries.iter().filter(|(known, _)| *known == key).map(|(_, value)| *value);
        values.next().ok_or_else(|| bad(&format!("lacks {key}")))
    };
    let dtype = value("descr")?;
    if dtype.starts_with('[') {
        let what = "columns with names (a structured dtype); expected numbers of one type: save \
                    numpy.column_stack of the fields";
        return Err(Error::malformed(what));
    }
    let is_by_columns = match value("fortran_order")? {
        "True" => true,
        "False" => false,
        _ => return Err(bad("states no order")),
    };
    let shape = shape(value("shape")?).ok_or_else(|| bad("states no shape"))?;
    let dtype = string(dtype).ok_or_else(|| bad("states no dtype"))?;
    if !dtype.is_ascii() || dtype.is_empty() {
        return Err(bad("states no dtype"));
    }
    Ok(NpyHeader { dtype: dtype.to_string(), is_by_columns, shape, start: 0 })
}

/// The entries of a dictionary, with their values as text; `None` if it is none.
fn entries(text: &str) -> Option<Vec<(&str, &str)>> {
    let mut rest = text.trim().strip_prefix('{')?.strip_suffix('}')?.trim();
    let mut entries = Vec::new();
    while !rest.is_empty() {
        let (key, after) = rest.split_once(':')?;
        let end = value_end(after);
        entries.push((string(key.trim())?, after[..end].trim()));
        rest = after[end..].trim_start_matches(',').trim();
    }
    Some(entries)
}

/// Where the value at the start of `text` ends: at a comma outside of brackets and quotes.
fn value_end(text: &str) -> usize {
    let (mut depth, mut quote) = (0i32, None);
    for (at, byte) in text.bytes().enumerate() {
        match (quote, byte) {
            (Some(open), _) if byte == open => quote = None,
            (Some(_), _) => {}
            (None, b'\'' | b'"') => quote = Some(byte),
            (None, b'(' | b'[') => depth += 1,
            (None, b')' | b']') => depth -= 1,
            (None, b',') if depth == 0 => return at,
            _ => {}
        }
    }
    text.len()
}

/// The content of a string.
fn string(text: &str) -> Option<&str> {
    let quoted = |quote| text.strip_prefix(quote).and_then(|rest| rest.strip_suffix(quote));
    quoted('\'').or_else(|| quoted('"'))
}

/// The numbers of a tuple. Python 2 wrote `3L`.
fn shape(text: &str) -> Option<Vec<u64>> {
    let inner = text.strip_prefix('(')?.strip_suffix(')')?.trim();
    let inner = inner.strip_suffix(',').unwrap_or(inner);
    if inner.is_empty() {
        return Some(Vec::new());
    }
    inner.split(',').map(|word| word.trim().trim_end_matches('L').parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dictionaries_are_parsed() {
        let of = |text: &str| parse(text.as_bytes());
        let header = NpyHeader { dtype: "<f8".into(), is_by_columns: false, shape: vec![3, 2], start: 0 };
        for text in [
            "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2), }     \n",
            "{\"shape\":(3L,2L),\"fortran_order\":False,\"descr\":\"<f8\"}",
        ] {
            assert_eq!(of(text).unwrap(), header);
        }
        let flat = of("{'descr': '|u1', 'fortran_order': True, 'shape': (7,)}").unwrap();
        assert_eq!((flat.is_by_columns, flat.shape), (true, vec![7]));
        assert!(of("{'descr': '<f8', 'fortran_order': True, 'shape': ()}").unwrap().shape.is_empty());
        let deep = format!("{{'descr': {}", "(".repeat(9_000));
        for (text, part) in [
            ("", "no dictionary"),
            ("{'descr' '<f8'}", "no dictionary"),
            (&deep[..], "no dictionary"),
            ("{}", "lacks descr"),
            ("{'descr': '<f8', 'fortran_order': 0, 'shape': (3, 2)}", "no order"),
            ("{'descr': '<f8', 'fortran_order': True, 'shape': (-3, 2)}", "no shape"),
            ("{'descr': <f8, 'fortran_order': True, 'shape': (3, 2)}", "no dtype"),
            ("{'descr': '', 'fortran_order': True, 'shape': (3, 2)}", "no dtype"),
            ("{'descr': [('x', '<f8')], 'fortran_order': True, 'shape': (3,)}", "structured"),
        ] {
            let message = of(text).unwrap_err().to_string();
            assert!(message.contains(part), "{message}");
        }
    }
}
