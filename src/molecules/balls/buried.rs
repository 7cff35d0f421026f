//! The areas that parts of a union take from each other.

use super::near::{Grid, around};
use super::{Balls, check, measure};
use spmesh_base::error::Result;
use spmesh_delaunay::parallel;
use spmesh_delaunay::predicates::Point3;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;

/// What two parts take from each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Burial {
    /// The parts, the lesser first.
    pub parts: [u32; 2],
    /// For each of them its balls that overlap the other part, and the area that they lose to it.
    pub lost: [Vec<(u32, f64)>; 2],
}

impl Burial {
    /// The area that each part loses.
    pub fn areas(&self) -> [f64; 2] {
        [0, 1].map(|side| self.lost[side].iter().map(|(_, area)| area).sum())
    }
}

/// For each pair of parts with balls that overlap, the area that each ball loses: that of its cell in its
/// part alone, less that in both parts together. `parts` has the part of each ball; pairs are in order, those
/// that are `wanted`.
///
/// Cost: the balls of a pair that overlap the other part, and those around them, are measured twice.
///
/// # Errors
/// As [`measure`].
pub fn buried(
    balls: Balls<'_>,
    parts: &[u32],
    wanted: impl Fn([u32; 2]) -> bool,
    threads: NonZeroUsize,
) -> Result<Vec<Burial>> {
    check(balls)?;
    let borders = borders(balls, parts, wanted);
    let members = members(parts);
    let pairs: Vec<&[([u32; 2], u32)]> = borders.chunk_by(|p, q| p.0 == q.0).collect();
    parallel::map(threads, pairs.iter(), |pair| {
        let border: Vec<u32> = pair.iter().map(|&(_, ball)| ball).collect();
        of_pair(balls, pair[0].0, &border, &members)
    })
}

/// Balls of one part that overlap another: pairs of parts, the lesser first, with the ball; sorted.
fn borders(balls: Balls<'_>, parts: &[u32], wanted: impl Fn([u32; 2]) -> bool) -> Vec<([u32; 2], u32)> {
    let all = 0..balls.centres.len() as u32;
    let grid = Grid::new(balls, all.clone());
    let mut borders = Vec::new();
    let mut others = Vec::new();
    for ball in all {
        let own = parts[ball as usize];
        grid.for_each_near(ball, |other| {
            let other = parts[other as usize];
            if other != own && others.last() != Some(&other) {
                others.push(other);
            }
            ControlFlow::Continue(())
        });
        others.sort_unstable();
        others.dedup();
        let pairs = others.drain(..).map(|other| [own.min(other), own.max(other)]);
        borders.extend(pairs.filter(|&pair| wanted(pair)).map(|pair| (pair, ball)));
    }
    borders.sort_unstable();
    borders
}

/// The balls of each part.
fn members(parts: &[u32]) -> Vec<Vec<u32>> {
    let mut members = vec![Vec::new(); parts.iter().max().map_or(0, |&last| last as usize + 1)];
    (0..).zip(parts).for_each(|(ball, &part)| members[part as usize].push(ball));
    members
}

fn of_pair(balls: Balls<'_>, parts: [u32; 2], border: &[u32], members: &[Vec<u32>]) -> Result<Burial> {
    // Of other balls the areas do not change, and those of the border depend on no others.
    let sides = parts.map(|part| around(balls, border, members[part as usize].iter().copied()));
    let together = areas(balls, &sides.concat())?;
    let (first, second) = together.split_at(sides[0].len());
    let mut lost = [Vec::new(), Vec::new()];
    for ((side, together), lost) in sides.iter().zip([first, second]).zip(&mut lost) {
        let alone = areas(balls, side)?;
        for ((&ball, alone), together) in side.iter().zip(alone).zip(together) {
            if border.binary_search(&ball).is_ok() {
                lost.push((ball, (alone - together).max(0.0)));
            }
        }
    }
    Ok(Burial { parts, lost })
}

/// The areas of some balls in their union.
fn areas(balls: Balls<'_>, members: &[u32]) -> Result<Vec<f64>> {
    let centres: Vec<Point3> = members.iter().map(|&ball| balls.centres[ball as usize]).collect();
    let radii: Vec<f64> = members.iter().map(|&ball| balls.radii[ball as usize]).collect();
    let measured = measure(Balls { centres: &centres, radii: &radii }, None, NonZeroUsize::MIN)?;
    Ok(measured.cells.into_iter().map(|cell| cell.area).collect())
}
