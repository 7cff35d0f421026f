//! Lines in a mesh: the triangles are those of the definition.

// The tests of lines use more of this module.
#[allow(dead_code)]
#[path = "../../constrain/scene.rs"]
mod scene;

use scene::{Scene, run};
use spmesh_reference::as_set;
use spmesh_reference::constrained::Scene as Reference;
use spmesh_reference::segments::without_copies;
use spmesh_reference::sets::Random;

/// The side of the square whose corners come first, so that no later point is outside.
const SIDE: i64 = 8;

/// Random segments between points of a small grid, of which some are added to the mesh.
///
/// Two bytes are a seed, the third tells which points the mesh has, and the others are points.
pub fn constrained(bytes: &[u8]) {
    let Some((&[low, high, first], rest)) = bytes.split_first_chunk() else { return };
    let mut random = Random::new(u64::from(u16::from_le_bytes([low, high])));
    let corners = [[0, 0], [SIDE, 0], [SIDE, SIDE], [0, SIDE]];
    let of_byte = |byte: &u8| [byte & 15, byte >> 4].map(|c| i64::from(c) % (SIDE + 1));
    let points = without_copies(corners.into_iter().chain(rest.iter().take(14).map(of_byte)));
    let first = 4 + usize::from(first) % (points.len() - 3);
    let scene = Scene::random(&mut random, points, 5).with_first(first);
    let network = scene.network(|point| point % 3 == 0);
    let found = run(&scene.stream(&mut random), &network);
    let number = |place: [i64; 2]| {
        scene.points.iter().position(|&other| other == place).expect("a point of the scene") as u32
    };
    let set = as_set(found.triangles.iter().map(|corners| corners.map(number)));
    let expected = Reference::new(&scene.points, &scene.segments).triangles();
    let code = || format!("let points = {:?};\nlet segments = {:?};", scene.points, scene.segments);
    assert_eq!(set, expected, "{}", code());
    assert_eq!((found.stats.outside, found.stats.open_segments), (0, 0), "{}", code());
}
