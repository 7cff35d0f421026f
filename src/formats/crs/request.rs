//! Systems that users name.

use std::path::Path;

use spmesh_base::error::{Error, Result};
use spmesh_base::inputs;
use spmesh_base::limits::CRS_LEN_MAX;
use spmesh_stream::Crs;

use crate::crs::epsg;
use crate::crs::from_wkt;

/// The system of an argument: `EPSG:n`, `EPSG:n+m` (n for x and y, m for heights), well-known text, or the
/// name of a file with such text, as `.prj` files have it.
///
/// # Errors
/// Usage, if the code is unknown or the text defines no system; I/O, if the file cannot be read.
pub fn requested(argument: &str) -> Result<Crs> {
    let bare = argument.trim();
    if let Some(codes) = strip_authority(bare) {
        return of_codes(codes).map(Crs::Wkt);
    }
    if bare.is_empty() || bare.bytes().all(|byte| byte.is_ascii_digit()) && !Path::new(argument).exists() {
        let what = format!("--crs {argument:?}: expected EPSG:CODE, well-known text, or a file");
        return Err(Error::usage(what));
    }
    let text = if bare.contains(['[', '(']) && !Path::new(argument).exists() {
        bare.to_string()
    } else {
        let content = inputs::read(Path::new(argument), "a system of", CRS_LEN_MAX as u64);
        let hint = "--crs takes EPSG:CODE, well-known text, or a file";
        let content = content.map_err(|e| e.noting(hint).of_input(argument))?;
        String::from_utf8(content)
            .map_err(|_| Error::malformed("is no text").noting(hint).of_input(argument))?
    };
    of_text(text.trim_start_matches('\u{feff}').trim())
}

fn strip_authority(text: &str) -> Option<&str> {
    let (authority, codes) = text.split_once(':')?;
    authority.eq_ignore_ascii_case("EPSG").then_some(codes)
}

/// The text of one code, or of a horizontal and a vertical one together.
pub(crate) fn of_codes(codes: &str) -> Result<String> {
    let text = |code: &str| {
        let number = code.trim().parse().map_err(|_| {
            Error::usage(format!("--crs EPSG:{codes}: expected a code, as in EPSG:25832 or EPSG:25832+7837"))
        })?;
        epsg::text(number).ok_or_else(|| Error::usage(format!("EPSG:{number} is not in the EPSG dataset")))
    };
    let Some((horizontal, vertical)) = codes.split_once('+') else {
        let text = text(codes)?;
        let is_horizontal = from_wkt::system(text).horizontal.is_some();
        let fault = || Error::usage(format!("EPSG:{codes} is no system of x and y"));
        return is_horizontal.then(|| text.to_string()).ok_or_else(fault);
    };
    let (x, z) = (text(horizontal)?, text(vertical)?);
    let (of_x, of_z) = (from_wkt::system(x), from_wkt::system(z));
    if of_x.horizontal.is_none() || of_x.vertical.is_some() {
        return Err(Error::usage(format!("EPSG:{horizontal} is no system of x and y alone")));
    }
    let (Some(of_z), None) = (of_z.vertical, of_z.horizontal) else {
        return Err(Error::usage(format!("EPSG:{vertical} is no system of heights")));
    };
    let name = of_x.horizontal.map(|known| known.name).unwrap_or_default();
    Ok(format!("COMPOUNDCRS[\"{name} + {}\",{x},{z}]", of_z.name))
}

fn of_text(text: &str) -> Result<Crs> {
    let system = from_wkt::system(text);
    if system.horizontal.is_none() {
        let why = system.remarks.first().map_or("it defines no system of x and y", String::as_str);
        return Err(Error::usage(format!("--crs: {why}")));
    }
    if text.len() > CRS_LEN_MAX {
        return Err(Error::usage(format!("--crs: the text is longer than {CRS_LEN_MAX} bytes")));
    }
    Ok(Crs::Wkt(text.to_string()))
}
