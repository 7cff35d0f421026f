//! Tetrahedra of points of space, and where other points lie among them.

use spmesh_delaunay::Location;
use spmesh_delaunay::delaunay3::triangulate;
use spmesh_delaunay::points::points;

fn main() -> spmesh_delaunay::Result<()> {
    // The nodes of a cubic grid: many are on one sphere, on one plane and on one line.
    let nodes = (0..5 * 5 * 5).map(|i| [i % 5, i / 5 % 5, i / 25]);
    let mesh = triangulate(&points(nodes))?;
    println!("{} tetrahedra, {} edges", mesh.simplices().count(), mesh.edges().len());
    println!("{} facets of the hull", mesh.hull().count());
    for target in [[1.0, 2.0, 3.0], [0.5, 0.0, 0.0], [1.3, 1.2, 1.1], [4.5, 0.0, 0.0]] {
        match mesh.locate(target) {
            Location::Vertex(vertex) => println!("{target:?} is point {vertex}"),
            Location::Edge(ends) => println!("{target:?} is on the edge between {ends:?}"),
            Location::Facet(corners) => println!("{target:?} is on the facet of {corners:?}"),
            Location::Simplex(number) => println!("{target:?} is in tetrahedron {number}"),
            _ => println!("{target:?} is outside"),
        }
    }
    Ok(())
}
