//! Makes nodes.

use std::fs::{self, File};
use std::io::{PipeReader, Write, pipe};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::folder::{Folder, PART, RESIDUAL, file_name, open_stream};
use super::leaf::{LeafCounts, write_leaf};
use super::{FileSize, Node, NodeKind, NodeReport, Plan, hash_of_file};
use crate::finalize::Recipe;
use crate::reduce::{
    Options, Outputs, Part, Stats, join_tetrahedra, join_triangles, tetrahedralize_part, triangulate_part,
};
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_base::inputs;
use spmesh_base::output::{Output, create_folder, remove_earlier};
use spmesh_base::system;
use spmesh_base::temporary::remove_orphans;
use spmesh_formats::source::Plain;
use spmesh_stream::StreamReader;
use spmesh_stream::model::bounds::Region;

/// How nodes are made.
#[derive(Debug, Clone)]
pub struct Work {
    /// Folder for the parts.
    pub folder: PathBuf,
    /// Threads of a node.
    pub threads: NonZeroUsize,
    /// Memory for points of a leaf that wait. Units: bytes.
    pub memory: u64,
    /// Folder for temporary files; that of the system if `None`.
    pub temp_dir: Option<PathBuf>,
    /// Whether parts and residuals are compressed.
    pub compress: bool,
}

/// Which nodes are made again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Again {
    /// Those that are not complete.
    Incomplete,
    /// Those, too, whose parts are damaged: all parts are read.
    Damaged,
    /// All.
    All,
}

/// Makes nodes of a plan in a folder.
pub struct Maker<'a> {
    pub(super) folder: Folder<'a>,
    work: &'a Work,
    recipe: &'a dyn Fn(&Plan) -> Result<Recipe>,
    pub(super) note: &'a dyn Fn(&str),
}

/// What a node has read and made.
struct Made {
    outputs: Outputs<Output>,
    stats: Stats,
    counts: LeafCounts,
}

impl<'a> Maker<'a> {
    /// A maker of nodes, which makes the folder. `recipe` says how points were to be finalized when the plan
    /// was made, and `note` takes messages for the user.
    ///
    /// # Errors
    /// I/O, if the folder cannot be made.
    pub fn new(
        plan: &'a Plan,
        work: &'a Work,
        recipe: &'a dyn Fn(&Plan) -> Result<Recipe>,
        note: &'a dyn Fn(&str),
    ) -> Result<Self> {
        create_folder(&work.folder)?;
        let folder = Folder { path: &work.folder, plan };
        Ok(Maker { folder, work, recipe, note })
    }

    /// Makes a node, and what it needs, if it is to be made `again` or is not complete.
    ///
    /// # Errors
    /// Those of reading points, triangulating and writing; usage, if files have changed since the plan was
    /// made.
    pub fn run(&self, number: u32, again: Again) -> Result<()> {
        let node = self.folder.plan.node(number)?;
        if again != Again::All && self.folder.complete(node)?.is_some() {
            let damage = if again == Again::Damaged { self.folder.damage_of(node)? } else { None };
            let Some(damage) = damage else { return Ok(()) };
            (self.note)(&format!("{damage}: making node {number} again"));
        }
        self.make(node)
    }

    /// Makes a node.
    fn make(&self, node: &Node) -> Result<()> {
        let home = self.folder.home(node);
        create_folder(&home)?;
        remove_orphans(&home);
        self.check_outputs(node)?;
        // Without its report, a node counts as incomplete while its files are replaced.
        remove_earlier(&self.folder.report_path(node), "the report")?;
        if node.kind() == NodeKind::Inner {
            self.complete_children(node)?;
        }
        self.try_to_make(node)
    }

