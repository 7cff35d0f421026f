//! Polygons as text (WKT, well-known text).

use std::io::Read;

use crate::lines::collect::Shape;
use crate::lines::{Breaklines, Collector, Reading, without_mark};
use crate::text::lines::quote;
use crate::text::words::finite;
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::WKT_LEN_MAX;
use spmesh_stream::Crs;

/// Whether a file that starts with `head` is well-known text of polygons.
pub(crate) fn is_wkt(head: &[u8]) -> bool {
    let text = without_mark(head).trim_ascii_start();
    let starts = |word: &[u8]| text.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word));
    starts(b"POLYGON") || starts(b"MULTIPOLYGON") || starts(b"SRID=")
}

/// Reads any number of `POLYGON` and `MULTIPOLYGON`, each with an optional `SRID=N;` before it.
pub(crate) fn read(input: impl Read, reading: &Reading) -> Result<Breaklines> {
    let mut bytes = Vec::new();
    input.take(WKT_LEN_MAX + 1).read_to_end(&mut bytes).map_err(|e| Error::io("reading", e))?;
    if bytes.len() as u64 > WKT_LEN_MAX {
        return Err(Error::malformed(format!("more than {WKT_LEN_MAX} bytes: simplify the polygons")));
    }
    let mut text = Text { rest: without_mark(&bytes), line: 1 };
    let mut polygons = Polygons { lines: Collector::new(reading), count: 0 };
    while text.peek().is_some() {
        polygons.geometry(&mut text).map_err(|error| error.at(format!("line {}", text.line)))?;
    }
    polygons.lines.finish(Crs::Unknown)
}

/// The polygons that were read.
struct Polygons {
    lines: Collector,
    count: u64,
}

impl Polygons {
    fn geometry(&mut self, text: &mut Text) -> Result<()> {
        let mut word = text.word();
        if word.to_ascii_uppercase().starts_with(b"SRID=") {
            text.expect(b";")?;
            word = text.word();
        }
        let is_multi = word.eq_ignore_ascii_case(b"MULTIPOLYGON");
        if !is_multi && !word.eq_ignore_ascii_case(b"POLYGON") {
            return Err(expected(word, "POLYGON or MULTIPOLYGON"));
        }
        if text.peek().is_some_and(|byte| byte.is_ascii_alphabetic()) {
            let word = text.word().to_ascii_uppercase();
            match &word[..] {
                b"EMPTY" => return Ok(()),
                b"Z" | b"M" | b"ZM" => {}
                _ => return Err(expected(&word, "(")),
            }
        }
        if is_multi { list(text, |text, _| self.polygon(text)).map(drop) } else { self.polygon(text) }
    }

    fn polygon(&mut self, text: &mut Text) -> Result<()> {
        self.lines.polygon();
        list(text, |text, number| {
            let vertices = list(text, |text, _| position(text))?;
            check_closed(&vertices).map_err(|error| Error::malformed(format!("ring {number}: {error}")))?;
            self.lines.add(Shape::Ring, &vertices, || format!("polygon {}", self.count))
        })?;
        self.count += 1;
        Ok(())
    }
}

/// Checks that a ring repeats its first vertex at the end.
fn check_closed(vertices: &[[f64; 3]]) -> Result<()> {
    let ([x, y, _], [u, v, _]) = (vertices[0], vertices[vertices.len() - 1]);
    let message = if [x, y] != [u, v] {
        format!("it starts at {x}, {y} and ends at {u}, {v}: repeat its first position at the end")
    } else if vertices.len() < 4 {
        format!("found {} positions, expected 4 at least: the first again at the end", vertices.len())
    } else {
        return Ok(());
    };
    Err(Error::malformed(message))
}

/// A position, without its third coordinate.
fn position(text: &mut Text) -> Result<[f64; 3]> {
    let mut numbers = Vec::new();
    while text.peek().is_some_and(|byte| !b",()".contains(&byte)) {
        numbers.push(finite(text.word())?);
    }
    match numbers[..] {
        [x, y, ..] => Ok([x, y, f64::NAN]),
        _ => Err(Error::malformed(format!("found {} coordinates, expected 2 at least", numbers.len()))),
    }
}

