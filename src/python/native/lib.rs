//! `spmesh._native`: triangulations of arrays of numpy, and payloads of streams. Modules of Python give them
//! their names, check arguments and document them; nothing here is for users.

mod arrays;
mod compression;
mod interpolation;
mod mesh;
mod waiting;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    #[pymodule_export]
    use super::compression::Payloads;
    #[pymodule_export]
    use super::mesh::Mesh;
}
