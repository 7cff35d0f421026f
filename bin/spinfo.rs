//! Says what a stream holds, and proves that it keeps its promises.

#[global_allocator]
static ALLOCATOR: spmesh_shell::Allocator = spmesh_shell::Allocator;

fn main() -> std::process::ExitCode {
    spmesh_shell::main(spmesh_pipeline::flags::spinfo::run)
}
