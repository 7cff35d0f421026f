//! Constrained meshes by brute force: all empty triangles, then flips.

use std::collections::{BTreeMap, BTreeSet};

use spmesh_audit::Standard;
use spmesh_stream::{Constrained, Coordinates, Header, Kind, Patch, Segment, StreamWriter};

use super::{Verdict, audit};

pub type Place = [i32; 2];

/// A mesh with its segments, as a stream states them.
#[derive(Debug, Clone, PartialEq)]
pub struct ConstrainedMesh {
    pub points: Vec<Place>,
    pub segments: Vec<[Place; 2]>,
    pub triangles: Vec<[usize; 3]>,
    /// The segment of a side, by triangle and place.
    pub sides: BTreeMap<[usize; 2], u32>,
    pub open: BTreeSet<u32>,
    pub is_cut: bool,
    pub kill: f64,
}

pub fn turn(a: Place, b: Place, c: Place) -> i64 {
    let [[ax, ay], [bx, by], [cx, cy]] = [a, b, c].map(|p| p.map(i64::from));
    ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)).signum()
}

/// Whether d is inside of the circle of the counterclockwise triangle abc, ties broken canonically.
fn is_inside(a: Place, b: Place, c: Place, d: Place) -> bool {
    let [a2, b2, c2] = [a, b, c].map(|p| [0, 1].map(|axis| i128::from(p[axis]) - i128::from(d[axis])));
    let lift = |p: [i128; 2]| p[0] * p[0] + p[1] * p[1];
    let area = |p: [i128; 2], q: [i128; 2]| p[0] * q[1] - p[1] * q[0];
    let determinant = lift(a2) * area(b2, c2) + lift(b2) * area(c2, a2) + lift(c2) * area(a2, b2);
    if determinant != 0 {
        return determinant > 0;
    }
    match [a, b, c, d].iter().max().copied().unwrap() {
        greatest if greatest == d => false,
        greatest if greatest == a => turn(d, b, c) > 0,
        greatest if greatest == b => turn(a, d, c) > 0,
        _ => turn(a, b, d) > 0,
    }
}

/// Whether p is on the segment, ends included.
fn is_on([a, b]: [Place; 2], p: Place) -> bool {
    turn(a, b, p) == 0 && a.min(b) <= p && p <= a.max(b)
}

fn crosses([a, b]: [Place; 2], [c, d]: [Place; 2]) -> bool {
    turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0
}

/// The edges that points on a segment make of it.
fn chain(points: &[Place], segment: [Place; 2]) -> Vec<[usize; 2]> {
    let mut on: Vec<usize> = (0..points.len()).filter(|&i| is_on(segment, points[i])).collect();
    on.sort_by_key(|&i| points[i]);
    on.windows(2).map(|pair| [pair[0], pair[1]]).collect()
}

/// Whether segments have nothing in common but ends of both.
pub fn are_apart(points: &[Place], s: [Place; 2], t: [Place; 2]) -> bool {
    let common: Vec<Place> = points.iter().copied().filter(|&p| is_on(s, p) && is_on(t, p)).collect();
    !crosses(s, t) && common.len() < 2 && common.iter().all(|p| s.contains(p) && t.contains(p))
}

/// The constrained Delaunay triangulation, by flips.
fn triangulate(points: &[Place], constraints: &BTreeSet<[usize; 2]>) -> Vec<[usize; 3]> {
    let ends = |[i, j]: [usize; 2]| [points[i], points[j]];
    let pairs = (0..points.len()).flat_map(|j| (0..j).map(move |i| [i, j]));
    let mut edges: BTreeSet<[usize; 2]> = BTreeSet::new();
    for edge in constraints.iter().copied().chain(pairs) {
        let is_free = (0..points.len()).all(|k| edge.contains(&k) || !is_on(ends(edge), points[k]));
        if is_free && edges.iter().all(|&other| !crosses(ends(edge), ends(other))) {
            edges.insert([edge[0].min(edge[1]), edge[0].max(edge[1])]);
        }
    }
    let has = |i: usize, j: usize| edges.contains(&[i.min(j), i.max(j)]);
    let mut triangles = Vec::new();
    for i in 0..points.len() {
        for j in i + 1..points.len() {
            for k in i + 1..points.len() {
                let [a, b, c] = [i, j, k].map(|v| points[v]);
                let holds = |p: Place| turn(a, b, p) > 0 && turn(b, c, p) > 0 && turn(c, a, p) > 0;
                let is_empty = !points.iter().any(|&p| holds(p));
                if j != k && turn(a, b, c) > 0 && has(i, j) && has(j, k) && has(k, i) && is_empty {
                    triangles.push([i, j, k]);
                }
            }
        }
    }
    while let Some((one, other, new)) = next_flip(points, constraints, &triangles) {
        [triangles[one], triangles[other]] = new;
    }
    triangles
}

