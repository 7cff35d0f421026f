//! Says what a stream holds, and proves that it keeps its promises.

fn main() -> std::process::ExitCode {
    spmesh_cli::main(spmesh_cli::spinfo::run)
}
