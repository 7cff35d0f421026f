//! GeoPackages: the geometries of all tables of features, which others call layers, or of one of them.
//!
//! Source: OGC 12-128r19, GeoPackage Encoding Standard 1.4.

use std::fs::File;
use std::io::{ErrorKind, Read};
use std::os::unix::ffi::OsStrExt;
use std::path::Path;

use rusqlite::hooks::{AuthAction, AuthContext, Authorization};
use rusqlite::limits::Limit;
use rusqlite::types::ValueRef;
use rusqlite::{Connection, ErrorCode, OpenFlags};

use crate::crs::{System, differences, requested};
use crate::lines::{Breaklines, Collector, Properties, Reading, wkb};
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

/// Reads all tables of features, or the one of this name. The file is never changed: it is opened as one that
/// nobody writes.
pub(crate) fn read(path: &Path, layer: Option<&str>, reading: &Reading) -> Result<Breaklines> {
    let flags =
        OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_URI | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    check_complete(path)?;
    let len = check_whole(path)?;
    let database = Connection::open_with_flags(uri(path)?, flags).map_err(malformed)?;
    confine(&database, len)?;
    let mut tables = tables(&database)?;
    let names = names(&tables);
    let layers = (tables.len() > 1 && layer.is_none()).then(|| layers(&names, &path.display().to_string()));
    if let Some(layer) = layer {
        tables.retain(|table| table.name.eq_ignore_ascii_case(layer));
        if tables.is_empty() {
            return Err(Error::usage(format!("has no layer {layer:?}: its layers are {names}")));
        }
    }
    read_tables(&database, &tables, layers.clone(), reading)
        .map_err(|error| layers.iter().fold(error, |error, layers| error.noting(layers)))
}

fn read_tables(
    database: &Connection,
    tables: &[Table],
    layers: Option<String>,
    reading: &Reading,
) -> Result<Breaklines> {
    let mut lines = Collector::new(reading);
    let mut crs: Option<(Crs, &Table)> = None;
    for table in tables {
        let own = system(database, table.system)?;
        match &crs {
            Some((first, other)) => check_same(first, other, &own, table)?,
            None => crs = Some((own, table)),
        }
        features(database, table, &mut lines)?;
    }
    if tables.is_empty() {
        return Err(Error::malformed("the database has no table of features: it is no GeoPackage of lines"));
    }
    let lines = lines.finish(crs.map_or(Crs::Unknown, |(crs, _)| crs))?;
    Ok(Breaklines { layers, ..lines })
}

/// The names of tables, for messages.
fn names(tables: &[Table]) -> String {
    let names: Vec<String> = tables.iter().map(|table| format!("{:?}", table.name)).collect();
    names.join(", ")
}

/// What to say about the layers of a file if none of them was chosen.
fn layers(names: &str, file: &str) -> String {
    format!("the layers of {file} are {names}: add a colon and a name to choose one, as in {file}:NAME")
}

/// How often steps of SQLite are counted.
const STEPS: u32 = 1000;

/// Functions of views whose work and result are no longer than their arguments.
const FUNCTIONS: &str = "abs avg coalesce count iif ifnull length lower max min nullif round row_number \
                         substr sum total trim upper";

/// A file of so many bytes may not run code of its own, make values that are longer than itself, or compute
/// for much longer than it takes to read lines: views are code. A step may take long in few functions, so
/// others are refused.
fn confine(database: &Connection, len: u64) -> Result<()> {
    database.pragma_update(None, "trusted_schema", false).map_err(malformed)?;
    database.set_limit(Limit::SQLITE_LIMIT_LENGTH, geopackage_value_max(len)).map_err(malformed)?;
    let mut left = geopackage_steps_max(len) / u64::from(STEPS);
    let is_over = move || {
        left = left.saturating_sub(1);
        left == 0
    };
    database.progress_handler(STEPS as i32, Some(is_over)).map_err(malformed)?;
    let is_short = |name: &str| FUNCTIONS.split(' ').any(|short| short.eq_ignore_ascii_case(name));
    let may = move |context: AuthContext| match context.action {
        AuthAction::Function { function_name } if !is_short(function_name) => Authorization::Deny,
        _ => Authorization::Allow,
    };
    database.authorizer(Some(may)).map_err(malformed)
}

