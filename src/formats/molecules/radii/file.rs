//! Reads files of radii.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::hash::Hash;
use std::io::Read;

use crate::molecules::decimal::Number;
use crate::molecules::elements::Element;
use crate::molecules::guess::looked_up;
use crate::molecules::radii::{ANY, Fallback, Radii};
use crate::text::lines::quote;
use crate::text::words::for_each_line;
use crate::twin::tokens::unexpected;
use spmesh_base::error::{Error, Result};

/// Decimal places of a radius in Å.
const PLACES: usize = 3;

/// Greatest radius, in steps of 0.001 Å: far beyond all atoms, but an upper limit for the arithmetic.
const STEPS_MAX: f64 = 100_000.0;

/// Reads all lines; they are described at [`Radii::read`].
pub(crate) fn read(input: impl Read) -> Result<Radii> {
    let mut radii = Radii::default();
    for_each_line(input, |words| line(words, &mut radii))?;
    Ok(radii)
}

fn line(words: &[&[u8]], radii: &mut Radii) -> Result<()> {
    match *words {
        [word, name] if word.eq_ignore_ascii_case(b"table") => table(name, radii),
        [word, radius] if word.eq_ignore_ascii_case(b"else") => rest(radius, radii),
        [symbol, radius] => {
            let element = std::str::from_utf8(symbol).ok().and_then(Element::of_symbol);
            let element = element.ok_or_else(|| unexpected(symbol, "the symbol of an element"))?;
            let radii = &mut radii.by_element;
            insert(radii, element, steps(radius)?, element.symbol())
        }
        // Commas divide words, so "C 1,7" comes as three.
        [_, atom, _] if atom.iter().all(u8::is_ascii_digit) => {
            Err(unexpected(atom, "the name of an atom; decimals of a radius follow a point"))
        }
        [residue, atom, radius] => {
            let key = [name(residue)?, name(atom)?];
            let shown = key.join(" ");
            insert(&mut radii.by_name, key, steps(radius)?, &shown)
        }
        _ => Err(unexpected(
            &words.join(&b' '),
            "\"RESIDUE ATOM RADIUS\", \"ELEMENT RADIUS\", \"table NAME\" or \"else RADIUS\"",
        )),
    }
}

/// Takes the radii of a table for all atoms that the file does not have.
fn table(name: &[u8], radii: &mut Radii) -> Result<()> {
    if !matches!(radii.fallback, Fallback::None) {
        return Err(Error::malformed("a second table, expected one"));
    }
    let table = std::str::from_utf8(name).ok().and_then(Radii::named);
    let expected = || format!("the name of a table: {}", Radii::NAMES.join(", "));
    let table = table.ok_or_else(|| unexpected(name, &expected()))?;
    radii.prefers_own = table.prefers_own;
    radii.fallback = Fallback::Table(Box::new(table));
    Ok(())
}

/// Takes a radius for all atoms that have none by the file and its table.
fn rest(word: &[u8], radii: &mut Radii) -> Result<()> {
    let steps = steps(word)?;
    if radii.rest.is_some_and(|before| before != steps) {
        return Err(Error::malformed("a second radius for \"else\", which differs"));
    }
    radii.rest = Some(steps);
    Ok(())
}

/// The name of a residue or an atom.
fn name(word: &[u8]) -> Result<String> {
    let name = std::str::from_utf8(word).map_err(|_| unexpected(word, "a name in UTF-8"))?;
    let is_any = name == ANY || name.eq_ignore_ascii_case("ANY");
    Ok(if is_any { ANY.to_string() } else { looked_up(name) })
}

/// A radius in Å as a multiple of 0.001 Å.
fn steps(word: &[u8]) -> Result<u32> {
    let steps = match Number::parse(word) {
        Some(Number::Decimal { digits, places }) => {
            digits * 10f64.powi(PLACES as i32) / 10f64.powi(places as i32)
        }
        _ => f64::NAN,
    };
    if steps.fract() == 0.0 && (0.0..=STEPS_MAX).contains(&steps) {
        return Ok(steps as u32);
    }
    Err(unexpected(word, "a radius of 0 to 100 Å with at most three decimal places"))
}

/// Adds a radius.
fn insert<K: Eq + Hash>(radii: &mut HashMap<K, u32>, key: K, steps: u32, shown: &str) -> Result<()> {
    match radii.entry(key) {
        Entry::Vacant(entry) => {
            entry.insert(steps);
            Ok(())
        }
        Entry::Occupied(entry) if *entry.get() == steps => Ok(()),
        Entry::Occupied(_) => {
            Err(Error::malformed(format!("a second radius for {}, which differs", quote(shown.as_bytes()))))
        }
    }
}
