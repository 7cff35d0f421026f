//! Bivariate splines fitted to scattered points.

fn main() -> std::process::ExitCode {
    spmesh_cli::main(spmesh_cli::splinefit::run)
}
