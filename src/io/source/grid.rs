//! One grid for files of integer coordinates.
//!
//! Axes that take part in the geometry (x and y; all three in three dimensions) need one quantum, so that the
//! exact predicates can work on the integers themselves. Files are brought to a common grid only where
//! nothing is rounded.

use super::placement::{RATIO_TOLERANCE, whole_steps};
use spmesh_core::error::{Error, Result};
use spmesh_model::bounds::{Bounds, Point};
use spmesh_stream::Coordinates;

/// Greatest numerator and denominator of a ratio of scales that counts as a small fraction.
const MULTIPLIER_MAX: f64 = 10_000.0;

/// A file that the common grid must serve.
pub(super) struct Member {
    pub(super) name: String,
    pub(super) coordinates: Coordinates,
    /// Bounding box that the file states, in its stored coordinates.
    pub(super) bounds: Option<Bounds>,
}

/// Coordinates that all members can be converted to without rounding; world coordinates if one has no grid,
/// or if the scales of its axes have no common measure.
///
/// # Errors
/// [`spmesh_core::error::ErrorKind::Usage`] if each member has a grid, but together they have none.
pub(super) fn common(members: &[Member], dims: u8) -> Result<Coordinates> {
    let mut grids = Vec::with_capacity(members.len());
    for member in members {
        match one_quantum(&member.coordinates, dims) {
            Some(grid) => grids.push(grid),
            None => return Ok(Coordinates::F64),
        }
    }
    let Some(&first) = grids.first() else { return Ok(Coordinates::F64) };
    let mut scale = first.0;
    for (member, grid) in members.iter().zip(&grids) {
        // Geometric axes keep one scale, because all of them go through the same steps.
        for (scale, other) in scale.iter_mut().zip(grid.0) {
            *scale = common_measure(*scale, other).ok_or_else(|| conflict(&members[0], member))?;
        }
    }
    let grid = Coordinates::I32 { scale, offset: first.1 };
    for member in members {
        if whole_steps(&member.coordinates, &grid).is_none() {
            return Err(conflict(&members[0], member));
        }
    }
    fit(members, scale, first.1)
}

/// The grid with an offset for which the stated boxes fit 32 bits: the first file's offset where possible.
fn fit(members: &[Member], scale: Point, offset: Point) -> Result<Coordinates> {
    let grid = Coordinates::I32 { scale, offset };
    if members.iter().all(|member| member.coordinates == grid) {
        return Ok(grid);
    }
    let Some((union, widest)) = union(members, &grid) else { return Ok(grid) };
    if fits(&union) {
        return Ok(grid);
    }
    let centre: Point = std::array::from_fn(|axis| ((union.min[axis] + union.max[axis]) / 2.0).round());
    let moved = |corner: Point| std::array::from_fn(|axis| corner[axis] - centre[axis]);
    if fits(&Bounds { min: moved(union.min), max: moved(union.max) }) {
        let offset = std::array::from_fn(|axis| offset[axis] + centre[axis] * scale[axis]);
        return Ok(Coordinates::I32 { scale, offset });
    }
    if members.len() == 1 { Ok(Coordinates::F64) } else { Err(conflict(&members[0], widest)) }
}

/// The union of the stated boxes in steps of `grid`, and the member that reaches farthest from the first.
fn union<'m>(members: &'m [Member], grid: &Coordinates) -> Option<(Bounds, &'m Member)> {
    let mut found: Option<(Bounds, &Member)> = None;
    for member in members {
        let (Some(bounds), Some((factor, shift))) = (member.bounds, whole_steps(&member.coordinates, grid))
        else {
            continue;
        };
        let place = |corner: Point| std::array::from_fn(|axis| corner[axis] * factor[axis] + shift[axis]);
        let placed = Bounds { min: place(bounds.min), max: place(bounds.max) };
        found = Some(match found {
            None => (placed, member),
            Some((union, _)) if !fits(&placed) => (union.union(placed), member),
            Some((union, widest)) => (union.union(placed), widest),
        });
    }
    found
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

fn conflict(first: &Member, other: &Member) -> Error {
    Error::usage(format!(
        "{} and {} have no common grid of 32 bits ({}; {}): choose one with --scale and --offset",
        first.name,
        other.name,
        describe(&first.coordinates),
        describe(&other.coordinates)
    ))
}

fn describe(coordinates: &Coordinates) -> String {
    match coordinates {
        Coordinates::F64 => "no grid".to_string(),
        Coordinates::I32 { scale, offset } => format!("scale {scale:?}, offset {offset:?}"),
    }
}
