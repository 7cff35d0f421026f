//! Tetrahedra: the reduction in space.

use std::borrow::Cow;
use std::collections::HashSet;
use std::convert::Infallible;
use std::num::NonZeroUsize;

use super::bulk::{Bulk, Facet, WallSide};
use super::residual::Residual;
use super::walls::{self, WallIndex};
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_base::prefetch::prefetch;
use spmesh_delaunay as delaunay;
use spmesh_delaunay::delaunay3::{Corner, Corners, Kernel, Tetrahedralization, Tetrahedron, turned};
use spmesh_delaunay::order::sizes_to_starts;
use spmesh_delaunay::parallel;
use spmesh_delaunay::predicates::PredicateCounts;
use spmesh_delaunay::predicates::sphere::{SphereBounds, centre_is_inside};
use spmesh_delaunay::simplex::TETRAHEDRON_FACETS_FROM_INSIDE;
use spmesh_stream::model::bounds::Region;
use spmesh_stream::{Coordinates, Kind, Weights};

/// Distance of the prefetch, in tetrahedra.
const AHEAD: usize = 12;

/// Bytes of a tetrahedron that is being made and written.
const TETRAHEDRON_BYTES: usize = 64;

/// Tetrahedra that a thread searches in one go.
const PIECE: usize = 1 << 16;

/// The kernel of space and its tetrahedralization.
#[derive(Default)]
pub(super) struct Space {
    kernel: Kernel,
    mesh: Tetrahedralization,
    /// The weight of each point; empty without weights.
    weights: Vec<f64>,
    /// The tetrahedra, ordered along the curve by their last vertex: in the mesh, insertion in rounds has
    /// scattered them.
    sequence: Vec<u32>,
    /// Whether the kernel may have several threads, so that the order in the mesh may depend on them.
    is_shared: bool,
    /// Bytes beyond those of each point; `None` without a limit.
    spare: Option<u64>,
    hull: Vec<Facet>,
    walls: WallIndex,
}

/// The test of whether a ball lies in a region.
pub(super) struct Balls {
    bounds: SphereBounds,
    region: Region<3>,
    /// The greatest weight of all points, if they have weights.
    greatest: Option<f64>,
}

impl Space {
    /// Number of tetrahedra of so many points that there is memory for.
    fn most(&self, points: usize) -> usize {
        let bytes = (Space::KERNEL_BYTES * points) as u64;
        self.spare.map_or(usize::MAX, |spare| ((bytes + spare) / TETRAHEDRON_BYTES as u64) as usize)
    }

    /// The error of the kernel for so many points.
    fn refused(&self, error: delaunay::Error, points: usize) -> Error {
        match (error, self.spare) {
            (delaunay::Error::TooManyTetrahedra(so_far), Some(_)) => {
                let why = "their number grows with the square of that of points on curves or lines";
                let message =
                    format!("{points} points have {so_far} tetrahedra so far, which --memory has no");
                Error::new(
                    ErrorKind::Memory,
                    format!("{message} room for: {why}; raise it, or thin the points"),
                )
            }
            (error, _) => Error::of_computation(error),
        }
    }

    fn find_hull(&mut self) {
        self.hull.clear();
        for (simplex, tetrahedron) in (0..).zip(self.mesh.tetrahedra()) {
            let open = (0..4).filter(|&corner| tetrahedron.neighbour(corner as usize).is_none());
            self.hull.extend(open.map(|corner| Facet { simplex, corner }));
        }
    }
}

impl Space {
    /// The corners of the tetrahedra that a region owns, whose circumcentres are in its box, in an order that
    /// does not depend on the threads.
    ///
    /// Points before `own` are in no other region. So all their tetrahedra are this region's.
    pub(super) fn take_owned(
        &mut self,
        own: u64,
        region: &Region<3>,
        bounds: SphereBounds,
    ) -> Result<Corners> {
        let vertices = self.mesh.vertices();
        let owns = |tetrahedron: &Tetrahedron| {
            let corners = tetrahedron.vertices.map(|vertex| &vertices[vertex as usize]);
            corners.iter().any(|corner| u64::from(corner.index) < own)
                || centre_is_inside(bounds, corners.map(|corner| corner.at), region.sides())
        };
        let pieces = self.mesh.tetrahedra().chunks(PIECE);
        let owned = |piece: &[Tetrahedron]| Ok::<Vec<bool>, Infallible>(piece.iter().map(owns).collect());
        let Ok(owned) = parallel::map(self.kernel.threads, pieces, owned);
        let mut mesh = std::mem::take(&mut self.mesh);
        self.mesh.duplicates = std::mem::take(&mut mesh.duplicates);
        let keep = |tetrahedron: usize| owned[tetrahedron / PIECE][tetrahedron % PIECE];
        mesh.into_corners(keep, self.kernel.threads).map_err(Error::of_computation)
    }
}

