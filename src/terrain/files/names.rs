//! Names of sheets by a pattern.

use std::ffi::{OsStr, OsString};
use std::str::FromStr;

use super::division::{Division, SheetSize, Strips};
use super::sheet_table::SheetTable;
use super::tiles::TilePlace;
use spmesh_base::error::{Error, Result};

/// Names of sheets, as text with fields in braces; without their folder and ending.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    pieces: Vec<Piece>,
    /// Names that a field stands for. Sheets without one are not written.
    table: Option<SheetTable>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum Piece {
    Text(String),
    /// The name of the raster.
    Name,
    /// The name in the table.
    Sheet,
    /// A number, with zeros in front up to this many characters.
    Number(Field, usize),
}

/// A number that places a sheet along one axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Field {
    axis: usize,
    kind: Kind,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// The number of the column or the row, from 0 at the lower left.
    Count,
    /// A coordinate of a square: that of its lower left or its upper left corner, in units or in thousands of
    /// them.
    Corner { is_upper: bool, are_thousands: bool },
}

/// Greatest number of characters that zeros fill up.
const WIDTH_MAX: usize = 20;

const fn corner(axis: usize, is_upper: bool, are_thousands: bool) -> Field {
    Field { axis, kind: Kind::Corner { is_upper, are_thousands } }
}

/// The fields by name. The upper left corner has the x of the lower left one.
const FIELDS: [(&str, Field); 10] = [
    ("x", corner(0, false, false)),
    ("y", corner(1, false, false)),
    ("x_km", corner(0, false, true)),
    ("y_km", corner(1, false, true)),
    ("x_nw", corner(0, false, false)),
    ("y_nw", corner(1, true, false)),
    ("x_nw_km", corner(0, false, true)),
    ("y_nw_km", corner(1, true, true)),
    ("column", Field { axis: 0, kind: Kind::Count }),
    ("row", Field { axis: 1, kind: Kind::Count }),
];

impl Pattern {
    /// The name of the raster, and the lower left corner of the square or the column and the row.
    pub fn usual(size: SheetSize) -> Pattern {
        let kind = match size {
            SheetSize::Side(_) => Kind::Corner { is_upper: false, are_thousands: false },
            SheetSize::Counts(_) => Kind::Count,
        };
        let number = |axis: usize| Piece::Number(Field { axis, kind }, 0);
        let gap = || Piece::Text("_".to_string());
        Pattern { pieces: vec![Piece::Name, gap(), number(0), gap(), number(1)], table: None }
    }

    /// The names of a table, as they are.
    pub fn of_table() -> Pattern {
        Pattern { pieces: vec![Piece::Sheet], table: None }
    }

    /// The same with a table.
    ///
    /// # Errors
    /// Usage, if a field needs a table and there is none, or the other way round.
    pub fn with_table(self, table: Option<SheetTable>) -> Result<Pattern> {
        match (self.pieces.contains(&Piece::Sheet), &table) {
            (true, None) => Err(Error::usage("{sheet} stands for names of a table: give --tile-table FILE")),
            (false, Some(_)) => {
                Err(Error::usage("no name is taken from --tile-table: add {sheet} to --tile-name"))
            }
            _ => Ok(Pattern { table, ..self }),
        }
    }

    /// Refuses corners for sheets that are counted.
    pub(super) fn check(&self, size: SheetSize) -> Result<()> {
        let is_corner =
            |piece: &Piece| matches!(piece, Piece::Number(Field { kind: Kind::Corner { .. }, .. }, _));
        match size {
            SheetSize::Counts(_) if self.pieces.iter().any(is_corner) => Err(Error::usage(
                "names by corners are for squares: give --tiles the length of their side, or take {column} and {row}",
            )),
            _ => Ok(()),
        }
    }

    /// The name of a sheet of the raster `name`; `None` if the table has none for it.
    pub(super) fn name(
        &self,
        name: &OsStr,
        division: &Division,
        strips: &[Strips; 2],
        at: TilePlace,
    ) -> Option<OsString> {
        let mut all = OsString::new();
        let numbers = [0, 1].map(|axis| strips[axis][at[axis]].number);
        let sheet = self.table.as_ref().map(|table| table.name(numbers));
        for piece in &self.pieces {
            match piece {
                Piece::Text(text) => all.push(text),
                Piece::Name => all.push(name),
                Piece::Sheet => all.push(sheet.flatten()?),
                Piece::Number(field, width) => all.push(field.text(division, strips, at, *width)),
            }
        }
        Some(all)
    }
}

impl Field {
    fn text(self, division: &Division, strips: &[Strips; 2], at: TilePlace, width: usize) -> String {
        let Field { axis, kind } = self;
        match (kind, division.size) {
            (Kind::Corner { is_upper, are_thousands }, SheetSize::Side(side)) => {
                let number = strips[axis][at[axis]].number + f64::from(u8::from(is_upper));
                let scale = if are_thousands { 1000.0 } else { 1.0 };
                corner_text([division.anchor[axis], side], number, scale, width)
            }
            // Rows of sheets count from the top.
            _ if axis == 1 => format!("{:0width$}", strips[1].len() - 1 - at[1]),
            _ => format!("{:0width$}", at[0]),
        }
    }
}

