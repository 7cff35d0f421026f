//! Converts streams of points and meshes to and from other formats.

use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: spmesh_shell::Allocator = spmesh_shell::Allocator;

fn main() -> ExitCode {
    spmesh_shell::main(spmesh_convert::flags::spconvert::run)
}
