//! Delaunay configurations of any degree, and their generalisation.

fn main() -> std::process::ExitCode {
    spmesh_cli::main(spmesh_cli::configgen::run)
}
