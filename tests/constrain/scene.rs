//! Random points with lines between them, as streams in any order.

use spmesh_delaunay::delaunay2::triangulate;
use spmesh_delaunay::network::{Network, NetworkSegment, NetworkVertex};
use spmesh_pipeline::lines::Areas;
use spmesh_reference::peer::Peer;
use spmesh_reference::segments::{is_on, random_segments};
use spmesh_reference::sets::{Random, as_floats};
use spmesh_stream::{Coordinates, Event, Header, Kind, Patch, StreamReader, StreamWriter};
use spmesh_terrain::constrain::{Options, Stats, constrain};
use std::collections::BTreeMap;

/// Points, segments between them that do not cross, and how many of the points are in the mesh at first.
pub struct Scene {
    pub points: Vec<[i64; 2]>,
    pub segments: Vec<[u32; 2]>,
    pub first: usize,
}

/// The surface without lines.
pub fn elevation([x, y]: [i64; 2]) -> f64 {
    (2 * x - 3 * y + 5) as f64
}

/// The elevation of lines that have one.
pub const LINE: f64 = 1000.0;

impl Scene {
    pub fn random(random: &mut Random, points: Vec<[i64; 2]>, most: usize) -> Scene {
        let segments = random_segments(random, &points, most, false);
        Scene { first: points.len(), points, segments }
    }

    /// Leaves out segments with a point amid them that the mesh does not have: the point would divide them.
    pub fn with_first(mut self, first: usize) -> Scene {
        self.first = first;
        let (points, segments) = (&self.points, &mut self.segments);
        segments.retain(|ends| {
            let at = ends.map(|end| points[end as usize]);
            points[first..].iter().all(|&x| !is_on(at, x) || at.contains(&x))
        });
        self
    }

    /// Points and segments for another implementation.
    pub fn peer(&self) -> Peer {
        let ends: Vec<_> =
            self.segments.iter().map(|ends| ends.map(|end| self.points[end as usize])).collect();
        Peer::new(&self.points, &ends)
    }

    /// The segments, and the points that the mesh does not have; those that `is_hard` accepts have
    /// elevations.
    pub fn network(&self, is_hard: impl Fn(u32) -> bool) -> Network {
        let in_segments = self.segments.iter().flatten().copied();
        let mut used: Vec<u32> = in_segments.chain(self.first as u32..self.points.len() as u32).collect();
        used.sort_unstable_by_key(|&point| self.points[point as usize]);
        used.dedup();
        let vertex = |&point: &u32| NetworkVertex {
            place: self.points[point as usize].map(|c| c as f64),
            z: is_hard(point).then_some(LINE),
        };
        let number = |point: u32| used.iter().position(|&other| other == point).unwrap() as u32;
        let mut segments: Vec<NetworkSegment> = (0..)
            .zip(&self.segments)
            .map(|(line, ends)| {
                let is_hard = ends.iter().all(|&end| is_hard(end));
                let mut ends = ends.map(number);
                ends.sort_unstable();
                NetworkSegment { ends, line, is_hard }
            })
            .collect();
        segments.sort_unstable_by_key(|segment| segment.ends);
        Network { vertices: used.iter().map(vertex).collect(), segments, step: 1.0 }
    }

    /// Whether a place is within three quarters of a step of a segment of the network with elevations.
    pub fn is_amid_hard(&self, place: [i64; 2], network: &Network) -> bool {
        let hard = network.segments.iter().filter(|segment| segment.is_hard);
        hard.map(|segment| network.places(segment).map(|end| end.map(|c| c as i128))).any(|[a, b]| {
            let minus = |p: [i128; 2]| [p[0] - a[0], p[1] - a[1]];
            let ([dx, dy], [x, y]) = (minus(b), minus(place.map(i128::from)));
            let (square, along, across) = (dx * dx + dy * dy, dx * x + dy * y, dx * y - dy * x);
            (0..=square).contains(&along) && 16 * across * across <= 9 * square
        })
    }

