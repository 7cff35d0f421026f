//! Bivariate splines fitted to scattered points.

fn main() -> std::process::ExitCode {
    spmesh::cli::main(spmesh::cli::splinefit::run)
}
