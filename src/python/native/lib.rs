//! `spmesh._native`: triangulations of arrays of numpy. The module `spmesh.delaunay` gives them their names, checks
//! arguments and documents them; nothing here is for users.

mod arrays;
mod interpolation;
mod mesh;
mod waiting;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    #[pymodule_export]
    use super::mesh::Mesh;
}