impl Space {
    /// The number of the first wall that is no facet; there must be one. `index` has all walls.
    #[cold]
    fn missing(&self, walls: &[[u32; 3]], index: &WallIndex) -> usize {
        let mut found = HashSet::new();
        for side in find_walls(index, 0, self.mesh.tetrahedra()) {
            let (WallSide::Final(facet) | WallSide::Open(facet)) = side;
            let mut wall = self.wall(facet);
            if matches!(side, WallSide::Open(_)) {
                wall.swap(0, 1);
            }
            found.insert(walls::turned(wall));
        }
        walls.iter().position(|&wall| !found.contains(&walls::turned(wall))).unwrap_or(0)
    }
}

/// The walls among the facets of tetrahedra, of which the first has the number `first`.
fn find_walls(index: &WallIndex, first: usize, tetrahedra: &[Tetrahedron]) -> Vec<WallSide> {
    let mut sides = Vec::new();
    for (simplex, tetrahedron) in (first as u32..).zip(tetrahedra) {
        for (corner, facet) in (0..).zip(TETRAHEDRON_FACETS_FROM_INSIDE) {
            let side = Facet { simplex, corner };
            let [a, b, c] = facet.map(|i| tetrahedron.vertices[i]);
            if index.contains([a, b, c]) {
                sides.push(WallSide::Final(side));
            } else if tetrahedron.neighbour(corner as usize).is_none() && index.contains([b, a, c]) {
                sides.push(WallSide::Open(side));
            }
        }
    }
    sides
}

/// The bounds of errors for stored coordinates.
pub(super) fn sphere_bounds(coordinates: &Coordinates) -> SphereBounds {
    match coordinates {
        Coordinates::F64 => SphereBounds::FLOAT,
        Coordinates::I32 { .. } => SphereBounds::INTEGER,
    }
}

impl Bulk<3> for Space {
    type Corners = [u32; 4];
    type Balls = Balls;

    const MESH: Kind = Kind::TetrahedralMesh;
    const PARTIAL_MESH: Kind = Kind::PartialTetrahedralMesh;
    const RESIDUAL: Kind = Kind::TetrahedralResidual;
    const SIMPLEX: &'static str = "tetrahedron";
    const FACET: &'static str = "facet";
    const TRIANGULATION: &'static str = "tetrahedralization";
    const WAITING_BYTES: usize = 130;
    const KERNEL_BYTES: usize = 640;
    const KEPT_POINTS_MAX: usize = usize::MAX;
    const KEPT_BLOCKS_MAX: usize = 4 << 20;
    const SAMPLED_MIN: usize = 50_000;
    const PASSES_FEW: bool = true;
    const SURFACE_MAX: usize = 1 << 18;

    fn share(&mut self, threads: NonZeroUsize) {
        self.kernel.threads = threads;
        self.is_shared = true;
    }

    fn allow(&mut self, bytes: u64) {
        self.spare = (bytes < u64::MAX).then_some(bytes);
    }

    fn shrink(&mut self, points: usize) {
        if self.mesh.tetrahedra().len() * TETRAHEDRON_BYTES > Space::KERNEL_BYTES * points {
            self.mesh = Tetrahedralization::default();
            (self.sequence, self.hull) = (Vec::new(), Vec::new());
        }
    }

    fn triangulate(&mut self, points: &Residual<3>, weights: Option<Weights>) -> Result<()> {
        self.weights.clear();
        self.kernel.tetrahedra_max = self.most(points.len());
        let at = Cow::Borrowed(&points.at[..]);
        let done = match weights {
            Some(weights) => {
                self.weights.extend(weights.read(&points.rows));
                self.kernel.triangulate_weighted(at, &self.weights, &mut self.mesh)
            }
            None => self.kernel.triangulate(at, &mut self.mesh),
        };
        done.map_err(|error| self.refused(error, points.len()))?;
        self.find_hull();
        Ok(())
    }

    /// By a counting sort.
    fn arrange(&mut self) {
        let tetrahedra = self.mesh.tetrahedra();
        let last = |vertices: [u32; 4]| vertices.into_iter().fold(0, u32::max) as usize;
        // For each vertex, the places of the tetrahedra whose last vertex it is.
        let mut places = vec![0u32; self.mesh.vertices().len()];
        tetrahedra.iter().for_each(|tetrahedron| places[last(tetrahedron.vertices)] += 1);
        sizes_to_starts(&mut places);
        self.sequence.resize(tetrahedra.len(), 0);
        for (t, tetrahedron) in (0..).zip(tetrahedra) {
            let place = &mut places[last(tetrahedron.vertices)];
            self.sequence[*place as usize] = t;
            *place += 1;
        }
        if self.is_shared {
            let mut start = 0;
            for end in places {
                let equal = &mut self.sequence[start..end as usize];
                equal.sort_unstable_by_key(|&t| turned(tetrahedra[t as usize].vertices));
                start = end as usize;
            }
        }
    }

