//! `spdelaunay3d`: flags.

use clap::Parser;

use super::reduction::{Shared, Tool};
use crate::reduce::Duplicates;
use spmesh_base::system;
use spmesh_shell::{Names, named};

const EXAMPLES: &str = "\
Examples:
  From points of space to a tetrahedral mesh, in bounded memory:
    spfinalize --octree cloud.xyz | spdelaunay3d -o cloud.spm
  Print the counts of the run, and prove the result:
    spfinalize --octree cloud.las | spdelaunay3d --stats -o cloud.spm
    spinfo --audit cloud.spm
  Balls, for example atoms with their radii: the dual of the power diagram:
    spfinalize --octree --radii protor 1abc.cif | spdelaunay3d --weights -o 1abc.spm
  One tile of many, to be finished later or elsewhere:
    spfinalize --octree a.las b.las | spdelaunay3d --partial --region 0,0,-inf,50,50,inf -o tile7.spm
    spdelaunay3d --merge tile*.spm -o whole.spm

Points that fill space need little memory. Points on surfaces do, too, if spfinalize writes them in
regions, as it does of more than a million; otherwise most wait until the end, because the balls
around their tetrahedra reach far.

Exit codes: 0 success, 1 I/O or runtime failure, 2 usage, 3 malformed or truncated input,
5 not enough memory, 6 input of another version of spmesh, 141 output closed by its reader.";

/// Tetrahedralize a stream of points in space (Delaunay), in bounded memory.
///
/// Reads a stream of (finalized) points of three dimensions and writes a tetrahedral mesh stream. The result
/// is exact and canonical: the set of tetrahedra depends neither on the order of the points, nor on cells,
/// tiles or threads.
#[derive(Debug, Parser)]
#[command(name = "spdelaunay3d", version, after_help = EXAMPLES)]
pub struct Flags {
    #[command(flatten)]
    shared: Shared<3>,

    /// Treatment of coinciding points
    #[arg(long, default_value = "first", value_name = "POLICY", value_parser = named(DUPLICATES))]
    duplicates: Duplicates,

    /// Make the regular tetrahedralization, for points that have weights (spfinalize --radii or --weights).
    /// Of coinciding points the heaviest is the vertex
    #[arg(long, conflicts_with_all = ["partial", "merge"])]
    weights: bool,
}

/// What coinciding points may be.
const DUPLICATES: Names<Duplicates> =
    &[("first: They are one vertex", Duplicates::First), ("error: They are an error", Duplicates::Error)];

const TOOL: Tool<3> = Tool {
    name: "spdelaunay3d",
    verb: "tetrahedralizing",
    simplices: "tetrahedra",
    reasons: ["fewer than four different points", "all points in a plane"],
    reduce: |reader, output, options, done| crate::reduce::tetrahedralize(reader, output, options, done),
    merge: |readers, output, options, done| crate::reduce::merge_tetrahedra(readers, output, options, done),
};

/// Runs the tool.
///
/// # Errors
/// As [`crate::reduce::tetrahedralize`] and [`crate::reduce::merge_tetrahedra`], and if an input or the
/// output cannot be opened.
pub fn run(flags: Flags) -> anyhow::Result<()> {
    system::give_back_large_blocks();
    TOOL.run(&flags.shared, flags.duplicates, flags.weights)
}
