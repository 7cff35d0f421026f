//! `spfinalize`: points in, finalized point stream out.

use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: spmesh_cli::Allocator = spmesh_cli::Allocator;

fn main() -> ExitCode {
    spmesh_cli::main(spmesh_cli::spfinalize::run)
}
