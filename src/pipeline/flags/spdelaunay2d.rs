//! `spdelaunay2d`: flags.

use clap::Parser;

use super::reduction::{Shared, Tool};
use crate::reduce::Duplicates;
use spmesh_base::system;

const EXAMPLES: &str = "\
Examples:
  From LAZ files to a triangle mesh, in bounded memory:
    spfinalize a.laz b.laz | spdelaunay2d -o terrain.spm
  Keep the lowest of coinciding points, and print the counts of the run:
    spfinalize --keep-class 2 a.laz | spdelaunay2d --duplicates lowest --stats -o ground.spm
  One tile of many, to be finished later or elsewhere:
    spfinalize a.laz b.laz | spdelaunay2d --partial --region 1000,2000,2000,3000 -o tile7.spm
    spdelaunay2d --merge tile*.spm -o whole.spm

Exit codes: 0 success, 1 I/O or runtime failure, 2 usage, 3 malformed or truncated input,
5 not enough memory, 6 input of another version of spmesh, 141 output closed by its reader.";

/// Triangulate a stream of points in the plane (Delaunay), in bounded memory.
///
/// Reads a stream of (finalized) points and writes a triangle mesh stream. The result is exact and canonical:
/// it depends neither on the order of the points, nor on cells, tiles or threads.
#[derive(Debug, Parser)]
#[command(name = "spdelaunay2d", version, after_help = EXAMPLES)]
pub struct Flags {
    #[command(flatten)]
    shared: Shared<2>,

    /// Elevation of a vertex where points coincide in x and y
    #[arg(long, value_enum, default_value_t = Duplicates::First, value_name = "POLICY")]
    duplicates: Duplicates,
}

const TOOL: Tool<2> = Tool {
    name: "spdelaunay2d",
    verb: "triangulating",
    simplices: "triangles",
    reasons: ["fewer than three different points", "all points on a line"],
    reduce: |reader, output, options, done| crate::reduce::triangulate(reader, output, options, done),
    merge: |readers, output, options, done| crate::reduce::merge_triangles(readers, output, options, done),
};

/// Runs the tool.
///
/// # Errors
/// As [`crate::reduce::triangulate`] and [`crate::reduce::merge_triangles`], and if an input or the output
/// cannot be opened.
pub fn run(flags: Flags) -> anyhow::Result<()> {
    system::give_back_large_blocks();
    system::share_heap();
    TOOL.run(&flags.shared, flags.duplicates, false)
}
