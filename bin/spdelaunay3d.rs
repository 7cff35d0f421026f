//! Streaming Delaunay tetrahedralization in space.

fn main() -> std::process::ExitCode {
    spmesh::cli::main(spmesh::cli::spdelaunay3d::run)
}
