//! A field of integers in the extra bytes of point records.

use spmesh_base::error::{Error, Result};

/// Length of the description of a field.
pub(crate) const DESCRIPTION_LEN: usize = 192;
/// Longest name, and longest text about it. Units: bytes.
const TEXT_LEN: usize = 32;

/// Places in a description.
const KIND: usize = 2;
const OPTIONS: usize = 3;
const NAME: usize = 4;
const NO_DATA: usize = 40;
const SCALE: usize = 112;
const TEXT: usize = 160;

/// Its bits of options.
const HAS_NO_DATA: u8 = 1;
const HAS_SCALE: u8 = 8;
const HAS_OFFSET: u8 = 16;

/// The name of bytes without a meaning, as readers here call them.
const UNKNOWN_NAME: &str = "extra_bytes";

/// Kinds of fields: bytes without a meaning, and integers of 32 bits.
const KIND_BYTES: u8 = 0;
const KIND_I32: u8 = 6;
/// The kinds from 1 to this are numbers, and two or three of them.
const KIND_MAX: u8 = 30;

/// Bytes of a number, by its kind less one, modulo ten.
const NUMBER_LENS: [usize; 10] = [1, 1, 2, 2, 4, 4, 8, 8, 4, 8];

/// A field of 32-bit integers, of which each stands for a multiple of `scale`; [`ExtraField::NO_DATA`] stands for
/// none.
#[derive(Debug, Clone, PartialEq)]
pub struct ExtraField {
    /// Name, at most 32 bytes.
    pub name: String,
    /// What it is, at most 32 bytes.
    pub text: String,
    /// The value of one step.
    pub scale: f64,
}

impl ExtraField {
    /// The integer of points without a value.
    pub const NO_DATA: i32 = i32::MIN;

    /// Bytes of the field in a record.
    pub const LEN: usize = 4;

    /// The description in the record LASF_Spec 4.
    pub(crate) fn description(&self) -> [u8; DESCRIPTION_LEN] {
        let mut bytes = [0; DESCRIPTION_LEN];
        let mut put = |at: usize, value: &[u8]| bytes[at..at + value.len()].copy_from_slice(value);
        put(KIND, &[KIND_I32]);
        put(OPTIONS, &[HAS_NO_DATA | HAS_SCALE]);
        put(NAME, short(&self.name));
        put(NO_DATA, &i64::from(Self::NO_DATA).to_le_bytes());
        put(SCALE, &self.scale.to_le_bytes());
        put(TEXT, short(&self.text));
        bytes
    }
}

fn short(text: &str) -> &[u8] {
    &text.as_bytes()[..text.len().min(TEXT_LEN)]
}

/// `described`, the descriptions of `extra_len` extra bytes, with that of one more field. Bytes that none of
/// them describes are described as bytes without a meaning, so that the new field is at its place. Descriptions of
/// more bytes than there are mean nothing: they are left out, with a notice.
pub(crate) fn with_field(
    described: &[u8],
    extra_len: usize,
    field: &ExtraField,
    notices: &mut Vec<String>,
) -> Result<Vec<u8>> {
    let mut all = Vec::new();
    let mut left = extra_len;
    for description in described.chunks_exact(DESCRIPTION_LEN) {
        let Some(after) = len_of(description).and_then(|len| left.checked_sub(len)) else {
            notices.push(format!(
                "{} descriptions of extra bytes that do not fit the {extra_len} in each record are left out",
                described[all.len()..].len() / DESCRIPTION_LEN
            ));
            break;
        };
        if name_of(description) == short(&field.name) {
            let what =
                format!("the points have a field {} already: give the new one another --name", field.name);
            return Err(Error::usage(what));
        }
        all.extend_from_slice(description);
        left = after;
    }
    describe_unknown(&mut all, left, field);
    all.extend_from_slice(&field.description());
    Ok(all)
}

fn name_of(description: &[u8]) -> &[u8] {
    description[NAME..NAME + TEXT_LEN].split(|&byte| byte == 0).next().unwrap_or_default()
}

/// Appends descriptions of `left` bytes without a meaning. Their names are unused: readers tell fields apart
/// by their names.
fn describe_unknown(all: &mut Vec<u8>, mut left: usize, field: &ExtraField) {
    let numbered = (2..).map(|number| format!("{UNKNOWN_NAME}_{number}"));
    let mut names = std::iter::once(UNKNOWN_NAME.to_string()).chain(numbered);
    while left > 0 {
        let is_used = |name: &str| {
            name == field.name || all.chunks_exact(DESCRIPTION_LEN).any(|one| name_of(one) == name.as_bytes())
        };
        let name = names.find(|name| !is_used(name)).unwrap_or_default();
        let mut bytes = [0; DESCRIPTION_LEN];
        let len = unknown_len(left);
        (bytes[KIND], bytes[OPTIONS]) = (KIND_BYTES, len);
        bytes[NAME..NAME + name.len()].copy_from_slice(name.as_bytes());
        all.extend_from_slice(&bytes);
        left -= usize::from(len);
    }
}

