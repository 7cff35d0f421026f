//! How good points and a mesh are, as a page and as JSON.

#[global_allocator]
static ALLOCATOR: spmesh_shell::Allocator = spmesh_shell::Allocator;

fn main() -> std::process::ExitCode {
    spmesh_shell::main(spmesh_terrain::flags::spreport::run)
}
