//! Small streams of every kind.

use spmesh_stream::model::bounds::{Bounds, Point, Region};
use spmesh_stream::model::cells::{CellCode, CellTree};
use spmesh_stream::{Coordinates, Crs, Header, Kind, Patch, StreamWriter};

pub const SIDE: u64 = 12;

/// Grids that are hard for decimals: a northing in millimetres, tiny steps, steps other than powers of two.
pub fn grids() -> Vec<Coordinates> {
    let grid = |scale: f64, offset: [f64; 3]| Coordinates::I32 { scale: [scale; 3], offset };
    vec![
        Coordinates::F64,
        grid(0.001, [412_345.678, 5_432_109.876, -12.5]),
        grid(1e-7, [8.5, 47.1, 0.0]),
        grid(0.01, [0.0; 3]),
        grid(0.3, [1e9 / 3.0, -1e9 / 7.0, 0.1]),
    ]
}

/// A linear congruential generator.
pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % bound
    }
}

fn point(coordinates: &Coordinates, x: u64, y: u64, random: &mut Random) -> Point {
    match coordinates {
        Coordinates::F64 => {
            let jitter = random.below(1000) as f64 / 3000.0;
            [x as f64 + jitter, y as f64 - jitter / 7.0, jitter * 100.0]
        }
        Coordinates::I32 { .. } => {
            let mut stored = |i: u64| (i * 1_000_000 + random.below(900_000)) as f64 - 5e6;
            [stored(x), stored(y), stored(0)]
        }
    }
}

/// A mesh of `SIDE` squared vertices, one patch per row. Vertices are final after the next row. A patch
/// without triangles finalizes the last row.
pub fn mesh(coordinates: Coordinates) -> Vec<u8> {
    let mut random = Random(7);
    let mut header = Header::new(Kind::TriangleMesh, coordinates, 2, true);
    header.crs = Crs::Wkt("PROJCS[\"a \\ \u{e9}\"]\n".into());
    let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
    for row in 0..SIDE {
        let new = (0..SIDE).map(|x| point(&coordinates, x, row, &mut random)).collect();
        let mut patch = Patch { first_id: row * SIDE, new, ..Patch::default() };
        if row > 0 {
            patch.imported = ((row - 1) * SIDE..row * SIDE).collect();
            let side = SIDE as u32;
            for x in 0..side - 1 {
                patch.simplices.extend([side + x, side + x + 1, x + 1, side + x, x + 1, x]);
            }
            patch.finalized = (side..2 * side).collect();
        }
        writer.patch(&patch).unwrap();
    }
    let imported = ((SIDE - 1) * SIDE..SIDE * SIDE).collect();
    let finalized = (0..SIDE as u32).collect();
    let last = Patch { first_id: SIDE * SIDE, imported, finalized, ..Patch::default() };
    writer.patch(&last).unwrap();
    writer.end(SIDE * SIDE + 3, 3).unwrap()
}

/// Points of a quadtree or octree of two levels, chunked and tagged cell by cell.
pub fn points(dims: u8, has_elevation: bool, is_i32: bool) -> Vec<u8> {
    let coordinates = match is_i32 {
        false => Coordinates::F64,
        true => {
            let height = if dims == 3 { 0.01 } else { 0.001 };
            Coordinates::I32 { scale: [0.01, 0.01, height], offset: [300_000.0, 5_000_000.25, 10.0] }
        }
    };
    let axes = usize::from(dims);
    let mut origin = [0.0; 3];
    origin[..axes].fill(-64.0);
    let tree = CellTree::new(dims, 2, origin, 128.0).unwrap();
    let mut header = Header::new(Kind::Points, coordinates, dims, has_elevation);
    let top = if header.coordinates_per_point() == 3 { 64.0 } else { 0.0 };
    header.bounds =
        Some(Bounds { min: [-64.0, -64.0, -top], max: [63.0, 63.0, if dims == 3 { 63.0 } else { top }] });
    header.tree = Some(tree);
    header.chunked = true;
    let mut random = Random(3);
    let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
    let first = 1u64 << (2 * dims);
    for code in first..2 * first {
        let (min, _) = tree.corners(CellCode(code));
        // Points on corners of cells, which would leave their cell if its border was rounded.
        let mut inside = vec![min];
        for _ in 0..random.below(5) {
            let mut step = |axis: usize| min[axis] + random.below(32) as f64;
            let z = if dims == 3 { step(2) } else { 0.0 };
            inside.push([step(0), step(1), z]);
        }
        if header_has_no_z(dims, has_elevation) {
            inside.iter_mut().for_each(|point| point[2] = 0.0);
        }
        writer.points(&inside).unwrap();
        writer.cells(&[CellCode(code)]).unwrap();
    }
    writer.end(0, 0).unwrap()
}

fn header_has_no_z(dims: u8, has_elevation: bool) -> bool {
    dims == 2 && !has_elevation
}

