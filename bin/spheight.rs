//! Heights of points above the ground.

fn main() -> std::process::ExitCode {
    spmesh_cli::main(spmesh_cli::spheight::run)
}
