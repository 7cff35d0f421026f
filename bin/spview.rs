//! Pictures of streams.

fn main() -> std::process::ExitCode {
    spmesh_cli::main(spmesh_cli::spview::run)
}
