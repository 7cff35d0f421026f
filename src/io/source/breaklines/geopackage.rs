//! GeoPackages: the geometries of all tables of features.
//!
//! Source: OGC 12-128r19, GeoPackage Encoding Standard 1.4.

use std::fs::File;
use std::io::Read;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;

use rusqlite::types::ValueRef;
use rusqlite::{Connection, OpenFlags};

use super::{Breaklines, Collector, Properties, wkb};
use spmesh_core::error::{Error, Result};
use spmesh_core::limits::{CRS_LEN_MAX, GEOPACKAGE_MEMORY_MAX};
use spmesh_crs::{System, differences, requested};
use spmesh_stream::Crs;

/// A table of features.
struct Table {
    name: String,
    column: String,
    system: i64,
}

/// Reads all tables of features. The file is never changed: it is opened as one that nobody writes.
///
/// # Errors
/// As [`super::read_breaklines`].
pub(super) fn read(path: &Path) -> Result<Breaklines> {
    let flags =
        OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_URI | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    check_whole(path)?;
    let database = Connection::open_with_flags(uri(path)?, flags).map_err(malformed)?;
    confine(&database, GEOPACKAGE_MEMORY_MAX)?;
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

/// A file may not run code of its own, and may not take all memory.
fn confine(database: &Connection, memory: i64) -> Result<()> {
    database.pragma_update(None, "trusted_schema", false).map_err(malformed)?;
    database.pragma_update(None, "hard_heap_limit", memory).map_err(malformed)
}

/// Checks that the file has all of its pages: SQLite reads what it needs of a file that was cut off.
///
/// The header has the size of pages at byte 16 (1 stands for 65536) and their number at byte 28, which counts
/// if bytes 24 and 92 state the same change.
fn check_whole(path: &Path) -> Result<()> {
    let reading = |e| Error::io("reading", e);
    let mut file = File::open(path).map_err(|e| Error::io("opening", e))?;
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
    Ok(())
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
    let query = format!("SELECT {}, * FROM {}", quoted(&table.column), quoted(&table.name));
    let mut statement = database.prepare(&query).map_err(malformed)?;
    let names = statement.column_names().into_iter().map(str::to_string).enumerate().skip(1);
    let columns: Vec<(usize, String)> =
        names.filter(|(_, name)| Properties::default().of_name(name).is_some()).collect();
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

fn properties(row: &rusqlite::Row, columns: &[(usize, String)]) -> rusqlite::Result<Properties> {
    let mut found = Properties::default();
    for (column, name) in columns {
        let text = match row.get_ref(*column)? {
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

    /// The limit counts for the process; no other test opens a database.
    #[test]
    fn memory_has_a_limit() {
        let database = Connection::open_in_memory().unwrap();
        let ask = |query: &str| database.query_row(query, [], |row| row.get::<_, i64>(0));
        confine(&database, GEOPACKAGE_MEMORY_MAX).unwrap();
        assert_eq!(ask("PRAGMA hard_heap_limit").unwrap(), GEOPACKAGE_MEMORY_MAX);
        // A limit can be lowered only.
        confine(&database, 8 << 20).unwrap();
        assert_eq!(ask("SELECT length(randomblob(6000000))").unwrap(), 6_000_000);
        let message = ask("SELECT length(randomblob(9000000))").unwrap_err().to_string();
        assert!(message.contains("out of memory"), "{message}");
    }
}
