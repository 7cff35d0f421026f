//! Rasters of triangle meshes.

fn main() -> std::process::ExitCode {
    spmesh::cli::main(spmesh::cli::spdem::run)
}
