//! Models of the height of a canopy.

#[global_allocator]
static ALLOCATOR: spmesh_shell::Allocator = spmesh_shell::Allocator;

fn main() -> std::process::ExitCode {
    spmesh_shell::main(spmesh_terrain::flags::spcanopy::run)
}
