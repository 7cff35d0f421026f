//! Converts streams of points and meshes to and from other formats.

use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: spmesh_cli::Allocator = spmesh_cli::Allocator;

fn main() -> ExitCode {
    spmesh_cli::main(spmesh_cli::spconvert::run)
}
