//! One node of a mesh that many jobs make.

#[global_allocator]
static ALLOCATOR: spmesh_shell::Allocator = spmesh_shell::Allocator;

fn main() -> std::process::ExitCode {
    spmesh_shell::main(spmesh_pipeline::flags::spnode::run)
}
