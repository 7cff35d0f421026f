//! `spconstrain` as a user runs it: in pipes, over tiles, with areas.

mod areas;
mod failures;
mod peer;
mod pipes;

use std::collections::BTreeMap;

use spmesh_stream::{Event, Patch, StreamReader};

use crate::programs::{outcome, run};

/// A mesh by places in stored coordinates.
pub(super) struct Mesh {
    /// Sorted, the corners of each sorted, too.
    pub triangles: Vec<[[i64; 2]; 3]>,
    pub elevations: BTreeMap<[i64; 2], i64>,
    /// Ends of sides that are on segments, sorted.
    pub constrained: Vec<[[i64; 2]; 2]>,
}

impl Mesh {
    /// Sorts what is given in any order; constraints may be given twice.
    pub fn new(
        mut triangles: Vec<[[i64; 2]; 3]>,
        elevations: BTreeMap<[i64; 2], i64>,
        mut constrained: Vec<[[i64; 2]; 2]>,
    ) -> Mesh {
        triangles.iter_mut().for_each(|corners| corners.sort_unstable());
        triangles.sort_unstable();
        constrained.iter_mut().for_each(|ends| ends.sort_unstable());
        constrained.sort_unstable();
        constrained.dedup();
        Mesh { triangles, elevations, constrained }
    }
}

/// Runs a program that must succeed.
pub(super) fn output(name: &str, arguments: &[&str], input: &[u8]) -> Vec<u8> {
    let output = run(name, arguments, input);
    assert!(output.status.success(), "{name} {arguments:?}: {:?}", outcome(&output));
    output.stdout
}

/// Reads a mesh of integer coordinates.
pub(super) fn mesh(stream: &[u8]) -> Mesh {
    let mut reader = StreamReader::new(stream, "mesh").unwrap();
    let mut points: Vec<[i64; 3]> = Vec::new();
    let mut patches: Vec<Patch> = Vec::new();
    while let Some(event) = reader.next_event().unwrap() {
        if let Event::Patch(patch) = event {
            points.extend(patch.new.iter().map(|point| point.map(|x| x as i64)));
            patches.push(patch);
        }
    }
    let place = |id: u64| [points[id as usize][0], points[id as usize][1]];
    let elevations = points.iter().map(|&[x, y, z]| ([x, y], z)).collect();
    let (mut all, mut constrained) = (Vec::new(), Vec::new());
    for patch in &patches {
        let triangles: Vec<[[i64; 2]; 3]> =
            patch.triangles().map(|corners| corners.map(|local| place(patch.id(local)))).collect();
        for &[triangle, side, _] in &patch.sides {
            constrained.push([1, 2].map(|turn| triangles[triangle as usize][(side as usize + turn) % 3]));
        }
        all.extend(triangles);
    }
    Mesh::new(all, elevations, constrained)
}

/// Asserts that the audit finds nothing.
pub(super) fn audit(stream: &[u8]) {
    output("spinfo", &["--audit", "-"], stream);
}
