//! Tetrahedral meshes made and read back, all in memory.

use std::borrow::Cow;
use std::io::Cursor;

use spmesh_base::error::Result;
use spmesh_delaunay::delaunay3::{Kernel, Tetrahedralization};
use spmesh_pipeline::reduce::{Options, Stats};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Event, LiveVertices, StreamReader};

/// The corners of a tetrahedron, sorted, as bits of their coordinates.
pub type Corners = [[u64; 3]; 4];

/// Options under which small nodes are triangulated, too.
pub fn every_node(threads: usize) -> Options<3> {
    Options { threads, every_node: true, ..Options::default() }
}

pub fn tetrahedralize(points: &[u8], options: &Options<3>) -> Result<(Vec<u8>, Stats)> {
    let reader = StreamReader::new(Cursor::new(points.to_vec()), "points")?;
    spmesh_pipeline::reduce::tetrahedralize(reader, Vec::new(), options, |_| ())
}

pub fn bits(point: Point) -> [u64; 3] {
    point.map(|x| (x + 0.0).to_bits())
}

fn sorted(mut corners: Corners) -> Corners {
    corners.sort_unstable();
    corners
}

/// The kernel's tetrahedra of all points at once.
pub fn expected(points: &[Point]) -> Vec<Corners> {
    let mut mesh = Tetrahedralization::default();
    Kernel::new().triangulate(Cow::Borrowed(points), &mut mesh).unwrap();
    let corner = |v: u32| bits(mesh.vertices()[v as usize].at);
    let mut set: Vec<Corners> = mesh.tetrahedra().iter().map(|t| sorted(t.vertices.map(corner))).collect();
    set.sort_unstable();
    set
}

/// The tetrahedra of a mesh stream and its number of vertices. Checks that each vertex is used only while it
/// is live.
pub fn read_mesh(bytes: &[u8]) -> (Vec<Corners>, usize) {
    let mut reader = StreamReader::new(bytes, "mesh").unwrap();
    let mut live = LiveVertices::new();
    let (mut set, mut vertices) = (Vec::new(), 0);
    while let Some(event) = reader.next_event().unwrap() {
        if let Event::Patch(patch) = event {
            let local = live.enter(&patch, |_, point| point).unwrap();
            vertices += patch.new.len();
            let corner = |&v: &u32| bits(local[v as usize].1);
            set.extend(patch.simplices.chunks_exact(4).map(|t| {
                let corners: Vec<[u64; 3]> = t.iter().map(corner).collect();
                sorted(corners.try_into().unwrap())
            }));
        }
    }
    assert!(live.is_empty(), "{} vertices are never finalized", live.len());
    set.sort_unstable();
    (set, vertices)
}

pub fn fits_a_grid(points: &[Point]) -> bool {
    points.as_flattened().iter().all(|&x| f64::from(x as i32) == x)
}
