//! The report: a table of what was changed about lines, and of the levels of water.

use std::io::{self, Write};

use super::changes::{Change, Changes};
use super::levels::{Given, Levels};
use super::water::{River, WaterPolygon};
use spmesh_base::error::{Error, Result};
use spmesh_base::output::Output;
use spmesh_stream::model::points::Point2;

/// How a level was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Found {
    /// Third coordinates state it.
    Coordinates,
    /// The property `level` states it.
    Property,
    /// From so many points near the shore.
    Points(usize),
    /// From so many points of water.
    WaterPoints(usize),
}

impl Found {
    /// Its name in tables.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Found::Coordinates => "coordinates",
            Found::Property => "property",
            Found::Points(_) => "points",
            Found::WaterPoints(_) => "water",
        }
    }
}

/// A lake, or a station of a river.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LevelRow {
    /// Name of the river; `None` of a lake.
    river: Option<String>,
    line: u32,
    /// World coordinates of the first vertex of a lake, or of the station.
    place: Point2,
    level: f64,
    /// The elevation before it was lowered, and how it was found; `None` if it was interpolated.
    measured: Option<(f64, Found)>,
    feature: String,
}

impl LevelRow {
    pub(crate) fn of_lake(given: &Given, polygon: &WaterPolygon, level: f64, found: Found) -> LevelRow {
        let first = polygon.edges(given.network).next().map_or([f64::NAN; 2], |[place, _]| place);
        let world = |z: f64| given.target.coordinates.to_decimal([first[0], first[1], z]);
        let [x, y, level] = world(level);
        LevelRow {
            river: None,
            line: polygon.line,
            place: [x, y],
            level,
            measured: Some((level, found)),
            feature: polygon.position.to_string(),
        }
    }

    pub(crate) fn of_station(
        given: &Given,
        river: &River,
        ([x, y], measured): (Point2, Option<(f64, Found)>),
        level: f64,
    ) -> LevelRow {
        let world = |z: f64| given.target.coordinates.to_decimal([x, y, z]);
        let [x, y, level] = world(level);
        LevelRow {
            river: Some(river.name.clone()),
            line: river.line,
            place: [x, y],
            level,
            measured: measured.map(|(z, found)| (world(z)[2], found)),
            feature: river.position.to_string(),
        }
    }

    fn write(&self, output: &mut impl Write) -> io::Result<()> {
        let LevelRow { line, place: [x, y], level, .. } = self;
        let kind = if self.river.is_some() { "station" } else { "lake" };
        let measured = self.measured.map(|(z, _)| z.to_string()).unwrap_or_default();
        let found = self.measured.map_or("interpolated", |(_, found)| found.name());
        let points = match self.measured {
            Some((_, Found::Points(count) | Found::WaterPoints(count))) => count.to_string(),
            _ => String::new(),
        };
        let river = in_a_field(self.river.as_deref().unwrap_or_default());
        let feature = in_a_field(&self.feature);
        writeln!(
            output,
            "{kind}\t{line}\t{x}\t{y}\t{level}\t{measured}\t{found}\t{points}\t{river}\t{feature}"
        )
    }
}

/// Text without what ends a field or a line.
fn in_a_field(text: &str) -> String {
    text.replace(char::is_control, " ")
}

/// Writes what was changed about lines as tab-separated values, with a line of names. Lines are numbered from
/// 0, over all files. With levels, the table has more columns and a row for each lake and station.
///
/// # Errors
/// If writing fails.
pub fn write_report(mut output: Output, changes: &Changes, levels: Option<&Levels>) -> Result<()> {
    write(&mut output, changes, levels).map_err(|e| Error::io("writing the report", e))?;
    output.commit()
}

fn write(output: &mut impl Write, changes: &Changes, levels: Option<&Levels>) -> io::Result<()> {
    let (names, empty) = match levels {
        Some(_) => ("\tlevel\tmeasured\tfound\tpoints\triver\tfeature", "\t\t\t\t\t\t"),
        None => ("", ""),
    };
    writeln!(output, "kind\tline\tx\ty{names}")?;
    for Change { kind, line, place: [x, y] } in changes.list() {
        writeln!(output, "{}\t{line}\t{x}\t{y}{empty}", kind.name())?;
    }
    levels.iter().flat_map(|levels| &levels.rows).try_for_each(|row| row.write(output))
}
