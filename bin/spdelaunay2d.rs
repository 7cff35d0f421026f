//! Streaming Delaunay triangulation in the plane.

fn main() -> std::process::ExitCode {
    spmesh::cli::main(spmesh::cli::spdelaunay2d::run)
}
