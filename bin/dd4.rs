//! Exact Delaunay diagrams in four dimensions.

#[global_allocator]
static ALLOCATOR: spmesh_shell::Allocator = spmesh_shell::Allocator;

fn main() -> std::process::ExitCode {
    spmesh_shell::main(spmesh_spacetime::flags::dd4::run)
}
