//! Says what a stream holds, and proves that it keeps its promises.

#[global_allocator]
static ALLOCATOR: spmesh_cli::Allocator = spmesh_cli::Allocator;

fn main() -> std::process::ExitCode {
    spmesh_cli::main(spmesh_cli::spinfo::run)
}
