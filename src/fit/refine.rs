//! Knots where they are needed: fits that add knots until residuals are small enough.
//!
//! The knots begin as a coarse grid over the box of the data, those inside moved at random, by a fixed seed, so that no three are
//! on a line and splines are smooth. Each round fits a spline, and looks for the greatest residual in each triangle of knots. Where
//! it is above the tolerance, a new knot halfway between the place and the middle of the triangle: near to where it is needed,
//! and away from knots and edges. Next to the border it is the middle of the border's edge instead.
//!
//! Gross errors would attract knots. So with a loss, fits are robust, and rejected observations ask for no knot, unless they are a
//! good part of what is in a triangle.
//!
//! The border is pulled apart, so that along edges from border to border splines could be folded. Such edges get a knot, too.

use super::control::bending;
use super::cover::Cover;
use super::mesh::Mesh;
use super::normal::Normal;
use super::observations::Observations;
use super::residuals::{self, Residual};
use super::robust::{Loss, robust_soon};
use super::solve::Equations;
use crate::error::{Error, Result};
use crate::predicates::Point2;
use crate::random::Random;
use std::num::NonZeroUsize;

/// Cells along the longer side of the box in the first round.
const CELLS_FIRST: usize = 4;
/// How far knots are moved, in cells.
const MOVED: f64 = 0.2;
/// Least number of observations in a triangle that gets a knot, which brings two or three functions.
const OBSERVATIONS_MIN: u32 = 3;
/// The least part of observations of a triangle that is rejected for want of knots, and not for gross errors.
const REJECTED_MIN: f64 = 0.25;
/// Least number of knots: those of the first grid, and one for each corner that an edge cuts off.
pub const KNOTS_MIN: usize = (CELLS_FIRST + 1) * (CELLS_FIRST + 1) + 4;
/// Most cells of a grid.
const EVEN_MAX: f64 = 5e7;
/// Attempts to place knots so that no edge through the inside joins two knots of the border.
const ATTEMPTS: usize = 4;

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Greatest magnitude of residuals that is good enough. Units: those of values.
    pub tolerance: f64,
    /// Most places of knots: copies on the border do not count.
    pub max_knots: usize,
    /// The factor of the energy, in units of [`Equations::halving`]: not zero, so that gaps in the data are bridged.
    pub smoothing: f64,
    /// What residuals cost, if not their squares.
    pub loss: Option<Loss>,
}

impl Goal {
    /// A goal with as much smoothing as observations can bear.
    #[must_use]
    pub fn new(tolerance: f64, max_knots: usize) -> Goal {
        Goal { tolerance, max_knots, smoothing: 1.0, loss: None }
    }

    fn check(&self) -> Result<()> {
        if self.tolerance.is_nan() || self.tolerance <= 0.0 {
            return Err(Error::usage(format!("tolerance {}: expected a number above zero", self.tolerance)));
        }
        if self.max_knots < KNOTS_MIN {
            return Err(Error::usage(format!("{} knots: {KNOTS_MIN} are needed at least", self.max_knots)));
        }
        if !(self.smoothing > 0.0 && self.smoothing.is_finite()) {
            let what = format!("smoothing {}: expected a finite number above zero", self.smoothing);
            return Err(Error::usage(what));
        }
        Ok(())
    }
}

/// One round in numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Round {
    /// Places of knots.
    pub knots: usize,
    /// Functions.
    pub functions: usize,
    /// Greatest magnitude of residuals.
    pub greatest: f64,
    /// Root of the mean square of residuals.
    pub root_mean_square: f64,
    /// Number of residuals above the tolerance, but for rejected observations.
    pub above: u64,
}

/// A spline with knots of its own.
#[derive(Debug)]
pub struct Refined {
    /// Knots and functions.
    pub cover: Cover,
    /// Coefficients.
    pub coefficients: Vec<f64>,
    /// All rounds; the last one is that of the result.
    pub rounds: Vec<Round>,
    /// Whether all residuals are within the tolerance, but for rejected observations. If not, knots were used up, or there were too
    /// few observations to add more.
    pub is_reached: bool,
}

