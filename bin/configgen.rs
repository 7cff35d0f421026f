//! Delaunay configurations of any degree, and their generalisation.

#[global_allocator]
static ALLOCATOR: spmesh_shell::Allocator = spmesh_shell::Allocator;

fn main() -> std::process::ExitCode {
    spmesh_shell::main(spmesh_splines::flags::configgen::run)
}
