//! The error of an input that changes between passes.

use spmesh_base::error::Error;

/// The input is not the same in every pass.
pub(super) fn input_changed() -> Error {
    Error::malformed("the input changed between two passes over it")
}
