//! A mesh stream as read from its bytes, checked by exact predicates that share no code with the program.

use std::collections::HashMap;

use spmesh_stream::{Coordinates, Event, Kind, StreamReader};

/// A mesh as read from a stream.
pub struct Mesh {
    pub points: Vec<[i64; 3]>,
    pub labels: Vec<u64>,
    pub tetrahedra: Vec<[usize; 4]>,
    pub merged: u64,
    pub patches: usize,
    /// The greatest number of live vertices.
    pub width: usize,
    pub producer: String,
}

impl Mesh {
    /// Reads a stream of integer coordinates; each vertex must be finalized once, and not be used after that.
    pub fn read(bytes: &[u8]) -> Mesh {
        let mut reader = StreamReader::new(bytes, "mesh").unwrap();
        let header = reader.header().clone();
        assert_eq!(header.kind, Kind::TetrahedralMesh);
        assert_eq!((header.dims, header.has_elevation), (3, false));
        assert!(matches!(header.coordinates, Coordinates::I32 { .. } | Coordinates::F64));
        let mut mesh = Mesh {
            points: Vec::new(),
            labels: Vec::new(),
            tetrahedra: Vec::new(),
            merged: 0,
            patches: 0,
            width: 0,
            producer: header.producer,
        };
        let mut is_final: Vec<bool> = Vec::new();
        let mut live = 0;
        let mut stored: Vec<[f64; 3]> = Vec::new();
        while let Some(event) = reader.next_event().unwrap() {
            match event {
                Event::Patch(patch) => {
                    mesh.patches += 1;
                    stored.extend(&patch.new);
                    mesh.points.extend(patch.new.iter().map(|point| point.map(|value| value as i64)));
                    is_final.resize(mesh.points.len(), false);
                    for tetrahedron in patch.tetrahedra() {
                        let ids = tetrahedron.map(|local| patch.id(local) as usize);
                        assert!(ids.iter().all(|&id| !is_final[id]));
                        mesh.tetrahedra.push(ids);
                    }
                    live += patch.new.len();
                    mesh.width = mesh.width.max(live);
                    live -= patch.finalized.len();
                    for &local in &patch.finalized {
                        let id = patch.id(local) as usize;
                        assert!(!std::mem::replace(&mut is_final[id], true));
                    }
                }
                Event::Labels(labels) => mesh.labels.extend(labels),
                Event::End(totals) => mesh.merged = totals.merged,
                other => panic!("{other:?}"),
            }
        }
        assert!(is_final.iter().all(|&is_final| is_final));
        assert!(mesh.labels.len() == mesh.points.len() || mesh.labels.is_empty());
        if let Some(bounds) = header.bounds {
            for axis in 0..3 {
                let values = || stored.iter().map(|point| point[axis]);
                assert_eq!(values().fold(f64::INFINITY, f64::min), bounds.min[axis]);
                assert_eq!(values().fold(f64::NEG_INFINITY, f64::max), bounds.max[axis]);
            }
        }
        mesh
    }

    /// The tetrahedra as labels, sorted.
    pub fn by_label(&self) -> Vec<[u64; 4]> {
        let sorted = |ids: &[usize; 4]| {
            let mut labels = ids.map(|id| self.labels[id]);
            labels.sort_unstable();
            labels
        };
        let mut all: Vec<_> = self.tetrahedra.iter().map(sorted).collect();
        all.sort_unstable();
        all
    }

    /// Proves that this is a Delaunay triangulation of its vertices: every tetrahedron is positively oriented
    /// and has no vertex inside its sphere, and every facet belongs to two tetrahedra or lies on the hull.
    pub fn prove(&self) {
        let mut facets: HashMap<[usize; 3], Vec<usize>> = HashMap::new();
        for t in &self.tetrahedra {
            let corners = t.map(|id| self.points[id]);
            assert!(orientation(corners) > 0, "{t:?}");
            for (id, &point) in self.points.iter().enumerate() {
                assert!(t.contains(&id) || in_sphere(corners, point) <= 0, "{id} is inside of {t:?}");
            }
            for side in 0..4 {
                let mut facet: Vec<usize> = (0..4).filter(|&i| i != side).map(|i| t[i]).collect();
                facet.sort_unstable();
                facets.entry(facet.try_into().unwrap()).or_default().push(t[side]);
            }
        }
        for (facet, opposite) in facets {
            let [a, b, c] = facet.map(|id| self.points[id]);
            let side = |id: usize| orientation([a, b, c, self.points[id]]).signum();
            match opposite[..] {
                [inner] => assert!((0..self.points.len()).all(|id| side(id) != -side(inner))),
                [one, other] => assert_eq!(side(one), -side(other)),
                _ => panic!("{} tetrahedra at a facet", opposite.len()),
            }
        }
    }
}

type Point = [i64; 3];

fn from(origin: Point, point: Point) -> [i128; 3] {
    std::array::from_fn(|axis| i128::from(point[axis] - origin[axis]))
}

fn determinant([a, b, c]: [[i128; 3]; 3]) -> i128 {
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}

/// det(b - a, c - a, d - a).
pub fn orientation([a, b, c, d]: [Point; 4]) -> i128 {
    determinant([b, c, d].map(|point| from(a, point)))
}

/// Positive if `e` is inside the sphere of a positively oriented tetrahedron. Evaluates cofactors of the
/// lifts of the differences to `e`.
pub fn in_sphere(corners: [Point; 4], e: Point) -> i128 {
    let rows = corners.map(|point| from(e, point));
    let lift = |row: [i128; 3]| row.iter().map(|value| value * value).sum::<i128>();
    let [a, b, c, d] = rows;
    lift(a) * determinant([b, c, d]) - lift(b) * determinant([a, c, d]) + lift(c) * determinant([a, b, d])
        - lift(d) * determinant([a, b, c])
}
