//! Models of the height of a canopy.

fn main() -> std::process::ExitCode {
    spmesh_cli::main(spmesh_cli::spcanopy::run)
}
