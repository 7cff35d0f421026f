//! The points of one leaf of a plan, for `spnode`.

use std::io::Write;
use std::path::PathBuf;

use clap::Parser;

use super::{Flags, target_of};
use crate::finalize::{Budget, Observer, Passes, PlannedBox, Selected, Windowed};
use crate::plan::{FileCount, Node, Plan};
use spmesh_base::error::{Error, Result};
use spmesh_formats::source::{AttributeChoice, Input, SourceOptions};
use spmesh_stream::model::bounds::{Bounds, Region};
use spmesh_stream::{Coordinates, Header, Kind, StreamWriter};

/// How a job reads the points of a leaf.
#[derive(Debug, Clone)]
pub(crate) struct Resources {
    /// Memory for points that wait. Units: bytes.
    pub(crate) memory: u64,
    /// Threads that decode LAZ.
    pub(crate) threads: usize,
    /// Folder for temporary files.
    pub(crate) temp_dir: Option<PathBuf>,
}

/// What a leaf has read.
#[derive(Debug, Default)]
pub(crate) struct LeafCounts {
    /// Points of each file in the box.
    pub(crate) files: Vec<FileCount>,
    /// Points in the box that were dropped.
    pub(crate) dropped: u64,
    /// Notices for the user.
    pub(crate) notices: Vec<String>,
}

/// Writes the finalized points of a leaf to `output`.
pub(crate) fn write_leaf(
    plan: &Plan,
    node: &Node,
    resources: &Resources,
    output: impl Write,
) -> anyhow::Result<LeafCounts> {
    let flags = flags_of(&plan.arguments)?;
    let files = plan.files_of(node);
    files.iter().try_for_each(|file| file.check())?;
    check_beside(plan, &flags)?;
    let header = plan.header(Kind::Points)?;
    if files.is_empty() {
        StreamWriter::new(output, Header { points: Some(0), ..header })?.end(0, 0)?;
        return Ok(LeafCounts::default());
    }
    let window = node.region.region();
    let source = SourceOptions {
        attributes: AttributeChoice::of_names(&plan.attributes),
        encoding: Some(plan.coordinates()),
        crs: Some(header.crs.clone()),
        window: Some(window),
        reach: Some(in_world(&window, &plan.coordinates())),
        threads: std::num::NonZeroUsize::new(resources.threads),
        temp_dir: resources.temp_dir.clone(),
        ..flags.source_options(None)?
    };
    let paths: Vec<PathBuf> = files.iter().map(|file| file.path()).collect();
    let input = Input::open(&paths, &source)?;
    let boxes: Vec<PlannedBox> =
        files.iter().map(|file| PlannedBox { name: file.path.clone(), bounds: file.bounds() }).collect();
    let windowed = Windowed::new(&input, &boxes, &window, header.has_elevation);
    let (areas, mut notices) = flags.areas.read(&target_of(&input))?;
    let selected = Selected::new(&windowed, &areas);
    let points: &dyn Passes = if areas.keep_all() { &windowed } else { &selected };
    let mut options = flags.options()?;
    options.budget = Budget::of_process(resources.memory, resources.threads)?;
    options.temp_dir.clone_from(&resources.temp_dir);
    let mut watch = Watch { notices: &mut notices };
    let stats = crate::finalize::run(points, &options, &mut watch, output)?;
    // A file that changed while it was read may look whole.
    files.iter().try_for_each(|file| file.check())?;
    check_beside(plan, &flags)?;
    let in_box: u64 = input.counts().iter().sum();
    let files = node.files.iter().zip(input.counts()).map(|(&file, &points)| FileCount { file, points });
    Ok(LeafCounts { files: files.collect(), dropped: in_box - stats.points, notices })
}

/// Checks that polygons are those of the plan: the same files, unchanged.
fn check_beside(plan: &Plan, flags: &Flags) -> Result<()> {
    for (path, planned) in flags.areas.files().zip(&plan.beside) {
        let absolute = std::path::absolute(path).map_err(|e| Error::io("finding", e))?;
        if absolute != planned.path() {
            let message = "is another file than when the plan was made: run jobs in the same folder";
            return Err(Error::usage(message).of_input(absolute.display().to_string()));
        }
        planned.check()?;
    }
    Ok(())
}

/// The closed box of the world that holds the points of a window.
fn in_world(window: &Region<3>, coordinates: &Coordinates) -> Bounds {
    Bounds { min: coordinates.to_world(window.min), max: coordinates.to_world(window.max) }
}

/// The flags that the plan was made with.
pub(super) fn flags_of(arguments: &[String]) -> Result<Flags> {
    let program = std::iter::once("spfinalize".to_string());
    Flags::try_parse_from(program.chain(arguments.iter().cloned()))
        .map_err(|e| Error::malformed(format!("the arguments of the plan: {e}")))
}

/// Keeps notices for the caller.
struct Watch<'a> {
    notices: &'a mut Vec<String>,
}

impl Observer for Watch<'_> {
    fn notice(&mut self, message: &str) {
        self.notices.push(message.to_string());
    }
}
