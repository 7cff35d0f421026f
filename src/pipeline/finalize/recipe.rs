//! A whole run over files: points of one input, which polygons select, with vertices of lines and water, and
//! with weights.

use std::io::Write;
use std::path::PathBuf;

use super::added::AddedPoints;
use super::budget::Budget;
use super::options::Options;
use super::passes::{Observer, Passes};
use super::run::Stats;
use super::run::run_with;
use super::select::{Areas, Selected};
use super::shores::{Shores, extent, shore_width, with_points};
use super::weigh::{Weighed, Weighing};
use crate::lines::{self, ABOUT_FAR, Changes, Levels, Lines, Sources, Target, Water, is_far};
use spmesh_base::error::{Error, Result, counted_of};
use spmesh_base::limits::LINE_VERTEX_BYTES;
use spmesh_delaunay::network::Network;
use spmesh_formats::source::{Description, Dropped, Input, SourceOptions};
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::{Bounds, Point};

/// What is finalized, and how.
#[derive(Debug, Clone)]
pub struct Recipe {
    /// Files of points, which are one input; `-` is stdin.
    pub inputs: Vec<PathBuf>,
    /// How these are read. Weights add what they are made of to the attributes.
    pub source: SourceOptions,
    /// Files of polygons. If there are any, only points inside of one of them or on its border count.
    pub clip: Vec<PathBuf>,
    /// Files of polygons inside of which no point counts.
    pub drop_inside: Vec<PathBuf>,
    /// Files of lines, whose vertices with elevations are added.
    pub lines: Vec<PathBuf>,
    /// How these are read.
    pub line_options: lines::Options,
    /// Lakes and rivers to make flat.
    pub flatten: Flatten,
    /// What points are weighed by, if they are.
    pub weighing: Option<Weighing>,
    /// How points are finalized. What the header says of weights follows from `weighing`.
    pub options: Options,
}

/// Lakes and rivers, and how their levels are found where no file states them.
#[derive(Debug, Clone)]
pub struct Flatten {
    /// Their files.
    pub files: Vec<PathBuf>,
    /// The percentile of the elevations of points near a shore, from 0 to 100.
    pub percentile: f64,
    /// Up to this distance points are near, in world units; a few mean distances between points if `None`.
    pub width: Option<f64>,
}

/// What a run has done.
#[derive(Debug)]
pub struct Outcome {
    /// Figures of the finalization.
    pub stats: Stats,
    /// Numbers of dropped points.
    pub dropped: Drops,
    /// Figures about lines.
    pub lines: LineStats,
    /// The levels of water.
    pub levels: Levels,
    /// What was taken of each input that was cut off.
    pub salvaged: Vec<String>,
}

/// Numbers of dropped points.
#[derive(Debug, Default)]
pub struct Drops {
    /// By the filters of the input.
    pub filters: Dropped,
    /// Outside of polygons to keep, inside of those to drop, and in water.
    pub areas: [u64; 3],
}

/// Figures about lines.
#[derive(Debug)]
pub struct LineStats {
    /// Whether lines or water have vertices.
    pub has_lines: bool,
    /// Lakes, rivers, and levels that were found from points; `None` without water.
    pub water: Option<[u64; 3]>,
    /// Points of lines.
    pub points: usize,
    /// Points of the input that they replace.
    pub replaced: u64,
    /// What was changed about lines.
    pub changes: Changes,
}

impl Recipe {
    /// Writes the finalized stream, END included.
    ///
    /// # Errors
    /// Those of reading; those of [`super::run()`].
    pub fn run(&self, observer: &mut dyn Observer, mut output: impl Write) -> Result<Outcome> {
        let input = self.open()?;
        input.notices().iter().for_each(|message| observer.notice(message));
        let mut outcome = self.finalize(&input, observer, &mut output)?;
        (outcome.dropped.filters, outcome.salvaged) = (input.dropped(), input.salvaged());
        Ok(outcome)
    }

    /// Opens the points.
    pub(crate) fn open(&self) -> Result<Input> {
        let mut source = self.source.clone();
        if let Some(weighing) = &self.weighing {
            weighing.enter(&mut source);
        }
        Input::open(&self.inputs, &source)
    }

