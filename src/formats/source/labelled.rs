//! Points that are held in memory, with a word about each, such as check points: lines of text, features of
//! GeoJSON, Shapefiles and GeoPackages, and any other input of points.

use std::collections::HashMap;
use std::path::Path;

use crate::crs::requested;
use crate::detect::{Format, detect, read_head};
use crate::lines::{Reading, is_of_features, read_breaklines};
use crate::source::gzip::Plain;
use crate::source::input::Input;
use crate::source::options::SourceOptions;
use crate::source::origin::{Admitted, Origin, name_of};
use crate::source::row_plan::AttributeChoice;
use crate::text::labelled as text;
use crate::text::options::Column;
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_base::inputs;
use spmesh_stream::Crs;
use spmesh_stream::model::bounds::Point;

/// The attribute of points of LAS files that is their word, unless the user names another.
const CLASS: &str = "classification";

/// Most different words.
const LABELS_MAX: usize = 1000;

/// Points with a word about each.
#[derive(Debug, Default)]
pub struct LabelledPoints {
    /// World coordinates.
    pub points: Vec<Point>,
    /// For each point, the number of its word.
    pub numbers: Vec<u32>,
    /// All words; those of points without one are empty.
    pub labels: Vec<String>,
    /// Whether words are numbers of classes of LAS points.
    pub are_classes: bool,
    /// Their coordinate reference system.
    pub crs: Crs,
    /// What the user should know.
    pub notices: Vec<String>,
    most: usize,
}

/// Words, each with a number.
#[derive(Default)]
pub(crate) struct Labels(HashMap<String, u32>);

impl Labels {
    /// The number of a word.
    pub(crate) fn number(&mut self, label: Option<String>) -> Result<u32> {
        let next = self.0.len() as u32;
        let number = *self.0.entry(label.unwrap_or_default()).or_insert(next);
        if number as usize == LABELS_MAX {
            let message = "these are no classes of points: --class-field takes what many have in common";
            return Err(Error::usage(format!("more than {LABELS_MAX} different words, {message}")));
        }
        Ok(number)
    }

    /// The words by number.
    pub(crate) fn finish(self) -> Vec<String> {
        let mut labels = vec![String::new(); self.0.len()];
        self.0.into_iter().for_each(|(label, number)| labels[number as usize] = label);
        labels
    }
}

impl LabelledPoints {
    /// Takes a point.
    pub(crate) fn put(&mut self, point: Point, number: u32) -> Result<()> {
        if !point.iter().all(|coordinate| coordinate.is_finite()) {
            return Err(Error::malformed(
                "found NaN or infinity, expected finite coordinates: leave the point out",
            ));
        }
        if self.points.len() == self.most {
            let message = format!("more than {} points, for which --memory has room: take fewer", self.most);
            return Err(Error::new(ErrorKind::Memory, message));
        }
        self.points.push(point);
        self.numbers.push(number);
        Ok(())
    }
}

/// Reads the points of the file at `path`, which are at most `most`, with what the column, property or
/// attribute `label` says. Points of LAS files have their class without it.
///
/// # Errors
/// If the file cannot be opened, holds something else than points with finite coordinates and elevations, or
/// does not have what `label` names; memory, if there are more points. The file is named, and the place in
/// it.
pub fn read_labelled(
    path: &Path,
    label: Option<&Column>,
    most: usize,
    options: &SourceOptions,
) -> Result<LabelledPoints> {
    let read = || {
        let mut found = LabelledPoints { most, ..LabelledPoints::default() };
        if path.as_os_str() == "-" {
            return Err(Error::usage("check points come from a file: stdin is for points or the mesh"));
        }
        let mut file = Plain::new(inputs::open(path)?).map_err(|e| Error::io("reading", e))?;
        let head = read_head(&mut file).map_err(|e| Error::io("reading", e))?;
        if is_of_features(&head) {
            read_features(path, label, &mut found)?;
        } else if let Format::Text | Format::OtherText = detect(&head)? {
            let admitted = Admitted::Formats(options.reader);
            let origin = Origin::new(path, admitted, &options.temp_dir(), &mut found.notices)?;
            text::read(&origin, label, &options.text, &mut found)?;
        } else {
            read_input(path, label, options, &mut found)?;
        }
        Ok(found)
    };
    read().map_err(|e: Error| e.of_input(name_of(path)))
}

/// Reads the points of features.
fn read_features(path: &Path, label: Option<&Column>, found: &mut LabelledPoints) -> Result<()> {
    let name = match label {
        Some(Column::Number(number)) => Some(number.to_string().into()),
        Some(Column::Name(name)) => Some(name.as_str().into()),
        None => None,
    };
    let has_name = name.is_some();
    let file = read_breaklines(path, &Reading { label: name, ..Reading::default() })?;
    found.notices.extend(file.layers.clone());
    let mut labels = Labels::default();
    for line in &file.lines {
        let mut put = || {
            let (Some(&[x, y]), Some(&z)) = (line.vertices.first(), line.elevations.first()) else {
                return Ok(());
            };
            let z = z
                .filter(|_| line.is_point)
                .ok_or_else(|| Error::malformed("expected points with an elevation as third coordinate"))?;
            found.put([x, y, z], labels.number(line.properties.label.clone())?)
        };
        put().map_err(|e: Error| e.at(&line.position[..]))?;
    }
    if has_name && file.lines.iter().all(|line| line.properties.label.is_none()) {
        return Err(Error::usage("no feature has the property that --class-field names"));
    }
    // GeoJSON that does not say so is in degrees, by RFC 7946.
    found.crs = if file.system.may_be_degrees { requested("EPSG:4326")? } else { file.system.crs };
    found.labels = labels.finish();
    Ok(())
}

/// Reads the points of any other format.
fn read_input(
    path: &Path,
    label: Option<&Column>,
    options: &SourceOptions,
    found: &mut LabelledPoints,
) -> Result<()> {
    let attributes = match label {
        None => AttributeChoice::Offered(vec![CLASS.to_string()]),
        Some(Column::Name(name)) => AttributeChoice::Named(vec![name.clone()]),
        Some(Column::Number(number)) => {
            let message = format!("--class-field {number}: only text has columns with numbers, give a name");
            return Err(Error::usage(message));
        }
    };
    let input = Input::open(&[path.to_path_buf()], &SourceOptions { attributes, ..options.clone() })?;
    let description = input.description();
    if !description.has_elevation && description.stated_points != Some(0) {
        return Err(Error::usage("points have no elevation: give points x y z"));
    }
    let name = description.attributes.iter().next().map(|attribute| attribute.name.clone());
    found.are_classes = name.as_deref() == Some(CLASS);
    let column = name.map(|name| description.attributes.column(&name)).transpose().map_err(Error::usage)?;
    let (mut reader, mut batch, mut labels) = (input.read()?, Vec::new(), Labels::default());
    loop {
        reader.next_batch(&mut batch)?;
        if batch.is_empty() {
            break;
        }
        for (number, &point) in batch.iter().enumerate() {
            let value = column.as_ref().map(|column| column.of(reader.rows(), number));
            let label =
                labels.number(value.filter(|value| !value.is_nan()).map(|value| value.to_string()))?;
            found.put(description.coordinates.to_world(point), label)?;
        }
    }
    (found.labels, found.crs) = (labels.finish(), description.crs.clone());
    found.notices.extend(input.notices().iter().cloned().chain(input.withheld_notice()));
    Ok(())
}
