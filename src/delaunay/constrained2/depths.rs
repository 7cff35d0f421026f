//! Which triangles segments enclose.

use super::mesh::NONE;
use super::triangulation::ConstrainedTriangulation;

impl ConstrainedTriangulation {
    /// For each triangle the least number of constrained edges between it and the outside of the hull.
    ///
    /// With segments along the rings of polygons, which do not touch each other along edges, triangles of odd
    /// depth are inside of polygons, and the others outside or in holes. Segments that enclose nothing do not
    /// matter.
    ///
    /// Cost: O(n) steps for n triangles.
    ///
    /// ```
    /// use spmesh_delaunay::constrained2::ConstrainedTriangulation;
    ///
    /// // A polygon shaped like an arrowhead; the hull has one triangle more.
    /// let points = [[0.0, 0.0], [2.0, 1.0], [4.0, 0.0], [2.0, 4.0]];
    /// let mesh = ConstrainedTriangulation::new(&points, &[[0, 1], [1, 2], [2, 3], [3, 0]])?;
    /// let inside = mesh.depths().into_iter().filter(|depth| depth % 2 == 1).count();
    /// assert_eq!((inside, mesh.simplices().count()), (2, 3));
    /// # Ok::<(), spmesh_delaunay::Error>(())
    /// ```
    pub fn depths(&self) -> Vec<u32> {
        let triangles = &self.mesh.triangles;
        let mut depths = vec![NONE; triangles.len()];
        // Triangles to be given the present depth, and the next one.
        let [mut present, mut next] = [Vec::new(), Vec::new()];
        for (number, triangle) in (0..).zip(triangles) {
            for side in (0..3).filter(|&side| triangle.neighbours[side] == NONE) {
                if triangle.segments[side] == NONE { &mut present } else { &mut next }.push(number);
            }
        }
        let mut depth = 0;
        while !(present.is_empty() && next.is_empty()) {
            while let Some(number) = present.pop() {
                if depths[number as usize] != NONE {
                    continue;
                }
                depths[number as usize] = depth;
                let triangle = &triangles[number as usize];
                for side in (0..3).filter(|&side| triangle.neighbours[side] != NONE) {
                    let list = if triangle.segments[side] == NONE { &mut present } else { &mut next };
                    list.push(triangle.neighbours[side]);
                }
            }
            std::mem::swap(&mut present, &mut next);
            depth += 1;
        }
        depths
    }
}
