//! Volumes between meshes.

mod closed_forms;
mod exact;
mod regions;

use num_bigint::BigInt;
use spmesh_base::random::Random;
use spmesh_delaunay::delaunay2::triangulate;
use spmesh_reference::overlay::Triangle3;
use spmesh_stream::{Coordinates, Header, Kind, StreamReader, write_triangles};
use spmesh_terrain::diff::{Comparison, Options, Other, Surface, Volumes, compare};

/// Vertices on a grid of integers, and triangles.
#[derive(Debug, Clone)]
struct Mesh {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// The Delaunay mesh of points.
    fn of(mut vertices: Vec<[f64; 3]>) -> Mesh {
        vertices.sort_by(|p, q| p.partial_cmp(q).unwrap());
        vertices.dedup_by_key(|[x, y, _]| [*x, *y]);
        let places: Vec<[f64; 2]> = vertices.iter().map(|&[x, y, _]| [x, y]).collect();
        let triangles: Vec<[u32; 3]> = triangulate(&places).unwrap().simplices().collect();
        Mesh { vertices, triangles }
    }

    fn random(random: &mut Random, points: u64, side: u64, relief: u64) -> Mesh {
        let point =
            |_| [side, side, relief].map(|size| if size == 0 { 0.0 } else { random.below(size) as f64 });
        Mesh::of((0..points).map(point).collect())
    }

    /// Another elevation for each vertex.
    fn raised(&self, mut z: impl FnMut([f64; 3]) -> f64) -> Mesh {
        let vertices = self.vertices.iter().map(|&[x, y, old]| [x, y, z([x, y, old])]).collect();
        Mesh { vertices, triangles: self.triangles.clone() }
    }

    fn corners(&self) -> Vec<Triangle3> {
        let corner = |at: u32| self.vertices[at as usize].map(|value| value as i64);
        self.triangles.iter().map(|triangle| triangle.map(corner)).collect()
    }

    fn surface(&self, coordinates: Coordinates) -> Surface {
        let header = Header::new(Kind::TriangleMesh, coordinates, 2, true);
        let mut used: Vec<u32> = self.triangles.as_flattened().to_vec();
        used.sort_unstable();
        used.dedup();
        let number = |at: u32| used.binary_search(&at).unwrap() as u32;
        let triangles: Vec<[u32; 3]> = self.triangles.iter().map(|triangle| triangle.map(number)).collect();
        let mut stream = Vec::new();
        let at = |vertex: u32| self.vertices[used[vertex as usize] as usize];
        write_triangles(header, &triangles, used.len(), 0, at, &mut stream).unwrap();
        let mut reader = StreamReader::new(&stream[..], "mesh").unwrap();
        Surface::read(&mut reader, None, 1 << 26, |_| ()).unwrap()
    }

    fn integers(&self) -> Surface {
        self.surface(GRID)
    }
}

/// Integers as they are.
const GRID: Coordinates = Coordinates::I32 { scale: [1.0; 3], offset: [0.0; 3] };

const MEMORY: u64 = 1 << 28;

/// A unit of areas and volumes, in steps.
fn units_of_step() -> [BigInt; 2] {
    [BigInt::from(2) << 64, BigInt::from(6) << 64]
}

fn compared(first: &Surface, other: &Other) -> Comparison {
    let options = Options { polygons: &[], memory: MEMORY, threads: 2 };
    compare(first, other, &options, &mut |_, _| ()).unwrap()
}

fn volumes(first: &Surface, second: &Surface) -> Volumes {
    compared(first, &Other::Mesh(second)).volumes.remove(0).remove(0)
}

/// The sum of volumes.
fn sum<'v>(volumes: impl IntoIterator<Item = &'v Volumes>) -> Volumes {
    volumes.into_iter().fold(Volumes::default(), |all, one| Volumes {
        cut: all.cut + &one.cut,
        cut_area: all.cut_area + &one.cut_area,
        fill: all.fill + &one.fill,
        fill_area: all.fill_area + &one.fill_area,
        level_area: all.level_area + &one.level_area,
    })
}

fn turned(volumes: &Volumes) -> Volumes {
    let Volumes { cut, cut_area, fill, fill_area, level_area } = volumes.clone();
    Volumes { cut: fill, cut_area: fill_area, fill: cut, fill_area: cut_area, level_area }
}
