//! One node of a mesh that many jobs make.

#[global_allocator]
static ALLOCATOR: spmesh_cli::Allocator = spmesh_cli::Allocator;

fn main() -> std::process::ExitCode {
    spmesh_cli::main(spmesh_cli::spnode::run)
}
