//! The triangles of a polygon with a hole.

use spmesh_delaunay::constrained2::ConstrainedTriangulation;
use spmesh_delaunay::predicates::area;

/// The segments around a ring of points, numbered from `first`.
fn ring(first: u32, count: u32) -> impl Iterator<Item = [u32; 2]> {
    (0..count).map(move |i| [first + i, first + (i + 1) % count])
}

fn main() -> spmesh_delaunay::Result<()> {
    // A house with a window.
    let points = [
        [[0.0, 0.0], [8.0, 0.0], [8.0, 6.0], [4.0, 9.0], [0.0, 6.0]].as_slice(),
        &[[3.0, 3.0], [3.0, 5.0], [5.0, 5.0], [5.0, 3.0]],
    ]
    .concat();
    let segments: Vec<[u32; 2]> = ring(0, 5).chain(ring(5, 4)).collect();
    let mesh = ConstrainedTriangulation::new(&points, &segments)?;
    let mut sum = 0.0;
    for (vertices, depth) in mesh.simplices().zip(mesh.depths()) {
        // In the hole, the depth is 2.
        if depth % 2 == 1 {
            println!("{vertices:?}");
            let [a, b, c] = vertices.map(|v| points[v as usize]);
            sum += area(a, b, c);
        }
    }
    println!("area {sum}");
    Ok(())
}
