//! Five points that are not in a hyperplane.

use crate::diagram4::sites::Sites;
use crate::predicates::exact_integers::integers;
use num_bigint::BigInt;
use spmesh_core::error::{Error, Result};
use spmesh_model::cells4::Point4;

/// Moves the first five points that span space to the front, others stay in their order.
///
/// # Errors
/// There are none; the message has the dimension of the points.
pub(super) fn to_front(sites: &Sites, order: &mut [u32]) -> Result<()> {
    let Some(&first) = order.first() else {
        return Err(Error::usage("no points, where a diagram in 4 dimensions needs at least 5"));
    };
    let origin = sites.points[first as usize];
    let mut basis: Vec<Row> = Vec::new();
    let mut found = vec![0];
    for (place, &number) in order.iter().enumerate().skip(1) {
        if let Some(row) = reduced(origin, sites.points[number as usize], &basis) {
            basis.push(row);
            found.push(place);
            if basis.len() == 4 {
                break;
            }
        }
    }
    if basis.len() < 4 {
        return Err(Error::usage(format!(
            "{} only {} of 4 dimensions: there are no cells",
            match order.len() {
                1 => "1 distinct point spans".to_owned(),
                distinct => format!("the {distinct} distinct points span"),
            },
            basis.len()
        )));
    }
    for (front, place) in found.into_iter().enumerate() {
        order[front..=place].rotate_right(1);
    }
    Ok(())
}

/// A vector, and the axis that no row after it has.
struct Row {
    vector: [BigInt; 4],
    axis: usize,
}

/// The vector from the origin to the point without its parts along the basis, times some integer, unless
/// nothing is left (Gauss's elimination without division).
fn reduced(origin: Point4, point: Point4, basis: &[Row]) -> Option<Row> {
    // All in one unit: that of the points, for each alone, will do, as rows may be scaled.
    let [o, p] = integers([origin, point]);
    let mut vector: [BigInt; 4] = std::array::from_fn(|axis| &p[axis] - &o[axis]);
    for row in basis {
        let (factor, pivot) = (vector[row.axis].clone(), &row.vector[row.axis]);
        vector = std::array::from_fn(|axis| &vector[axis] * pivot - &row.vector[axis] * &factor);
    }
    let axis = vector.iter().position(|x| *x != BigInt::ZERO)?;
    Some(Row { vector, axis })
}
