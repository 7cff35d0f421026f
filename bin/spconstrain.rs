//! Breaklines in triangle meshes.

fn main() -> std::process::ExitCode {
    spmesh_cli::main(spmesh_cli::spconstrain::run)
}
