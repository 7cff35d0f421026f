//! `spfinalize`: points in, finalized point stream out.

use std::process::ExitCode;

fn main() -> ExitCode {
    spmesh_cli::main(spmesh_cli::spfinalize::run)
}