    /// Refuses to replace files of the plan. There may be a million of them: they are looked at if there is a
    /// file under a name of this node that is not its own.
    fn check_outputs(&self, node: &Node) -> Result<()> {
        let folder = &self.folder;
        let outputs = [folder.mesh(node), folder.residual(node), folder.report_path(node)];
        if outputs.iter().any(|path| path.exists()) && !matches!(folder.report(node), Ok(Some(_))) {
            folder.plan.note_files()?;
        }
        outputs.iter().try_for_each(|path| {
            // Opening a pipe would wait, and a link would be written through.
            if fs::symlink_metadata(path).is_ok_and(|found| !found.is_file()) {
                let message = "this is the name of a file of a node, but it is no regular file: remove it";
                return Err(Error::usage(message).of_input(path.display().to_string()));
            }
            inputs::check_output(path)
        })
    }

    /// Makes the children whose residuals are not there as they were written.
    fn complete_children(&self, node: &Node) -> Result<()> {
        for &child in &node.children {
            let child = self.folder.plan.node(child)?;
            if !self.folder.has_whole_residual(child)? {
                let number = child.number;
                (self.note)(&format!("the residual of node {number} is missing or damaged: making it first"));
                self.make(child)?;
            }
        }
        Ok(())
    }

    /// Makes a node from what is there.
    fn try_to_make(&self, node: &Node) -> Result<()> {
        let (started, cpu) = (Instant::now(), system::cpu_seconds());
        system::reset_peak_memory();
        let made = match self.folder.plan.dims() {
            2 => self.solve::<2>(
                node,
                |reader, outputs, options| triangulate_part(reader, outputs, options, |_| ()),
                join_triangles,
            )?,
            _ => self.solve::<3>(
                node,
                |reader, outputs, options| tetrahedralize_part(reader, outputs, options, |_| ()),
                join_tetrahedra,
            )?,
        };
        let mut report = self.commit(node, made)?;
        report.seconds = started.elapsed().as_secs_f64();
        report.cpu_seconds = system::cpu_seconds() - cpu;
        report.peak_memory_bytes = system::peak_memory();
        report.host = system::host_name();
        let mut output = Output::create(&self.folder.report_path(node), false)?;
        output.write_all(report.to_json()?.as_bytes()).map_err(|e| Error::io("writing the report", e))?;
        output.commit()?;
        let what = if self.folder.plan.dims() == 2 { "triangles" } else { "tetrahedra" };
        let (number, simplices, seconds) = (node.number, report.simplices, report.seconds);
        (self.note)(&format!("node {number}: {simplices} {what}, {seconds:.1} s"));
        Ok(())
    }

    fn solve<const D: usize>(
        &self,
        node: &Node,
        reduce: impl FnOnce(
            StreamReader<PipeReader>,
            Outputs<Output>,
            &Options<D>,
        ) -> Result<(Outputs<Output>, Stats)>,
        join: impl FnOnce(
            Vec<StreamReader<Plain<File>>>,
            Outputs<Output>,
            &Options<D>,
        ) -> Result<(Outputs<Output>, Stats)>,
    ) -> Result<Made> {
        let (min, max) = (node.region.region().min, node.region.region().max);
        let options = Options::<D> {
            duplicates: self.folder.plan.duplicates,
            threads: self.work.threads.get(),
            part: Some(Part::Stored(Region::between(min, max))),
            name: Some(self.folder.plan.part(node)),
            compress: self.work.compress,
            ..Options::default()
        };
        let outputs = self.outputs(node)?;
        match node.kind() {
            NodeKind::Inner => {
                let (outputs, stats) = join(self.residuals(node)?, outputs, &options)?;
                Ok(Made { outputs, stats, counts: LeafCounts::default() })
            }
            NodeKind::Leaf => self.leaf(node, |reader| reduce(reader, outputs, &options)),
        }
    }

    /// The residuals that a node joins.
    fn residuals(&self, node: &Node) -> Result<Vec<StreamReader<Plain<File>>>> {
        let open = |&child: &u32| {
            let child = self.folder.plan.node(child)?;
            let reader = open_stream(&self.folder.residual(child))?;
            if reader.header().part != Some(self.folder.plan.part(child)) {
                let message = format!("this is not the residual of node {}", child.number);
                return Err(Error::malformed(message).of_input(reader.name()));
            }
            Ok(reader)
        };
        node.children.iter().map(open).collect()
    }