    fn take_written(&mut self, keep: impl Fn(usize) -> bool) -> Result<Option<Corners>> {
        if !self.is_shared {
            return Ok(None);
        }
        let mut mesh = std::mem::take(&mut self.mesh);
        self.mesh.duplicates = std::mem::take(&mut mesh.duplicates);
        self.mesh.hidden = std::mem::take(&mut mesh.hidden);
        self.hull.clear();
        mesh.into_corners(keep, self.kernel.threads).map(Some).map_err(Error::of_computation)
    }

    fn duplicates(&mut self) -> &mut Vec<[u32; 2]> {
        &mut self.mesh.duplicates
    }

    fn hidden(&self) -> &[u32] {
        &self.mesh.hidden
    }

    fn len(&self) -> usize {
        self.mesh.tetrahedra().len()
    }

    #[inline]
    fn nth(&self, k: usize) -> u32 {
        // Neighbours in the sequence are scattered over the array: without the prefetch, half of the time is
        // spent waiting.
        if let Some(&ahead) = self.sequence.get(k + AHEAD) {
            prefetch(self.mesh.tetrahedra(), ahead as usize);
        }
        self.sequence[k]
    }

    #[inline]
    fn corners(&self, tetrahedron: u32) -> [u32; 4] {
        let vertices = self.mesh.vertices();
        self.mesh.tetrahedra()[tetrahedron as usize].vertices.map(|v| vertices[v as usize].index)
    }

    fn written(&self, tetrahedron: u32) -> [u32; 4] {
        let corners = self.mesh.tetrahedra()[tetrahedron as usize].vertices;
        let corners = if self.is_shared { turned(corners) } else { corners };
        corners.map(|v| self.mesh.vertices()[v as usize].index)
    }

    #[inline]
    fn neighbour(&self, Facet { simplex, corner }: Facet) -> Option<Facet> {
        let beyond = self.mesh.tetrahedra()[simplex as usize].neighbour(corner as usize);
        beyond.map(|Corner { tetrahedron: simplex, corner }| Facet { simplex, corner })
    }

    fn hull_vertices(&self) -> impl Iterator<Item = u32> {
        // Without tetrahedra, all vertices are on the hull.
        let flat = if self.mesh.tetrahedra().is_empty() { self.mesh.vertices() } else { &[] };
        flat.iter().map(|vertex| vertex.index).chain(self.hull.iter().flat_map(|&facet| self.wall(facet)))
    }

    fn hull_facets(&self) -> impl Iterator<Item = Facet> {
        self.hull.iter().copied()
    }

    fn find(
        &mut self,
        walls: &[[u32; 3]],
        mut found: impl FnMut(WallSide),
    ) -> std::result::Result<(), usize> {
        if walls.is_empty() {
            return Ok(());
        }
        let mut index = std::mem::take(&mut self.walls);
        let vertices = self.mesh.vertices().iter().map(|vertex| vertex.index);
        index.fill(walls, vertices.len() + self.mesh.duplicates.len(), vertices);
        let pieces = self.mesh.tetrahedra().chunks(PIECE).enumerate();
        let search = |(number, piece)| Ok::<_, Infallible>(find_walls(&index, number * PIECE, piece));
        let Ok(sides) = parallel::map(self.kernel.threads, pieces, search);
        let count: usize = sides.iter().map(Vec::len).sum();
        sides.into_iter().flatten().for_each(&mut found);
        let result = if count == walls.len() { Ok(()) } else { Err(self.missing(walls, &index)) };
        self.walls = index;
        result
    }

    fn wall(&self, Facet { simplex, corner }: Facet) -> [u32; 3] {
        let vertices = self.corners(simplex);
        TETRAHEDRON_FACETS_FROM_INSIDE[corner as usize].map(|i| vertices[i])
    }

    fn balls(coordinates: &Coordinates, region: Region<3>, weights: Option<Weights>) -> Balls {
        let bounds = sphere_bounds(coordinates);
        Balls { bounds, region, greatest: weights.map(|weights| weights.greatest()) }
    }

    #[inline]
    fn is_inside(&self, tetrahedron: u32, _points: &Residual<3>, balls: &Balls) -> bool {
        let vertices = self.mesh.vertices();
        let corners = self.mesh.tetrahedra()[tetrahedron as usize].vertices.map(|v| &vertices[v as usize]);
        let at = corners.map(|vertex| vertex.at);
        let Some(greatest) = balls.greatest else {
            return balls.bounds.ball_inside(at, balls.region.sides());
        };
        let weights = corners.map(|vertex| self.weights[vertex.index as usize]);
        balls.bounds.power_ball_inside(at, weights, greatest, balls.region.sides())
    }

    fn counts(&self) -> &PredicateCounts {
        self.kernel.counts()
    }
}
