//! What the files of an input have in common.

use crate::source::crs;
use crate::source::grid::{self, Member};
use crate::source::options::SourceOptions;
use crate::source::pass::Stated;
use crate::source::placement::Placement;
use crate::source::reader::Description;
use crate::source::row_plan::{self, RowPlan};
use spmesh_base::error::{Error, Result};
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::Bounds;

/// A file and what it states.
#[derive(Debug, Clone, Copy)]
pub(crate) struct File<'a> {
    pub(crate) name: &'a str,
    pub(crate) stated: &'a Stated,
}

/// What all files have in common, and how the rows of each are made.
pub(crate) fn describe(
    files: &[File],
    options: &SourceOptions,
    notices: &mut Vec<String>,
) -> Result<(Description, Vec<RowPlan>)> {
    let coordinates = match (options.encoding, options.grid) {
        (Some(encoding), _) => encoding,
        (None, Some((scale, offset))) => Coordinates::I32 { scale, offset },
        (None, None) => {
            let member = |file: &File| -> Member {
                let Stated { coordinates, bounds, .. } = *file.stated;
                Member { name: file.name.to_string(), coordinates, bounds }
            };
            // Files without points need no grid, unless all are.
            let has_points = |file: &&File| file.stated.points != Some(0);
            let mut members: Vec<Member> = files.iter().filter(has_points).map(member).collect();
            if members.is_empty() {
                members.extend(files.first().map(member));
            }
            grid::common(&members, options.dims)?
        }
    };
    let offers: Vec<_> = files.iter().map(|file| (file.name, &file.stated.offers[..])).collect();
    let (attributes, plans) = row_plan::choose(&options.attributes, &offers, notices)?;
    let description = Description {
        coordinates,
        dims: options.dims,
        has_elevation: has_z(files)? && options.dims == 2,
        crs: match &options.crs {
            Some(crs) => crs.clone(),
            None => crs::common(files.iter().map(|file| (file.name, &*file.stated.crs)), notices)?,
        },
        stated_bounds: stated_bounds(files, &coordinates),
        stated_points: files.iter().map(|file| file.stated.points).sum(),
        attributes,
    };
    Ok((description, plans))
}

fn has_z(files: &[File]) -> Result<bool> {
    let find = |wanted| files.iter().find(|file| file.stated.has_z == Some(wanted));
    match (find(true), find(false)) {
        (Some(with), Some(without)) => Err(Error::usage(format!(
            "points of {} have an elevation, those of {} have none",
            with.name, without.name
        ))),
        (with, _) => Ok(with.is_some()),
    }
}

/// The union of the stated boxes in `coordinates`; `None` if a file states none.
fn stated_bounds(files: &[File], coordinates: &Coordinates) -> Option<Bounds> {
    let mut corners = Vec::with_capacity(2 * files.len());
    for file in files {
        if file.stated.points == Some(0) {
            continue;
        }
        let bounds = file.stated.bounds?;
        let mut placement = Placement::new(&file.stated.coordinates, coordinates, &SourceOptions::default());
        placement.put(bounds.min, &mut corners).ok()?;
        placement.put(bounds.max, &mut corners).ok()?;
    }
    Bounds::of_points(&corners)
}
