//! Makes nodes.

use std::fs;
use std::io::{PipeReader, Write, pipe};
use std::path::Path;
use std::time::Instant;

use super::outputs::{Folder, mesh_name, residual_name};
use super::{Policy, TOOL, WorkFlags, tell};
use crate::flags::spfinalize::leaf::{LeafCounts, Resources, write_leaf};
use crate::plan::{FileSize, Node, NodeKind, NodeReport, Plan, hash_of_file};
use crate::reduce::{
    Duplicates, Options, Outputs, Part, Stats, join_tetrahedra, join_triangles, tetrahedralize_part,
    triangulate_part,
};
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_base::output::{Output, create_folder};
use spmesh_base::system;
use spmesh_shell::open_stream;
use spmesh_shell::{Common, notice, peak_memory};
use spmesh_stream::StreamReader;
use spmesh_stream::model::bounds::Region;

/// Makes nodes of a plan in a folder.
pub(super) struct Maker<'a> {
    pub(super) folder: Folder<'a>,
    work: &'a WorkFlags,
    policy: Policy,
    /// What was asked for that changes the mesh.
    options: String,
    common: &'a Common,
}

/// What a node has read and made.
struct Made {
    outputs: Outputs<Output>,
    stats: Stats,
    counts: LeafCounts,
}

impl<'a> Maker<'a> {
    pub(super) fn new(
        plan: &'a Plan,
        work: &'a WorkFlags,
        policy: Policy,
        common: &'a Common,
    ) -> Result<Self> {
        if plan.dims() == 3 && !matches!(policy, Policy::First | Policy::Error) {
            return Err(Error::usage("points of space have no elevation: --duplicates first or error"));
        }
        create_folder(&work.dir)?;
        let folder = Folder { path: &work.dir, plan };
        let options = format!("duplicates {policy:?}").to_lowercase();
        Ok(Maker { folder, work, policy, options, common })
    }

    /// Makes a node, unless it is complete.
    pub(super) fn run(&self, number: u32, is_forced: bool) -> anyhow::Result<()> {
        let node = self.folder.plan.node(number)?;
        let done = self.folder.complete(node)?;
        if !is_forced && done.is_some_and(|report| report.options == self.options) {
            return Ok(());
        }
        self.make(node)
    }

    /// Makes a node.
    pub(super) fn make(&self, node: &Node) -> anyhow::Result<()> {
        // Without its report, a node counts as incomplete while its files are replaced.
        self.forget(node.number)?;
        if node.kind() == NodeKind::Inner {
            self.complete_children(node)?;
        }
        self.try_to_make(node)
    }

