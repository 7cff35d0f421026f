//! Lakes and rivers: which count, and their levels.

use std::io::Write;
use std::path::PathBuf;

use super::budget::Budget;
use super::passes::{Observer, Passes};
use super::select::Selected;
use super::shores::{Raise, Room, Shores, collect_inside, extent, shore_width, with_points};
use crate::lines::{Layer, Levels, Near, Shore, Target, Water};
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::network::Network;
use spmesh_formats::source::Description;
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::Bounds;

/// Lakes and rivers, and how their levels are found where no file states them.
#[derive(Debug, Clone)]
pub struct Flatten {
    /// Their files.
    pub files: Vec<PathBuf>,
    /// The percentile of the elevations of points near a shore, from 0 to 100.
    pub percentile: f64,
    /// Up to this distance points are near, in world units; a few mean distances between points if `None`.
    pub width: Option<f64>,
    /// The median of the points of water in a polygon is its level where there are so many of them.
    pub water_points: Option<usize>,
    /// Whether points near shores that are below the water are raised to it. Needs a width.
    pub raise: bool,
    /// Whether points are those of a part alone, so that water away from them is no reason to leave it out.
    pub is_part: bool,
}

/// The points that levels are found from.
#[derive(Clone, Copy)]
pub(super) struct Evidence<'a> {
    /// Those near shores are among these.
    pub(super) points: &'a Selected<'a>,
    /// Points of the class of water.
    pub(super) in_water: Option<&'a Selected<'a>>,
    /// Memory for those that count, and for shores.
    pub(super) budget: Budget,
}

/// The box of points and their number, as far as they are known, and the width of shores in stored units.
struct Extent {
    points: Option<(Bounds, u64)>,
    width: f64,
}

impl Flatten {
    /// Finds the levels, from those of points that are near a shore if none are stated. Leaves water without
    /// points out.
    pub(super) fn levels(
        &self,
        network: &Network,
        water: &mut Water,
        points: &Evidence,
        observer: &mut dyn Observer,
    ) -> Result<Levels> {
        let needed = water.need_points();
        let extent = self.extent(&needed, points.points, observer)?;
        let mut near = self.find(network, water, &needed, extent.width, points, observer)?;
        self.settle(network, water, &needed, (&mut near, &extent), points, observer)
    }

    /// What raises points near shores to the water, if that is asked for.
    pub(super) fn raising(
        &self,
        network: &Network,
        water: &Water,
        levels: &Levels,
        coordinates: Coordinates,
    ) -> Option<Raise> {
        let width = self.width.filter(|_| self.raise)?;
        Some(Raise::of(network, water, levels, stored(width, &coordinates), coordinates))
    }

    /// Writes the layer of levels. Points near all shores are looked at, also where files state the level.
    pub(super) fn write_levels(
        &self,
        network: &Network,
        water: &mut Water,
        points: &Evidence,
        observer: &mut dyn Observer,
        output: &mut dyn Write,
    ) -> Result<Vec<Shore>> {
        let needed = vec![true; water.polygons.len()];
        // Headers state the box of all points, and not of those that filters keep.
        let Some(known) = extent(points.points, observer)? else {
            return Err(Error::usage("no points: the input has none, or the filters keep none"));
        };
        let extent = self.extent_of(Some(known), points.points);
        let mut near = self.find(network, water, &needed, extent.width, points, observer)?;
        let levels = self.settle(network, water, &needed, (&mut near, &extent), points, observer)?;
        levels.notices.iter().for_each(|message| observer.notice(message));
        let target = &Target::of_points(points.points.description());
        let (bounds, percentile) = (known.0, self.percentile);
        Layer { network, water, levels: &levels, near: &near, bounds, percentile, target }.write(output)
    }