    /// Finalizes `input`, which are the points of [`Self::open`] or a part of them.
    pub(crate) fn finalize(
        &self,
        input: &dyn Passes,
        observer: &mut dyn Observer,
        output: &mut dyn Write,
    ) -> Result<Outcome> {
        let target = Target::of_points(input.description());
        let (mut areas, notices) = Areas::read(&self.clip, &self.drop_inside, &target)?;
        let Lines { network, mut water, changes, .. } = self.read_lines(&target)?;
        notices.iter().chain(&changes.notices).for_each(|message| observer.notice(message));
        let levels = if water.polygons.is_empty() {
            Levels::default()
        } else {
            let points = Selected::new(input, &areas);
            let levels = self.flatten.levels(&network, &mut water, &points, observer)?;
            areas = areas.with_water(water.edges(&network).into_iter());
            levels
        };
        levels.notices.iter().for_each(|message| observer.notice(message));
        let [all, stated] = self.added(&network, &levels, &water, &target);
        let added = AddedPoints::new(all);
        let has_lines = !network.vertices.is_empty();
        let budget = self.budget_beside(&areas, network.vertices.len())?;
        drop(network);
        let selected = Selected::new(input, &areas);
        // Without polygons, no point takes a way round.
        let points: &dyn Passes = if areas.keep_all() { input } else { &selected };
        let weighed =
            self.weighing.as_ref().map(|weighing| Weighed::new(points, &weighing.source)).transpose()?;
        let mut options = Options { budget, ..self.options.clone() };
        if let Some(weighed) = &weighed {
            options.weighted = Some(weighed.weighted(observer)?);
        }
        let points: &dyn Passes = weighed.as_ref().map_or(points, |weighed| weighed);
        let stats = run_with(points, &added, &options, observer, output)?;
        let [lakes, rivers] = water.counts();
        let water = (!self.flatten.files.is_empty()).then_some([lakes, rivers, levels.found]);
        let (points, replaced) = (added.len(), added.replaced());
        if let Some(text) = about_far(&stated, added.around(&stated), &target.coordinates) {
            observer.notice(&text);
        }
        Ok(Outcome {
            stats,
            dropped: Drops { areas: selected.dropped(), ..Drops::default() },
            lines: LineStats { has_lines, water, points, replaced, changes },
            levels,
            salvaged: Vec::new(),
        })
    }

    /// What is left of the memory beside polygons, and lines of so many vertices.
    fn budget_beside(&self, areas: &Areas, vertices: usize) -> Result<Budget> {
        let (edges, bytes) = areas.size();
        let what = format!("{edges} edges of polygons take");
        let budget = self.options.budget.beside(bytes, &what, "give simpler polygons")?;
        let what = format!("{vertices} vertices of lines take");
        budget.beside(LINE_VERTEX_BYTES * vertices as u64, &what, "give fewer lines at once")
    }

    /// Lines and water, and what was changed about them.
    fn read_lines(&self, target: &Target) -> Result<Lines> {
        let of_plane = [("--lines", &self.lines), ("--flatten", &self.flatten.files)];
        match of_plane.iter().find(|(_, files)| !files.is_empty()) {
            None => Ok(Lines::default()),
            Some((flag, _)) if self.source.dims != 2 => {
                Err(Error::usage(format!("{flag} needs points of the plane: leave out --octree")))
            }
            Some(_) => {
                let sources =
                    Sources { lines: &self.lines, water: &self.flatten.files, ..Sources::default() };
                lines::read(&sources, target, &self.line_options.within(self.options.budget.bytes()))
            }
        }
    }

    /// The vertices of lines and water that become points, and those of them whose elevation a file states.
    fn added(&self, network: &Network, levels: &Levels, water: &Water, target: &Target) -> [Vec<Point>; 2] {
        let of_water = water.stated_vertices(network);
        let is_kept = |point: &Point| {
            self.source.bounds.is_none_or(|bounds| bounds.contains(target.coordinates.to_decimal(*point)))
        };
        let [mut all, mut stated] = [Vec::new(), Vec::new()];
        for (number, vertex) in (0..).zip(&network.vertices) {
            let z = levels.elevations.get(&number).copied().or(vertex.z);
            let point = z.map(|z| [vertex.place[0], vertex.place[1], z]);
            let Some(point) = point.filter(is_kept).filter(|_| !levels.left_out.contains(&number)) else {
                continue;
            };
            all.push(point);
            if vertex.z.is_some() || of_water.contains(&number) {
                stated.push(point);
            }
        }
        [all, stated]
    }
}

