//! The files of an NRRD volume's values: the header's own file, another file, or several.

use std::path::Path;

use crate::source::origin::{Admitted, Origin};
use crate::text::lines::quote;
use crate::volumes::data::Part;
use crate::volumes::nrrd::fields::{Fields, integer};
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::NRRD_FILES_MAX;

/// The files that hold the values, each with the same number of them.
pub(crate) fn parts(fields: &Fields, origin: Origin, path: Option<&Path>, sites: u64) -> Result<Vec<Part>> {
    let Some(names) = names(fields).map_err(|e| fields.locate("data file", e))? else {
        if !fields.is_ended {
            let message = "truncated: the header has no empty line at its end, and no field data file";
            return Err(Error::malformed(message));
        }
        return Ok(vec![Part { origin, name: None, is_gzip: fields.is_gzip, header_len: fields.len }]);
    };
    let located = |e| fields.locate("data file", e);
    let Some(folder) = path.map(|path| path.parent().unwrap_or(Path::new(""))) else {
        let message = "the values are in another file: give the header as a file, not through stdin";
        return Err(located(Error::usage(message)));
    };
    if names.is_empty() || !sites.is_multiple_of(names.len() as u64) {
        let message = format!("{sites} values cannot be in {} files, each with as many", names.len());
        return Err(located(Error::malformed(message)));
    }
    names.into_iter().map(|name| part(folder, &name)).collect()
}

fn part(folder: &Path, name: &str) -> Result<Part> {
    let path = folder.join(name);
    // Anything else, such as a device, might be spooled without end.
    if std::fs::metadata(&path).is_ok_and(|metadata| !metadata.is_file()) {
        let message = "is not a file, expected the values of the volume";
        return Err(Error::malformed(message).of_input(path.display().to_string()));
    }
    let origin = Origin::new(&path, Admitted::Everything, &std::env::temp_dir(), &mut Vec::new())?;
    Ok(Part { origin, name: Some(path.display().to_string()), is_gzip: false, header_len: 0 })
}

/// Names of the files; `None` if the values are in the file of the header.
fn names(fields: &Fields) -> Result<Option<Vec<String>>> {
    let Some(text) = fields.get("data file") else { return Ok(None) };
    let words: Vec<&str> = text.split_whitespace().collect();
    match words[..] {
        ["LIST", ..] => Ok(Some(fields.listed.clone())),
        ["LOCAL"] => Ok(None),
        [pattern, min, max, ref rest @ ..] if pattern.contains('%') && rest.len() <= 2 => {
            let number = |text| integer(text, "a number of a file");
            let step = rest.first().map_or(Ok(1), |step| number(step))?;
            numbered(pattern, [number(min)?, number(max)?, step]).map(Some)
        }
        [] => Err(Error::malformed("expected the name of a file")),
        // A name may contain spaces.
        _ => Ok(Some(vec![text.to_string()])),
    }
}

/// Names of numbered files: `pattern` with the numbers from `min` to `max` in place of its `%d` or `%03d`.
fn numbered(pattern: &str, [min, max, step]: [u64; 3]) -> Result<Vec<String>> {
    let expected = || {
        let found = quote(pattern.as_bytes());
        Error::malformed(format!("found {found}, expected a name with one %d, or like %03d"))
    };
    let (before, rest) = pattern.split_once('%').ok_or_else(expected)?;
    let (width, after) = rest.split_once(['d', 'u', 'i']).ok_or_else(expected)?;
    let is_padded = width.starts_with('0');
    let width = if width.is_empty() { 0 } else { integer(width, "the width of a number")? as usize };
    if after.contains('%') || width > 20 {
        return Err(expected());
    }
    if step == 0 || min > max || (max - min) / step >= NRRD_FILES_MAX as u64 {
        let message =
            format!("found {min} to {max} by {step}, expected from 1 to {NRRD_FILES_MAX} increasing numbers");
        return Err(Error::malformed(message));
    }
    let count = (max - min) / step + 1;
    let name = |number: u64| {
        let number = min + number * step;
        if is_padded {
            format!("{before}{number:0width$}{after}")
        } else {
            format!("{before}{number:width$}{after}")
        }
    };
    Ok((0..count).map(name).collect())
}
