//! `spnode`: the jobs of a plan.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::{Args, Parser, Subcommand};

use super::roots::RootFlags;
use super::spfinalize;
use crate::plan::{Again, Maker, Node, Plan, Work, batches, collect, expected, incomplete, remove, spent};
use spmesh_base::error::{Error, Result, counted};
use spmesh_base::output::Output;
use spmesh_shell::resources::{TempDirFlag, ThreadsFlag};
use spmesh_shell::{Common, advise_on_memory, endings, notice, parse_size};

const TOOL: &str = "spnode";

const EXAMPLES: &str = "\
Examples:
  Plan from the headers of tiles, make all nodes one after the other, and collect them into one mesh:
      spfinalize --plan plan.json --keep-class 2 tiles/*.laz
      spnode list plan.json | cut -f 1 | xargs spnode run plan.json -d parts
      spnode collect plan.json -d parts -o ground.json
      spdem --step 1 ground.json -o terrain.tif
  The leaves as one job array of Slurm, and later the nodes of the next stage:
      sbatch --array=0-999 --wrap 'spnode run plan.json $SLURM_ARRAY_TASK_ID -d parts'
  After some tiles have changed: what does not depend on them is not made again:
      spfinalize --plan plan.json --keep-class 2 tiles/*.laz
      spnode list plan.json -d parts --missing | cut -f 1 | xargs -r spnode run plan.json -d parts
      spnode collect plan.json -d parts -o ground.json && spnode clean plan.json -d parts
  The parts as one stream without parts:
      spconvert ground.json -o ground.spm

Exit codes: 0 success, 1 I/O failure, 2 usage, or files that changed since the plan was made, 3 malformed input, or \
points that are not accounted for, 5 not enough memory, 6 input of another version of spmesh.";

/// Make one part of a mesh that many jobs make, on one machine or on a cluster
///
/// spfinalize --plan divides the box of all points into leaves. A leaf triangulates its points; a node above
/// it joins what its children left. Each node writes three files into the folder, under its name, a hash of
/// all that it depends on: its part of the mesh (NAME.spm, a stream that other programs read), what it leaves
/// to the node above (NAME.rest.spm), and at last its report (NAME.json). A node that is complete is not made
/// again, also by another plan that has it. Jobs need nothing but the plan, the points and the folder, and
/// run in any order in which children come before their parents: scripts/cluster has them for Snakemake,
/// Slurm and GNU parallel.
#[derive(Debug, Parser)]
#[command(name = TOOL, version, after_help = EXAMPLES)]
pub struct Flags {
    #[command(subcommand)]
    action: Action,

    #[command(flatten)]
    common: Common,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// List the nodes: number, stage, kind, children, expected points and name, separated by tabs
    List(ListFlags),
    /// Make nodes, unless they are complete
    Run(RunFlags),
    /// Check that all nodes are complete and account for every point, and write the manifest of the mesh
    Collect(CollectFlags),
    /// Remove the parts of earlier plans from the folder, and say which
    Clean(CleanFlags),
}

#[derive(Debug, Args)]
struct ListFlags {
    /// The plan of spfinalize --plan
    #[arg(value_name = "PLAN")]
    plan: PathBuf,

    /// Only the nodes of this stage: 0 for leaves
    #[arg(long, value_name = "S")]
    stage: Option<u32>,

    /// Print the first and the last node of each stage instead: stage, first, last
    #[arg(long, conflicts_with_all = ["stage", "missing", "batch_points"])]
    stages: bool,

    /// Only nodes that are not complete in the folder of -d
    #[arg(long, requires = "dir")]
    missing: bool,

    /// Print batches of nodes of one stage instead: a line of numbers for each, which have up to so many
    /// expected points together, inner nodes those that their children leave. 0: one node a batch
    #[arg(long, value_name = "N")]
    batch_points: Option<u64>,

    /// Folder for the parts
    #[arg(short = 'd', long, value_name = "FOLDER", requires = "missing")]
    dir: Option<PathBuf>,

    #[command(flatten)]
    roots: RootFlags,
}

#[derive(Debug, Args)]
struct RunFlags {
    /// The plan of spfinalize --plan
    #[arg(value_name = "PLAN")]
    plan: PathBuf,

    /// Numbers of nodes, which are made one after the other
    #[arg(value_name = "NODE", required = true)]
    nodes: Vec<u32>,

    /// Make nodes again that are complete
    #[arg(long)]
    force: bool,

    /// Read the parts of nodes that are complete, and make those again whose checksums are wrong
    #[arg(long, conflicts_with = "force")]
    verify: bool,

    #[command(flatten)]
    work: WorkFlags,
}

#[derive(Debug, Args)]
struct CollectFlags {
    /// The plan of spfinalize --plan
    #[arg(value_name = "PLAN")]
    plan: PathBuf,

    /// File for the manifest, which stands for the mesh wherever a stream of it is read
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// Read all parts, and make those again whose checksums are wrong
    #[arg(long)]
    verify: bool,

    #[command(flatten)]
    work: WorkFlags,
}

#[derive(Debug, Args)]
struct CleanFlags {
    /// The plan of spfinalize --plan whose parts stay
    #[arg(value_name = "PLAN")]
    plan: PathBuf,

    /// Folder for the parts
    #[arg(short = 'd', long, value_name = "FOLDER")]
    dir: PathBuf,

    /// Only print the names of the files
    #[arg(long)]
    dry_run: bool,

    #[command(flatten)]
    roots: RootFlags,
}

/// How nodes are made.
#[derive(Debug, Args)]
struct WorkFlags {
    /// Folder for the parts; it is made if it does not exist
    #[arg(short = 'd', long, value_name = "FOLDER")]
    dir: PathBuf,

    #[command(flatten)]
    threads: ThreadsFlag,

    /// Memory for points of a leaf that wait; others wait in a temporary file
    #[arg(long, value_name = "SIZE", default_value = "512M", value_parser = parse_size)]
    memory: u64,

    #[command(flatten)]
    temp_dir: TempDirFlag,

    /// Compress parts and residuals
    #[arg(long)]
    compress: bool,

    #[command(flatten)]
    roots: RootFlags,
}

impl WorkFlags {
    fn work(&self) -> Work {
        let &WorkFlags { memory, compress, .. } = self;
        let (folder, threads, temp_dir) = (self.dir.clone(), self.threads.get(), self.temp_dir.to_owned());
        Work { folder, threads, memory, temp_dir, compress }
    }
}

/// Runs the tool.
///
/// # Errors
/// Everything that reading points, triangulating and writing fail with.
pub fn run(flags: Flags) -> anyhow::Result<()> {
    advise_on_memory(TOOL, "take fewer --threads, or plan with fewer --leaf-points");
    let recipe = |plan: &Plan| spfinalize::flags_of(&plan.arguments)?.recipe();
    let note = |message: &str| notice(TOOL, &flags.common, message);
    match &flags.action {
        Action::List(action) => list(action)?,
        Action::Run(action) => {
            let plan = read(&action.plan, &action.work.roots)?;
            let work = action.work.work();
            let maker = Maker::new(&plan, &work, &recipe, &note)?;
            action.nodes.iter().try_for_each(|&number| plan.node(number).map(|_| ()))?;
            let again = match (action.force, action.verify) {
                (true, _) => Again::All,
                (_, true) => Again::Damaged,
                _ => Again::Incomplete,
            };
            action.nodes.iter().try_for_each(|&number| maker.run(number, again))?;
        }
        Action::Collect(CollectFlags { plan, output, verify, work }) => {
            endings::check(output, &[endings::JSON])?;
            let loaded = read(plan, &work.roots)?;
            collect(&loaded, &work.work(), output, *verify, &recipe, &note)?;
        }
        Action::Clean(action) => clean(action, &note)?,
    }
    Ok(())
}

/// Reads a plan whose files are where `roots` says.
fn read(path: &Path, roots: &RootFlags) -> Result<Plan> {
    let mut plan = Plan::read(path)?;
    plan.move_roots(roots.roots()?)?;
    Ok(plan)
}

fn list(flags: &ListFlags) -> Result<()> {
    let plan = read(&flags.plan, &flags.roots)?;
    if flags.stages {
        let lines =
            (0..).zip(&plan.stages).map(|(stage, [first, last])| format!("{stage}\t{first}\t{last}\n"));
        return print(&lines.collect::<String>());
    }
    let mut nodes: Vec<&Node> = match flags.dir.as_ref().filter(|_| flags.missing) {
        Some(folder) => incomplete(&plan, folder)?,
        None => plan.nodes.iter().collect(),
    };
    nodes.retain(|node| flags.stage.is_none_or(|stage| stage == node.stage));
    match flags.batch_points {
        Some(points) => {
            let batches = batches(&plan, &nodes, points);
            print(&batches.iter().map(|batch| batch_line(batch)).collect::<String>())
        }
        None => print(&nodes.iter().map(|node| line_of(&plan, node)).collect::<String>()),
    }
}

fn line_of(plan: &Plan, node: &Node) -> String {
    let Node { number, stage, ref children, ref name, .. } = *node;
    let children: Vec<String> = children.iter().map(u32::to_string).collect();
    let children = if children.is_empty() { "-".to_string() } else { children.join(",") };
    format!("{number}\t{stage}\t{}\t{children}\t{}\t{name}\n", node.kind_name(), expected(plan, node))
}

fn batch_line(batch: &[&Node]) -> String {
    let numbers: Vec<String> = batch.iter().map(|node| node.number.to_string()).collect();
    format!("{}\n", numbers.join(" "))
}

fn clean(flags: &CleanFlags, note: &dyn Fn(&str)) -> Result<()> {
    let plan = read(&flags.plan, &flags.roots)?;
    let files = spent(&plan, &flags.dir)?;
    print(&files.iter().map(|file| format!("{}\n", file.path.display())).collect::<String>())?;
    let bytes: u64 = files.iter().map(|file| file.bytes).sum();
    let what = format!("{} of earlier plans, {bytes} bytes", counted(files.len() as u64, "file", "files"));
    if flags.dry_run {
        note(&format!("{what}: not removed"));
        return Ok(());
    }
    remove(&files)?;
    note(&format!("{what}: removed"));
    Ok(())
}

fn print(text: &str) -> Result<()> {
    let mut output = Output::create(Path::new("-"), false)?;
    output.write_all(text.as_bytes()).map_err(|e| Error::io("writing", e))?;
    output.commit()
}
