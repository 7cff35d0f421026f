//! Conversion between formats: what goes round comes back, and what is damaged is refused.

mod command;
mod corruption;
mod historical;
mod independent;
mod peers;
mod ply;
mod samples;
mod text;
mod volume;

use std::io::Cursor;

use spmesh::convert::{Format, Options, convert};
use spmesh::error::Result;

/// `input`, of format `from`, as `to`.
fn converted(input: &[u8], from: Format, to: Format) -> Result<Vec<u8>> {
    with_notices(input, from, to).map(|(output, _)| output)
}

fn with_notices(input: &[u8], from: Format, to: Format) -> Result<(Vec<u8>, Vec<String>)> {
    let options = Options { from: Some(from), ..Options::default() };
    let mut output = Vec::new();
    let notices = convert(Cursor::new(input.to_vec()), "test", to, &mut output, &options, |_| ())?;
    Ok((output, notices))
}

fn text_of(stream: &[u8]) -> String {
    String::from_utf8(converted(stream, Format::Spm, Format::Text).unwrap()).unwrap()
}