    /// The Delaunay triangulation of the first points as a stream: triangles in any order, in patches of any
    /// size.
    pub fn stream(&self, random: &mut Random) -> Vec<u8> {
        let mesh = triangulate(&as_floats(&self.points[..self.first])).unwrap();
        let mut triangles: Vec<[u32; 3]> = mesh.simplices().collect();
        random.shuffle(&mut triangles);
        let mut uses = vec![0; self.first];
        triangles.iter().flatten().for_each(|&vertex| uses[vertex as usize] += 1);
        let mut ids: Vec<Option<u64>> = vec![None; self.first];
        let grid = Coordinates::I32 { scale: [1.0; 3], offset: [0.0; 3] };
        let mut writer =
            StreamWriter::new(Vec::new(), Header::new(Kind::TriangleMesh, grid, 2, true)).unwrap();
        let mut next = 0;
        while !triangles.is_empty() {
            let count = (random.integer(1, 9) as usize).min(triangles.len());
            let part: Vec<[u32; 3]> = triangles.drain(..count).collect();
            let mut patch = Patch { first_id: next, ..Patch::default() };
            let mut vertices: Vec<u32> = part.iter().flatten().copied().collect();
            vertices.sort_unstable();
            vertices.dedup();
            for &vertex in vertices.iter().filter(|&&vertex| ids[vertex as usize].is_none()) {
                let [x, y] = self.points[vertex as usize];
                patch.new.push([x as f64, y as f64, elevation([x, y])]);
            }
            let known = vertices.iter().filter_map(|&vertex| ids[vertex as usize]);
            patch.imported = known.collect();
            patch.imported.sort_unstable();
            for &vertex in &vertices {
                let id = &mut ids[vertex as usize];
                if id.is_none() {
                    *id = Some(next);
                    next += 1;
                }
            }
            let local = |vertex: u32| {
                let id = ids[vertex as usize].unwrap();
                let imported = || patch.new.len() as u64 + patch.imported.binary_search(&id).unwrap() as u64;
                id.checked_sub(patch.first_id).unwrap_or_else(imported) as u32
            };
            patch.simplices = part.iter().flatten().map(|&vertex| local(vertex)).collect();
            part.iter().flatten().for_each(|&vertex| uses[vertex as usize] -= 1);
            patch.finalized =
                vertices.iter().filter(|&&vertex| uses[vertex as usize] == 0).map(|&v| local(v)).collect();
            patch.finalized.sort_unstable();
            writer.patch(&patch).unwrap();
        }
        writer.end(next, 0).unwrap()
    }
}

/// A mesh with lines: triangles by places, and elevations.
pub struct Constrained {
    pub triangles: Vec<[[i64; 2]; 3]>,
    pub elevations: BTreeMap<[i64; 2], f64>,
    pub stats: Stats,
}

/// Runs the filter, and checks that its output is a stream that finalizes all vertices.
pub fn run(stream: &[u8], network: &Network) -> Constrained {
    let mut reader = StreamReader::new(stream, "mesh").unwrap();
    let (bytes, stats) =
        constrain(&mut reader, network, &Areas::default(), Vec::new(), &Options::default(), |_| ()).unwrap();
    let mut reader = StreamReader::new(&bytes[..], "constrained").unwrap();
    let mut rules = spmesh_stream::MemoryRules::new(reader.header());
    let mut points: Vec<[f64; 3]> = Vec::new();
    let mut triangles = Vec::new();
    while let Some(event) = reader.next_event().unwrap() {
        rules.check(&event).unwrap();
        if let Event::Patch(patch) = event {
            points.extend(&patch.new);
            let ids = patch.triangles().map(|corners| corners.map(|local| patch.id(local) as usize));
            triangles.extend(ids);
        }
    }
    let place = |id: usize| [points[id][0] as i64, points[id][1] as i64];
    let elevations: BTreeMap<[i64; 2], f64> =
        (0..points.len()).map(|id| (place(id), points[id][2])).collect();
    assert_eq!(elevations.len(), points.len(), "no place twice");
    Constrained { triangles: triangles.into_iter().map(|ids| ids.map(place)).collect(), elevations, stats }
}
