//! Polygons as text (WKT, well-known text).

use crate::lines::mask::{Polygon, closed, of_ring};
use crate::text::lines::quote;
use crate::text::words::finite;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::points::Point2;

/// The polygons of a text: any number of `POLYGON` and `MULTIPOLYGON`, each with an optional `SRID=N;` before it.
pub(crate) fn polygons(text: &[u8]) -> Result<Vec<Polygon>> {
    let mut text = Text { rest: text, line: 1 };
    let mut polygons = Vec::new();
    while text.peek().is_some() {
        geometry(&mut text, &mut polygons).map_err(|error| error.at(format!("line {}", text.line)))?;
    }
    Ok(polygons)
}

fn geometry(text: &mut Text, polygons: &mut Vec<Polygon>) -> Result<()> {
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
    if is_multi {
        polygons.extend(list(text, |text, _| rings(text))?);
    } else {
        polygons.push(rings(text)?);
    }
    Ok(())
}

fn rings(text: &mut Text) -> Result<Polygon> {
    list(text, |text, number| {
        let vertices = list(text, |text, _| position(text))?;
        closed(vertices).map_err(|error| of_ring(&error, number))
    })
}

fn position(text: &mut Text) -> Result<Point2> {
    let mut numbers = Vec::new();
    while text.peek().is_some_and(|byte| !b",()".contains(&byte)) {
        numbers.push(finite(text.word())?);
    }
    match numbers[..] {
        [x, y, ..] => Ok([x, y]),
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
