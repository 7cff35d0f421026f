//! The format of an input: by its content, and by the name of the file where that leaves a doubt.

use std::path::Path;

use super::Format;
use spmesh_base::error::{Error, Result};
use spmesh_formats::detect::{self, SPCONVERT, detect};

/// The format of an input that starts with `head`.
///
/// # Errors
/// Malformed, if the input is empty or of a format that is not read; usage, if its format is unknown or
/// ambiguous.
pub(super) fn recognize(head: &[u8], name: &Path) -> Result<Format> {
    let found = detect(head)?;
    let by_name = || Format::from_path(&without_gz(name)).filter(|format| format.is_read());
    let unknown =
        || Error::usage("cannot tell the format from the first bytes and the name: give it with --from");
    Ok(match found {
        detect::Format::Stream => Format::Spm,
        detect::Format::Twin => Format::Text,
        detect::Format::Obj => Format::Obj,
        detect::Format::Ply => Format::Ply,
        detect::Format::Spa => Format::Spa,
        detect::Format::Spb => Format::Spb,
        detect::Format::Sma => Format::Sma,
        detect::Format::Smb => Format::Smb,
        detect::Format::VertexLines | detect::Format::OtherText => by_name().ok_or_else(unknown)?,
        other if SPCONVERT.reads(other) => Format::Points,
        detect::Format::Binary => by_name().ok_or_else(unknown)?,
        other => return Err(Error::malformed(SPCONVERT.refusal(other, head))),
    })
}

/// The name of a compressed file without its last extension.
fn without_gz(name: &Path) -> std::borrow::Cow<'_, Path> {
    let is_gz = name.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gz"));
    if is_gz { name.with_extension("").into() } else { name.into() }
}
