//! Finds five points that do not lie in a hyperplane.

use crate::diagram4::sites::Sites;
use num_bigint::BigInt;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::exact_integers::integers;
use spmesh_stream::model::cells4::Point4;

/// Moves the first five points that span space to the front; the others keep their order.
pub(super) fn to_front(sites: &Sites, order: &mut [u32]) -> Result<()> {
    if order.is_empty() {
        return Err(Error::usage("no points, where a diagram in 4 dimensions needs at least 5"));
    }
    let found = spanning(order.iter().map(|&number| sites.points[number as usize]), 4);
    if found.len() < 5 {
        return Err(Error::usage(format!(
            "{} only {} of 4 dimensions: there are no cells",
            match order.len() {
                1 => "1 distinct point spans".to_owned(),
                distinct => format!("the {distinct} distinct points span"),
            },
            found.len() - 1
        )));
    }
    for (front, place) in found.into_iter().enumerate() {
        order[front..=place].rotate_right(1);
    }
    Ok(())
}

/// The places of the first points that span so many dimensions, or of fewer that span as much as all.
pub(in crate::diagram4) fn spanning(
    mut points: impl Iterator<Item = Point4>,
    dimensions: usize,
) -> Vec<usize> {
    let Some(origin) = points.next() else { return Vec::new() };
    let mut basis: Vec<Row> = Vec::new();
    let mut found = vec![0];
    for (place, point) in (1..).zip(points) {
        if basis.len() == dimensions {
            break;
        }
        if let Some(row) = reduced(origin, point, &basis) {
            basis.push(row);
            found.push(place);
        }
    }
    found
}

/// A vector, and the axis that is eliminated from all later rows.
struct Row {
    vector: [BigInt; 4],
    axis: usize,
}

/// The vector from the origin to the point without its parts along the basis, times some integer; `None` if
/// that is zero (Gaussian elimination without division).
fn reduced(origin: Point4, point: Point4, basis: &[Row]) -> Option<Row> {
    // Each pair may have a unit of its own, as rows may be scaled.
    let [o, p] = integers([origin, point]);
    let mut vector: [BigInt; 4] = std::array::from_fn(|axis| &p[axis] - &o[axis]);
    for row in basis {
        let (factor, pivot) = (vector[row.axis].clone(), &row.vector[row.axis]);
        vector = std::array::from_fn(|axis| &vector[axis] * pivot - &row.vector[axis] * &factor);
    }
    let axis = vector.iter().position(|x| *x != BigInt::ZERO)?;
    Some(Row { vector, axis })
}
