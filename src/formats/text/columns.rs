//! Which columns of a text hold the coordinates.

use crate::source::origin::Bytes;
use crate::source::pass::Stated;
use crate::source::row_plan::offers_of;
use crate::text::lines::{Lines, number};
use crate::text::options::{Column, TextOptions};
use crate::text::read::{Delimiter, delimiter_of, fields};
use spmesh_base::error::{Error, Result, counted};
use spmesh_stream::model::attributes::{Attribute, NumberType, with_usable_names};
use spmesh_stream::{Coordinates, Crs};

/// Lines of points that are looked at for a column that only numbers them.
const LOOKED_AT: usize = 20;

/// The columns that hold the coordinates.
#[derive(Debug, Clone)]
pub(crate) struct Columns {
    pub(crate) delimiter: Delimiter,
    /// Columns of x, y and, if points have one, z.
    pub(crate) axes: Vec<usize>,
    /// The other columns, in their order: each is a number of the record of a line.
    pub(crate) others: Vec<usize>,
    /// Line of the column names, if there is one.
    pub(crate) names_line: Option<u64>,
    /// Whether the first line of points has only two columns, so that a third column in another line is an
    /// error.
    pub(crate) only_two: bool,
    /// What the user said about the lines.
    pub(crate) layout: TextOptions,
}

/// A line without numbers, before all points.
struct Names {
    line: u64,
    delimiter: Delimiter,
    fields: Vec<Vec<u8>>,
}

impl Names {
    fn of(line: u64, delimiter: Delimiter, fields: &[&[u8]]) -> Names {
        Names { line, delimiter, fields: fields.iter().map(|field| field.to_vec()).collect() }
    }

    fn find(&self, name: &str) -> Option<usize> {
        self.fields.iter().position(|field| field.eq_ignore_ascii_case(name.as_bytes()))
    }

    fn list(&self) -> String {
        let names: Vec<_> = self.fields.iter().map(|field| String::from_utf8_lossy(field)).collect();
        names.join(", ")
    }
}

/// What comes before the first point, and that point.
#[derive(Default)]
struct Start {
    names: Option<Names>,
    /// The last comment.
    comment: Option<Names>,
    /// Delimiter and fields of the first line of points.
    first: Option<(Delimiter, Vec<Vec<u8>>)>,
}

/// Finds the columns from the first line that is neither blank nor a comment and, if that holds the names of
/// the columns, from the next one. The last comment before the points may name the columns, too. The pass
/// checks the other lines.
///
/// # Errors
/// If the first line is neither a point nor names of columns, or if the names do not tell which columns are x
/// and y; usage, if the user chose columns that are not there.
pub(crate) fn state(
    file: Bytes,
    layout: &TextOptions,
    notices: &mut Vec<String>,
) -> Result<(Columns, Stated)> {
    let mut lines = Lines::new(file, "");
    layout.skip(&mut lines)?;
    let start = read_start(&mut lines, layout)?;
    let found: Option<Vec<&[u8]>> =
        start.first.as_ref().map(|(_, fields)| fields.iter().map(Vec::as_slice).collect());
    let delimiter = start.first.as_ref().map_or(Delimiter::WhiteSpace, |first| first.0);
    let blank = || Columns {
        delimiter,
        axes: vec![0, 1],
        others: Vec::new(),
        names_line: Some(0),
        only_two: false,
        layout: layout.clone(),
    };
    let (mut columns, names) = match (&found, &start.names) {
        (Some(found), _) => choose(delimiter, found, &start, layout)?,
        (None, Some(names)) if layout.columns.is_empty() && named_axes(&names.fields).is_none() => {
            return Err(no_text_of_points(names.line));
        }
        // Names without points below them offer their columns all the same.
        (None, Some(names)) => choose(names.delimiter, &[], &start, layout)?,
        (None, None) => (blank(), None),
    };
    if let Some(names) = names.filter(|_| layout.columns.is_empty() && columns.axes.len() == 2) {
        notices.extend(value_of(&mut columns, names)?);
    }
    if layout.columns.is_empty() && names.is_none() && columns.axes == [0, 1, 2] && !columns.others.is_empty()
    {
        notices.extend(numbering(&mut lines, &columns, found.as_deref().unwrap_or_default())?);
    }
    let has_z = found.is_some().then_some(columns.axes.len() == 3);
    let has_columns = found.is_some() || start.names.is_some();
    let attributes = if has_columns { attributes_of(&columns, names) } else { Vec::new() };
    let offers = offers_of(&attributes);
    let (coordinates, crs) = (Coordinates::F64, Crs::Unknown);
    let stated =
        Stated { coordinates, has_z, crs: crs.into(), bounds: None, points: None, offers: offers.into() };
    Ok((columns, stated))
}

