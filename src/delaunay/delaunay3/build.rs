//! The first tetrahedron, then point after point.

use super::complex::Complex;
use super::exact::Exact;
use super::insertion::{Buffers, Insertion, Refusal};
use super::lanes::Lanes;
use super::stats::{PhaseTimer, Stats};
use super::tetrahedralization::Vertex;
use super::weights::Weights;
use super::whole::Setting;
use crate::order::Insertions;
use crate::predicates::{Point3, Predicates3, Sign, WithPredicates3};
use crate::watch::Pace;

/// Inserts vertices into a complex, all in one arithmetic.
pub(super) struct Build<'a, 's, W> {
    pub(super) complex: &'a mut Complex<'s>,
    pub(super) setting: &'a Setting<W>,
    pub(super) buffers: &'a mut Buffers,
    pub(super) stats: &'a mut Stats,
    /// The numbers of the vertices in the order of insertion; those of `first` are skipped.
    pub(super) insertions: &'a mut Insertions,
    pub(super) first: [u32; 4],
    /// Tetrahedra of the complex that are not frozen, along the curve. The first walk starts at the first.
    pub(super) starts: &'a [u32],
    /// Takes the vertices that frozen tetrahedra, or lack of room, kept from being inserted.
    pub(super) refused: &'a mut Vec<u32>,
}

impl<W: Weights> Build<'_, '_, W> {
    /// Inserts the vertices: all but those refused, or, if there is no more room or the work is stopped, all
    /// until the one refused last.
    ///
    /// Inlined, like everything that it calls with lanes, into one function per kind of processor.
    #[inline(always)]
    pub(super) fn run<L: Lanes>(self, predicates: &mut dyn Exact, token: L::Token) {
        let Build { setting, insertions, first, starts, refused, .. } = self;
        let own = self.complex.own.clone();
        let mut start = starts.first().copied().unwrap_or(0);
        self.buffers.clear(start);
        let mut insertion = Insertion::<L, W> {
            complex: self.complex,
            weights: &setting.weights,
            predicates,
            buffers: self.buffers,
            stats: self.stats,
            timer: PhaseTimer::new(setting.is_timed),
            infinite_lift: setting.infinite_lift,
            tests: 0,
            unfiltered: 0,
            token,
        };
        let mut pace = Pace::of(setting.watch.as_deref());
        for vertex in insertions {
            if pace.is_stopped() {
                refused.push(vertex);
                break;
            }
            if first.contains(&vertex) {
                continue;
            }
            let mut is_retried = false;
            loop {
                match insertion.insert(vertex, start) {
                    Ok(next) => start = next,
                    Err(Refusal::Blocked) if !is_retried => {
                        is_retried = true;
                        let nearest = starts[(vertex - own.start) as usize * starts.len() / own.len()];
                        if !insertion.complex.is_deleted(nearest) {
                            start = nearest;
                            continue;
                        }
                        refused.push(vertex);
                    }
                    Err(Refusal::Blocked) => refused.push(vertex),
                    Err(Refusal::Frozen(next)) => {
                        refused.push(vertex);
                        start = next;
                    }
                    Err(Refusal::Full) => {
                        refused.push(vertex);
                        return insertion.finish();
                    }
                }
                break;
            }
        }
        insertion.finish();
    }
}

/// Searches the first four vertices that are not in a plane.
pub(super) struct First<'a> {
    pub(super) vertices: &'a [Vertex],
    /// The numbers of the vertices in the order of insertion.
    pub(super) insertions: Insertions,
}

impl WithPredicates3 for First<'_> {
    /// They are positively oriented.
    type Output = Option<[u32; 4]>;

    fn with(mut self, predicates: &mut impl Predicates3) -> Option<[u32; 4]> {
        let point = |v: u32| self.vertices[v as usize].at;
        let sequence = &mut self.insertions;
        let (a, b) = (sequence.next()?, sequence.next()?);
        let c = sequence.find(|&c| !is_line(point(a), point(b), point(c), predicates))?;
        let mut orientation = Sign::Zero;
        let d = sequence.find(|&d| {
            orientation = predicates.orient3d(point(a), point(b), point(c), point(d));
            orientation != Sign::Zero
        })?;
        Some(if orientation == Sign::Positive { [a, b, c, d] } else { [b, a, c, d] })
    }
}

/// Whether three points lie on a line: so do then their projections along all axes.
fn is_line(a: Point3, b: Point3, c: Point3, predicates: &mut impl Predicates3) -> bool {
    [(0, 1), (1, 2), (2, 0)].into_iter().all(|(i, j)| {
        let [p, q, r] = [a, b, c].map(|point| [point[i], point[j], 0.0]);
        predicates.orient3d(p, q, r, [p[0], p[1], 1.0]) == Sign::Zero
    })
}