/// The most bytes without a meaning, at most `left`, that one description may count. The count is where other
/// kinds have their options, and laspy (2.7) takes it for these too: it must not look like scale or offset.
fn unknown_len(left: usize) -> u8 {
    let len = left.min(usize::from(u8::MAX)) as u8;
    let taken_for = HAS_SCALE | HAS_OFFSET;
    if len & taken_for == 0 { len } else { len & !(2 * HAS_OFFSET - 1) | (HAS_SCALE - 1) }
}

/// Bytes in a record of the field that a description tells of; `None` if its kind is unknown.
fn len_of(description: &[u8]) -> Option<usize> {
    match description[KIND] {
        KIND_BYTES => Some(usize::from(description[OPTIONS])),
        kind @ 1..=KIND_MAX => {
            let (kind, count) = (usize::from(kind - 1) % 10, usize::from(kind - 1) / 10 + 1);
            Some(count * NUMBER_LENS[kind])
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_base::error::ErrorKind;

    fn field() -> ExtraField {
        ExtraField { name: "height".into(), text: "above ground".into(), scale: 0.01 }
    }

    fn with(described: &[u8], extra_len: usize, field: &ExtraField) -> Result<(Vec<u8>, usize)> {
        let mut notices = Vec::new();
        Ok((with_field(described, extra_len, field, &mut notices)?, notices.len()))
    }

    #[test]
    fn bytes_without_a_description_get_one() {
        let (all, notices) = with(&[], 300, &field()).unwrap();
        let found: Vec<_> = all.chunks(DESCRIPTION_LEN).map(|one| (one[KIND], one[OPTIONS])).collect();
        let bytes = |len| (KIND_BYTES, len);
        let height = (KIND_I32, HAS_NO_DATA | HAS_SCALE);
        assert_eq!(found, [bytes(231), bytes(69), height]);
        let names: Vec<_> = all.chunks(DESCRIPTION_LEN).map(name_of).collect();
        assert_eq!(names, [&b"extra_bytes"[..], b"extra_bytes_2", b"height"]);
        assert_eq!(notices, 0);
    }

    #[test]
    fn counts_of_bytes_look_like_no_options() {
        for len in 1..=600 {
            let (all, _) = with(&[], len, &field()).unwrap();
            let (_, bytes) = all.as_chunks::<DESCRIPTION_LEN>().0.split_last().unwrap();
            assert!(bytes.iter().all(|one| one[OPTIONS] & (HAS_SCALE | HAS_OFFSET) == 0), "{len}");
            assert_eq!(bytes.iter().map(|one| usize::from(one[OPTIONS])).sum::<usize>(), len);
        }
    }

    #[test]
    fn names_of_bytes_are_unused() {
        let named = |name: &str| ExtraField { name: name.into(), ..field() };
        let one = named("extra_bytes_2").description();
        let (all, _) = with(&one, 4 + 9, &named("extra_bytes")).unwrap();
        let names: Vec<_> = all.chunks(DESCRIPTION_LEN).map(name_of).collect();
        assert_eq!(names, [&b"extra_bytes_2"[..], b"extra_bytes_3", b"extra_bytes_4", b"extra_bytes"]);
    }

    #[test]
    fn a_field_needs_an_unused_name() {
        let (one, _) = with(&[], 0, &field()).unwrap();
        assert_eq!(with(&one, 4, &field()).unwrap_err().kind(), ErrorKind::Usage);
        let other = ExtraField { name: "other".into(), ..field() };
        assert_eq!(with(&one, 4, &other).unwrap(), ([&one[..], &other.description()].concat(), 0));
    }

    #[test]
    fn descriptions_of_nothing_are_left_out() {
        let (one, _) = with(&[], 0, &field()).unwrap();
        let other = ExtraField { name: "other".into(), ..field() };
        assert_eq!(with(&one, 0, &other).unwrap(), (other.description().to_vec(), 1));
        let mut unknown = one;
        unknown[KIND] = 31;
        let (all, notices) = with(&unknown, 4, &other).unwrap();
        assert_eq!((all[KIND], all[OPTIONS], all.len(), notices), (KIND_BYTES, 4, 2 * DESCRIPTION_LEN, 1));
    }
}
