//! Exact Delaunay diagrams in four dimensions.

fn main() -> std::process::ExitCode {
    spmesh_cli::main(spmesh_cli::dd4::run)
}
