//! `spfinalize`: points in, finalized point stream out.

use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: spmesh_shell::Allocator = spmesh_shell::Allocator;

fn main() -> ExitCode {
    spmesh_shell::main(spmesh_pipeline::flags::spfinalize::run)
}