/// What is to be said about stated elevations that are far from those of the points around them.
fn about_far(stated: &[Point], around: Vec<Option<[f64; 2]>>, coordinates: &Coordinates) -> Option<String> {
    let pairs = stated.iter().zip(around);
    let mut far = pairs.filter_map(|(&point, around)| {
        around.filter(|&around| is_far(coordinates, point[2], around)).map(|around| (point, around))
    });
    let (first, around) = far.next()?;
    let [x, y, z] = coordinates.to_decimal(first);
    let [least, most] = around.map(|z| coordinates.to_decimal([0.0, 0.0, z])[2]);
    let elevations = ["elevation that lines or water state", "elevations that lines or water state"];
    Some(format!(
        "{} far from those of the points around, the first at {x}, {y}: {z}, amid points from {least} to {most}. \
         Check them; {ABOUT_FAR}",
        counted_of(far.count() as u64 + 1, stated.len() as u64, elevations, ["is", "are"])
    ))
}

impl Flatten {
    /// Finds the levels, from those of `points` that are near a shore if none are stated. Leaves water
    /// without points out.
    fn levels(
        &self,
        network: &Network,
        water: &mut Water,
        points: &dyn Passes,
        observer: &mut dyn Observer,
    ) -> Result<Levels> {
        let (target, needed) = (Target::of_points(points.description()), water.need_points());
        let (extent, width) = self.extent(&needed, points, observer)?;
        let mut shores = vec![Vec::new(); needed.len()];
        if needed.contains(&true) {
            shores = Shores::new(water.edges(network), &needed, width).collect(points, observer)?;
        }
        let is_beyond = |number: usize| {
            extent.is_some_and(|(bounds, _)| !water.polygons[number].is_within(width, &bounds, network))
        };
        let is_empty = |number: usize| !needed[number] || shores[number].is_empty();
        let mut far: Vec<bool> = (0..needed.len()).map(|it| is_empty(it) && is_beyond(it)).collect();
        let is_doubtful = |number: usize| needed[number] && shores[number].is_empty() && !far[number];
        if (0..needed.len()).any(is_doubtful) {
            let edges = water.edges(network).into_iter().filter(|(number, _)| is_doubtful(*number as usize));
            let inside = with_points(edges, points, observer)?;
            let is_dry = |number: &usize| is_doubtful(*number) && !inside.contains(&(*number as u32));
            let dry: Vec<usize> = (0..needed.len()).filter(is_dry).collect();
            dry.into_iter().for_each(|number| far[number] = true);
        }
        if let Some(text) = water.about_far(&far) {
            observer.notice(&text);
        }
        let left_out = water.leave_out(&far, network);
        let mut far = far.into_iter();
        shores.retain(|_| far.next() == Some(false));
        Ok(Levels { left_out, ..Levels::find(network, water, shores, self.percentile, &target)? })
    }

    /// The box and the number of the points, as far as they are known, and the width of shores in stored
    /// units. Headers say enough of the points where levels are stated.
    fn extent(
        &self,
        needed: &[bool],
        points: &dyn Passes,
        observer: &mut dyn Observer,
    ) -> Result<(Option<(Bounds, u64)>, f64)> {
        let &Description { stated_bounds, stated_points, coordinates, .. } = points.description();
        let mut known = stated_bounds.zip(stated_points);
        let lacks_width = self.width.is_none() && needed.contains(&true);
        if lacks_width || known.is_none() && needed.contains(&false) {
            known = extent(points, observer)?;
        }
        let width = match (self.width, coordinates) {
            (Some(width), Coordinates::I32 { scale, .. }) => width / scale[0],
            (Some(width), Coordinates::F64) => width,
            (None, _) => known.map_or(1.0, shore_width),
        };
        Ok((known, width))
    }
}