/// Checks that no other program has changes for this file in a file beside it, in which SQLite keeps them
/// until they are complete, or the old pages while it writes new ones. Next to a link, they may be beside
/// either.
///
/// Source: SQLite, "Database File Format", 3 and 4: a log has frames behind a header of 32 bytes, and a
/// journal counts unless its first byte was set to zero.
fn check_complete(path: &Path) -> Result<()> {
    let real = path.canonicalize().map_err(|e| Error::io("opening", e))?;
    for (path, ending, header_len) in
        [(path, "-wal", 32), (&real, "-wal", 32), (path, "-journal", 0), (&real, "-journal", 0)]
    {
        let mut beside = path.as_os_str().to_os_string();
        beside.push(ending);
        let mut start = Vec::new();
        match File::open(&beside) {
            Ok(file) => file.take(header_len + 1).read_to_end(&mut start),
            Err(error) if error.kind() == ErrorKind::NotFound => continue,
            Err(error) => Err(error),
        }
        .map_err(|e| Error::io("reading", e).of_input(beside.display().to_string()))?;
        if start.len() as u64 > header_len && start[0] != 0 {
            return Err(Error::usage(format!(
                "has changes that are not complete, in {}: close the program that writes it; if there is none, \
                 `sqlite3 {} 'PRAGMA journal_mode = DELETE'` completes or undoes them",
                beside.display(),
                path.display()
            )));
        }
    }
    Ok(())
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

/// What to do about code.
const AS_TABLE: &str = "save it as a table, for example with ogr2ogr";

fn malformed(error: rusqlite::Error) -> Error {
    let message = error.to_string();
    Error::malformed(if error.sqlite_error_code() == Some(ErrorCode::OperationInterrupted) {
        format!(
            "the tables take far more steps than those of a file of its size should: if one is a view, {AS_TABLE}"
        )
    } else if message.starts_with("not authorized") {
        format!("a view computes too much: {AS_TABLE} ({message})")
    } else {
        format!("not a GeoPackage that can be read: {message}")
    })
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
    let none = lines.no_properties();
    let columns = columns(database, table, &none)?;
    let names = std::iter::once(&table.column).chain(&columns).map(|name| quoted(name));
    let query = format!("SELECT {} FROM {}", names.collect::<Vec<_>>().join(", "), quoted(&table.name));
    let mut statement = database.prepare(&query).map_err(malformed)?;
    let mut rows = statement.query([]).map_err(malformed)?;
    for number in 1u64.. {
        let position = || format!("table {:?}, row {number}", table.name);
        let Some(row) = rows.next().map_err(|e| malformed(e).at(position()))? else { break };
        lines.feature(properties(row, &columns, none.clone()).map_err(|e| malformed(e).at(position()))?);
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
fn columns(database: &Connection, table: &Table, none: &Properties) -> Result<Vec<String>> {
    let query = "SELECT CAST(name AS BLOB), hidden FROM pragma_table_xinfo(?)";
    let mut statement = database.prepare(query).map_err(malformed)?;
    let mut rows = statement.query([&table.name]).map_err(malformed)?;
    let mut found = Vec::new();
    while let Some(row) = rows.next().map_err(malformed)? {
        // Other names need not be text.
        let name = row.get_ref(0).map_err(malformed)?.as_blob().unwrap_or_default();
        let Ok(name) = str::from_utf8(name) else { continue };
        let is_property = none.clone().of_name(name).is_some();
        if (is_property || name.eq_ignore_ascii_case(&table.column)) && is_computed(row)? {
            let message = format!("the column {name:?} of {:?} is computed: {AS_TABLE}", table.name);
            return Err(Error::malformed(message));
        }
        if is_property {
            found.push(name.to_string());
        }
    }
    Ok(found)
}

/// Whether a column is computed by code when it is read.
fn is_computed(column: &rusqlite::Row) -> Result<bool> {
    const GENERATED: i64 = 2;
    Ok(column.get::<_, i64>(1).map_err(malformed)? == GENERATED)
}

/// The properties of a row of the geometry and these columns.
fn properties(
    row: &rusqlite::Row,
    columns: &[String],
    mut found: Properties,
) -> rusqlite::Result<Properties> {
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
        let mut longest = "SELECT '0123456789abcdef' AS t".to_string();
        (0..6).for_each(|_| longest = format!("SELECT t || t || t || t AS t FROM ({longest})"));
        assert_eq!(ask(&format!("SELECT length(t) FROM ({longest})")).unwrap(), 1 << 16);
        let message = ask(&format!("SELECT length(t || 'a') FROM ({longest})")).unwrap_err().to_string();
        assert!(message.contains("too big"), "{message}");
        let message = malformed(ask("SELECT instr('aab', 'ab')").unwrap_err()).to_string();
        assert!(message.contains("a view computes too much"), "{message}");
        assert_eq!(ask("SELECT Coalesce(NULL, 7)").unwrap(), 7);
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
