//! Writes tiles in the format quantized-mesh 1.0.
//!
//! Source: the specification of quantized-mesh-1.0 (CesiumGS/quantized-mesh). Numbers are little-endian.

use super::buckets::{Corner, HEIGHT_STEPS};
use super::earth::{SEMI_MAJOR, SEMI_MINOR, geocentric};
use super::scheme::STEPS;
use super::tile_mesh::{TileMesh, difference, direction, dot, length};
use spmesh_stream::model::bounds::{Bounds, Point};

/// The most vertices that indices of 16 bits count.
const SHORT_MAX: usize = 1 << 16;

/// Numbers of extensions.
const NORMALS: u8 = 1;
const METADATA: u8 = 4;

/// The least power of two such that heights in a range are at most [`STEPS`] multiples of it above the first,
/// and f32 holds these multiples.
pub(super) fn power_of([min, max]: [i32; 2]) -> u32 {
    let fits = |power: &u32| {
        let [base, top] = [min >> power, (max >> power) + 1];
        i64::from(top) - i64::from(base) <= STEPS && base.unsigned_abs().max(top.unsigned_abs()) < 1 << 23
    };
    (0..31).find(fits).unwrap_or(31)
}

/// The bytes of a tile whose heights are multiples of `power`. `middle` is its place, and `normals` those of
/// the vertices.
pub(super) fn encode(mesh: &TileMesh, power: u32, normals: Option<&[Point]>) -> Vec<u8> {
    let heights = || mesh.vertices.iter().map(|vertex| vertex[2]);
    let base = heights().min().unwrap_or(0) >> power;
    let metres = |steps: i64| (steps << power) as f64 / HEIGHT_STEPS;
    let [least, most] = [metres(base.into()), metres(i64::from(base) + STEPS)];
    let bounds = Bounds::of_points(&mesh.positions).unwrap_or(Bounds::of_point([0.0; 3]));
    let centre = [0, 1, 2].map(|i| 0.5 * (bounds.min[i] + bounds.max[i]));
    let radius = mesh.positions.iter().map(|&at| length(difference(at, centre))).fold(0.0, f64::max);
    let mut bytes = Vec::new();
    put(&mut bytes, &middle(mesh));
    bytes.extend((least as f32).to_le_bytes());
    bytes.extend((most as f32).to_le_bytes());
    put(&mut bytes, &centre);
    put(&mut bytes, &[radius]);
    put(&mut bytes, &horizon(&mesh.positions, centre));
    bytes.extend((mesh.vertices.len() as u32).to_le_bytes());
    deltas(&mut bytes, mesh.vertices.iter().map(|vertex| vertex[0]));
    deltas(&mut bytes, mesh.vertices.iter().map(|vertex| vertex[1]));
    deltas(&mut bytes, heights().map(|height| (height >> power) - base));
    let is_short = mesh.vertices.len() <= SHORT_MAX;
    let width = if is_short { 2 } else { 4 };
    bytes.resize(bytes.len().next_multiple_of(width), 0);
    let index = |bytes: &mut Vec<u8>, number: u32| match is_short {
        true => bytes.extend((number as u16).to_le_bytes()),
        false => bytes.extend(number.to_le_bytes()),
    };
    bytes.extend((mesh.corners.len() as u32 / 3).to_le_bytes());
    // The number of vertices so far, less the index; vertices come in the order of their first use.
    let mut next = 0;
    for &corner in &mesh.corners {
        index(&mut bytes, next - corner);
        next += u32::from(corner == next);
    }
    // West, south, east and north.
    for (axis, steps) in [(0, 0), (1, 0), (0, STEPS), (1, STEPS)] {
        let on_side = |vertex: &Corner| i64::from(vertex[axis]) == steps;
        let mut numbers: Vec<u32> = (0..)
            .zip(&mesh.vertices)
            .filter(|(_, vertex)| on_side(vertex))
            .map(|(number, _)| number)
            .collect();
        numbers.sort_by_key(|&number| mesh.vertices[number as usize][1 - axis]);
        bytes.extend((numbers.len() as u32).to_le_bytes());
        numbers.into_iter().for_each(|number| index(&mut bytes, number));
    }
    if let Some(normals) = normals {
        let up = |number: usize| direction(normals[number], mesh.positions[number]);
        let encoded: Vec<u8> = (0..normals.len()).flat_map(|number| octahedral(up(number))).collect();
        extension(&mut bytes, NORMALS, &encoded);
    }
    bytes
}

