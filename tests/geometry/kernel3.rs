//! The 3D kernel against independent tetrahedralizations, and its output against its own promises.

mod large;
mod promises;
mod small;
mod threads;
mod weighted;

use promises::prove;
use spmesh_delaunay::delaunay3::{Kernel, Tetrahedralization};
use spmesh_reference::space::Point;
use std::borrow::Cow;

/// Tetrahedralizes and proves the result.
fn proved(kernel: &mut Kernel, points: &[Point]) -> Tetrahedralization {
    let mut mesh = Tetrahedralization::default();
    kernel.triangulate(Cow::Borrowed(points), &mut mesh).expect("finite points");
    if let Err(message) = prove(points, &mesh) {
        let shown = if points.len() < 100 { format!("let points = vec!{points:?};") } else { String::new() };
        panic!("{message}\n{shown}");
    }
    mesh
}