    fn outputs(&self, node: &Node) -> Result<Outputs<Output>> {
        let mesh = Output::create(&self.folder.mesh(node), true)?;
        let residual = (!node.is_root()).then(|| Output::create(&self.folder.residual(node), true));
        Ok(Outputs { mesh, residual: residual.transpose()? })
    }

    /// Finalizes the points of a leaf on one thread, and triangulates them on others, with a pipe between
    /// them as between two programs.
    fn leaf(
        &self,
        node: &Node,
        reduce: impl FnOnce(StreamReader<PipeReader>) -> Result<(Outputs<Output>, Stats)>,
    ) -> Result<Made> {
        let (reader, writer) = pipe().map_err(|e| Error::io("making a pipe", e))?;
        system::widen_pipe(&writer);
        let (plan, work, recipe) = (self.folder.plan, self.work, (self.recipe)(self.folder.plan)?);
        let (finalized, reduced) = std::thread::scope(|scope| {
            let finalizer = scope.spawn(move || write_leaf(plan, node, recipe, work, writer));
            let name = format!("points of node {}", node.number);
            let reduced = StreamReader::new(reader, name).and_then(reduce);
            (finalizer.join(), reduced)
        });
        let finalized = finalized.map_err(|_| Error::new(ErrorKind::Io, "a thread ended unexpectedly"))?;
        let counts = match (finalized, &reduced) {
            // The points ended early for a reason of their own.
            (Err(error), _) if error.kind() != ErrorKind::ClosedPipe => return Err(with_remedy(error)),
            (Err(error), Ok(_)) => return Err(error),
            (Err(_), Err(_)) => LeafCounts::default(),
            (Ok(counts), _) => counts,
        };
        let (outputs, stats) = reduced?;
        counts.notices.iter().for_each(|message| (self.note)(message));
        Ok(Made { outputs, stats, counts })
    }

    /// Gives the outputs their names.
    fn commit(&self, node: &Node, made: Made) -> Result<NodeReport> {
        let Made { outputs, stats, counts } = made;
        let is_leaf = node.kind() == NodeKind::Leaf;
        let mut report = NodeReport::new(node);
        let size = |file: String, output: &Output| FileSize {
            file,
            bytes: output.bytes_written(),
            hash: String::new(),
        };
        report.mesh = size(file_name(node, PART), &outputs.mesh);
        report.residual = outputs.residual.as_ref().map(|residual| size(file_name(node, RESIDUAL), residual));
        outputs.mesh.commit()?;
        outputs.residual.map_or(Ok(()), Output::commit)?;
        if let Some(residual) = &mut report.residual {
            residual.hash = hash_of_file(&self.folder.residual(node))?;
        }
        report.joined = self.folder.residual_hashes(node)?;
        report.residual_points = stats.residual;
        report.simplices = stats.simplices;
        report.vertices = stats.vertices - stats.shared;
        report.read_bytes = stats.input_bytes;
        report.bounds = bounds_of(&self.folder.mesh(node))?;
        if is_leaf {
            (report.points, report.merged) = (stats.points, stats.merged);
            report.files = counts.files;
            (report.added, report.dropped) = (counts.added, counts.dropped);
        }
        Ok(report)
    }
}

/// Says how to go on without a damaged file of points.
fn with_remedy(error: Error) -> Error {
    let remedy = "to go on without this file, add its path to the list of --skip-bad, and plan again";
    if error.kind() == ErrorKind::Malformed { error.noting(remedy) } else { error }
}

/// The bounding box in the header of a stream.
fn bounds_of(path: &Path) -> Result<Option<[[f64; 3]; 2]>> {
    let bounds = open_stream(path)?.header().bounds;
    Ok(bounds.map(|bounds| [bounds.min, bounds.max]))
}