/// Reads up to the first line of points.
fn read_start(lines: &mut Lines<Bytes>, layout: &TextOptions) -> Result<Start> {
    let mut start = Start::default();
    loop {
        let number_of_line = lines.number() + 1;
        let Some(line) = lines.next_trimmed()? else { return Ok(start) };
        let delimiter_in = |line| layout.separator.map_or_else(|| delimiter_of(line), |given| given.0);
        if let Some(comment) = layout.comment(line) {
            let delimiter = delimiter_in(comment);
            let words: Vec<&[u8]> = fields(comment, delimiter).collect();
            start.comment = Some(Names::of(number_of_line, delimiter, &words));
            continue;
        }
        let line = layout.content(line);
        if line.is_empty() {
            continue;
        }
        let delimiter = delimiter_in(line);
        let found: Vec<&[u8]> = fields(line, delimiter).collect();
        if start.names.is_some() || found.iter().any(|field| number(field).is_some()) {
            start.first = Some((delimiter, found.into_iter().map(<[u8]>::to_vec).collect()));
            return Ok(start);
        }
        start.names = Some(Names::of(number_of_line, delimiter, &found));
    }
}

/// The columns, from the first line of points and any names above it; also returns the names, if they are
/// those of the columns.
fn choose<'a>(
    delimiter: Delimiter,
    found: &[&[u8]],
    start: &'a Start,
    layout: &TextOptions,
) -> Result<(Columns, Option<&'a Names>)> {
    let is_number = |field: &Vec<u8>| number(field).is_some();
    let comment = start.comment.as_ref().filter(|comment| {
        start.names.is_none() && comment.fields.len() == found.len() && !comment.fields.iter().any(is_number)
    });
    let names = start.names.as_ref();
    let columns = |delimiter, axes: Vec<usize>, count: usize, only_two| {
        let others = (0..count).filter(|column| !axes.contains(column)).collect();
        let names_line = names.map(|names| names.line);
        Columns { delimiter, axes, others, names_line, only_two, layout: layout.clone() }
    };
    if !layout.columns.is_empty() {
        let titles = names.or(comment);
        let axes = chosen_axes(&layout.columns, titles, found.len())?;
        let delimiter = layout.separator.map_or(delimiter, |given| given.0);
        return Ok((columns(delimiter, axes, found.len(), false), titles));
    }
    let usual: Vec<usize> = (0..found.len().clamp(2, 3)).collect();
    let Some(names) = names else {
        let titles = comment.filter(|_| found.len() > 3);
        if let Some(titles) = titles {
            match named_axes(&titles.fields) {
                Some(axes) if axes.len() == 3 => {
                    return Ok((columns(delimiter, axes, found.len(), false), Some(titles)));
                }
                Some(axes) if axes == [0, 1] => {
                    return Ok((columns(delimiter, usual, found.len(), false), Some(titles)));
                }
                Some(_) => return Err(unclear(titles, "4,5,6")),
                None => check_order(titles)?,
            }
        }
        return Ok((columns(delimiter, usual, found.len(), found.len() == 2), None));
    };
    if let Some(axes) = named_axes(&names.fields) {
        return Ok((columns(names.delimiter, axes, names.fields.len(), false), Some(names)));
    }
    let has_number = found.iter().any(|field| number(field).is_some());
    if names.fields.len() != found.len() || !has_number {
        return Err(no_text_of_points(names.line));
    }
    if found.len() > 3 {
        let reason = "cannot tell which columns are the coordinates: call them x, y and z, or choose them \
                      (spfinalize --columns)";
        return Err(Error::malformed(reason).at(format!("line {}", names.line)));
    }
    Ok((columns(delimiter, usual, found.len(), found.len() == 2), Some(names)))
}

