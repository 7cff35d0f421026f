//! Balls of different parts that overlap, and those that the faces between parts depend on.

use super::Balls;
use foldhash::HashSet;
use spmesh_delaunay::vector::{difference, dot};
use spmesh_stream::model::bounds::Bounds;
use std::ops::ControlFlow;

/// Rounding must not lose balls that touch.
const SLACK: f64 = 1.0 + 1e-9;

/// Cells along an axis: three of their numbers fit into a word.
const CELLS_MAX: f64 = (1 << 20) as f64;

/// Distances per ball after which all balls are kept: with a large probe, neighbourhoods are whole molecules.
const TESTS_MAX: usize = 1_000;

/// Some of the balls in the cells of a grid, which are not smaller than the largest diameter of all balls.
pub(super) struct Grid<'b> {
    balls: Balls<'b>,
    /// Number of the cell of each member, and the member, sorted.
    members: Vec<(u64, u32)>,
    lower: [f64; 3],
    side: f64,
}

impl<'b> Grid<'b> {
    /// The grid of `members`, which may be asked for the neighbours of any ball.
    pub(super) fn new(balls: Balls<'b>, members: impl Iterator<Item = u32>) -> Grid<'b> {
        let radius = balls.radii.iter().copied().fold(0.0, f64::max);
        let bounds = balls.centres.iter().map(|&at| Bounds::of_point(at)).reduce(Bounds::union);
        let (lower, extent) = bounds.map_or(([0.0; 3], 0.0), |Bounds { min, max }| {
            (min, (0..3).map(|axis| max[axis] - min[axis]).fold(0.0, f64::max))
        });
        let side = (2.0 * radius * SLACK).max(extent / CELLS_MAX).max(f64::MIN_POSITIVE);
        let mut grid = Grid { balls, members: Vec::new(), lower, side };
        grid.members = members.map(|ball| (key(grid.cell(ball)), ball)).collect();
        grid.members.sort_unstable();
        grid
    }

    /// Calls `visit` with the members that overlap a ball, itself too if it is one, until it breaks. Returns
    /// the number of distances that were compared.
    pub(super) fn for_each_near(&self, ball: u32, mut visit: impl FnMut(u32) -> ControlFlow<()>) -> usize {
        let [x, y, z] = self.cell(ball);
        let range = |at: u64| at.saturating_sub(1)..=at + 1;
        let mut tests = 0;
        for (x, y) in range(x).flat_map(|x| range(y).map(move |y| (x, y))) {
            let last = key([x, y, z + 1]);
            let first = key([x, y, z.saturating_sub(1)]);
            let start = self.members.partition_point(|&(key, _)| key < first);
            for &(_, other) in self.members[start..].iter().take_while(|&&(key, _)| key <= last) {
                tests += 1;
                if self.overlap(ball, other) && visit(other).is_break() {
                    return tests;
                }
            }
        }
        tests
    }

    /// The numbers of the cell of a ball, from 0.
    fn cell(&self, ball: u32) -> [u64; 3] {
        let at = self.balls.centres[ball as usize];
        [0, 1, 2].map(|axis| ((at[axis] - self.lower[axis]) / self.side).clamp(0.0, CELLS_MAX) as u64)
    }

    fn overlap(&self, p: u32, q: u32) -> bool {
        let [p, q] = [p, q].map(|ball| ball as usize);
        let reach = (self.balls.radii[p] + self.balls.radii[q]) * SLACK;
        let between = difference(self.balls.centres[p], self.balls.centres[q]);
        dot(between, between) <= reach * reach
    }
}

fn key([x, y, z]: [u64; 3]) -> u64 {
    x << 42 | y << 21 | z
}

/// The balls on which the faces between parts depend, in increasing order; all of them where neighbourhoods
/// are large. `parts` has the part of each ball.
///
/// A face depends on the balls that overlap one of its two. So these are the balls that overlap one of
/// another part, and what overlaps those.
pub(super) fn between_parts(balls: Balls<'_>, parts: &[u32]) -> Vec<u32> {
    let count = balls.centres.len();
    let all = || 0..count as u32;
    let mut tests = 0;
    let grid = Grid::new(balls, all());
    let mut at_border = Vec::new();
    for ball in all() {
        let part = parts[ball as usize];
        tests += grid.for_each_near(ball, |other| {
            if parts[other as usize] == part {
                return ControlFlow::Continue(());
            }
            at_border.push(ball);
            ControlFlow::Break(())
        });
        if tests > count.saturating_mul(TESTS_MAX) {
            return all().collect();
        }
    }
    around(balls, &at_border, all())
}

/// For each of `balls_of` the nearest of the members that it overlaps.
pub fn nearest(balls: Balls<'_>, members: &[u32], balls_of: &[u32]) -> Vec<Option<u32>> {
    let grid = Grid::new(balls, members.iter().copied());
    let nearest = |&ball: &u32| {
        let mut least: Option<(f64, u32)> = None;
        grid.for_each_near(ball, |other| {
            let [p, q] = [ball, other].map(|ball| balls.centres[ball as usize]);
            let between = difference(p, q);
            let square = dot(between, between);
            if least.is_none_or(|(best, _)| square < best) {
                least = Some((square, other));
            }
            ControlFlow::Continue(())
        });
        least.map(|(_, other)| other)
    };
    balls_of.iter().map(nearest).collect()
}

/// The balls of `others` that overlap one of `members`, in the order of `others`.
pub(super) fn around(balls: Balls<'_>, members: &[u32], others: impl Iterator<Item = u32>) -> Vec<u32> {
    let grid = Grid::new(balls, members.iter().copied());
    let known: HashSet<u32> = members.iter().copied().collect();
    let is_near = |&ball: &u32| {
        let mut is_near = known.contains(&ball);
        if !is_near {
            grid.for_each_near(ball, |_| {
                is_near = true;
                ControlFlow::Break(())
            });
        }
        is_near
    };
    others.filter(is_near).collect()
}
