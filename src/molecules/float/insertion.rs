//! Insertion of points: the tetrahedra in conflict with a point give way to a star around it.

use std::time::Instant;

use super::Options;
use super::cavity::Cavity;
use super::mesh::{MAX_TETRAHEDRA, Mesh, Tetrahedron, corner_of, facet, faraway_corner, tetrahedron_of};
use super::phase_timer::{Phase, PhaseTimer, Stats};
use super::star::Star;
use spmesh_base::random::Random;
use spmesh_delaunay::delaunay3::{self, Vertex};
use spmesh_delaunay::order::{Insertions, SpatialOrder, Suffixes};
use spmesh_delaunay::predicates::{Extent, Point3};
use spmesh_delaunay::{Error, Result};

impl State<'_> {
    /// Inserts the other vertices: the finite tetrahedra, and what was done.
    pub(super) fn run(mut self, insertions: Insertions) -> Result<(Vec<delaunay3::Tetrahedron>, Stats)> {
        let first = self.mesh.tetrahedra[0].vertices;
        self.timer.begin_all();
        for v in insertions.filter(|v| !first.contains(v)) {
            self.insert(v)?;
        }
        self.timer.end_all(&mut self.stats.seconds);
        self.stats.bytes = (self.mesh.bytes() + self.cavity.bytes() + self.star.bytes()) as u64;
        let begin = Instant::now();
        let tetrahedra = self.mesh.finite();
        self.stats.missing = self.missing(&tetrahedra);
        self.stats.seconds.extract = begin.elapsed().as_secs_f64();
        Ok((tetrahedra, self.stats))
    }

    /// Inserts a vertex; leaves it out if rounding makes it impossible.
    fn insert(&mut self, v: u32) -> Result<()> {
        self.timer.begin(v);
        let seed = self.locate(self.mesh.vertices[v as usize].at);
        self.timer.end(Phase::Locate);
        if seed.is_some_and(|seed| self.find_star(v, seed) || self.repair_star(v, seed)) {
            self.replace()?;
        }
        self.timer.end(Phase::Update);
        Ok(())
    }

    /// Puts the star in the place of the cavity.
    fn replace(&mut self) -> Result<()> {
        let Cavity { tetrahedra, walls, .. } = &self.cavity;
        let Star { slots, beside, .. } = &mut self.star;
        slots.clear();
        slots.extend(tetrahedra.iter().take(walls.len()));
        tetrahedra.iter().skip(walls.len()).for_each(|&t| self.mesh.delete(t));
        while slots.len() < walls.len() {
            slots.push(self.mesh.slot().ok_or(Error::TooManyTetrahedra(MAX_TETRAHEDRA))?);
        }
        for ((wall, beside), &slot) in walls.iter().zip(beside).zip(&*slots) {
            let mut neighbours =
                beside.map(|side| facet(slots[tetrahedron_of(side) as usize], corner_of(side)));
            neighbours[0] = wall.outside;
            self.mesh.write(slot, Tetrahedron { vertices: wall.vertices, neighbours }, &wall.sphere);
            self.mesh.set_neighbour(wall.outside, facet(slot, 0));
            if faraway_corner(&wall.vertices).is_none() {
                self.start = slot;
            }
        }
        self.stats.created += walls.len() as u64;
        Ok(())
    }

    /// Counts the vertices that are in none of the `tetrahedra`.
    fn missing(&self, tetrahedra: &[delaunay3::Tetrahedron]) -> u64 {
        let mut is_there = vec![false; self.mesh.vertices.len()];
        for vertex in tetrahedra.iter().flat_map(|tetrahedron| tetrahedron.vertices) {
            is_there[vertex as usize] = true;
        }
        is_there.iter().filter(|&&is_there| !is_there).count() as u64
    }
}

/// Work per point, in tetrahedra, after which walks and cavities are kept short: rounding must not make a run
/// endless.
const WORK_PER_POINT: u64 = 10_000;

/// Tetrahedra per walk or cavity until then, and from then on.
const LONG: usize = 1 << 26;
const SHORT: usize = 1000;

/// The work that walks and cavities may still cost.
#[derive(Debug)]
pub(super) struct Patience {
    left: u64,
}

impl Patience {
    /// Greatest number of tetrahedra in a walk or a cavity, if there are `count` in all.
    #[inline(always)]
    pub(super) fn limit(&self, count: usize) -> usize {
        count.min(if self.left > 0 { LONG } else { SHORT })
    }

    /// Records that this many tetrahedra were visited.
    #[inline(always)]
    pub(super) fn spend(&mut self, tetrahedra: usize) {
        self.left = self.left.saturating_sub(tetrahedra as u64);
    }
}

/// The triangulation of the points inserted so far, and the buffers of insertions.
pub(super) struct State<'a> {
    pub(super) mesh: Mesh<'a>,
    pub(super) options: &'a Options,
    pub(super) stats: Stats,
    pub(super) random: Random,
    pub(super) cavity: Cavity,
    pub(super) patience: Patience,
    /// A finite tetrahedron made of late: where walks start.
    pub(super) start: u32,
    pub(super) star: Star,
    pub(super) timer: PhaseTimer,
}

impl<'a> State<'a> {
    /// Begins with the corners of `first`, which is positively oriented.
    pub(super) fn new(vertices: &'a [Vertex], options: &'a Options, first: [u32; 4]) -> State<'a> {
        let mesh = Mesh::new(vertices, first, options.cache_spheres);
        State {
            stats: Stats { created: mesh.tetrahedra.len() as u64, ..Stats::default() },
            mesh,
            options,
            random: Random::new(options.seed),
            cavity: Cavity::default(),
            patience: Patience { left: WORK_PER_POINT * vertices.len() as u64 },
            start: 0,
            star: Star::new(vertices.len()),
            timer: PhaseTimer::default(),
        }
    }
}

/// Distinct points, and what was found when they were put in order.
pub(super) struct Sorted {
    /// In order along the curve.
    pub(super) vertices: Vec<Vertex>,
    /// Indices of other points, with those of their equals.
    pub(super) duplicates: Vec<[u32; 2]>,
    /// The vertices as they are to be inserted.
    pub(super) insertions: Insertions,
}

/// Puts points in order. Domain: finite coordinates, whose extent is `extent`.
pub(super) fn sort(points: &[Point3], extent: &Extent<3>, options: &Options) -> Sorted {
    let mut vertices: Vec<Vertex> = Vec::with_capacity(points.len());
    let mut duplicates = Vec::new();
    for index in SpatialOrder::default().sort(points, extent, options.curve) {
        let at = points[index as usize];
        match vertices.last() {
            Some(last) if last.at == at => duplicates.push([index, last.index]),
            _ => vertices.push(Vertex::new(at, index)),
        }
    }
    let insertions = if options.by_bit_levels {
        let points: Vec<Point3> = vertices.iter().map(|vertex| vertex.at).collect();
        options.sequence.by_levels(&points, Suffixes::MostCommon)
    } else {
        options.sequence.of(vertices.len())
    };
    Sorted { vertices, duplicates, insertions }
}
