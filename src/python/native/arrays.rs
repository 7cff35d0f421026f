//! Between arrays of numpy and slices.

use numpy::ndarray::Array2;
use numpy::{Element, IntoPyArray, PyArray2, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::{PyMemoryError, PyValueError};
use pyo3::prelude::*;

/// The rows of an array of `D` columns; `None` for another number of columns.
///
/// # Errors
/// If the array does not lie in memory row by row.
pub(crate) fn rows<'a, T: Element, const D: usize>(
    array: &'a PyReadonlyArray2<'_, T>,
) -> PyResult<Option<&'a [[T; D]]>> {
    if array.shape()[1] != D {
        return Ok(None);
    }
    Ok(Some(numbers(array)?.as_chunks().0))
}

/// The numbers of an array, row by row.
///
/// # Errors
/// If it does not lie in memory like that.
pub(crate) fn numbers<'a, T: Element>(array: &'a PyReadonlyArray2<'_, T>) -> PyResult<&'a [T]> {
    let numbers = array.as_slice().ok().filter(|_| array.is_c_contiguous());
    numbers.ok_or_else(|| PyValueError::new_err("the array is not contiguous, row by row"))
}

/// An empty list with room for so many items.
///
/// # Errors
/// MemoryError, where the process would end otherwise.
pub(crate) fn room_for<T>(count: usize) -> PyResult<Vec<T>> {
    let mut list = Vec::new();
    list.try_reserve_exact(count)
        .map_err(|_| PyMemoryError::new_err(format!("no memory for {count} results")))?;
    Ok(list)
}

/// An array of rows of so many numbers, without a copy.
pub(crate) fn array_of_rows<T: Element>(
    py: Python<'_>,
    numbers: Vec<T>,
    width: usize,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let shape = (numbers.len().checked_div(width).unwrap_or(0), width);
    let rows =
        Array2::from_shape_vec(shape, numbers).map_err(|error| PyValueError::new_err(error.to_string()))?;
    Ok(rows.into_pyarray(py))
}

/// An array of these rows, without a copy.
pub(crate) fn array_of<T: Element, const D: usize>(
    py: Python<'_>,
    rows: Vec<[T; D]>,
) -> Bound<'_, PyArray2<T>> {
    let shape = (rows.len(), D);
    Array2::from_shape_vec(shape, rows.into_flattened()).expect("rows of D").into_pyarray(py)
}

/// Numbers of vertices or simplices as numpy's users know them: 32 bits, -1 for none.
pub(crate) fn signed(number: u32) -> i32 {
    number.cast_signed()
}
