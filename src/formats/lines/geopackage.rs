//! GeoPackages: the geometries of all tables of features.
//!
//! Source: OGC 12-128r19, GeoPackage Encoding Standard 1.4.

use std::io::Read;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;

use rusqlite::limits::Limit;
use rusqlite::types::ValueRef;
use rusqlite::{Connection, ErrorCode, OpenFlags};

use crate::crs::{System, differences, requested};
use crate::lines::{Breaklines, Collector, Properties, wkb};
use spmesh_base::error::{Error, Result};
use spmesh_base::inputs;
use spmesh_base::limits::{CRS_LEN_MAX, geopackage_steps_max, geopackage_value_max};
use spmesh_stream::Crs;

/// A table of features.
struct Table {
    name: String,
    column: String,
    system: i64,
}

/// Reads all tables of features. The file is never changed: it is opened as one that nobody writes.
pub(crate) fn read(path: &Path) -> Result<Breaklines> {
    let flags =
        OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_URI | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let len = check_whole(path)?;
    let database = Connection::open_with_flags(uri(path)?, flags).map_err(malformed)?;
    confine(&database, len)?;
    let tables = tables(&database)?;
    let mut lines = Collector::default();
    let mut crs: Option<(Crs, &Table)> = None;
    for table in &tables {
        let own = system(&database, table.system)?;
        match &crs {
            Some((first, other)) => check_same(first, other, &own, table)?,
            None => crs = Some((own, table)),
        }
        features(&database, table, &mut lines)?;
    }
    if tables.is_empty() {
        return Err(Error::malformed("the database has no table of features: it is no GeoPackage of lines"));
    }
    lines.finish(crs.map_or(Crs::Unknown, |(crs, _)| crs))
}

/// How often steps of SQLite are counted.
const STEPS: u32 = 1000;

/// A file of so many bytes may not run code of its own, make values that are longer than itself, or compute
/// for much longer than it takes to read it: views and generated columns are code.
fn confine(database: &Connection, len: u64) -> Result<()> {
    database.pragma_update(None, "trusted_schema", false).map_err(malformed)?;
    database.set_limit(Limit::SQLITE_LIMIT_LENGTH, geopackage_value_max(len)).map_err(malformed)?;
    let mut left = geopackage_steps_max(len) / u64::from(STEPS);
    let is_over = move || {
        left = left.saturating_sub(1);
        left == 0
    };
    database.progress_handler(STEPS as i32, Some(is_over)).map_err(malformed)
}

/// Checks that the file has all of its pages: SQLite reads what it needs of a file that was cut off. Returns
/// the length of the file.
///
/// The header has the size of pages at byte 16 (1 stands for 65536) and their number at byte 28, which counts
/// if bytes 24 and 92 state the same change.
fn check_whole(path: &Path) -> Result<u64> {
    let reading = |e| Error::io("reading", e);
    let mut file = inputs::open(path)?;
    let found = file.metadata().map_err(reading)?.len();
    let mut header = [0; 100];
    if file.read_exact(&mut header).is_err() {
        return Err(Error::malformed(format!("the database was cut off: {found} bytes")));
    }
    let number = |at: usize| u64::from(u32::from_be_bytes([0, 1, 2, 3].map(|byte| header[at + byte])));
    let page = match u64::from(u16::from_be_bytes([header[16], header[17]])) {
        1 => 65536,
        page => page,
    };
    let expected = if number(24) == number(92) { page * number(28) } else { page };
    if found < expected || page > 0 && found % page != 0 {
        return Err(Error::malformed(format!(
            "the database was cut off: {found} bytes, expected {expected}"
        )));
    }
    Ok(found)
}

/// The file as one that does not change: SQLite then makes no files beside it.
fn uri(path: &Path) -> Result<String> {
    let path = std::path::absolute(path).map_err(|e| Error::io("opening", e))?;
    let mut uri = "file:".to_string();
    for &byte in path.as_os_str().as_bytes() {
        if byte.is_ascii_alphanumeric() || b"/-_.".contains(&byte) {
            uri.push(byte.into());
        } else {
            uri += &format!("%{byte:02X}");
        }
    }
    Ok(uri + "?immutable=1")
}

fn malformed(error: rusqlite::Error) -> Error {
    if error.sqlite_error_code() == Some(ErrorCode::OperationInterrupted) {
        return Error::malformed(
            "the tables of the GeoPackage take far more steps than a file of its size should: save views as \
             tables, for example with ogr2ogr",
        );
    }
    Error::malformed(format!("not a GeoPackage that can be read: {error}"))
}

fn tables(database: &Connection) -> Result<Vec<Table>> {
    let query = "SELECT g.table_name, g.column_name, g.srs_id FROM gpkg_contents c JOIN gpkg_geometry_columns g \
                 ON g.table_name = c.table_name WHERE c.data_type = 'features' ORDER BY g.table_name";
    let mut statement = database.prepare(query).map_err(malformed)?;
    let table =
        |row: &rusqlite::Row| Ok(Table { name: row.get(0)?, column: row.get(1)?, system: row.get(2)? });
    let tables = statement.query_map([], table).map_err(malformed)?;
    tables.collect::<rusqlite::Result<_>>().map_err(malformed)
}