/// The items between parentheses and commas.
fn list<T>(text: &mut Text, mut item: impl FnMut(&mut Text, usize) -> Result<T>) -> Result<Vec<T>> {
    text.expect(b"(")?;
    let mut items = Vec::new();
    loop {
        items.push(item(text, items.len())?);
        if text.expect(b",)")? == b')' {
            return Ok(items);
        }
    }
}

fn expected(found: &[u8], what: &str) -> Error {
    let found = if found.is_empty() { "the end of the file".to_string() } else { quote(found) };
    Error::malformed(format!("found {found}, expected {what}"))
}

/// The rest of a text.
struct Text<'a> {
    rest: &'a [u8],
    line: u64,
}

impl<'a> Text<'a> {
    /// The next byte that is not a blank.
    fn peek(&mut self) -> Option<u8> {
        while let Some((&byte, rest)) = self.rest.split_first().filter(|(byte, _)| byte.is_ascii_whitespace())
        {
            self.line += u64::from(byte == b'\n');
            self.rest = rest;
        }
        self.rest.first().copied()
    }

    /// The bytes up to the next blank or mark; a mark itself is a word of one byte.
    fn word(&mut self) -> &'a [u8] {
        self.peek();
        let is_end = |byte: &u8| byte.is_ascii_whitespace() || b",();".contains(byte);
        let len = self.rest.iter().position(is_end).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(len.max(1).min(self.rest.len()));
        self.rest = rest;
        word
    }

    /// Takes one of some marks.
    fn expect(&mut self, marks: &[u8]) -> Result<u8> {
        let word = self.word();
        match word {
            &[mark] if marks.contains(&mark) => Ok(mark),
            _ => {
                let marks: Vec<String> = marks.iter().map(|&mark| char::from(mark).to_string()).collect();
                Err(expected(word, &marks.join(" or ")))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_have_rings() {
        let rings = |text: &str| {
            let lines = read(text.as_bytes(), &Reading::default()).unwrap().lines;
            let ring = |line: crate::lines::Breakline| {
                (line.polygon, line.vertices.len(), line.position.to_string())
            };
            lines.into_iter().map(ring).collect::<Vec<_>>()
        };
        let ring = |polygon: u32, len: usize| (Some(polygon), len, format!("polygon {polygon}"));
        let square = "(0 0,4 0,4 4,0 4,0 0)";
        let hole = "(1 1,2 1,1 2,1 1)";
        assert_eq!(rings(&format!("\u{feff}POLYGON({square},{hole})")), [ring(0, 5), ring(0, 4)]);
        let text = format!(
            "SRID=2154;polygon z (( 0 0 7, 4 0 7, 0 4 7, 0 0 7 ))\nPolygon EMPTY\n \
                            MULTIPOLYGON (({square}),\n({hole},{hole}))"
        );
        assert_eq!(rings(&text), [ring(0, 4), ring(1, 5), ring(2, 4), ring(2, 4)]);
    }

    #[test]
    fn what_is_wrong_is_said_with_its_place() {
        for (text, part) in [
            ("POLYGON EMPTY", "found no lines"),
            ("POLYGON((0 0,1 0,1 1,0 0)", "line 1: found the end of the file, expected , or )"),
            ("\n\nPOLYGON((0 0,1 0,\nx 1,0 0))", "line 4: found \"x\", expected a finite number"),
            ("POLYGON((0 0,1,1 1,0 0))", "line 1: found 1 coordinates, expected 2 at least"),
            ("POLYGON((0 0,1 0,0 0))", "line 1: ring 0: found 3 positions, expected 4"),
            ("POLYGON((0 0,1 0,1 1,0 0))\nPOINT(1 2)", "line 2: found \"POINT\", expected POLYGON or"),
            ("POLYGON((0 0,1 0,1 1,0 2))", "line 1: ring 0: it starts at 0, 0 and ends at 0, 2"),
        ] {
            let message = read(text.as_bytes(), &Reading::default()).unwrap_err().to_string();
            assert!(message.contains(part), "{text}: {message}");
        }
    }
}
