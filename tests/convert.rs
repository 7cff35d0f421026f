//! Conversion between formats: round trips restore the stream, and damaged input is refused.

mod command;
mod corruption;
mod exchange;
mod historical;
mod independent;
mod peers;
mod ply;
mod samples;
mod survey;
mod text;
mod volume;

use std::io::Cursor;

use spmesh_base::error::{ErrorKind, Result};
use spmesh_convert::{Options, convert};
use spmesh_formats::drivers::Format;

use crate::programs::assert_outcome;
use crate::vectors::load;

/// `input` converted from one format to another.
pub fn converted(input: &[u8], from: Format, to: Format) -> Result<Vec<u8>> {
    with_notices(input, from, to).map(|(output, _)| output)
}

fn with_notices(input: &[u8], from: Format, to: Format) -> Result<(Vec<u8>, Vec<String>)> {
    let options = Options { from: Some(from), ..Options::default() };
    let mut output = Vec::new();
    let notices = convert(Cursor::new(input.to_vec()), "test", to, &mut output, &options, |_| ())?;
    Ok((output, notices))
}

pub fn text_of(stream: &[u8]) -> String {
    String::from_utf8(converted(stream, Format::Stream, Format::Twin).unwrap()).unwrap()
}

/// Asserts that a text twin is refused after `found` is replaced by `replaced`, and that the message has the
/// line number and `expected`.
pub fn assert_refused(text: &str, found: &str, replaced: &str, expected: &str) {
    assert!(text.contains(found), "{found} in {text}");
    let damaged = text.replacen(found, replaced, 1);
    let error = converted(damaged.as_bytes(), Format::Twin, Format::Stream).expect_err(replaced);
    assert_eq!(error.kind(), ErrorKind::Malformed, "{replaced}: {error}");
    let message = error.to_string();
    assert!(message.contains(expected) && message.starts_with("test: line "), "{replaced}: {message}");
}

/// A fault that no reader of the output could see must not get an END.
#[test]
fn no_refused_vector_goes_on_to_an_output() {
    for vector in load("fail", "err") {
        for to in
            [Format::Stream, Format::Twin, Format::Obj, Format::Ply, Format::Spa, Format::Smb, Format::VtkXml]
        {
            let error = converted(&vector.bytes, Format::Stream, to).expect_err(&vector.name);
            // Some formats refuse the kind of stream by its header.
            let is_expected =
                error.exit_code() == vector.exit_code && error.to_string().contains(&vector.expected);
            assert!(is_expected || error.kind() == ErrorKind::Usage, "{}: {error}", vector.name);
        }
    }
}

/// The twins break the same rules, and cell tags that lie are refused in points, too.
#[test]
fn rules_that_need_memory_hold_in_twins_and_in_points() {
    let twin =
        |name: &str| load("pass", "txt").into_iter().find(|vector| vector.name == name).unwrap().expected;
    assert_refused(&twin("points-tagged"), "x cell 16\n", "x cell 19\n", "in a cell that is final");
    assert_refused(&twin("points-tagged"), "x cell 31\n", "x cell 16\n", "final already");
    assert_refused(
        &twin("mesh-two-patches"),
        "x 1\n# patch",
        "x 2\n# patch",
        "referenced after finalization",
    );
    assert_refused(
        &twin("partial-residual"),
        "r 1 0 0 0",
        "r 1 1 0 0",
        "other coordinates than its vertex 0",
    );
    for vector in load("fail", "err").into_iter().filter(|vector| vector.name.starts_with("point-in-final-"))
    {
        for (tool, arguments) in [
            ("spfinalize", &[][..]),
            ("tess3", &[]),
            ("configgen", &["--degree", "1"]),
            ("spdelaunay2d", &[]),
        ] {
            assert_outcome(tool, &[arguments, &["-"]].concat(), &vector.bytes, 3, &vector.expected);
        }
    }
}

/// Asserts that a text twin is refused when cut anywhere but before its last line feed.
pub fn assert_cuts_are_refused(text: &str) {
    for end in 0..text.len() - 1 {
        let error = converted(&text.as_bytes()[..end], Format::Twin, Format::Stream).expect_err("cut");
        assert_eq!(error.kind(), ErrorKind::Malformed, "cut at byte {end}: {error}");
    }
}

/// Asserts this for the twins of all vectors whose names are meant.
pub fn assert_cut_vectors_are_refused(is_meant: impl Fn(&str) -> bool) {
    let vectors: Vec<_> = load("pass", "txt").into_iter().filter(|vector| is_meant(&vector.name)).collect();
    assert!(!vectors.is_empty());
    vectors.iter().for_each(|vector| assert_cuts_are_refused(&vector.expected));
}