/// Takes the third of three columns as the value, if points need one and no column is called z; returns a
/// notice.
///
/// # Errors
/// Usage, if points need a value, and several columns may have it.
fn value_of(columns: &mut Columns, names: &Names) -> Result<Option<String>> {
    let [x, y] = [columns.axes[0], columns.axes[1]].map(|axis| String::from_utf8_lossy(&names.fields[axis]));
    match columns.others[..] {
        [2] if columns.layout.needs_z => {
            columns.axes.push(2);
            columns.others.clear();
            let value = String::from_utf8_lossy(&names.fields[2]);
            Ok(Some(format!("column 3, {value:?}, is the value: no column is called z")))
        }
        [2] => {
            let value = String::from_utf8_lossy(&names.fields[2]);
            Ok(Some(format!(
                "points have no elevation, as no column is called z: --columns {x},{y},{value} takes the third one"
            )))
        }
        [_, ..] if columns.layout.needs_z => Err(Error::usage(format!(
            "line {} names {}: which one is the value? Choose it with --columns {x},{y},NAME",
            names.line,
            names.list()
        ))),
        [_, ..] => Ok(Some(format!(
            "points have no elevation, as no column of {} is called z: --columns {x},{y},NAME takes one",
            names.list()
        ))),
        [] => Ok(None),
    }
}

/// The columns that the user chose, of `count`.
fn chosen_axes(chosen: &[Column], names: Option<&Names>, count: usize) -> Result<Vec<usize>> {
    if !matches!(chosen.len(), 2 | 3) {
        let found = counted(chosen.len() as u64, "column is", "columns are");
        let message = format!("{found} chosen (--columns), expected those of x, y and z");
        return Err(Error::usage(message));
    }
    let mut axes = Vec::with_capacity(3);
    for column in chosen {
        let axis = match column {
            Column::Number(number) => (*number <= count || count == 0).then(|| number.saturating_sub(1)),
            Column::Name(name) => names.and_then(|names| names.find(name)),
        };
        let Some(axis) = axis else { return Err(no_column(column, names, count)) };
        if axes.contains(&axis) {
            return Err(Error::usage("a column is chosen twice (--columns)"));
        }
        axes.push(axis);
    }
    Ok(axes)
}

fn no_column(column: &Column, names: Option<&Names>, count: usize) -> Error {
    let has = match names {
        Some(names) => format!("line {} names {}", names.line, names.list()),
        None => format!("no line names the {count} columns"),
    };
    match column {
        Column::Number(number) => {
            Error::usage(format!("there is no column {number} (--columns): points have {count} columns"))
        }
        Column::Name(name) => Error::usage(format!("there is no column \"{name}\" (--columns): {has}")),
    }
}

/// Refuses names that tell that other columns than the first two are x and y, but not which is z.
fn check_order(names: &Names) -> Result<()> {
    let has = |part: &str| {
        names.fields.iter().position(|name| {
            let name = name.to_ascii_lowercase();
            name.windows(part.len()).any(|window| window == part.as_bytes())
        })
    };
    let first = |parts: &[&str]| parts.iter().filter_map(|part| has(part)).min();
    let (Some(x), Some(y)) = (first(&["lon", "east"]), first(&["lat", "north"])) else { return Ok(()) };
    if (x, y) == (0, 1) {
        return Ok(());
    }
    let name = |column: usize| String::from_utf8_lossy(&names.fields[column]).into_owned();
    let starts_with_z = |name: &Vec<u8>| name.starts_with(b"Z") || name.starts_with(b"z");
    match first(&["elev", "height", "alt"]).or_else(|| names.fields.iter().position(starts_with_z)) {
        Some(z) => Err(unclear(names, &[x, y, z].map(name).join(","))),
        None => Err(unclear(names, &format!("{},{},...", name(x), name(y)))),
    }
}

