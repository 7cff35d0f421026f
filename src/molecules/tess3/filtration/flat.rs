//! Sets of points in a plane, on a line or at one place, which have no tetrahedra.
//!
//! As many points are added as it takes to span the space, which is as few as possible. The flat of the given
//! points then touches the convex hull of all in a face. So the regular tetrahedralization of all contains
//! that of the given points, in which none is hidden that was not before, whatever the weights of the others
//! are.

use std::borrow::Cow;

use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay3::{Kernel, Tetrahedralization};
use spmesh_delaunay::predicates::Point3;

/// The tetrahedralization of the points and of as few others as possible, which come after them.
pub(super) fn tetrahedralize(points: &[Point3], weights: Option<&[f64]>) -> Result<Tetrahedralization> {
    let mut kernel = Kernel::new();
    let mut mesh = Tetrahedralization::default();
    for axes in AXES {
        let mut all = points.to_vec();
        all.extend(axes.iter().map(|&axis| aside(points[0], axis)));
        let done = match weights {
            None => kernel.triangulate(Cow::Owned(all), &mut mesh),
            Some(weights) => {
                let weights: Vec<f64> = weights.iter().copied().chain(axes.iter().map(|_| 0.0)).collect();
                kernel.triangulate_weighted(Cow::Owned(all), &weights, &mut mesh)
            }
        };
        done.map_err(Error::of_computation)?;
        if !mesh.tetrahedra().is_empty() {
            break;
        }
    }
    Ok(mesh)
}

/// Axes along which points are added: first one point, then two, then three.
const AXES: [&[usize]; 7] = [&[0], &[1], &[2], &[0, 1], &[1, 2], &[0, 2], &[0, 1, 2]];

/// Another point on a line along an axis, exactly.
fn aside(mut point: Point3, axis: usize) -> Point3 {
    let coordinate = &mut point[axis];
    *coordinate = if *coordinate == 0.0 { 1.0 } else { -*coordinate };
    point
}