/// A partial mesh with a residual.
pub fn partial() -> Vec<u8> {
    let mut header = Header::new(Kind::PartialTriangleMesh, Coordinates::F64, 2, false);
    let region = Region { min: [f64::NEG_INFINITY, 0.0], max: [8.0, f64::INFINITY] };
    header.region = Some(region.in_space());
    header.crs = Crs::GeoKeys { directory: vec![1, 0, 255], doubles: vec![], ascii: b"x|".to_vec() };
    let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
    let new = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let patch = Patch { first_id: 0, new, simplices: vec![0, 1, 2], finalized: vec![0], ..Patch::default() };
    writer.patch(&patch).unwrap();
    let residual = [(Some(1), [1.0, 0.0, 0.0]), (None, [5.0, 1e-300, 0.0]), (Some(2), [0.0, 1.0, 0.0])];
    writer.residual_points(&residual).unwrap();
    writer.walls(&[0, 2, 2, 1]).unwrap();
    writer.end(4, 0).unwrap()
}

/// A partial tetrahedral mesh with a residual.
pub fn partial_space() -> Vec<u8> {
    let mut header = Header::new(Kind::PartialTetrahedralMesh, Coordinates::F64, 3, false);
    header.region = Some(Region { min: [f64::NEG_INFINITY, 0.0, -1.0], max: [8.0, f64::INFINITY, 8.0] });
    let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
    let new = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.5]];
    let patch = Patch { new: new.clone(), simplices: vec![0, 1, 2, 3], ..Patch::default() };
    writer.patch(&patch).unwrap();
    let unwritten = (None, [5.0, 1e-300, -1.0]);
    let residual = [(Some(1), new[1]), unwritten, (Some(2), new[2]), (Some(0), new[0]), (Some(3), new[3])];
    writer.residual_points(&residual).unwrap();
    writer.walls(&[0, 4, 2, 3, 2, 4, 3, 4, 0, 3, 0, 2]).unwrap();
    writer.end(6, 1).unwrap()
}

/// A box of `LAYERS` layers of cubes, with five tetrahedra per cube and one patch per layer of vertices.
/// Vertices are final after the next layer. Labels, if any, follow every second patch.
pub fn tetrahedra(coordinates: Coordinates, has_labels: bool) -> Vec<u8> {
    const SIDE: u64 = 4;
    const LAYERS: u64 = 3;
    const AREA: u64 = SIDE * SIDE;
    let mut header = Header::new(Kind::TetrahedralMesh, coordinates, 3, false);
    header.points = Some(AREA * (LAYERS + 1) + 2);
    let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
    let step = if coordinates == Coordinates::F64 { 1.0 / 3.0 } else { 1e8 };
    for layer in 0..=LAYERS {
        let at = |i: u64| [i % SIDE, i / SIDE, layer].map(|x| x as f64 * step - step);
        let mut patch =
            Patch { first_id: layer * AREA, new: (0..AREA).map(at).collect(), ..Patch::default() };
        if layer > 0 {
            patch.imported = ((layer - 1) * AREA..layer * AREA).collect();
            let cubes = (0..SIDE - 1).flat_map(|x| (0..SIDE - 1).map(move |y| (x, y)));
            patch.simplices = cubes.flat_map(|(x, y)| cube(x, y, layer, SIDE)).collect();
            let all = 2 * AREA as u32;
            patch.finalized = (if layer == LAYERS { 0 } else { AREA as u32 }..all).collect();
        }
        writer.patch(&patch).unwrap();
        if has_labels && layer % 2 == 1 {
            writer.labels(&((layer - 1) * AREA..(layer + 1) * AREA).map(label).collect::<Vec<_>>()).unwrap();
        }
    }
    writer.end(AREA * (LAYERS + 1) + 2, 2).unwrap()
}

/// Label of a vertex of [`tetrahedra`].
pub fn label(id: u64) -> u64 {
    1000 - 7 * id
}

/// Local indices of the five tetrahedra of a cube whose upper side is new and whose lower side is imported.
/// Neighbouring cubes are mirror images, so that their diagonals agree.
fn cube(x: u64, y: u64, layer: u64, side: u64) -> Vec<u32> {
    let corner = |i: u64| {
        let lower = if i & 4 == 0 { side * side } else { 0 };
        (lower + (y + (i >> 1 & 1)) * side + x + (i & 1)) as u32
    };
    let is_mirrored = (x + y + layer) % 2 == 1;
    let five = [[0, 1, 2, 4], [3, 2, 1, 7], [5, 4, 7, 1], [6, 7, 4, 2], [1, 2, 4, 7]];
    let turned = five.map(|t| if is_mirrored { [t[1] ^ 1, t[0] ^ 1, t[2] ^ 1, t[3] ^ 1] } else { t });
    turned.iter().flatten().map(|&i| corner(i)).collect()
}

/// One stream of every sort.
pub fn all() -> Vec<Vec<u8>> {
    let mut all: Vec<Vec<u8>> = grids().into_iter().map(mesh).collect();
    for is_i32 in [false, true] {
        all.extend([points(2, true, is_i32), points(2, false, is_i32), points(3, false, is_i32)]);
    }
    all.extend([partial(), partial_space()]);
    all.extend(grids().into_iter().map(|grid| tetrahedra(grid, true)));
    all.push(tetrahedra(Coordinates::F64, false));
    all
}
