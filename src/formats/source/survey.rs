//! What the headers of many files state, without reading their points.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use crate::source::describe::{File, describe};
use crate::source::input::{Input, check_options, stated_of};
use crate::source::options::SourceOptions;
use crate::source::pass::Stated;
use crate::source::placement::Placement;
use crate::source::reader::Description;
use spmesh_base::error::{Error, ErrorKind, Result};
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
    /// Their extents, in the order of the files without the bad ones.
    pub extents: Vec<Extent>,
    /// The bad files: their numbers among all, in this order, and what is wrong with each.
    pub bad: Vec<(usize, Error)>,
    /// Notices for the user.
    pub notices: Vec<String>,
}

impl Survey {
    /// Reads the headers of files. Files whose headers do not state number and box of their points are read
    /// as a whole, with a notice. If `keep_going`, bad files are left out, as if they had not been given;
    /// those that are gone count as bad. `progress` is called with the number of files done.
    ///
    /// Memory: about 200 bytes for each file.
    ///
    /// # Errors
    /// As [`Input::open`]; the file is named. If `keep_going`, only if no file is left, the files do not fit
    /// together, or the machine has too little memory or disk.
    pub fn of(
        paths: &[PathBuf],
        options: &SourceOptions,
        keep_going: bool,
        mut progress: impl FnMut(u64),
    ) -> Result<Survey> {
        check_options(paths, options)?;
        let mut surveyor = Surveyor { paths, options, keep_going, bad: BTreeMap::new() };
        let mut notices = Vec::new();
        let mut stated = surveyor.read_headers(&mut notices, &mut progress)?;
        loop {
            let bad = surveyor.bad.len();
            if bad > 0 && (!keep_going || stated.is_empty()) {
                return Err(surveyor.refusal());
            }
            let mut told = Vec::new();
            let (description, extents) = surveyor.measure(&stated, &mut told)?;
            if surveyor.bad.len() == bad {
                notices.extend(told);
                let bad = surveyor.bad.into_iter().collect();
                return Ok(Survey { description, extents, bad, notices });
            }
            // Files that turn out to be bad when they are read count for no grid of the others.
            stated.retain(|(index, _)| !surveyor.bad.contains_key(index));
        }
    }
}

/// Reads many files, and knows which are bad.
struct Surveyor<'a> {
    paths: &'a [PathBuf],
    options: &'a SourceOptions,
    keep_going: bool,
    bad: BTreeMap<usize, Error>,
}

impl Surveyor<'_> {
    /// What the headers of good files state, with their numbers among all. Files are opened on several
    /// threads, because most of the time goes into waiting for a file system.
    fn read_headers(
        &mut self,
        notices: &mut Vec<String>,
        progress: &mut impl FnMut(u64),
    ) -> Result<Vec<(usize, Stated)>> {
        let options = self.options.clone();
        let mut pool = OrderedPool::start("header", THREADS, AHEAD, move |path: PathBuf| {
            let mut notices = Vec::new();
            (stated_of(&path, &options, &mut notices), notices)
        })?;
        let mut stated: Vec<(usize, Stated)> = Vec::with_capacity(self.paths.len());
        let mut waiting = self.paths.iter();
        for index in 0..self.paths.len() {
            while !pool.is_full() {
                let Some(path) = waiting.next() else { break };
                pool.give(path.clone(), 1);
            }
            let Some((next, told)) = pool.take() else { break };
            notices.extend(told);
            match next {
                // Most files of a survey have the same reference system and the same fields.
                Ok(mut next) => {
                    if let Some((_, last)) = stated.last() {
                        share(&last.crs, &mut next.crs);
                        share(&last.offers, &mut next.offers);
                    }
                    stated.push((index, next));
                }
                Err(error) if self.keep_going && error.is_shortage() => return Err(error),
                Err(error) => _ = self.bad.insert(index, error),
            }
            progress(index as u64 + 1);
        }
        Ok(stated)
    }

    /// What files have in common, and their extents; those that cannot be measured become bad.
    fn measure(
        &mut self,
        stated: &[(usize, Stated)],
        notices: &mut Vec<String>,
    ) -> Result<(Description, Vec<Extent>)> {
        let paths = self.paths;
        let names: Vec<String> =
            stated.iter().map(|(index, _)| paths[*index].display().to_string()).collect();
        let files: Vec<File> =
            names.iter().zip(stated).map(|(name, (_, stated))| File { name, stated }).collect();
        let (description, _) = describe(&files, self.options, notices)?;
        let mut extents = Vec::with_capacity(files.len());
        for (&(index, ref stated), name) in stated.iter().zip(&names) {
            if let Some(extent) = extent_of(stated, &description.coordinates, self.options) {
                extents.push(extent);
                continue;
            }
            notices.push(format!("{name}: its header states no box, so it was read to plan"));
            match measured(&paths[index], self.options, &description).map_err(|e| e.of_input(name)) {
                Ok(extent) => extents.push(extent),
                // A file that only does not fit the common grid is not bad.
                Err(error) if error.kind() == ErrorKind::Usage => return Err(error),
                Err(error) if !self.keep_going || error.is_shortage() => return Err(error),
                Err(error) => _ = self.bad.insert(index, error),
            }
        }
        Ok((description, extents))
    }

    /// The error of the first bad file, which names the others.
    fn refusal(mut self) -> Error {
        let (_, error) = self.bad.pop_first().expect("a file is bad");
        let count = self.bad.len();
        if count == 0 {
            return error;
        }
        let named = self.bad.keys().take(NAMED_MAX).map(|&index| self.paths[index].display().to_string());
        let named = named.collect::<Vec<_>>().join(", ");
        let more = if count > NAMED_MAX { ", ..." } else { "" };
        error.noting(&format!("{count} other files are bad, too: {named}{more}"))
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