/// Appends the extension that says which tiles below there are.
pub(super) fn append_metadata(bytes: &mut Vec<u8>, available: &serde_json::Value) {
    let text = serde_json::json!({"available": available}).to_string();
    let content = [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat();
    extension(bytes, METADATA, &content);
}

fn extension(bytes: &mut Vec<u8>, number: u8, content: &[u8]) {
    bytes.push(number);
    bytes.extend((content.len() as u32).to_le_bytes());
    bytes.extend_from_slice(content);
}

fn put(bytes: &mut Vec<u8>, numbers: &[f64]) {
    numbers.iter().for_each(|number| bytes.extend(number.to_le_bytes()));
}

/// Differences, with the sign in the last bit.
fn deltas(bytes: &mut Vec<u8>, numbers: impl Iterator<Item = i32>) {
    let mut last = 0;
    for number in numbers {
        let delta = number - last;
        bytes.extend((((delta << 1) ^ (delta >> 31)) as u16).to_le_bytes());
        last = number;
    }
}

/// The place in the middle of the vertices.
fn middle(mesh: &TileMesh) -> Point {
    let bounds = Bounds::of_points(&mesh.places).unwrap_or(Bounds::of_point([0.0; 3]));
    geocentric([0, 1, 2].map(|i| 0.5 * (bounds.min[i] + bounds.max[i])))
}

/// The point above `centre` that is below the horizon only if all positions are, on the ellipsoid scaled to
/// the unit sphere.
///
/// Source: K. Ring, "Computing the horizon occlusion point" (cesium.com/blog, 2013).
fn horizon(positions: &[Point], centre: Point) -> Point {
    let scaled = |[x, y, z]: Point| [x / SEMI_MAJOR, y / SEMI_MAJOR, z / SEMI_MINOR];
    let up = direction(scaled(centre), [0.0, 0.0, 1.0]);
    let height = |&position: &Point| {
        let position = scaled(position);
        let squared = dot(position, position).max(1.0);
        let cos_alpha = dot(direction(position, up), up).min(1.0);
        let sin_alpha = (1.0 - cos_alpha * cos_alpha).sqrt();
        let cos_beta = 1.0 / squared.sqrt();
        let sin_beta = (squared - 1.0).sqrt() * cos_beta;
        1.0 / (cos_alpha * cos_beta - sin_alpha * sin_beta)
    };
    // Where a tile spans so much that no point serves, one far out is never below the horizon of a viewer
    // nearer.
    const FAR: f64 = 1e3;
    let highest =
        positions.iter().map(height).map(|h| if h > 0.0 { h.min(FAR) } else { FAR }).fold(1.0, f64::max);
    up.map(|x| x * highest)
}

/// A direction as two bytes on an octahedron.
///
/// Source: Q. Meyer and others, "On floating-point normal vectors" (EGSR 2010).
fn octahedral([x, y, z]: Point) -> [u8; 2] {
    let sum = x.abs() + y.abs() + z.abs();
    let (x, y) = (x / sum, y / sum);
    let folded = |a: f64, b: f64| (1.0 - b.abs()).copysign(a);
    let (x, y) = if z < 0.0 { (folded(x, y), folded(y, x)) } else { (x, y) };
    [x, y].map(|part| ((part * 0.5 + 0.5) * 255.0).round() as u8)
}