fn system(database: &Connection, number: i64) -> Result<Crs> {
    let query = "SELECT organization, organization_coordsys_id, definition FROM gpkg_spatial_ref_sys WHERE srs_id = ?";
    let found = database.query_row(query, [number], |row| {
        Ok((row.get::<_, String>(0)?, row.get::<_, i64>(1)?, row.get::<_, String>(2)?))
    });
    let (organization, code, definition) = match found {
        Ok(found) => found,
        Err(rusqlite::Error::QueryReturnedNoRows) => return Ok(Crs::Unknown),
        Err(error) => return Err(malformed(error)),
    };
    if organization.eq_ignore_ascii_case("EPSG")
        && let Ok(known) = requested(&format!("EPSG:{code}"))
    {
        return Ok(known);
    }
    let is_text = definition.contains('[') && definition.len() <= CRS_LEN_MAX;
    Ok(if is_text { Crs::Wkt(definition) } else { Crs::Unknown })
}

fn check_same(first: &Crs, other: &Table, own: &Crs, table: &Table) -> Result<()> {
    let found = differences(&System::of(first), &System::of(own));
    if found.is_empty() {
        return Ok(());
    }
    Err(Error::usage(format!(
        "the tables {:?} and {:?} have different systems ({}): transform one of them first, for example with ogr2ogr \
         -t_srs",
        other.name,
        table.name,
        found.join(", ")
    )))
}

fn features(database: &Connection, table: &Table, lines: &mut Collector) -> Result<()> {
    let quoted = |name: &str| format!("\"{}\"", name.replace('"', "\"\""));
    let columns = columns(database, table)?;
    let names = std::iter::once(&table.column).chain(&columns).map(|name| quoted(name));
    let query = format!("SELECT {} FROM {}", names.collect::<Vec<_>>().join(", "), quoted(&table.name));
    let mut statement = database.prepare(&query).map_err(malformed)?;
    let mut rows = statement.query([]).map_err(malformed)?;
    for number in 1u64.. {
        let position = || format!("table {:?}, row {number}", table.name);
        let Some(row) = rows.next().map_err(|e| malformed(e).at(position()))? else { break };
        lines.feature(properties(row, &columns).map_err(|e| malformed(e).at(position()))?);
        match row.get_ref(0).map_err(|e| malformed(e).at(position()))? {
            ValueRef::Null => {}
            ValueRef::Blob(bytes) => wkb::enter(bytes, lines, &position).map_err(|e| e.at(position()))?,
            other => {
                let message = format!("found {}, expected a geometry", other.data_type());
                return Err(Error::malformed(message).at(position()));
            }
        }
    }
    Ok(())
}

/// The columns of a table that have properties of lines.
fn columns(database: &Connection, table: &Table) -> Result<Vec<String>> {
    let mut statement =
        database.prepare("SELECT CAST(name AS BLOB) FROM pragma_table_xinfo(?)").map_err(malformed)?;
    let mut rows = statement.query([&table.name]).map_err(malformed)?;
    let mut found = Vec::new();
    while let Some(row) = rows.next().map_err(malformed)? {
        // Other names need not be text.
        let name = row.get_ref(0).map_err(malformed)?.as_blob().unwrap_or_default();
        if let Ok(name) = str::from_utf8(name)
            && Properties::default().of_name(name).is_some()
        {
            found.push(name.to_string());
        }
    }
    Ok(found)
}

/// The properties of a row of the geometry and these columns.
fn properties(row: &rusqlite::Row, columns: &[String]) -> rusqlite::Result<Properties> {
    let mut found = Properties::default();
    for (column, name) in (1..).zip(columns) {
        let text = match row.get_ref(column)? {
            ValueRef::Integer(value) => Some(value.to_string()),
            ValueRef::Real(value) => Some(value.to_string()),
            ValueRef::Text(bytes) => Some(String::from_utf8_lossy(bytes).into_owned()),
            ValueRef::Null | ValueRef::Blob(_) => None,
        };
        if let Some(property) = found.of_name(name) {
            *property = text;
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_steps_have_limits() {
        let database = Connection::open_in_memory().unwrap();
        confine(&database, 0).unwrap();
        let ask = |query: &str| database.query_row(query, [], |row| row.get::<_, i64>(0));
        let longest = i64::from(geopackage_value_max(0));
        assert_eq!(ask(&format!("SELECT length(zeroblob({longest}))")).unwrap(), longest);
        let message = ask(&format!("SELECT length(zeroblob({}))", longest + 1)).unwrap_err().to_string();
        assert!(message.contains("too big"), "{message}");
        let count = |to: u32| {
            ask(&format!(
                "WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM c WHERE x < {to}) \
                 SELECT max(x) FROM c"
            ))
        };
        assert_eq!(count(10_000).unwrap(), 10_000);
        let message = malformed(count(10_000_000).unwrap_err()).to_string();
        assert!(message.contains("more steps"), "{message}");
    }
}
