//! The first pass over points: what there is of each kind, and how dense points are.

use std::collections::BTreeMap;

use super::cell_map::{CellMap, Counts};
use super::fields::Fields;
use super::figures::percentile;
use super::picture::{Frame, Picture};
use super::{Options, of_axes};
use spmesh_base::error::{Error, Result};
use spmesh_formats::crs::System;
use spmesh_formats::source::{DropReason, Input};
use spmesh_stream::model::bounds::Bounds;

/// The side of cells of density, unless it is given.
const CELL: f64 = 10.0;
/// Of the cells along an axis, one in so many may be far from the others, at both ends.
const FAR: usize = 100;

/// Counts of points.
#[derive(Debug)]
pub struct Tally {
    /// Points that are neither withheld nor without a finite coordinate.
    pub points: u64,
    /// Points that are withheld.
    pub withheld: u64,
    /// Points with a coordinate that is not finite.
    pub invalid: u64,
    /// First returns, last returns, and only returns; `None` if points do not say which return they are.
    pub returns: Option<[u64; 3]>,
    /// Points of each class that has any; `None` if points have no class.
    pub classes: Option<Vec<(u8, u64)>>,
    /// Points of each flight line; `None` if points do not say which is theirs.
    pub sources: Option<BTreeMap<u16, u64>>,
    /// Their box; `None` if there are no points.
    pub bounds: Option<Bounds>,
    /// How dense they are; `None` if there are no points.
    pub density: Option<Density>,
}

/// How dense points are in cells. Densities are counts for each square unit.
#[derive(Debug)]
pub struct Density {
    /// Side of cells.
    pub cell: f64,
    /// Cells with points.
    pub cells: u64,
    /// Their area.
    pub area: f64,
    /// Points over this area.
    pub points: f64,
    /// First returns over this area.
    pub pulses: f64,
    /// The root of the area of a first return: the aggregate nominal pulse spacing.
    pub spacing: f64,
    /// Of the density of first returns in cells with points: the least, the 5th percentile, the median, the
    /// 95th percentile, and the greatest.
    pub quantiles: [f64; 5],
    /// The box of the cells, of which a few that are far from all others may be left out.
    pub frame: Frame,
    /// Cells that are left out of the box.
    pub far: u64,
    /// Density of first returns.
    pub picture: Picture,
}

/// Reads all points of an input; calls `progress` with their number.
///
/// Memory: half of `options.memory`.
///
/// # Errors
/// If the input is malformed or cannot be read; usage, if its coordinates are angles.
pub fn count(input: &Input, options: &Options, mut progress: impl FnMut(u64)) -> Result<Tally> {
    let description = input.description();
    if System::of(&description.crs).horizontal.is_some_and(|known| known.is_angular()) {
        let message =
            "x and y are angles, over which areas are not those of the ground: project the points first";
        return Err(Error::usage(message).of_input(input.name()));
    }
    let fields = Fields::of(&description.attributes);
    let mut map = CellMap::new(options.cell.unwrap_or(CELL), options.memory / 2);
    let (mut reader, mut batch) = (input.read()?, Vec::new());
    let (mut points, mut returns, mut classes, mut sources) = (0, [0; 3], [0; 256], BTreeMap::new());
    let mut bounds: Option<Bounds> = None;
    loop {
        reader.next_batch(&mut batch)?;
        if batch.is_empty() {
            break;
        }
        points += batch.len() as u64;
        for (number, &stored) in batch.iter().enumerate() {
            let world = description.coordinates.to_world(stored);
            let carried = fields.read(reader.rows(), number);
            map.add([world[0], world[1]], carried.is_first);
            let place = Bounds { min: world, max: world };
            bounds = Some(bounds.map_or(place, |bounds| bounds.union(place)));
            for (count, is) in returns.iter_mut().zip([carried.is_first, carried.is_last, carried.is_single])
            {
                *count += u64::from(is);
            }
            carried.class.into_iter().for_each(|class| classes[usize::from(class)] += 1);
            carried.source.into_iter().for_each(|source| *sources.entry(source).or_default() += 1);
        }
        progress(points);
    }
    let listed = (0..=u8::MAX).zip(classes).filter(|(_, count)| *count > 0).collect();
    Ok(Tally {
        points,
        withheld: input.dropped().of(DropReason::Withheld),
        invalid: reader.invalid(),
        returns: fields.returns.is_some().then_some(returns),
        classes: fields.class.is_some().then_some(listed),
        sources: fields.source.is_some().then_some(sources),
        bounds,
        density: (points > 0).then(|| density(&map)),
    })
}

impl Tally {
    /// First returns; all points, if they do not say which return they are.
    pub fn first(&self) -> u64 {
        self.returns.map_or(self.points, |[first, ..]| first)
    }
}

/// What cells say, of which there is one at least.
fn density(map: &CellMap) -> Density {
    let (side, cells) = (map.side(), map.cells().len() as u64);
    let of_cell = |counts: &Counts| counts.first as f64 / (side * side);
    let sum = |count: fn(&Counts) -> u64| map.cells().map(|(_, counts)| count(counts)).sum::<u64>() as f64;
    let (points, first) = (sum(|counts| counts.points), sum(|counts| counts.first));
    let mut densities: Vec<f64> = map.cells().map(|(_, counts)| of_cell(counts)).collect();
    densities.sort_unstable_by(f64::total_cmp);
    let area = cells as f64 * side * side;
    let frame = frame(map);
    let centre = |cell: &[i64; 2]| cell.map(|multiple| (multiple as f64 + 0.5) * side);
    let (mut picture, mut far) = (Picture::of(&frame, side), 0);
    for (cell, counts) in map.cells() {
        let at = centre(cell);
        picture.add(at, [counts.first as f64, side * side]);
        far += u64::from((0..2).any(|axis| at[axis] < frame.min[axis] || at[axis] > frame.max[axis]));
    }
    Density {
        cell: side,
        cells,
        area,
        points: points / area,
        pulses: first / area,
        spacing: (area / first).sqrt(),
        quantiles: [0.0, 5.0, 50.0, 95.0, 100.0].map(|percent| percentile(&densities, percent)),
        frame,
        far,
        picture,
    }
}

/// The box of the cells that are not far from the others. Far is what lies beyond the middle cells along an
/// axis by more than these extend; the middle ones are all but one in [`FAR`] at both ends.
fn frame(map: &CellMap) -> Frame {
    let reach = of_axes(|axis| {
        let mut along: Vec<i64> = map.cells().map(|(cell, _)| cell[axis]).collect();
        along.sort_unstable();
        let left_out = if along.len() < 4 { 0 } else { along.len().div_ceil(FAR) };
        let (low, high) = (along[left_out], along[along.len() - 1 - left_out]);
        let extent = high.saturating_sub(low).saturating_add(1);
        (low.saturating_sub(extent), high.saturating_add(extent))
    });
    let is_near = |cell: &[i64; 2]| (0..2).all(|axis| (reach[axis].0..=reach[axis].1).contains(&cell[axis]));
    let near = map.cells().map(|(cell, _)| cell).filter(|cell| is_near(cell));
    let (min, max) = near.fold(([i64::MAX; 2], [i64::MIN; 2]), |(min, max), cell| {
        (of_axes(|axis| min[axis].min(cell[axis])), of_axes(|axis| max[axis].max(cell[axis])))
    });
    let side = map.side();
    Frame { min: min.map(|cell| cell as f64 * side), max: max.map(|cell| (cell as f64 + 1.0) * side) }
}
