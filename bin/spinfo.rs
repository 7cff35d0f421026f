//! Says what a stream holds, and proves that it keeps its promises.

fn main() -> std::process::ExitCode {
    spmesh::cli::main(spmesh::cli::spinfo::run)
}
