//! The triangulation while points are inserted.

use super::cavity::Cavity;
use super::mesh::Mesh;
use super::options::Options;
use super::phase_timer::PhaseTimer;
use super::star::Star;
use super::stats::Stats;
use spmesh_base::random::Random;
use spmesh_delaunay::delaunay3::Vertex;

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