fn next_flip(
    points: &[Place],
    constraints: &BTreeSet<[usize; 2]>,
    triangles: &[[usize; 3]],
) -> Option<(usize, usize, [[usize; 3]; 2])> {
    for (one, triangle) in triangles.iter().enumerate() {
        for side in 0..3 {
            let [a, b, c] = [0, 1, 2].map(|k| triangle[(side + k) % 3]);
            let has_twin = |t: &[usize; 3]| (0..3).any(|k| t[k] == b && t[(k + 1) % 3] == a);
            let Some(other) = triangles.iter().position(has_twin) else { continue };
            let d = *triangles[other].iter().find(|v| ![a, b].contains(v)).unwrap();
            let is_constraint = constraints.contains(&[a.min(b), a.max(b)]);
            if !is_constraint && is_inside(points[a], points[b], points[c], points[d]) {
                return Some((one, other, [[a, d, c], [d, b, c]]));
            }
        }
    }
    None
}

impl ConstrainedMesh {
    /// The mesh of points and segments that have nothing in common but ends, and whose ends are points or
    /// leave the hull in line with two points.
    pub fn new(points: Vec<Place>, segments: Vec<[Place; 2]>) -> ConstrainedMesh {
        let chains = segments.iter().flat_map(|&segment| chain(&points, segment));
        let constraints = chains.map(|[a, b]| [a.min(b), a.max(b)]).collect();
        let triangles = triangulate(&points, &constraints);
        let (sides, open, is_cut, kill) = (BTreeMap::new(), BTreeSet::new(), false, 0.0);
        let mut mesh = ConstrainedMesh { points, segments, triangles, sides, open, is_cut, kill };
        mesh.state();
        mesh
    }

