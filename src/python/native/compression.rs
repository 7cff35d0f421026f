//! Compressed payloads of streams.

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use spmesh_stream::Decompressor;

/// Decompresses payloads.
#[pyclass(module = "spmesh._native")]
#[derive(Default)]
pub(crate) struct Payloads {
    decompressor: Decompressor,
    payload: Vec<u8>,
}

#[pymethods]
impl Payloads {
    #[new]
    fn new() -> Payloads {
        Payloads::default()
    }

    /// The payload that a compressed payload stands for.
    fn decompress<'py>(&mut self, py: Python<'py>, compressed: &[u8]) -> PyResult<Bound<'py, PyBytes>> {
        let Payloads { decompressor, payload } = self;
        py.detach(|| decompressor.decompress(compressed, payload))
            .map_err(|error| pyo3::exceptions::PyValueError::new_err(error.to_string()))?;
        Ok(PyBytes::new(py, payload))
    }
}
