//! Recognizes formats by their content.

use super::{Format, off};
use crate::source::lines::number;
use crate::source::vtk;
use spmesh_core::error::{Error, Result};

/// Bytes from the start of an input that are looked at.
pub(super) const HEAD_LEN: u64 = 1 << 16;

/// Records by which PDB is recognized, but for those of atoms: words that start a line of few other texts.
const PDB_RECORDS: [&[u8]; 22] = [
    b"HEADER", b"OBSLTE", b"COMPND", b"SOURCE", b"KEYWDS", b"EXPDTA", b"NUMMDL", b"AUTHOR", b"REVDAT",
    b"SPRSDE", b"JRNL", b"REMARK", b"DBREF", b"SEQADV", b"SEQRES", b"MODRES", b"HETNAM", b"FORMUL",
    b"SSBOND", b"CRYST1", b"ORIGX1", b"MODEL",
];

/// First bytes of files that are given by mistake, and what to do about it.
const MISTAKEN: [(&[u8], &str); 6] = [
    (b"\x28\xb5\x2f\xfd", "zstd data: decompress it first, for example with zstdcat"),
    (b"PK\x03\x04", "a zip archive: unpack it first, for example with unzip -p"),
    (b"BZh", "bzip2 data: decompress it first, for example with bzcat"),
    (b"\xfd7zXZ\x00", "xz data: decompress it first, for example with xzcat"),
    (b"\xff\xfe", "text in UTF-16: convert it first, for example with iconv -f utf-16 -t utf-8"),
    (b"\x1f\x8b", "gzip data within gzip data: decompress it first, for example with zcat"),
];

/// The format of an input that starts with `head`.
///
/// # Errors
/// If it is empty, or of a format that is known not to be read.
pub(super) fn detect(head: &[u8]) -> Result<Format> {
    if head.trim_ascii().is_empty() {
        return Err(Error::malformed("empty: found no atom and no point"));
    }
    if let Some((_, what)) = MISTAKEN.iter().find(|(magic, _)| head.starts_with(magic)) {
        return Err(Error::malformed(format!("is {what}")));
    }
    if head.contains(&0) || head.starts_with(b"#spmesh ") {
        let is_ply = head.starts_with(b"ply\n") || head.starts_with(b"ply\r");
        return Ok(if is_ply { Format::Ply } else { Format::Points });
    }
    if vtk::is_legacy(head) || vtk::is_xml(head) {
        return Ok(Format::Points);
    }
    Ok(detect_text(head))
}

fn detect_text(head: &[u8]) -> Format {
    let mut lines = head.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii_end);
    if lines.clone().next().is_some_and(|line| line == b"ply") {
        return Format::Ply;
    }
    if is_xyz(lines.clone()) {
        return Format::Xyz;
    }
    lines.find_map(by_line).unwrap_or(Format::Points)
}

/// The format that only one has such a line of.
fn by_line(line: &[u8]) -> Option<Format> {
    let mut fields = line.split(u8::is_ascii_whitespace).filter(|field| !field.is_empty());
    let word = fields.next()?;
    let starts_with = |start: &[u8]| word.get(..start.len()).is_some_and(|w| w.eq_ignore_ascii_case(start));
    if starts_with(b"data_") || starts_with(b"loop_") || starts_with(b"_atom_site.") {
        return Some(Format::Mmcif);
    }
    if off::is_kind(word) {
        return Some(Format::Off);
    }
    // The serial number may touch the name of the record.
    let is_atom = |name: &[u8]| starts_with(name) && word[name.len()..].iter().all(u8::is_ascii_digit);
    if line[0] == word[0] && (PDB_RECORDS.contains(&word) || is_atom(b"ATOM") || is_atom(b"HETATM")) {
        return Some(Format::Pdb);
    }
    (word == b"v" && fields.clone().count() >= 3 && fields.all(|field| number(field).is_some()))
        .then_some(Format::Obj)
}

/// Whether the text starts with a count, a comment and an atom: `element x y z`.
fn is_xyz<'a>(mut lines: impl Iterator<Item = &'a [u8]>) -> bool {
    let fields = |line: &'a [u8]| line.split(u8::is_ascii_whitespace).filter(|field| !field.is_empty());
    let Some(first) = lines.find(|line| !line.is_empty()) else { return false };
    let is_count = first.trim_ascii().iter().all(u8::is_ascii_digit);
    let mut atom = fields(lines.nth(1).unwrap_or_default()).skip(1);
    is_count && atom.by_ref().take(3).filter(|field| number(field).is_some()).count() == 3
}
