//! `spnode`: the jobs of a plan.

use std::io::Write;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use clap::{Args, Parser, Subcommand};

use super::spfinalize;
use crate::plan::{Maker, Node, Plan, Work, collect};
use crate::reduce::Duplicates;
use spmesh_base::error::{Error, Result};
use spmesh_base::output::Output;
use spmesh_shell::{Common, advise_on_memory, endings, notice, parse_size, parse_threads, threads};

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
  The raster of one part, in the job that made it:
      spnode run plan.json 17 -d parts && spdem --step 1 parts/000017.spm -o dem/000017.tif
  The parts as one stream without parts:
      spconvert ground.json -o ground.spm

Exit codes: 0 success, 1 I/O failure, 2 usage, or files that changed since the plan was made, 3 malformed input, or \
points that are not accounted for, 5 not enough memory, 6 input of another version of spmesh.";

/// Make one part of a mesh that many jobs make, on one machine or on a cluster
///
/// spfinalize --plan divides the box of all points into leaves. A leaf triangulates its points; a node above it joins
/// what its children left. Each node writes three files into the folder: its part of the mesh (000017.spm, a stream
/// that other programs read), what it leaves to the node above (000017.rest.spm), and at last its report
/// (000017.json). A node that is complete is not made again. Jobs need nothing but the plan, the points and the
/// folder, and run in any order in which children come before their parents: scripts/cluster has them for Snakemake,
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
    /// List the nodes: number, stage, kind, children, expected points, separated by tabs
    List(ListFlags),
    /// Make nodes, unless they are complete
    Run(RunFlags),
    /// Check that all nodes are complete and account for every point, and write the manifest of the mesh
    Collect(CollectFlags),
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
    #[arg(long, conflicts_with = "stage")]
    stages: bool,
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

    /// Elevation of a vertex where points coincide in x and y; the same for all nodes
    #[arg(long, value_enum, default_value_t = Duplicates::First, value_name = "POLICY")]
    duplicates: Duplicates,

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

/// How nodes are made.
#[derive(Debug, Args)]
struct WorkFlags {
    /// Folder for the parts; it is made if it does not exist
    #[arg(short = 'd', long, value_name = "FOLDER")]
    dir: PathBuf,

    /// Threads of a node [default: one per core, at most 8]
    #[arg(long, value_name = "N", value_parser = parse_threads())]
    threads: Option<NonZeroUsize>,

    /// Memory for points of a leaf that wait; others wait in a temporary file
    #[arg(long, value_name = "SIZE", default_value = "512M", value_parser = parse_size)]
    memory: u64,

    /// Folder for temporary files [default: the system's]
    #[arg(long, value_name = "FOLDER")]
    temp_dir: Option<PathBuf>,

    /// Compress parts and residuals
    #[arg(long)]
    compress: bool,
}

impl WorkFlags {
    fn work(&self, duplicates: Duplicates) -> Work {
        let &WorkFlags { ref dir, threads: asked, memory, ref temp_dir, compress } = self;
        let (folder, threads, temp_dir) = (dir.clone(), threads(asked), temp_dir.clone());
        Work { folder, duplicates, threads, memory, temp_dir, compress }
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
            let plan = Plan::read(&action.plan)?;
            let work = action.work.work(action.duplicates);
            let maker = Maker::new(&plan, &work, &recipe, &note)?;
            action.nodes.iter().try_for_each(|&number| plan.node(number).map(|_| ()))?;
            action.nodes.iter().try_for_each(|&number| maker.run(number, action.force))?;
        }
        Action::Collect(CollectFlags { plan, output, verify, work }) => {
            endings::check(output, &[endings::JSON])?;
            let work = work.work(Duplicates::default());
            let loaded = Plan::read(plan)?;
            collect(&loaded, &work, output, *verify, &recipe, &note)?;
        }
    }
    Ok(())
}

fn list(flags: &ListFlags) -> Result<()> {
    let plan = Plan::read(&flags.plan)?;
    if flags.stages {
        let lines =
            (0..).zip(&plan.stages).map(|(stage, [first, last])| format!("{stage}\t{first}\t{last}\n"));
        return print(&lines.collect::<String>());
    }
    let nodes = plan.nodes.iter().filter(|node| flags.stage.is_none_or(|stage| stage == node.stage));
    print(&nodes.map(line_of).collect::<String>())
}

fn line_of(node: &Node) -> String {
    let children: Vec<String> = node.children.iter().map(u32::to_string).collect();
    let children = if children.is_empty() { "-".to_string() } else { children.join(",") };
    format!("{}\t{}\t{}\t{children}\t{}\n", node.number, node.stage, node.kind_name(), node.points)
}

fn print(text: &str) -> Result<()> {
    let mut output = Output::create(Path::new("-"), false)?;
    output.write_all(text.as_bytes()).map_err(|e| Error::io("writing", e))?;
    output.commit()
}
