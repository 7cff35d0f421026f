//! Streaming Delaunay tetrahedralization in space.

fn main() -> std::process::ExitCode {
    spmesh_cli::main(spmesh_cli::spdelaunay3d::run)
}
