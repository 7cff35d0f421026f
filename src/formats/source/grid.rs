//! One grid for files of integer coordinates.
//!
//! Axes that take part in the geometry (x and y; all three in three dimensions) need one quantum, so that the
//! exact predicates can work on the integers themselves. Files are brought to a common grid only where
//! nothing is rounded.

use crate::source::placement::{RATIO_TOLERANCE, whole_steps};
use crate::text::decimal_grid::common_scales;
use spmesh_base::error::{Error, Result};
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::{Bounds, Point};

/// Greatest numerator and denominator of a ratio of scales that counts as a small fraction.
const MULTIPLIER_MAX: f64 = 10_000.0;

/// A file that the common grid must serve.
#[derive(Debug, Clone)]
pub(crate) struct Member {
    pub(crate) name: String,
    pub(crate) coordinates: Coordinates,
    /// Bounding box that the file states, in its stored coordinates.
    pub(crate) bounds: Option<Bounds>,
}

/// Coordinates that all members can be converted to without rounding; world coordinates if one has no grid,
/// or if the scales of its axes have no common measure.
pub(crate) fn common(members: &[Member], dims: u8) -> Result<Coordinates> {
    if members.is_empty() || members.iter().any(|member| one_quantum(&member.coordinates, dims).is_none()) {
        return Ok(Coordinates::F64);
    }
    joint(members, dims).ok_or_else(|| conflict(members, dims))
}

/// The common grid of members that each have a grid; `None` if there is none of 32 bits.
fn joint(members: &[Member], dims: u8) -> Option<Coordinates> {
    let candidates = [of_multiples(members, dims), of_decimals(members, dims)];
    let grid = candidates
        .into_iter()
        .flatten()
        .find(|grid| members.iter().all(|member| whole_steps(&member.coordinates, grid).is_some()));
    fit(members, grid?)
}

/// A grid whose steps divide those of all members, with the first member's offset.
fn of_multiples(members: &[Member], dims: u8) -> Option<Coordinates> {
    let mut quanta = members.iter().map(|member| one_quantum(&member.coordinates, dims));
    let (mut scale, offset) = quanta.next()??;
    for quantum in quanta {
        // Geometric axes keep one scale, because all of them go through the same steps.
        for (scale, other) in scale.iter_mut().zip(quantum?.0) {
            *scale = common_measure(*scale, other)?;
        }
    }
    Some(Coordinates::I32 { scale, offset })
}

/// The coarsest grid that holds scales and offsets of all members, taken as decimals.
fn of_decimals(members: &[Member], dims: u8) -> Option<Coordinates> {
    let grid_of = |member: &Member| match member.coordinates {
        Coordinates::I32 { scale, offset } => Some((scale, offset)),
        Coordinates::F64 => None,
    };
    let grids: Vec<(Point, Point)> = members.iter().map(grid_of).collect::<Option<_>>()?;
    let offset = grids.first()?.1;
    common_scales(&grids, dims).map(|scale| Coordinates::I32 { scale, offset })
}

/// The grid with an offset for which the stated boxes fit 32 bits: its own where possible.
fn fit(members: &[Member], grid: Coordinates) -> Option<Coordinates> {
    let Coordinates::I32 { scale, .. } = grid else { return Some(grid) };
    if members.iter().all(|member| member.coordinates == grid) {
        return Some(grid);
    }
    let Some(union) = union(members, &grid) else { return Some(grid) };
    if fits(&union) {
        return Some(grid);
    }
    let centre: Point = std::array::from_fn(|axis| ((union.min[axis] + union.max[axis]) / 2.0).round());
    let moved = |corner: Point| std::array::from_fn(|axis| corner[axis] - centre[axis]);
    if fits(&Bounds { min: moved(union.min), max: moved(union.max) }) {
        return Some(Coordinates::I32 { scale, offset: grid.to_decimal(centre) });
    }
    if members.len() == 1 { Some(Coordinates::F64) } else { None }
}

/// The union of the stated boxes in steps of `grid`.
fn union(members: &[Member], grid: &Coordinates) -> Option<Bounds> {
    let mut corners = Vec::with_capacity(2 * members.len());
    for member in members {
        let (Some(bounds), Some((factor, shift))) = (member.bounds, whole_steps(&member.coordinates, grid))
        else {
            continue;
        };
        let place = |corner: Point| std::array::from_fn(|axis| corner[axis] * factor[axis] + shift[axis]);
        corners.extend([place(bounds.min), place(bounds.max)]);
    }
    Bounds::of_points(&corners)
}

fn fits(bounds: &Bounds) -> bool {
    let range = f64::from(i32::MIN)..=f64::from(i32::MAX);
    bounds.min.iter().chain(&bounds.max).all(|value| range.contains(value))
}

/// Scale and offset of a grid whose geometric axes share one scale; `None` if they have none in common.
fn one_quantum(coordinates: &Coordinates, dims: u8) -> Option<(Point, Point)> {
    let Coordinates::I32 { scale, offset } = coordinates else { return None };
    let axes = 0..usize::from(dims);
    let quantum = axes.clone().skip(1).try_fold(scale[0], |q, axis| common_measure(q, scale[axis]))?;
    let mut scale = *scale;
    scale[axes].fill(quantum);
    Some((scale, *offset))
}

/// The greatest length of which both are integer multiples; `None` if the multiples are not small.
fn common_measure(a: f64, b: f64) -> Option<f64> {
    if a == b {
        return Some(a);
    }
    (1..=MULTIPLIER_MAX as u32).map(f64::from).find_map(|parts| {
        let multiple = b / a * parts;
        let rounded = multiple.round();
        let close = (multiple - rounded).abs() <= RATIO_TOLERANCE * rounded;
        let measure = if rounded == 1.0 { b } else { a / parts };
        (close && (1.0..=MULTIPLIER_MAX).contains(&rounded)).then_some(measure)
    })
}

/// The error of members without a common grid. It names the first member that does not fit those before it, and
/// one of these with which it has no grid.
fn conflict(members: &[Member], dims: u8) -> Error {
    // If some members have no grid, more have none either.
    let lens: Vec<usize> = (1..members.len()).collect();
    let last = lens.partition_point(|&len| joint(&members[..len], dims).is_some());
    let last = last.min(members.len() - 1);
    let other = &members[last];
    let pair = |first: &Member| [first.clone(), other.clone()];
    let remedy = "choose one with --scale and --offset of spfinalize";
    match members[..last].iter().find(|first| joint(&pair(first), dims).is_none()) {
        Some(first) => Error::usage(format!(
            "{} and {} have no common grid of 32 bits ({}; {}): {remedy}",
            first.name,
            other.name,
            describe(&first.coordinates),
            describe(&other.coordinates)
        )),
        None => Error::usage(format!(
            "{} and the {last} files before it have no common grid of 32 bits, although it has one with each \
             of them: {remedy}",
            other.name
        )),
    }
}

fn describe(coordinates: &Coordinates) -> String {
    match coordinates {
        Coordinates::F64 => "no grid".to_string(),
        Coordinates::I32 { scale, offset } => format!("scale {scale:?}, offset {offset:?}"),
    }
}
