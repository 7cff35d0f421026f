//! Lines as text.

use std::io::Read;

use crate::lines::collect::Shape;
use crate::lines::{Breaklines, Collector, Reading};
use crate::text::lines::{number, quote};
use crate::text::words::{finite, for_each_line_at};
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::check_line_vertices;
use spmesh_stream::Crs;

/// A line that is being read.
struct Open {
    vertices: Vec<[f64; 3]>,
    is_hard: bool,
    /// Number of the line of text that starts it.
    number: u64,
}

/// Reads lines of text: see [`crate::lines::read_breaklines`].
pub(crate) fn read(input: impl Read, reading: &Reading) -> Result<Breaklines> {
    let mut lines = Collector::new(reading);
    let mut open: Option<Open> = None;
    for_each_line_at(input, |number, words| {
        let mut words = words;
        let is_hard = match words[0] {
            b"line" => Some(true),
            b"soft" => Some(false),
            _ => None,
        };
        if let Some(is_hard) = is_hard {
            let started = Open { vertices: Vec::new(), is_hard, number };
            close(open.replace(started), &mut lines)?;
            words = &words[1..];
        }
        let Some(open) = &mut open else {
            return Err(Error::malformed(format!("found {}, expected line or soft", quote(words[0]))));
        };
        open.extend(words)
    })?;
    close(open, &mut lines)?;
    lines.finish(Crs::Unknown)
}

fn close(open: Option<Open>, lines: &mut Collector) -> Result<()> {
    let Some(Open { vertices, number, .. }) = open else { return Ok(()) };
    let position = || format!("line {number}");
    if vertices.is_empty() {
        return Err(Error::malformed("found no vertices of the line").at(position()));
    }
    lines.add(Shape::Line, &vertices, position)
}

impl Open {
    fn extend(&mut self, words: &[&[u8]]) -> Result<()> {
        let (len, names) = if self.is_hard { (3, "x, y and z") } else { (2, "x and y") };
        if !words.len().is_multiple_of(len) {
            let found = words.len();
            return Err(Error::malformed(format!("found {found} numbers, expected {names} of each vertex")));
        }
        for vertex in words.chunks_exact(len) {
            let z = vertex.get(2).map_or(Ok(f64::NAN), |&word| elevation(word))?;
            self.vertices.push([finite(vertex[0])?, finite(vertex[1])?, z]);
        }
        check_line_vertices(self.vertices.len(), usize::MAX)
    }
}

/// An elevation; NaN if it is unknown.
fn elevation(word: &[u8]) -> Result<f64> {
    let found = number(word).filter(|number| !number.is_infinite());
    found.ok_or_else(|| Error::malformed(format!("found {}, expected an elevation, or nan", quote(word))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_start_lines() {
        let text = "# roads\nline 0 0 1, 1 0 nan\n 2 0 3\n\nsoft\n5 5\n6 5 # end\n";
        let lines = read(text.as_bytes(), &Reading::default()).unwrap().lines;
        assert_eq!(lines[0].vertices, [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]);
        assert_eq!(lines[0].elevations, [Some(1.0), None, Some(3.0)]);
        assert_eq!(
            (&lines[1].vertices[..], &lines[1].position[..]),
            (&[[5.0, 5.0], [6.0, 5.0]][..], "line 5")
        );
        assert_eq!(lines[1].elevations, [None, None]);
        for (text, part) in [
            ("", "found no lines"),
            ("1 2 3\n", "line 1: found \"1\", expected line or soft"),
            ("line 1 2 3\nridge 1\n", "line 2: found 2 numbers, expected x, y and z"),
            ("line 1 2 3 ridge 1 2\n", "line 1: found \"ridge\", expected a finite number"),
            ("soft 1 2 3\n", "line 1: found 3 numbers, expected x and y"),
            ("soft 1 inf\n", "line 1: found \"inf\", expected a finite number"),
            ("line 1 1 inf\n", "line 1: found \"inf\", expected an elevation"),
            ("line\nsoft 1 1\n", "line 1: found no vertices"),
        ] {
            let message = read(text.as_bytes(), &Reading::default()).unwrap_err().to_string();
            assert!(message.contains(part), "{text}: {message}");
        }
    }
}
