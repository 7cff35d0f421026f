//! One node of a mesh that many jobs make.

fn main() -> std::process::ExitCode {
    spmesh_cli::main(spmesh_cli::spnode::run)
}