/// The coordinate of a corner of a square, with as many decimals as the anchor and the side have.
fn corner_text([anchor, side]: [f64; 2], number: f64, scale: f64, width: usize) -> String {
    let decimals = |number: f64| number.to_string().split_once('.').map_or(0, |(_, digits)| digits.len());
    let digits = decimals(anchor / scale).max(decimals(side / scale));
    format!("{:0width$.digits$}", (anchor + number * side) / scale)
}

impl FromStr for Pattern {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Pattern, String> {
        if text.contains(['/', '\\']) {
            return Err(
                "names are those of files: the folder is that of the output, as in -o folder/name.tif".into(),
            );
        }
        if text.chars().any(char::is_control) {
            return Err("names of files without control characters were expected".into());
        }
        let (mut pieces, mut rest) = (Vec::new(), text);
        while let Some((before, after)) = rest.split_once('{') {
            let (field, behind) = after.split_once('}').ok_or_else(|| format!("{{{after} lacks its }}"))?;
            pieces.push(plain(before)?);
            pieces.push(piece(field)?);
            rest = behind;
        }
        pieces.push(plain(rest)?);
        pieces.retain(|piece| *piece != Piece::Text(String::new()));
        if pieces.is_empty() || [".", ".."].contains(&text) {
            return Err("expected a name such as dem_{x}_{y}".into());
        }
        Ok(Pattern { pieces, table: None })
    }
}

/// Text between fields.
fn plain(text: &str) -> std::result::Result<Piece, String> {
    if text.contains('}') { Err(format!("{text} lacks its {{")) } else { Ok(Piece::Text(text.to_string())) }
}

/// What stands in braces: a field, with a width behind a colon if numbers are filled up.
fn piece(text: &str) -> std::result::Result<Piece, String> {
    match text {
        "name" => return Ok(Piece::Name),
        "sheet" => return Ok(Piece::Sheet),
        _ => {}
    }
    let (name, width) = text.split_once(':').map_or((text, None), |(name, width)| (name, Some(width)));
    let Some((_, field)) = FIELDS.iter().find(|(known, _)| *known == name) else {
        let known: Vec<String> = FIELDS.iter().map(|(known, _)| format!("{{{known}}}")).collect();
        return Err(format!("there is no field {{{text}}}, but {{name}}, {{sheet}}, {}", known.join(", ")));
    };
    let width = width.map_or(Some(0), |width| width.parse().ok().filter(|&width| width <= WIDTH_MAX));
    let width = width.ok_or_else(|| {
        format!(
            "{{{text}}}: expected a number of characters up to {WIDTH_MAX} behind the colon, as in {{x_km:4}}"
        )
    })?;
    Ok(Piece::Number(*field, width))
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_formats::raster::Grid;

    #[test]
    fn names_of_corners_are_decimals() {
        assert_eq!(corner_text([0.0, 0.1], 3.0, 1.0, 0), "0.3");
        assert_eq!(corner_text([0.25, 1000.0], 650.0, 1.0, 0), "650000.25");
        assert_eq!(corner_text([0.0, 1e3], -0.0, 1.0, 0), "0");
        assert_eq!(corner_text([0.0, 500.0], 1301.0, 1000.0, 0), "650.5");
        assert_eq!(corner_text([0.0, 1000.0], -7.0, 1000.0, 4), "-007");
    }

    #[test]
    fn fields_place_sheets() {
        let grid = Grid { left: 650_000.0, top: 6_822_000.0, step: 100.0, columns: 20, rows: 20 };
        let division = |size| Division { size, anchor: [0.0; 2], buffer: 0.0, is_full: false };
        let name = |pattern: &str, size: SheetSize, at: TilePlace| {
            let (pattern, division) = (pattern.parse::<Pattern>().unwrap(), division(size));
            pattern.check(size).map_err(|error| error.to_string())?;
            let strips = division.strips(&grid).unwrap();
            Ok(pattern.name(OsStr::new("dem"), &division, &strips, at).unwrap().into_string().unwrap())
        };
        let square = SheetSize::Side(1000.0);
        for (pattern, expected) in [
            ("{name}_{x}_{y}", "dem_651000_6820000"),
            ("D{x_nw}{y_nw}", "D6510006821000"),
            ("a_{x_km:4}_{y_nw_km:4}", "a_0651_6821"),
            ("{row}-{column}", "0-1"),
        ] {
            assert_eq!(name(pattern, square, [1, 1]), Ok(expected.to_string()));
        }
        assert_eq!(name("{column:2}{row:2}", SheetSize::Counts([4, 4]), [3, 0]), Ok("0303".to_string()));
        let refused: std::result::Result<String, String> = name("{x}", SheetSize::Counts([4, 4]), [3, 0]);
        assert!(refused.unwrap_err().contains("take {column} and {row}"));
    }

    #[test]
    fn wrong_patterns_are_refused() {
        for (text, part) in [
            ("", "expected a name"),
            ("..", "expected a name"),
            ("a/{x}_{y}", "-o folder/name.tif"),
            ("a\\{x}", "-o folder/name.tif"),
            ("a\n{x}", "control characters"),
            ("{z}", "there is no field {z}, but {name}, {sheet}, {x}, {y}"),
            ("{x:}", "a number of characters up to 20"),
            ("{x:21}", "a number of characters up to 20"),
            ("{x", "lacks its }"),
            ("x}_{y}", "lacks its {"),
        ] {
            let found = text.parse::<Pattern>().unwrap_err();
            assert!(found.contains(part), "{text}: {found}");
        }
    }
}
