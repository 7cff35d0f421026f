//! Pictures of streams.

fn main() -> std::process::ExitCode {
    spmesh::cli::main(spmesh::cli::spview::run)
}