/// Fits a spline with as many knots as a goal takes.
///
/// Errors: goals that make no sense; observations in no area; those of [`Normal::of`] and [`Equations::solve`].
///
/// Cost: two passes over the observations for each round, of which there are about ten; with a loss, ten times as many.
pub fn refine<O: Observations + ?Sized>(
    observations: &O,
    goal: &Goal,
    threads: NonZeroUsize,
) -> Result<Refined> {
    goal.check()?;
    let first = first_places(bounds(observations)?);
    let middles = settled(&first, Vec::new(), goal.max_knots - first.len())?;
    let mut places = [first, middles].concat();
    let mut rounds = Vec::new();
    loop {
        let cover = Cover::of(places)?;
        let Solution { coefficients, limit } = Solution::of(&cover, observations, goal, threads)?;
        let survey = Survey::of(&cover, &coefficients, limit, observations, goal, threads)?;
        rounds.push(survey.round);
        let is_reached = survey.round.above == 0;
        let wanted = if is_reached { Vec::new() } else { survey.knots(&cover.mesh, goal) };
        let room = goal.max_knots.saturating_sub(cover.mesh.points().len());
        let added = settled(cover.mesh.points(), wanted, room)?;
        if added.is_empty() {
            return Ok(Refined { cover, coefficients, rounds, is_reached });
        }
        places = cover.mesh.points().to_vec();
        places.extend(added);
    }
}

/// Knots on a grid over the box of all observations, with cells of about this side; those inside are moved a little.
///
/// Errors: a side that is not above zero, or makes more than 50 million knots; observations in no area; those of the source.
pub fn even_places<O: Observations + ?Sized>(observations: &O, side: f64) -> Result<Vec<Point2>> {
    if side.is_nan() || side <= 0.0 {
        return Err(Error::usage(format!("cells of {side}: expected a number above zero")));
    }
    let [lower, upper] = bounds(observations)?;
    let cells = [0, 1].map(|axis| ((upper[axis] - lower[axis]) / side).round().max(2.0));
    if cells[0] * cells[1] > EVEN_MAX {
        let what = format!("cells of {side} are {:.0} by {:.0}: take larger ones", cells[0], cells[1]);
        return Err(Error::usage(what));
    }
    let places = grid([lower, upper], cells.map(|count| count as usize));
    let middles = settled(&places, Vec::new(), usize::MAX)?;
    Ok([places, middles].concat())
}

/// A fit over the knots of a round.
struct Solution {
    coefficients: Vec<f64>,
    /// Observations whose residual is greater, for a weight of one, are rejected.
    limit: f64,
}

impl Solution {
    fn of<O: Observations + ?Sized>(
        cover: &Cover,
        observations: &O,
        goal: &Goal,
        threads: NonZeroUsize,
    ) -> Result<Solution> {
        let normal = Normal::of(&cover.basis, observations, threads)?;
        let energy = bending(&cover.basis)?;
        let equations = Equations::new(&cover.basis, &normal, Some(&energy))?;
        let lambda = goal.smoothing * equations.halving();
        let Some(loss) = goal.loss else {
            return Ok(Solution { coefficients: equations.solve(lambda)?, limit: f64::INFINITY });
        };
        let fit = robust_soon(&cover.basis, observations, loss, &energy, lambda, threads)?;
        Ok(Solution { limit: fit.limit(), coefficients: fit.coefficients })
    }
}

/// The box of all observations that count.
fn bounds<O: Observations + ?Sized>(observations: &O) -> Result<[Point2; 2]> {
    let (mut lower, mut upper) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let (mut reader, mut batch, mut index) = (observations.read()?, Vec::new(), 0u64);
    loop {
        batch.clear();
        reader.append(&mut batch)?;
        if batch.is_empty() {
            break;
        }
        for one in &batch {
            one.check(index)?;
            index += 1;
            lower = [0, 1].map(|axis| lower[axis].min(one.point[axis]));
            upper = [0, 1].map(|axis| upper[axis].max(one.point[axis]));
        }
    }
    if index == 0 {
        return Err(Error::usage("no observations: nothing can be fitted"));
    }
    if !(lower[0] < upper[0] && lower[1] < upper[1]) {
        return Err(Error::usage(format!(
            "all observations have the same x or y: they are between {} {} and {} {}, which is no area",
            lower[0], lower[1], upper[0], upper[1]
        )));
    }
    Ok([lower, upper])
}

