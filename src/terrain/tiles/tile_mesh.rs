//! The mesh of a tile: its vertices in the order in which triangles first use them.

use foldhash::{HashMap, HashMapExt};

use super::buckets::{Corner, HEIGHT_STEPS, Triangle};
use super::earth::geocentric;
use super::scheme::{Place, STEPS, Scheme, Tile};
use spmesh_stream::model::bounds::Point;

pub(super) struct TileMesh {
    pub(super) vertices: Vec<Corner>,
    /// Corners of the triangles, three each.
    pub(super) corners: Vec<u32>,
    /// The places of the vertices.
    pub(super) places: Vec<Place>,
    /// X, Y and Z of the vertices.
    pub(super) positions: Vec<Point>,
}

impl TileMesh {
    pub(super) fn new(scheme: Scheme, level: u32, tile: Tile, triangles: &[Triangle]) -> TileMesh {
        let mut numbers: HashMap<Corner, u32> = HashMap::new();
        let (mut vertices, mut corners) = (Vec::new(), Vec::with_capacity(3 * triangles.len()));
        for &corner in triangles.as_flattened() {
            corners.push(*numbers.entry(corner).or_insert_with(|| {
                vertices.push(corner);
                vertices.len() as u32 - 1
            }));
        }
        let sides = scheme.corners(level, tile);
        let places: Vec<Place> = vertices.iter().map(|corner| place(corner, &sides)).collect();
        let positions = places.iter().map(|&place| geocentric(place)).collect();
        TileMesh { vertices, corners, places, positions }
    }

    /// The normals of the triangles around each vertex, summed by area.
    pub(super) fn normals(&self) -> Vec<Point> {
        let mut normals = vec![[0.0; 3]; self.vertices.len()];
        for triangle in self.corners.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|i| self.positions[triangle[i] as usize]);
            let normal = cross(difference(b, a), difference(c, a));
            for &corner in triangle {
                let sum = &mut normals[corner as usize];
                *sum = [0, 1, 2].map(|i| sum[i] + normal[i]);
            }
        }
        normals
    }

    /// A key of each vertex on the border of the tile, which it has in all tiles there.
    pub(super) fn on_border(&self) -> impl Iterator<Item = (usize, [u64; 3])> {
        let is_border = |steps: i32| steps == 0 || i64::from(steps) == STEPS;
        let vertices = self.vertices.iter().enumerate();
        vertices
            .filter(move |(_, [u, v, _])| is_border(*u) || is_border(*v))
            .map(|(number, _)| (number, self.places[number].map(f64::to_bits)))
    }
}

/// The place of a corner. On a border, it is that of the tiles on both sides, to the last bit.
fn place([u, v, height]: &Corner, [min, max]: &[[f64; 2]; 2]) -> Place {
    let along = |steps: i32, axis: usize| match i64::from(steps) {
        0 => min[axis],
        STEPS => max[axis],
        steps => min[axis] + steps as f64 / STEPS as f64 * (max[axis] - min[axis]),
    };
    [along(*u, 0), along(*v, 1), f64::from(*height) / HEIGHT_STEPS]
}

pub(super) fn difference(a: Point, b: Point) -> Point {
    [0, 1, 2].map(|i| a[i] - b[i])
}

pub(super) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn length(a: Point) -> f64 {
    dot(a, a).sqrt()
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The direction of a vector; that of `other` if it has none.
pub(super) fn direction(vector: Point, other: Point) -> Point {
    let length = length(vector);
    if length.is_normal() { vector.map(|x| x / length) } else { other.map(|x| x / self::length(other)) }
}
