//! What the headers of many files state, without reading their points.

use std::path::PathBuf;
use std::sync::Arc;

use crate::source::describe::{File, describe};
use crate::source::input::{Input, check_options, stated_of};
use crate::source::options::SourceOptions;
use crate::source::pass::Stated;
use crate::source::placement::Placement;
use crate::source::reader::Description;
use spmesh_base::error::{Error, Result};
use spmesh_base::parallel::OrderedPool;
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::{Bounds, Point};

/// Threads that open files, and files under way.
const THREADS: usize = 8;
const AHEAD: u64 = 64;

/// Most bad files that an error names beside the first one.
const NAMED_MAX: usize = 20;

/// Points of a file, and where they are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Number of points, before filters.
    pub points: u64,
    /// Bounding box in the coordinates that all files share; `None` without points.
    pub bounds: Option<Bounds>,
}

/// What files have in common, and the extent of each.
#[derive(Debug)]
pub struct Survey {
    /// What they have in common.
    pub description: Description,
    /// Their extents, in the order of the files.
    pub extents: Vec<Extent>,
    /// Notices for the user.
    pub notices: Vec<String>,
}

impl Survey {
    /// Reads the headers of files. Files whose headers do not state number and box of their points are read as a
    /// whole, with a notice. `progress` is called with the number of files done.
    ///
    /// Memory: about 200 bytes for each file.
    ///
    /// # Errors
    /// As [`Input::open`]; the file is named.
    pub fn of(paths: &[PathBuf], options: &SourceOptions, mut progress: impl FnMut(u64)) -> Result<Survey> {
        check_options(paths, options)?;
        let mut notices = Vec::new();
        let stated = read_headers(paths, options, &mut notices, &mut progress)?;
        let names: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
        let files: Vec<File> =
            names.iter().zip(&stated).map(|(name, stated)| File { name, stated }).collect();
        let (description, _) = describe(&files, options, &mut notices)?;
        let mut extents = Vec::with_capacity(files.len());
        for (path, file) in paths.iter().zip(&files) {
            let known = extent_of(file.stated, &description.coordinates, options);
            let extent = match known {
                Some(extent) => extent,
                None => {
                    notices.push(format!("{}: its header states no box, so it was read to plan", file.name));
                    measured(path, options, &description).map_err(|e| e.of_input(file.name))?
                }
            };
            extents.push(extent);
        }
        Ok(Survey { description, extents, notices })
    }
}

/// What the headers of all files state. Files are opened on several threads, because most of the time goes into
/// waiting for a file system.
fn read_headers(
    paths: &[PathBuf],
    options: &SourceOptions,
    notices: &mut Vec<String>,
    progress: &mut impl FnMut(u64),
) -> Result<Vec<Stated>> {
    let options = options.clone();
    let mut pool = OrderedPool::start("header", THREADS, AHEAD, move |path: PathBuf| {
        let mut notices = Vec::new();
        (stated_of(&path, &options, &mut notices), notices)
    })?;
    let mut stated: Vec<Stated> = Vec::with_capacity(paths.len());
    let (mut failed, mut others) = (None, Vec::new());
    let mut waiting = paths.iter();
    for (path, done) in paths.iter().zip(1..) {
        while !pool.is_full() {
            let Some(path) = waiting.next() else { break };
            pool.give(path.clone(), 1);
        }
        let Some((next, told)) = pool.take() else { break };
        notices.extend(told);
        match (next, &failed) {
            // Most files of a survey have the same reference system and the same fields.
            (Ok(mut next), _) => {
                if let Some(last) = stated.last() {
                    share(&last.crs, &mut next.crs);
                    share(&last.offers, &mut next.offers);
                }
                stated.push(next);
            }
            (Err(error), None) => failed = Some(error),
            (Err(_), Some(_)) => others.push(path.display().to_string()),
        }
        progress(done);
    }
    match failed {
        None => Ok(stated),
        Some(error) if others.is_empty() => Err(error),
        Some(error) => {
            let (count, named) = (others.len(), others[..others.len().min(NAMED_MAX)].join(", "));
            let more = if count > NAMED_MAX { ", ..." } else { "" };
            Err(error.noting(&format!("{count} other files are bad, too: {named}{more}")))
        }
    }
}

/// Uses one copy of what is equal.
fn share<T: PartialEq + ?Sized>(last: &Arc<T>, next: &mut Arc<T>) {
    if **last == **next {
        *next = Arc::clone(last);
    }
}

/// The extent that a header states, if it does.
fn extent_of(stated: &Stated, coordinates: &Coordinates, options: &SourceOptions) -> Option<Extent> {
    let points = stated.points?;
    if points == 0 {
        return Some(Extent { points, bounds: None });
    }
    let bounds = stated.bounds?;
    let open = SourceOptions { bounds: None, filters: Default::default(), ..options.clone() };
    let mut placement = Placement::new(&stated.coordinates, coordinates, &open);
    let mut corners: Vec<Point> = Vec::with_capacity(2);
    placement.put(bounds.min, &mut corners).ok()?;
    placement.put(bounds.max, &mut corners).ok()?;
    Some(Extent { points, bounds: Bounds::of_points(&corners) })
}

/// The extent of the points of a file, which are read.
fn measured(path: &PathBuf, options: &SourceOptions, description: &Description) -> Result<Extent> {
    let open = SourceOptions {
        bounds: None,
        filters: Default::default(),
        encoding: Some(description.coordinates),
        crs: Some(description.crs.clone()),
        ..options.clone()
    };
    let input = Input::open(std::slice::from_ref(path), &open)?;
    let mut reader = input.read()?;
    let (mut extent, mut batch) = (Extent { points: 0, bounds: None }, Vec::new());
    loop {
        reader.next_batch(&mut batch)?;
        let Some(bounds) = Bounds::of_points(&batch) else { break };
        extent.points += batch.len() as u64;
        extent.bounds = Some(extent.bounds.map_or(bounds, |all| all.union(bounds)));
    }
    match reader.invalid() {
        0 => Ok(extent),
        _ => Err(Error::usage("points that are not finite cannot be planned: leave them out")),
    }
}
