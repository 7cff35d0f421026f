//! Streaming Delaunay triangulation in the plane.

fn main() -> std::process::ExitCode {
    spmesh_cli::main(spmesh_cli::spdelaunay2d::run)
}
