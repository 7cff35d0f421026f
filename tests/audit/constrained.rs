//! Constrained meshes by brute force: the audit passes them and refuses every fault that is planted.

use std::collections::{BTreeMap, BTreeSet};

use spmesh_audit::Standard;
use spmesh_stream::{Constrained, Coordinates, Header, Kind, Patch, Segment, StreamWriter};

use super::reference::Random;
use super::{Verdict, audit};

type Place = [i32; 2];

/// A mesh with its segments, as a stream states them.
#[derive(Debug, Clone, PartialEq)]
pub struct ConstrainedMesh {
    points: Vec<Place>,
    segments: Vec<[Place; 2]>,
    triangles: Vec<[usize; 3]>,
    /// The segment of a side, by triangle and place.
    sides: BTreeMap<[usize; 2], u32>,
    open: BTreeSet<u32>,
    is_cut: bool,
    kill: f64,
}

fn turn(a: Place, b: Place, c: Place) -> i64 {
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
fn are_apart(points: &[Place], s: [Place; 2], t: [Place; 2]) -> bool {
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
    /// The mesh of points and segments that have nothing in common but ends, and whose ends are points or leave
    /// the hull in line with two points.
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
    fn state(&mut self) {
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
    fn cut(mut self, kill: Option<f64>) -> ConstrainedMesh {
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
                })
                .unwrap();
        }
        writer.open_segments(&self.open.iter().copied().collect::<Vec<_>>()).unwrap();
        writer.end(self.points.len() as u64, 0).unwrap()
    }

    fn verdict(&self, patch_len: usize) -> Result<(), String> {
        match audit(&self.stream(patch_len), Standard::Canonical, None) {
            Ok(_) => Ok(()),
            Err(Verdict::Violation(violation)) => {
                Err(format!("{}: {}", violation.check.name(), violation.message))
            }
            Err(Verdict::Malformed(message)) => panic!("{message} of {self:?}"),
        }
    }
}

/// Random points and segments between them, some of them through other points or out of the hull.
fn random_mesh(random: &mut Random) -> ConstrainedMesh {
    let side = [4, 6, 30][random.below(3)];
    let count = 4 + random.below(9);
    let points = random.distinct_points(count, side);
    let mut segments: Vec<[Place; 2]> = Vec::new();
    let is_hull = |p: Place, q: Place| points.iter().all(|&r| turn(p, q, r) >= 0);
    for _ in 0..random.below(8) {
        let (i, j) = (random.below(points.len()), random.below(points.len()));
        let [p, mut q] = [points[i], points[j]];
        let is_corner = points.iter().any(|&r| r != q && is_hull(q, r));
        if p == q
            || is_corner && random.below(3) == 0 && {
                // Beyond a corner of the hull, if that leaves the hull.
                let beyond = [2 * q[0] - p[0], 2 * q[1] - p[1]];
                let leaves = points.iter().any(|&r| r != q && is_hull(q, r) && turn(q, r, beyond) < 0)
                    || points.iter().any(|&r| r != q && is_hull(r, q) && turn(r, q, beyond) < 0);
                q = if leaves { beyond } else { q };
                false
            }
        {
            continue;
        }
        if segments.iter().all(|&other| are_apart(&points, [p, q], other)) {
            segments.push([p, q]);
        }
    }
    ConstrainedMesh::new(points, segments)
}

#[test]
fn constrained_meshes_pass() {
    let (mut segments, mut open, mut cut) = (0, 0, 0);
    for seed in 0..600 {
        let mut random = Random::new(seed);
        let mesh = random_mesh(&mut random);
        if mesh.triangles.is_empty() {
            continue;
        }
        (segments, open) = (segments + mesh.segments.len(), open + mesh.open.len());
        let patch_len = 1 + random.below(4);
        mesh.verdict(patch_len).unwrap_or_else(|e| panic!("seed {seed}: {e}\n{mesh:?}"));
        let kill = 1.0 + random.below(8) as f64;
        for kill in [Some(kill), None] {
            let less = mesh.clone().cut(kill);
            if !less.triangles.is_empty() {
                cut += usize::from(less.triangles.len() < mesh.triangles.len());
                less.verdict(patch_len)
                    .unwrap_or_else(|e| panic!("seed {seed}, cut {kill:?}: {e}\n{less:?}"));
            }
        }
    }
    assert!(segments > 1000 && open > 30 && cut > 100, "{segments} segments, {open} open, {cut} cut");
}

