//! Which points of an input count: those inside of polygons, or those outside.
//!
//! Every pass tests every point anew, so all passes see the same points, whatever their order.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};

use super::passes::{Keep, KeptPoints, Passes};
use super::shores::Raise;
use crate::lines::Target;
use crate::polygons::{Polygons, Rings, Side};
use spmesh_base::error::Result;
use spmesh_formats::source::{Description, PointReader, read_polygons};
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::model::points::Point2;

/// Polygons that select points. Coordinates are those that the input stores.
#[derive(Debug, Default)]
pub(super) struct Areas {
    clip: Option<(Polygons, Option<[Point2; 2]>)>,
    drop: Option<Polygons>,
    water: Option<Polygons>,
    /// Points near these shores are not below the water.
    raise: Option<Raise>,
}

impl Areas {
    /// Keeps the points inside of `clip` or on its border, if it is given, and of these the ones that are not
    /// strictly inside of a polygon of `drop`.
    pub(super) fn new(clip: Option<&[Rings]>, drop: &[Rings]) -> Areas {
        Areas {
            clip: clip.map(|polygons| (Polygons::new(polygons), extent(polygons))),
            drop: (!drop.is_empty()).then(|| Polygons::new(drop)),
            water: None,
            raise: None,
        }
    }

    /// Reads the polygons of files for points of `target`, and messages for the user. Without files to keep
    /// points inside of, all are kept. Those of either kind may take so many bytes of memory.
    ///
    /// # Errors
    /// As [`read_polygons`].
    pub(super) fn read(
        [clip, drop]: [&[PathBuf]; 2],
        target: &Target,
        memory: u64,
    ) -> Result<(Areas, Vec<String>)> {
        let Target { coordinates, crs, .. } = target;
        let (kept, mut notices) = read_polygons(clip, coordinates, crs, memory)?;
        let (dropped, more) = read_polygons(drop, coordinates, crs, memory)?;
        notices.extend(more);
        Ok((Areas::new((!clip.is_empty()).then_some(&kept[..]), &dropped), notices))
    }

    /// Drops points in water, too, and those on its shores: the edges of its polygons with their numbers.
    /// Points near shores are raised to the water, if that is asked for.
    pub(super) fn with_water(self, edges: Vec<(u32, [Point2; 2])>, raise: Option<Raise>) -> Areas {
        Areas { water: Some(Polygons::of_edges(edges.into_iter())), raise, ..self }
    }

    /// Number of edges of all polygons, and the bytes that they take.
    pub(super) fn size(&self) -> (usize, u64) {
        let clip = self.clip.as_ref().map(|(clip, _)| clip);
        let raise = self.raise.as_ref().map(Raise::size);
        let all = clip.into_iter().chain(&self.drop).chain(&self.water).map(Polygons::size).chain(raise);
        all.fold((0, 0), |(edges, bytes), (more, more_bytes)| (edges + more, bytes + more_bytes))
    }

    /// Whether a point at a place is kept.
    pub(super) fn keeps(&self, place: Point2) -> bool {
        !self.clips(place) && !self.drops(place) && !self.floods(place)
    }

    /// Whether all points are kept.
    pub(super) fn keep_all(&self) -> bool {
        self.clip.is_none() && self.drop.is_none() && self.water.is_none()
    }

    fn clips(&self, place: Point2) -> bool {
        self.clip.as_ref().is_some_and(|(clip, _)| clip.side(place) == Side::Outside)
    }

    fn floods(&self, place: Point2) -> bool {
        self.water.as_ref().is_some_and(|water| water.side(place) != Side::Outside)
    }

    fn drops(&self, place: Point2) -> bool {
        self.drop.as_ref().is_some_and(|drop| drop.side(place) == Side::Inside)
    }
}

/// The box of polygons; `None` if they have no vertex.
fn extent(polygons: &[Rings]) -> Option<[Point2; 2]> {
    let mut places = polygons.iter().flatten().flatten();
    let &first = places.next()?;
    Some(places.fold([first; 2], |[min, max], place| {
        [[0, 1].map(|axis| min[axis].min(place[axis])), [0, 1].map(|axis| max[axis].max(place[axis]))]
    }))
}

/// The points of an input that polygons select.
pub(super) struct Selected<'a> {
    input: &'a dyn Passes,
    areas: &'a Areas,
    description: Description,
    counts: [AtomicU64; 4],
}

impl<'a> Selected<'a> {
    /// The points of `input` that `areas` select.
    pub(super) fn new(input: &'a dyn Passes, areas: &'a Areas) -> Self {
        let mut description = input.description().clone();
        if let Some((_, extent)) = &areas.clip {
            description.stated_bounds = description.stated_bounds.and_then(|stated| within(stated, *extent));
        }
        Selected { input, areas, description, counts: Default::default() }
    }

    /// After a run: points outside of the polygons to keep, inside of those to drop, and in water; and points
    /// that were raised to the water.
    pub(super) fn counts(&self) -> [u64; 4] {
        self.counts.each_ref().map(|count| count.load(Ordering::Relaxed))
    }
}

/// The part of a box that is in another one of the plane; `None` if there is none.
fn within(mut bounds: Bounds, extent: Option<[Point2; 2]>) -> Option<Bounds> {
    let [min, max] = extent?;
    for axis in 0..2 {
        bounds.min[axis] = bounds.min[axis].max(min[axis]);
        bounds.max[axis] = bounds.max[axis].min(max[axis]);
    }
    (0..2).all(|axis| bounds.min[axis] <= bounds.max[axis]).then_some(bounds)
}

impl Passes for Selected<'_> {
    fn description(&self) -> &Description {
        &self.description
    }

    fn read(&self) -> Result<Box<dyn PointReader + '_>> {
        let pass = SelectedPass { areas: self.areas, counts: &self.counts, own: [0; 4] };
        Ok(Box::new(KeptPoints::new(self.input, pass)?))
    }

    fn source(&self) -> Option<&dyn Passes> {
        Some(self.input)
    }
}

/// One pass over the points that count.
struct SelectedPass<'a> {
    areas: &'a Areas,
    /// For the counts of a whole pass.
    counts: &'a [AtomicU64; 4],
    own: [u64; 4],
}

impl Keep for SelectedPass<'_> {
    fn keeps(&mut self, point: &mut Point) -> bool {
        let place = [point[0], point[1]];
        let tests = [Areas::clips, Areas::drops, Areas::floods];
        if let Some(reason) = tests.iter().position(|test| test(self.areas, place)) {
            self.own[reason] += 1;
            return false;
        }
        if let Some(level) = self.areas.raise.as_ref().and_then(|raise| raise.level(place))
            && point[2] < level
        {
            point[2] = level;
            self.own[3] += 1;
        }
        true
    }

    fn end(&mut self) -> Result<()> {
        self.counts.iter().zip(self.own).for_each(|(count, own)| count.store(own, Ordering::Relaxed));
        Ok(())
    }
}
