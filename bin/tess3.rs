//! Delaunay tetrahedralization of the atoms of molecules, and of other points in space.

/// Counts what each file of a sweep takes.
#[global_allocator]
static HEAP: spmesh_molecules::flags::tess3::CountingHeap = spmesh_molecules::flags::tess3::CountingHeap;

fn main() -> std::process::ExitCode {
    spmesh_shell::main(spmesh_molecules::flags::tess3::run)
}