#[test]
fn what_passes_is_the_constrained_triangulation() {
    let (mut refused, mut passed) = (0, 0);
    for seed in 0..500 {
        let mut random = Random::new(seed);
        let right = random_mesh(&mut random);
        if right.triangles.len() < 2 {
            continue;
        }
        for _ in 0..20 {
            let mut mesh = right.clone();
            (0..=random.below(2)).for_each(|_| mutate(&mut mesh, &mut random));
            let same = |m: &ConstrainedMesh| {
                let mut sides: Vec<_> = m
                    .sides
                    .iter()
                    .map(|(&[t, place], &s)| ([1, 2].map(|k| m.triangles[t][(place + k) % 3]), s))
                    .collect();
                sides.sort_unstable();
                let mut triangles: Vec<_> = m
                    .triangles
                    .iter()
                    .map(|t| {
                        let mut t = *t;
                        t.sort_unstable();
                        t
                    })
                    .collect();
                triangles.sort_unstable();
                (triangles, sides, m.open.clone())
            };
            match mesh.verdict(1 + random.below(3)) {
                Ok(()) => {
                    assert_eq!(same(&mesh), same(&right), "seed {seed}");
                    passed += 1;
                }
                Err(message) => {
                    assert_ne!(same(&mesh), same(&right), "seed {seed}: {message}");
                    refused += 1;
                }
            }
        }
    }
    assert!(refused > 3000 && passed > 20, "{refused} refused, {passed} passed");
}

/// Changes the mesh, not its points and segments.
fn mutate(mesh: &mut ConstrainedMesh, random: &mut Random) {
    let (t, place) = (random.below(mesh.triangles.len()), random.below(3));
    let some_side = mesh.sides.keys().nth(random.below(mesh.sides.len().max(1))).copied();
    match (random.below(8), some_side) {
        (0, _) => flip(mesh, t, place),
        (1, Some([t, place])) => flip(mesh, t, place),
        (2, Some(side)) => drop(mesh.sides.remove(&side)),
        (3, Some(side)) => {
            let other = random.below(mesh.segments.len()) as u32;
            mesh.sides.insert(side, other);
        }
        (4, Some(_)) => drop(mesh.sides.insert([t, place], random.below(mesh.segments.len()) as u32)),
        (5, Some([t, place])) => {
            // On both sides.
            let [a, b] = [1, 2].map(|k| mesh.triangles[t][(place + k) % 3]);
            let triangles = mesh.triangles.clone();
            mesh.sides.retain(|&[t, place], _| {
                let ends = [1, 2].map(|k| triangles[t][(place + k) % 3]);
                ends != [a, b] && ends != [b, a]
            });
        }
        (6, _) if !mesh.segments.is_empty() => {
            let number = random.below(mesh.segments.len()) as u32;
            if !mesh.open.remove(&number) {
                mesh.open.insert(number);
            }
        }
        (_, Some(side)) => {
            let segment = mesh.sides[&side];
            mesh.sides.retain(|_, other| *other != segment);
        }
        _ => flip(mesh, t, place),
    }
}

/// Flips the edge opposite to a corner, if that leaves counterclockwise triangles.
fn flip(mesh: &mut ConstrainedMesh, t: usize, place: usize) {
    let [c, a, b] = [0, 1, 2].map(|k| mesh.triangles[t][(place + k) % 3]);
    let has_twin = |other: &[usize; 3]| (0..3).any(|k| other[k] == b && other[(k + 1) % 3] == a);
    let Some(other) = mesh.triangles.iter().position(has_twin) else { return };
    let d = *mesh.triangles[other].iter().find(|v| ![a, b].contains(v)).unwrap();
    let [pa, pb, pc, pd] = [a, b, c, d].map(|v| mesh.points[v]);
    if turn(pa, pd, pc) <= 0 || turn(pd, pb, pc) <= 0 {
        return;
    }
    let stated: BTreeMap<[usize; 2], u32> = [t, other]
        .iter()
        .flat_map(|&t| (0..3).map(move |place| [t, place]))
        .filter_map(|side| {
            let ends = [1, 2].map(|k| mesh.triangles[side[0]][(side[1] + k) % 3]);
            Some((ends, mesh.sides.remove(&side)?))
        })
        .collect();
    (mesh.triangles[t], mesh.triangles[other]) = ([a, d, c], [d, b, c]);
    for t in [t, other] {
        for place in 0..3 {
            let ends = [1, 2].map(|k| mesh.triangles[t][(place + k) % 3]);
            if let Some(&segment) = stated.get(&ends) {
                mesh.sides.insert([t, place], segment);
            }
        }
    }
}

