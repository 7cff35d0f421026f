//! Delaunay configurations of any degree, and their generalisation.

fn main() -> std::process::ExitCode {
    spmesh::cli::main(spmesh::cli::configgen::run)
}