fn unclear(names: &Names, example: &str) -> Error {
    let message = format!(
        "the comment names the columns {}: which of them are x, y and z? Choose them, as in spfinalize \
         --columns {example}",
        names.list()
    );
    Error::malformed(message).at(format!("line {}", names.line))
}

/// A notice if the first column seems to number the points, or to be the same for all, while others hold
/// decimals.
fn numbering(lines: &mut Lines<Bytes>, columns: &Columns, first: &[&[u8]]) -> Result<Option<String>> {
    let is_decimal = |field: &&&[u8]| number(field).is_some() && field.contains(&b'.');
    let integer = |field: &[u8]| std::str::from_utf8(field).ok()?.parse::<i64>().ok();
    let has_decimals = first.iter().skip(1).filter(is_decimal).count() > 1;
    let Some(start) = first.first().and_then(|field| integer(field)).filter(|_| has_decimals) else {
        return Ok(None);
    };
    let (mut is_same, mut is_counted, mut count) = (true, true, 1);
    while count < LOOKED_AT {
        let Some(line) = lines.next_trimmed()? else { break };
        let line = columns.layout.content(line);
        let Some(value) = fields(line, columns.delimiter).next().map(integer) else { continue };
        let Some(value) = value else { return Ok(None) };
        is_same &= value == start;
        is_counted &= i64::try_from(count).is_ok_and(|count| start.checked_add(count) == Some(value));
        count += 1;
    }
    Ok((count > 2 && (is_same || is_counted)).then(|| {
        format!(
            "column 1 is {} in the first {count} points, but is read as x: if x, y and z are other columns, \
             choose them, as in spfinalize --columns 2,3,4",
            if is_same { "the same integer" } else { "a running number" }
        )
    }))
}

/// The columns beside the coordinates as attributes: by their names, or by their numbers from 1 on.
fn attributes_of(columns: &Columns, names: Option<&Names>) -> Vec<Attribute> {
    let name_of = |&column: &usize| {
        let name = names.and_then(|names| names.fields.get(column)).filter(|name| !name.is_empty());
        name.map_or(format!("column{}", column + 1), |name| String::from_utf8_lossy(name).into_owned())
    };
    let attribute = |column: &usize| Attribute {
        unknown: Some(f64::NAN.to_le_bytes().to_vec()),
        ..Attribute::new(name_of(column), NumberType::F64)
    };
    with_usable_names(columns.others.iter().map(attribute).collect())
}

fn no_text_of_points(line: u64) -> Error {
    let reason = "expected a point, or the names of the columns: a point is a line of numbers separated by \
                  blanks, commas or semicolons";
    Error::malformed(reason).at(format!("line {line}"))
}

/// The columns named x, y and z, or by other usual names; `None` without x and y.
fn named_axes<Name: AsRef<[u8]>>(names: &[Name]) -> Option<Vec<usize>> {
    let column = |usual: &[&str]| {
        let is_usual =
            |name: &Name| usual.iter().any(|usual| name.as_ref().eq_ignore_ascii_case(usual.as_bytes()));
        names.iter().position(is_usual)
    };
    let mut axes = vec![
        column(&["x", "easting", "lon", "long", "longitude"])?,
        column(&["y", "northing", "lat", "latitude"])?,
    ];
    axes.extend(column(&["z", "elevation", "height", "altitude"]));
    Some(axes)
}
