//! The table and the report of volumes.

use std::io::Write;
use std::path::Path;

use num_bigint::BigInt;
use serde_json::{Value, json};

use crate::diff::{Comparison, Surface, Volumes, number};
use spmesh_base::error::{Error, Result};
use spmesh_base::output::Output;
use spmesh_formats::crs::{self, System};
use spmesh_formats::sink::{Column, ColumnKind, TableFormat, TableSink};
use spmesh_shell::endings;
use spmesh_stream::Crs;

/// Changes when a key of the report gets another meaning.
const VERSION: u32 = 1;

/// Endings of tables.
const TABLES: &[&str] = &["tsv", "jsonl", "ndjson", "parquet"];

/// Columns of all tables.
const COLUMNS: [&str; 6] = ["cut", "fill", "net", "cut_area", "fill_area", "level_area"];

/// What a run has found.
pub(super) struct Measured<'m> {
    pub(super) first: &'m Surface,
    pub(super) second: Option<&'m Surface>,
    pub(super) found: &'m Comparison,
    pub(super) levels: Option<&'m [f64]>,
    pub(super) plane: &'m [f64],
    pub(super) has_polygons: bool,
    pub(super) crs: &'m Crs,
    /// Standard deviation of differences, in units of z.
    pub(super) deviation: Option<f64>,
}

/// The files of a run.
pub(super) struct Outputs {
    table: Output,
    format: TableFormat,
    report: Option<Output>,
}

/// The volumes of a polygon and a level.
struct Entry<'m> {
    polygon: Option<usize>,
    level: Option<f64>,
    volumes: &'m Volumes,
    /// In the order of [`COLUMNS`].
    figures: [f64; 6],
    deviation: Option<f64>,
}

impl Outputs {
    pub(super) fn create(table: &Path, report: Option<&Path>) -> Result<Outputs> {
        endings::check(table, &[TABLES])?;
        report.iter().try_for_each(|path| endings::check(path, &[endings::JSON]))?;
        if report == Some(table) {
            return Err(Error::usage("the table and the report are one file: give two names"));
        }
        let format = TableFormat::of(table).unwrap_or_default();
        Ok(Outputs {
            table: Output::create(table, format == TableFormat::Parquet)?,
            format,
            report: report.map(|path| Output::create(path, false)).transpose()?,
        })
    }

    /// Writes both.
    pub(super) fn write(self, measured: &Measured) -> Result<()> {
        let entries: Vec<Entry> = measured.entries().collect();
        let mut table = TableSink::create(self.format, measured.columns(), self.table);
        for entry in &entries {
            if let Some(number) = entry.polygon {
                table.integer(number as u64)?;
            }
            let numbers = entry.level.into_iter().chain(entry.figures).chain(entry.deviation);
            numbers.for_each(|number| table.number(number));
            table.end()?;
        }
        table.commit()?;
        let Some(mut report) = self.report else { return Ok(()) };
        writeln!(report, "{:#}", measured.json(&entries)).map_err(|e| Error::io("writing", e))?;
        report.commit()
    }
}

impl Measured<'_> {
    /// Units of volumes: z is converted to the unit of x and y.
    fn units(&self) -> [f64; 2] {
        let [area, volume] = self.found.units;
        [area, volume * self.unit_of_z()]
    }

    fn unit_of_z(&self) -> f64 {
        System::of(self.crs).vertical_ratio().unwrap_or(1.0)
    }

    fn columns(&self) -> Vec<Column> {
        let column = |name: &str, kind| Column { name: name.into(), kind };
        let polygon = self.has_polygons.then(|| column("polygon", ColumnKind::Integer));
        let level = self.levels.map(|_| "level");
        let names = level.into_iter().chain(COLUMNS).chain(self.deviation.map(|_| "sd"));
        polygon.into_iter().chain(names.map(|name| column(name, ColumnKind::Number))).collect()
    }

    fn entries(&self) -> impl Iterator<Item = Entry<'_>> {
        let regions = self.found.volumes.iter().enumerate();
        regions.flat_map(move |(region, volumes)| {
            volumes.iter().enumerate().map(move |(at, volumes)| {
                let [area, volume] = self.units();
                let sized = |units: &BigInt, size: f64| number(units) * size;
                Entry {
                    polygon: self.has_polygons.then_some(region + 1),
                    level: self.levels.map(|levels| levels[at]),
                    volumes,
                    figures: [
                        sized(&volumes.cut, volume),
                        sized(&volumes.fill, volume),
                        sized(&volumes.net(), volume),
                        sized(&volumes.cut_area, area),
                        sized(&volumes.fill_area, area),
                        sized(&volumes.level_area, area),
                    ],
                    deviation: self
                        .deviation
                        .map(|deviation| deviation * self.unit_of_z() * sized(&volumes.area(), area)),
                }
            })
        })
    }

    fn json(&self, entries: &[Entry]) -> Value {
        let surface = |surface: &Surface| {
            let ground = surface.ground();
            json!({"name": ground.name(), "triangles": ground.triangles(), "area": surface.area()})
        };
        let system = System::of(self.crs);
        let [area, volume] = self.units();
        json!({
            "spdiff": VERSION,
            "a": surface(self.first),
            "b": self.second.map(surface),
            "plane": (!self.plane.is_empty()).then_some(self.plane),
            "crs": crs::name(self.crs),
            "unit": system.horizontal.map(|known| known.unit.symbol),
            "unit_of_z": self.unit_of_z(),
            "rounded_to": self.found.rounded,
            "pieces": self.found.pieces,
            "exact_units": {"area": area, "volume": volume},
            "volumes": entries.iter().map(Entry::json).collect::<Vec<_>>(),
        })
    }
}

impl Entry<'_> {
    fn json(&self) -> Value {
        let mut object = json!({"polygon": self.polygon, "level": self.level, "sd": self.deviation});
        let Volumes { cut, fill, cut_area, fill_area, level_area } = self.volumes;
        let exact = [cut, fill, &self.volumes.net(), cut_area, fill_area, level_area];
        for ((name, figure), exact) in COLUMNS.iter().zip(self.figures).zip(exact) {
            object[name] = figure.into();
            object["exact"][name] = exact.to_string().into();
        }
        object
    }
}