/// The grid of the first round: its cells are about square.
fn first_places([lower, upper]: [Point2; 2]) -> Vec<Point2> {
    let sides = [0, 1].map(|axis| upper[axis] - lower[axis]);
    let longest = sides[0].max(sides[1]);
    grid([lower, upper], sides.map(|side| ((side / longest * CELLS_FIRST as f64).round() as usize).max(2)))
}

/// The corners of the box and knots along its sides, exactly, and moved ones inside.
fn grid([lower, upper]: [Point2; 2], cells: [usize; 2]) -> Vec<Point2> {
    let mut random = Random::new(1);
    let mut places = Vec::with_capacity((cells[0] + 1) * (cells[1] + 1));
    for (i, j) in (0..=cells[1]).flat_map(|j| (0..=cells[0]).map(move |i| (i, j))) {
        let step = [i, j];
        let is_inside = (0..2).all(|axis| step[axis] > 0 && step[axis] < cells[axis]);
        places.push([0, 1].map(|axis| {
            let by = unit(&mut random);
            let place = step[axis] as f64 + if is_inside { MOVED * by } else { 0.0 };
            between(lower[axis], upper[axis], place / cells[axis] as f64)
        }));
    }
    places
}

/// A number between -1 and 1.
fn unit(random: &mut Random) -> f64 {
    2.0 * (random.bits() as f64 / u64::MAX as f64) - 1.0
}

/// A number at a part of the way; the ends themselves at zero and one.
fn between(from: f64, to: f64, part: f64) -> f64 {
    if part == 1.0 { to } else { from + part * (to - from) }
}

/// What a round leaves, triangle by triangle.
struct Survey {
    round: Round,
    triangles: Vec<Inside>,
}

/// What is in a triangle.
#[derive(Debug, Clone, Copy, Default)]
struct Inside {
    observations: u32,
    rejected: u32,
    /// The greatest residual above the tolerance, if any is: of observations that are not rejected, and of those that are.
    worst: [Option<Residual>; 2],
}

impl Inside {
    fn add(&mut self, found: Residual, is_above: bool, is_rejected: bool) {
        self.observations = self.observations.saturating_add(1);
        self.rejected = self.rejected.saturating_add(u32::from(is_rejected));
        let worst = &mut self.worst[usize::from(is_rejected)];
        if is_above && worst.is_none_or(|worst| found.residual.abs() > worst.residual.abs()) {
            *worst = Some(found);
        }
    }

    /// The observation that asks for a knot. Rejected ones do if there are many: then they are no gross errors.
    fn asks(&self) -> Option<Residual> {
        if self.observations < OBSERVATIONS_MIN {
            return None;
        }
        let [worst, rejected] = self.worst;
        let are_many = f64::from(self.rejected) >= REJECTED_MIN * f64::from(self.observations);
        worst.or(rejected.filter(|_| are_many))
    }
}

impl Survey {
    fn of<O: Observations + ?Sized>(
        cover: &Cover,
        coefficients: &[f64],
        limit: f64,
        observations: &O,
        goal: &Goal,
        threads: NonZeroUsize,
    ) -> Result<Survey> {
        let mut triangles = vec![Inside::default(); cover.mesh.triangles_len()];
        let (mut near, mut above, mut count, mut square, mut greatest) = (0, 0, 0u64, 0.0, 0f64);
        residuals::for_each_residual(&cover.basis, coefficients, observations, threads, |found| {
            if found.weight == 0.0 {
                return;
            }
            count += 1;
            square += found.residual * found.residual;
            greatest = greatest.max(found.residual.abs());
            let is_above = found.residual.abs() > goal.tolerance;
            let is_rejected = found.residual.abs() * found.weight.sqrt() > limit;
            above += u64::from(is_above && !is_rejected);
            if let Some(triangle) = cover.mesh.locate(found.point, &mut near) {
                triangles[triangle as usize].add(found, is_above, is_rejected);
            }
        })?;
        let round = Round {
            knots: cover.mesh.points().len(),
            functions: cover.basis.len(),
            greatest,
            root_mean_square: (square / count.max(1) as f64).sqrt(),
            above,
        };
        Ok(Survey { round, triangles })
    }

