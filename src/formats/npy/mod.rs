//! Arrays and sparse matrices of numpy.

pub(crate) mod header;
pub(crate) mod read;
pub(crate) mod sparse_matrix;
pub(crate) mod write;