    /// States sides and open segments.
    pub fn state(&mut self) {
        self.sides.clear();
        self.open.clear();
        for (number, &segment) in self.segments.iter().enumerate() {
            let mut edges = BTreeSet::new();
            for (t, triangle) in self.triangles.iter().enumerate() {
                for place in 0..3 {
                    let [a, b] = [1, 2].map(|k| self.points[triangle[(place + k) % 3]]);
                    if is_on(segment, a) && is_on(segment, b) {
                        self.sides.insert([t, place], number as u32);
                        edges.insert([a.min(b), a.max(b)]);
                    }
                }
            }
            let length = |[a, b]: [Place; 2]| (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
            if edges.into_iter().map(length).sum::<i32>() != length(segment) {
                self.open.insert(number as u32);
            }
        }
    }

    /// Drops triangles at edges of the border that are longer than `kill` and on no segment; without `kill`,
    /// at all that are on no segment.
    pub fn cut(mut self, kill: Option<f64>) -> ConstrainedMesh {
        loop {
            let edges: BTreeSet<[usize; 2]> =
                self.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
            let is_cut_off = |t: usize, triangle: &[usize; 3]| {
                (0..3).any(|place| {
                    let [a, b] = [1, 2].map(|k| triangle[(place + k) % 3]);
                    let [dx, dy] = [0, 1].map(|axis| f64::from(self.points[a][axis] - self.points[b][axis]));
                    let is_long = kill.is_none_or(|kill| dx * dx + dy * dy > kill * kill);
                    !edges.contains(&[b, a]) && is_long && !self.sides.contains_key(&[t, place])
                })
            };
            let found = (0..self.triangles.len()).find(|&t| is_cut_off(t, &self.triangles[t]));
            let Some(found) = found else { break };
            self.triangles.remove(found);
            self.state();
        }
        let used: BTreeSet<usize> = self.triangles.as_flattened().iter().copied().collect();
        let numbers: BTreeMap<usize, usize> = used.iter().copied().zip(0..).collect();
        self.points = used.iter().map(|&v| self.points[v]).collect();
        self.triangles.iter_mut().for_each(|triangle| *triangle = triangle.map(|v| numbers[&v]));
        (self.is_cut, self.kill) = (true, kill.unwrap_or(0.0));
        self
    }

    /// The mesh as a stream, with `patch_len` triangles in a patch.
    pub fn stream(&self, patch_len: usize) -> Vec<u8> {
        let constrained = Some(Constrained { is_cut: self.is_cut, kill: self.kill });
        let grid = Coordinates::I32 { scale: [1.0; 3], offset: [0.0; 3] };
        let header = Header { constrained, ..Header::new(Kind::TriangleMesh, grid, 2, true) };
        let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
        let segments = self
            .segments
            .iter()
            .zip(3..)
            .map(|(ends, line)| Segment { line, ends: ends.map(|end| end.map(f64::from)) });
        writer.segments(&segments.collect::<Vec<_>>()).unwrap();
        let mut ids: BTreeMap<usize, u64> = BTreeMap::new();
        let chunks: Vec<_> = self.triangles.chunks(patch_len).collect();
        for (number, chunk) in chunks.iter().enumerate() {
            let first_id = ids.len() as u64;
            let mut used: Vec<usize> = chunk.as_flattened().to_vec();
            if number + 1 == chunks.len() {
                used.extend(0..self.points.len());
            }
            used.sort_unstable();
            used.dedup();
            let new: Vec<usize> = used.iter().copied().filter(|v| !ids.contains_key(v)).collect();
            ids.extend(new.iter().copied().zip(first_id..));
            let later: BTreeSet<usize> =
                chunks[number + 1..].iter().copied().flatten().flatten().copied().collect();
            let is_last = number + 1 == chunks.len();
            let mut imported: Vec<usize> = used.iter().copied().filter(|v| ids[v] < first_id).collect();
            if is_last {
                imported.retain(|v| chunk.as_flattened().contains(v));
            }
            imported.sort_by_key(|v| ids[v]);
            let locals: Vec<usize> = new.iter().chain(&imported).copied().collect();
            let local = |v: &usize| locals.iter().position(|other| other == v).unwrap() as u32;
            let sides = self.sides.range([number * patch_len, 0]..[(number + 1) * patch_len, 0]);
            writer
                .patch(&Patch {
                    first_id,
                    new: new
                        .iter()
                        .map(|&v| [self.points[v][0].into(), self.points[v][1].into(), 0.0])
                        .collect(),
                    imported: imported.iter().map(|v| ids[v]).collect(),
                    simplices: chunk.as_flattened().iter().map(local).collect(),
                    finalized: (0..)
                        .zip(&locals)
                        .filter(|(_, v)| !later.contains(v))
                        .map(|(l, _)| l)
                        .collect(),
                    sides: sides
                        .map(|(&[t, place], &segment)| {
                            [(t - number * patch_len) as u32, place as u32, segment]
                        })
                        .collect(),
                    ..Patch::default()
                })
                .unwrap();
        }
        writer.open_segments(&self.open.iter().copied().collect::<Vec<_>>()).unwrap();
        writer.end(self.points.len() as u64, 0).unwrap()
    }

    pub fn verdict(&self, patch_len: usize) -> Result<(), String> {
        match audit(&self.stream(patch_len), Standard::Canonical, None) {
            Ok(_) => Ok(()),
            Err(Verdict::Violation(violation)) => {
                Err(format!("{}: {}", violation.check.name(), violation.message))
            }
            Err(Verdict::Malformed(message)) => panic!("{message} of {self:?}"),
        }
    }
}