    /// The next knots, those of greatest residuals first: no more than there are already.
    fn knots(&self, mesh: &Mesh, goal: &Goal) -> Vec<Point2> {
        let candidates =
            (0u32..).zip(&self.triangles).filter_map(|(triangle, inside)| Some((triangle, inside.asks()?)));
        let mut candidates: Vec<(u32, Residual)> = candidates.collect();
        candidates.sort_by(|a, b| b.1.residual.abs().total_cmp(&a.1.residual.abs()).then(a.0.cmp(&b.0)));
        let known = mesh.points().len();
        let room = goal.max_knots.saturating_sub(known).min(known);
        let mut added: Vec<Point2> = Vec::new();
        let mut random = Random::new(known as u64);
        for (triangle, worst) in candidates {
            if added.len() >= room {
                break;
            }
            let knot = knot_in(mesh, triangle, worst.point, &mut random);
            if !mesh.corners(triangle).contains(&knot) {
                added.push(knot);
            }
        }
        added
    }
}

/// New knots, with more at edges from border to border while there is `room`; otherwise without those that make such edges.
///
/// Edges between known knots only become fewer, so that at least one end of each is new, but at the very start.
fn settled(known: &[Point2], mut added: Vec<Point2>, room: usize) -> Result<Vec<Point2>> {
    for attempt in 0.. {
        let mesh = Mesh::of([known, &added].concat())?;
        let (ends, middles): (Vec<[u32; 2]>, Vec<Point2>) = creases(&mesh).into_iter().unzip();
        let is_new = |knot: u32| knot as usize >= known.len();
        if middles.is_empty() {
            break;
        }
        if attempt < ATTEMPTS && added.len() + middles.len() <= room {
            added.extend(middles);
            continue;
        }
        let before = added.len();
        let dropped: Vec<usize> =
            ends.iter().flatten().filter(|&&end| is_new(end)).map(|&end| end as usize).collect();
        let mut id = known.len()..;
        added.retain(|_| id.next().is_none_or(|id| !dropped.contains(&id)));
        if added.len() == before {
            break;
        }
    }
    Ok(added)
}

/// Edges through the inside that join two knots of the border, each with a place next to its middle, but not on it: knots on one
/// line make splines less smooth.
fn creases(mesh: &Mesh) -> Vec<([u32; 2], Point2)> {
    let mut is_border = vec![false; mesh.points().len()];
    mesh.hull().iter().for_each(|&knot| is_border[knot as usize] = true);
    let mut found = Vec::new();
    for triangle in 0..mesh.triangles_len() as u32 {
        let (vertices, corners) = (mesh.vertices(triangle), mesh.corners(triangle));
        for [from, to] in mesh.inner_edges(triangle) {
            let ends = [vertices[from], vertices[to]];
            // Each edge is one of two triangles.
            if ends[0] < ends[1] && ends.iter().all(|&end| is_border[end as usize]) {
                let (p, q, apex) = (corners[from], corners[to], corners[3 - from - to]);
                found.push((ends, [0, 1].map(|axis| 0.9 * p[axis].midpoint(q[axis]) + 0.1 * apex[axis])));
            }
        }
    }
    found
}

/// The knot for a residual in a triangle: about halfway between its place and the middle. Exactly there, knots of several rounds
/// for one residual would be on a line with a corner.
fn knot_in(mesh: &Mesh, triangle: u32, worst: Point2, random: &mut Random) -> Point2 {
    let corners = mesh.corners(triangle);
    let mut share = || 1.0 + MOVED * unit(random);
    let shares = [share(), share(), share(), 3.0 * share()];
    let whole: f64 = shares.iter().sum();
    let places = corners.into_iter().chain([worst]).zip(shares);
    let knot = places
        .fold([0.0; 2], |sum, (place, share)| [0, 1].map(|axis| sum[axis] + share / whole * place[axis]));
    // In the circle over an edge of the border, a knot would make a flat triangle (Ruppert 1995).
    let is_near = |&[p, q]: &[Point2; 2]| {
        (p[0] - knot[0]) * (q[0] - knot[0]) + (p[1] - knot[1]) * (q[1] - knot[1]) <= 0.0
    };
    match mesh.border_edges(triangle).find(is_near) {
        Some([p, q]) => [0, 1].map(|axis| p[axis].midpoint(q[axis])),
        None => knot,
    }
}
