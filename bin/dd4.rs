//! Exact Delaunay diagrams in four dimensions.

fn main() -> std::process::ExitCode {
    spmesh::cli::main(spmesh::cli::dd4::run)
}