/// A square of two triangles whose diagonal is on a segment, although it is not the canonical one.
fn square() -> ConstrainedMesh {
    let points = vec![[0, 0], [4, 0], [0, 4], [4, 4], [2, 9]];
    let segments = vec![[[0, 0], [4, 4]], [[4, 4], [0, 4]]];
    ConstrainedMesh::new(points, segments)
}

fn refusal(change: impl FnOnce(&mut ConstrainedMesh)) -> String {
    let mut mesh = square();
    mesh.verdict(1).unwrap();
    change(&mut mesh);
    mesh.verdict(1).expect_err("a fault")
}

#[test]
fn faults_are_named() {
    let mesh = square();
    let side = *mesh.sides.iter().find(|&(_, &segment)| segment == 0).unwrap().0;
    let message = refusal(|mesh| drop(mesh.sides.remove(&side)));
    assert!(message.contains("is on") && message.contains("for one of its triangles"), "{message}");
    let message = refusal(|mesh| mesh.segments[0][1] = [4, 3]);
    assert!(message.contains("is not on segment 0"), "{message}");
    let message = refusal(|mesh| mesh.segments[0][1] = [5, 5]);
    assert!(message.contains("edges do not cover segment 0: a chain of them ends at vertex"), "{message}");
    let message = refusal(|mesh| drop(mesh.open.insert(0)));
    assert!(message.contains("segment 0 is open, but edges cover it"), "{message}");
    let message = refusal(|mesh| mesh.segments.push([[4, 0], [0, 4]]));
    assert!(message.contains("edges do not cover segment 2"), "{message}");
    let message = refusal(|mesh| {
        mesh.segments.push([[4, 0], [0, 4]]);
        mesh.open.insert(2);
    });
    assert!(message.contains("segment 2 is open, but it lies in the convex hull"), "{message}");
    let message = refusal(|mesh| flip(mesh, side[0], side[1]));
    assert!(message.contains("edges do not cover segment 0"), "{message}");
}

#[test]
fn borders_are_those_that_cutting_leaves() {
    // A long thin triangle at the bottom of a square.
    let points = vec![[0, 0], [100, 0], [50, 1], [0, 100], [100, 100]];
    let mesh = ConstrainedMesh::new(points, vec![[[0, 0], [0, 100]]]);
    let cut = mesh.clone().cut(Some(60.0));
    assert!(cut.triangles.is_empty() || cut.verdict(2).is_ok());
    let too_long = ConstrainedMesh { is_cut: true, kill: 60.0, ..mesh.clone() };
    assert!(too_long.verdict(2).unwrap_err().contains("longer than 60"));
    // A notch in the hull, without a segment or a kill length.
    let mut notched = ConstrainedMesh { is_cut: true, ..mesh.clone() };
    notched.verdict(1).unwrap();
    notched.triangles.retain(|triangle| !(triangle.contains(&0) && triangle.contains(&1)));
    notched.state();
    assert!(notched.verdict(1).unwrap_err().contains("neither on a segment nor on the hull"));
    notched.kill = 200.0;
    notched.verdict(1).unwrap();
    notched.is_cut = false;
    notched.kill = 0.0;
    assert!(notched.verdict(1).unwrap_err().starts_with("hull"));
}

/// Two triangles that overlap although every edge is used once.
#[test]
fn overlapping_parts_of_a_cut_mesh_are_found() {
    let mesh = |points: Vec<Place>| ConstrainedMesh {
        triangles: vec![[0, 1, 2], [3, 4, 5]],
        points,
        segments: Vec::new(),
        sides: BTreeMap::new(),
        open: BTreeSet::new(),
        is_cut: true,
        kill: 100.0,
    };
    let first = [[0, 0], [9, 0], [0, 9]];
    mesh([first, [[10, 0], [10, 9], [1, 9]]].concat()).verdict(1).unwrap();
    for second in [[[1, 1], [3, 1], [1, 3]], [[4, 1], [12, 9], [3, 9]], [[-3, -3], [30, -3], [-3, 30]]] {
        let message = mesh([first, second].concat()).verdict(1).unwrap_err();
        assert!(message.starts_with("border"), "{message}");
    }
    for (second, fault) in [
        ([[0, 9], [9, 0], [9, 9]], "coincide"),
        ([[4, 5], [9, 9], [1, 9]], "is on the edge"),
        ([[9, 0], [12, 3], [9, 3]], "coincide"),
    ] {
        let message = mesh([first, second].concat()).verdict(1).unwrap_err();
        assert!(message.contains(fault), "{message}");
    }
}
