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
        let name = description[NAME..NAME + TEXT_LEN].split(|&byte| byte == 0).next().unwrap_or_default();
        if name == short(&field.name) {
            let what =
                format!("the points have a field {} already: give the new one another --name", field.name);
            return Err(Error::usage(what));
        }
        all.extend_from_slice(description);
        left = after;
    }
    while left > 0 {
        let len = left.min(usize::from(u8::MAX));
        let mut bytes = [0; DESCRIPTION_LEN];
        (bytes[KIND], bytes[OPTIONS]) = (KIND_BYTES, len as u8);
        all.extend_from_slice(&bytes);
        left -= len;
    }
    all.extend_from_slice(&field.description());
    Ok(all)
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
        assert_eq!(found, [(KIND_BYTES, 255), (KIND_BYTES, 45), (KIND_I32, HAS_NO_DATA | HAS_SCALE)]);
        assert!(all[2 * DESCRIPTION_LEN + NAME..].starts_with(b"height\0"));
        assert_eq!(notices, 0);
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
