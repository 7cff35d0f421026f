//! Converts streams of points and meshes to and from other formats.

use std::process::ExitCode;

fn main() -> ExitCode {
    spmesh_cli::main(spmesh_cli::spconvert::run)
}