    fn forget(&self, number: u32) -> Result<()> {
        let path = self.folder.report_path(number);
        match fs::remove_file(&path) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
                Err(Error::io("removing an old report", e).of_input(path.display().to_string()))
            }
            _ => Ok(()),
        }
    }

    /// Makes the children whose residuals are not there as they were written, or were made with other options.
    fn complete_children(&self, node: &Node) -> anyhow::Result<()> {
        for &child in &node.children {
            let options = self.folder.report(child)?.map(|report| report.options);
            if !self.folder.has_whole_residual(child)?
                || options.is_some_and(|options| options != self.options)
            {
                let what = "is missing or damaged, or was made differently: making it first";
                self.note(&format!("the residual of node {child} {what}"));
                self.make(self.folder.plan.node(child)?)?;
            }
        }
        Ok(())
    }

    pub(super) fn note(&self, message: &str) {
        notice(TOOL, self.common, message);
    }

    /// Makes a node from what is there.
    fn try_to_make(&self, node: &Node) -> anyhow::Result<()> {
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
        report.peak_memory_bytes = peak_memory();
        report.host = system::host_name();
        let mut output = Output::create(&self.folder.report_path(node.number), false)?;
        output.write_all(report.to_json()?.as_bytes()).map_err(|e| Error::io("writing the report", e))?;
        output.commit()?;
        tell(
            self.common,
            &format!(
                "node {}: {} {}, {:.1} s",
                node.number,
                report.simplices,
                if self.folder.plan.dims() == 2 { "triangles" } else { "tetrahedra" },
                report.seconds
            ),
        );
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
            Vec<StreamReader<Box<dyn std::io::Read + Send>>>,
            Outputs<Output>,
            &Options<D>,
        ) -> Result<(Outputs<Output>, Stats)>,
    ) -> anyhow::Result<Made> {
        let (min, max) = (node.region.region().min, node.region.region().max);
        let options = Options::<D> {
            duplicates: if D == 2 { self.policy.duplicates() } else { self.duplicates_in_space() },
            threads: self.work.threads().get(),
            part: Some(Part::Stored(Region::between(min, max))),
            name: Some(self.folder.plan.part(node)),
            compress: self.work.compress,
            ..Options::default()
        };
        let outputs = self.outputs(node)?;
        match node.kind() {
            NodeKind::Inner => {
                let children = node.children.iter().map(|&child| open_stream(&self.folder.residual(child)));
                let (outputs, stats) = join(children.collect::<Result<Vec<_>>>()?, outputs, &options)?;
                Ok(Made { outputs, stats, counts: LeafCounts::default() })
            }
            NodeKind::Leaf => self.leaf(node, |reader| reduce(reader, outputs, &options)),
        }
    }

    fn duplicates_in_space(&self) -> Duplicates {
        if self.policy == Policy::Error { Duplicates::Error } else { Duplicates::First }
    }

    fn outputs(&self, node: &Node) -> Result<Outputs<Output>> {
        let mesh = Output::create(&self.folder.mesh(node.number), true)?;
        let residual = (!node.is_root()).then(|| Output::create(&self.folder.residual(node.number), true));
        Ok(Outputs { mesh, residual: residual.transpose()? })
    }

    /// Finalizes the points of a leaf on one thread, and triangulates them on others, with a pipe between them as
    /// between two programs.
    fn leaf(
        &self,
        node: &Node,
        reduce: impl FnOnce(StreamReader<PipeReader>) -> Result<(Outputs<Output>, Stats)>,
    ) -> anyhow::Result<Made> {
        let (reader, writer) = pipe().map_err(|e| Error::io("making a pipe", e))?;
        system::widen_pipe(&writer);
        let resources = Resources {
            memory: self.work.memory,
            threads: self.work.threads().get(),
            temp_dir: self.work.temp_dir.clone(),
        };
        let plan = self.folder.plan;
        let (finalized, reduced) = std::thread::scope(|scope| {
            let finalizer = scope.spawn(move || write_leaf(plan, node, &resources, writer));
            let name = format!("points of node {}", node.number);
            let reduced = StreamReader::new(reader, name).and_then(reduce);
            (finalizer.join(), reduced)
        });
        let finalized = finalized.map_err(|_| Error::new(ErrorKind::Io, "a thread ended unexpectedly"))?;
        let counts = match (finalized, &reduced) {
            // The points ended early for a reason of their own.
            (Err(error), _) if !is_closed_pipe(&error) => return Err(error),
            (Err(error), Ok(_)) => return Err(error),
            (Err(_), Err(_)) => LeafCounts::default(),
            (Ok(counts), _) => counts,
        };
        let (outputs, stats) = reduced?;
        counts.notices.iter().for_each(|message| self.note(message));
        Ok(Made { outputs, stats, counts })
    }

    /// Gives the outputs their names.
    fn commit(&self, node: &Node, made: Made) -> Result<NodeReport> {
        let Made { outputs, stats, counts } = made;
        let is_leaf = node.kind() == NodeKind::Leaf;
        let mut report = NodeReport::new(self.folder.plan.id(), node.number, node.stage, node.kind_name());
        report.options.clone_from(&self.options);
        let size = |file: String, output: &Output| FileSize {
            file,
            bytes: output.bytes_written(),
            hash: String::new(),
        };
        report.mesh = size(mesh_name(node.number), &outputs.mesh);
        report.residual =
            outputs.residual.as_ref().map(|residual| size(residual_name(node.number), residual));
        outputs.mesh.commit()?;
        outputs.residual.map_or(Ok(()), Output::commit)?;
        if let Some(residual) = &mut report.residual {
            residual.hash = hash_of_file(&self.folder.residual(node.number))?;
        }
        report.joined = self.folder.residual_hashes(node)?;
        report.residual_points = stats.residual;
        report.simplices = stats.simplices;
        report.vertices = stats.vertices - stats.shared;
        report.read_bytes = stats.input_bytes;
        if is_leaf {
            (report.points, report.merged) = (stats.points, stats.merged);
            report.files = counts.files;
            report.dropped = counts.dropped;
            report.bounds = bounds_of(&self.folder.mesh(node.number))?;
        }
        Ok(report)
    }
}

/// The bounding box in the header of a stream.
fn bounds_of(path: &Path) -> Result<Option<[[f64; 3]; 2]>> {
    let bounds = open_stream(path)?.header().bounds;
    Ok(bounds.map(|bounds| [bounds.min, bounds.max]))
}

fn is_closed_pipe(error: &anyhow::Error) -> bool {
    error.downcast_ref::<Error>().is_some_and(|error| error.kind() == ErrorKind::ClosedPipe)
}
