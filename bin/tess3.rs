//! Delaunay tetrahedralization of the atoms of molecules, and of other points in space.

/// Counts what each file of a sweep takes.
#[global_allocator]
static HEAP: spmesh::tess3::heap::CountingHeap = spmesh::tess3::heap::CountingHeap;

fn main() -> std::process::ExitCode {
    spmesh::cli::main(spmesh::cli::tess3::run)
}