    /// Finds points for the polygons that `needed` says, near shores up to a width.
    fn find(
        &self,
        network: &Network,
        water: &Water,
        needed: &[bool],
        width: f64,
        points: &Evidence,
        observer: &mut dyn Observer,
    ) -> Result<Vec<Near>> {
        if !needed.contains(&true) {
            return Ok(vec![Near::default(); needed.len()]);
        }
        let mut near = vec![Near::default(); needed.len()];
        let shores = Shores::new(water.edges(network), needed, width);
        let (edges, bytes) = shores.size();
        let what = format!("{edges} edges of water take");
        let budget = points.budget.beside(bytes, &what, "give fewer lakes and rivers at once")?;
        let mut room = Room::within(budget.bytes());
        for (number, points) in shores.collect(points.points, &mut room, observer)? {
            near[number as usize].points = points;
        }
        if let (Some(input), Some(enough)) = (points.in_water, self.water_points) {
            let edges = water.edges(network).into_iter().filter(|&(number, _)| needed[number as usize]);
            for (number, inside) in collect_inside(edges, input, &mut room, observer)? {
                near[number as usize].take_water(inside, enough);
            }
        }
        Ok(near)
    }

    /// Leaves out water that is far from all points, and settles the levels of the rest.
    fn settle(
        &self,
        network: &Network,
        water: &mut Water,
        needed: &[bool],
        (near, extent): (&mut Vec<Near>, &Extent),
        points: &Evidence,
        observer: &mut dyn Observer,
    ) -> Result<Levels> {
        let far = if self.is_part {
            vec![false; needed.len()]
        } else {
            far(network, water, needed, (near, extent), points, observer)?
        };
        if let Some(text) = water.about_far(&far) {
            observer.notice(&text);
        }
        let left_out = water.leave_out(&far, network);
        let mut far = far.into_iter();
        near.retain(|_| far.next() == Some(false));
        let target = Target::of_points(points.points.description());
        Ok(Levels { left_out, ..Levels::find(network, water, near, self.percentile, &target)? })
    }

    /// What is known of the points. Headers say enough of them where levels are stated.
    fn extent(&self, needed: &[bool], points: &dyn Passes, observer: &mut dyn Observer) -> Result<Extent> {
        let &Description { stated_bounds, stated_points, .. } = points.description();
        let mut known = stated_bounds.zip(stated_points);
        let lacks_width = self.width.is_none() && needed.contains(&true);
        if lacks_width || known.is_none() && needed.contains(&false) && !self.is_part {
            known = extent(points, observer)?;
        }
        Ok(self.extent_of(known, points))
    }

    /// What is known of points, with the width of shores that is given, or else follows from them.
    fn extent_of(&self, points: Option<(Bounds, u64)>, input: &dyn Passes) -> Extent {
        let given = self.width.map(|width| stored(width, &input.description().coordinates));
        Extent { points, width: given.unwrap_or_else(|| points.map_or(1.0, shore_width)) }
    }
}

/// A width of the world in stored units.
fn stored(width: f64, coordinates: &Coordinates) -> f64 {
    match coordinates {
        Coordinates::I32 { scale, .. } => width / scale[0],
        Coordinates::F64 => width,
    }
}

/// Which polygons are far from all points: those without points near them whose box is beyond that of the
/// points, or that have no points inside, though their level would be found from some.
fn far(
    network: &Network,
    water: &Water,
    needed: &[bool],
    (near, extent): (&[Near], &Extent),
    points: &Evidence,
    observer: &mut dyn Observer,
) -> Result<Vec<bool>> {
    let is_beyond = |number: usize| {
        let is_off = |bounds| !water.polygons[number].is_within(extent.width, &bounds, network);
        extent.points.is_some_and(|(bounds, _)| is_off(bounds))
    };
    let is_empty = |number: usize| !needed[number] || near[number] == Near::default();
    let mut far: Vec<bool> = (0..needed.len()).map(|it| is_empty(it) && is_beyond(it)).collect();
    let is_doubtful = |number: usize| needed[number] && is_empty(number) && !far[number];
    if (0..needed.len()).any(is_doubtful) {
        let edges = water.edges(network).into_iter().filter(|(number, _)| is_doubtful(*number as usize));
        let inside = with_points(edges, points.points, Room::within(points.budget.bytes()), observer)?;
        let is_dry = |number: &usize| is_doubtful(*number) && !inside.contains(&(*number as u32));
        let dry: Vec<usize> = (0..needed.len()).filter(is_dry).collect();
        dry.into_iter().for_each(|number| far[number] = true);
    }
    Ok(far)
}
