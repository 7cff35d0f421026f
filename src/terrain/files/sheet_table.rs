//! Names of sheets from a table.

use std::collections::HashMap;
use std::path::Path;

use spmesh_base::error::{Error, Result};
use spmesh_base::inputs;
use spmesh_base::limits::SHEETS_MAX;

/// Longest line of a table with so many sheets. Units: bytes.
const LINE_LEN: u64 = 128;
/// How far a corner may be from one of a square. Units: parts of the side.
const ON_CORNER: f64 = 1e-6;

/// The names of square sheets.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SheetTable {
    /// By the numbers of their squares along each axis, from the anchor.
    names: HashMap<[i64; 2], String>,
}

impl SheetTable {
    /// Reads the lines of a table: x and y of the lower left corner of a square, and its name, separated by
    /// commas, semicolons or blanks. The first line may hold names of columns; lines that start with `#` do
    /// not count.
    ///
    /// # Errors
    /// If the file cannot be read; malformed, if a line is none of a table, or names a square again.
    pub fn read(path: &Path, side: f64, anchor: [f64; 2]) -> Result<SheetTable> {
        let bytes = inputs::read(path, "a table of", LINE_LEN * SHEETS_MAX)?;
        let of_path = |error: Error| error.of_input(path.display().to_string());
        let text = String::from_utf8(bytes).map_err(|_| of_path(Error::malformed("expected UTF-8")))?;
        SheetTable::parse(&text, side, anchor).map_err(of_path)
    }

    fn parse(text: &str, side: f64, anchor: [f64; 2]) -> Result<SheetTable> {
        let mut names = HashMap::new();
        let lines = text.trim_start_matches('\u{feff}').lines().zip(1..);
        for (line, number) in lines.filter(|(line, _)| !line.trim().is_empty() && !line.starts_with('#')) {
            let at = |message: String| Error::malformed(message).at(format!("line {number}"));
            let Some((corner, name)) = parts(line) else {
                if number == 1 {
                    continue;
                }
                return Err(at(format!("expected x, y and a name, found {line:?}")));
            };
            let square = [0, 1].map(|axis| (corner[axis] - anchor[axis]) / side);
            if square.iter().any(|at| (at - at.round()).abs() > ON_CORNER || at.abs() > 1e9) {
                let [x, y] = corner;
                return Err(at(format!("{x}, {y} is no corner of squares with a side of {side}")));
            }
            if name.is_empty() || name.contains(['/', '\\']) || name.chars().any(char::is_control) {
                return Err(at(format!("{name:?} is no name of a file")));
            }
            if names.insert(square.map(|at| at.round() as i64), name.to_string()).is_some() {
                return Err(at(format!("the square of {name} has a name already")));
            }
        }
        if names.is_empty() {
            return Err(Error::malformed("expected lines of x, y and a name, found none"));
        }
        Ok(SheetTable { names })
    }

    /// The name of a square by its numbers from the anchor, if it has one.
    pub(super) fn name(&self, numbers: [f64; 2]) -> Option<&str> {
        self.names.get(&numbers.map(|number| number as i64)).map(String::as_str)
    }
}

/// A corner and a name.
fn parts(line: &str) -> Option<([f64; 2], &str)> {
    let is_between = |c: char| c.is_whitespace() || c == ',' || c == ';';
    let number = |text: &str| text.parse().ok().filter(|number: &f64| number.is_finite());
    let next = |text: &'_ str| -> Option<(f64, usize)> {
        let end = text.find(is_between)?;
        Some((number(&text[..end])?, end))
    };
    let line = line.trim();
    let (x, end) = next(line)?;
    let line = line[end..].trim_start_matches(is_between);
    let (y, end) = next(line)?;
    let name = line[end..].trim_start_matches(is_between).trim();
    Some(([x, y], name.trim_matches('"')))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_have_names() {
        let text = "x;y;name\n# of the country\n2000;5000;47-NW\n\n3000,5000, \"Bad Ems\"\r\n-1000 0 c 7\n";
        let table = SheetTable::parse(text, 1000.0, [0.0; 2]).unwrap();
        let name = |numbers| table.name(numbers);
        assert_eq!([name([2.0, 5.0]), name([3.0, 5.0])], [Some("47-NW"), Some("Bad Ems")]);
        assert_eq!([name([-1.0, -0.0]), name([4.0, 5.0])], [Some("c 7"), None]);
        let table = SheetTable::parse("0.3 0.1 a", 0.1, [0.0; 2]).unwrap();
        assert_eq!(table.name([3.0, 1.0]), Some("a"));
    }

    #[test]
    fn wrong_tables_are_refused() {
        for (text, part) in [
            ("", "found none"),
            ("x y name\n", "found none"),
            ("0 0 a\n1000 0\n", "line 2: expected x, y and a name, found \"1000 0\""),
            ("0 0 a\n1000 NaN b\n", "line 2: expected"),
            ("1500 0 a", "line 1: 1500, 0 is no corner of squares with a side of 1000"),
            ("1e300 0 a", "is no corner"),
            ("0 0 a/b", "line 1: \"a/b\" is no name"),
            ("0 0 a\n0,0,b", "line 2: the square of b has a name already"),
        ] {
            let found = SheetTable::parse(text, 1000.0, [0.0; 2]).unwrap_err().to_string();
            assert!(found.contains(part), "{text}: {found}");
        }
    }
}
