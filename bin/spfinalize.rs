//! `spfinalize`: points in, finalized point stream out.

use std::process::ExitCode;

fn main() -> ExitCode {
    spmesh::cli::main(spmesh::cli::spfinalize::run)
}
