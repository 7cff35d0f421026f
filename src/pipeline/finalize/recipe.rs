//! A whole run over files: points of one input, which polygons select, with vertices of lines and water, and
//! with weights.

use std::io::Write;
use std::path::PathBuf;

use super::added::AddedPoints;
use super::budget::Budget;
use super::flatten::{Evidence, Flatten};
use super::no_points::NoPoints;
use super::options::Options;
use super::passes::{Observer, Passes};
use super::run::Stats;
use super::run::run_with;
use super::select::{Areas, Selected};
use super::weigh::{Weighed, Weighing};
use crate::lines::{self, ABOUT_FAR, Changes, Levels, Lines, Shore, Sources, Target, Water, is_far};
use spmesh_base::error::{Error, Result, counted_of};
use spmesh_base::limits::LINE_VERTEX_BYTES;
use spmesh_delaunay::network::Network;
use spmesh_formats::source::{Dropped, Filters, Input, SourceOptions};
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::model::points::Point2;

/// The class of points of water, by the LAS specification.
const WATER_CLASS: u8 = 9;

/// What is finalized, and how.
#[derive(Debug, Clone)]
pub struct Recipe {
    /// Files of points, which are one input; `-` is stdin. Without any, lines are all there is.
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
    /// Points of the input that were raised to the water.
    pub raised: u64,
    /// What was changed about lines.
    pub changes: Changes,
}

impl Recipe {
    /// Writes the finalized stream, END included.
    ///
    /// # Errors
    /// Those of reading; those of [`super::run()`].
    pub fn run(&self, observer: &mut dyn Observer, mut output: impl Write) -> Result<Outcome> {
        if self.inputs.is_empty() {
            let input = NoPoints::beside(&self.lines, &self.source)?;
            return self.finalize(&input, observer, &mut output);
        }
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

    /// Opens the points of the class of water, if levels may be found from them.
    fn open_water_points(&self) -> Result<Option<Input>> {
        if self.flatten.water_points.is_none() {
            return Ok(None);
        }
        if self.inputs.iter().any(|path| path.as_os_str() == "-") {
            let message =
                "--water-points reads the points twice, with other classes: give files, and not stdin";
            return Err(Error::usage(message));
        }
        let filters =
            Filters { keep_class: vec![WATER_CLASS], drop_class: Vec::new(), ..self.source.filters.clone() };
        let source = SourceOptions { filters, ..self.source.clone() };
        Input::open(&self.inputs, &source).map(Some)
    }

    /// Writes the lakes and rivers with their levels as GeoJSON, and no points. Returns what is said of each.
    ///
    /// # Errors
    /// Those of reading and writing; malformed, if a polygon has neither a level nor points, or lakes of
    /// different levels meet; usage, if there are no points.
    pub fn write_levels(&self, observer: &mut dyn Observer, output: &mut dyn Write) -> Result<Vec<Shore>> {
        let input = self.open()?;
        input.notices().iter().for_each(|message| observer.notice(message));
        let target = Target::of_points(input.description());
        let (areas, Lines { network, mut water, .. }) = self.read_beside(&target, observer)?;
        let in_water = self.open_water_points()?;
        let in_water = in_water.as_ref().map(|input| Selected::new(input, &areas));
        let budget = self.budget_beside(&areas, network.vertices.len())?;
        let points = &Selected::new(&input, &areas);
        let points = Evidence { points, in_water: in_water.as_ref(), budget };
        self.flatten.write_levels(&network, &mut water, &points, observer, output)
    }

    /// Finalizes `input`, which are the points of [`Self::open`] or a part of them.
    pub(crate) fn finalize(
        &self,
        input: &dyn Passes,
        observer: &mut dyn Observer,
        output: &mut dyn Write,
    ) -> Result<Outcome> {
        let target = Target::of_points(input.description());
        let (mut areas, lines) = self.read_beside(&target, observer)?;
        let Lines { network, points, mut water, changes, .. } = lines;
        let levels = if water.polygons.is_empty() {
            Levels::default()
        } else {
            let is_needed = water.need_points().contains(&true);
            let in_water = if is_needed { self.open_water_points()? } else { None };
            let in_water = in_water.as_ref().map(|input| Selected::new(input, &areas));
            let budget = self.budget_beside(&areas, network.vertices.len())?;
            let points = &Selected::new(input, &areas);
            let points = Evidence { points, in_water: in_water.as_ref(), budget };
            let levels = self.flatten.levels(&network, &mut water, &points, observer)?;
            let raise = self.flatten.raising(&network, &water, &levels, target.coordinates);
            areas = areas.with_water(water.edges(&network), raise);
            levels
        };
        levels.notices.iter().for_each(|message| observer.notice(message));
        let [mut all, mut stated] = self.added(&network, &levels, &water, &target);
        let is_free = |point: &Point| areas.keeps([point[0], point[1]]) && self.is_in_reach(point, &target);
        let points: Vec<Point> = points.into_iter().filter(is_free).collect();
        let has_lines = !network.vertices.is_empty() || !points.is_empty();
        stated.extend(&points);
        all.extend(points);
        let added = AddedPoints::new(all);
        if self.inputs.is_empty() && added.is_empty() {
            let message =
                "no vertex of --lines has an elevation: if a property states it, name it with --z-field";
            return Err(Error::usage(message));
        }
        let budget = self.budget_beside(&areas, network.vertices.len() + added.len())?;
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
        let [clip, inside, flooded, raised] = selected.counts();
        Ok(Outcome {
            stats,
            dropped: Drops { areas: [clip, inside, flooded], ..Drops::default() },
            lines: LineStats { has_lines, water, points, replaced, raised, changes },
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

    /// Polygons, lines and water; what is to be said about them is said.
    fn read_beside(&self, target: &Target, observer: &mut dyn Observer) -> Result<(Areas, Lines)> {
        let (areas, notices) =
            Areas::read([&self.clip, &self.drop_inside], target, self.options.budget.bytes())?;
        let lines = self.read_lines(target)?;
        notices.iter().chain(&lines.changes.notices).for_each(|message| observer.notice(message));
        Ok((areas, lines))
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
                lines::read(&sources, target, &self.line_options.clone().within(self.options.budget.bytes()))
            }
        }
    }

    /// How many vertices of water there are at which `is_covered` does not hold, and in all, for points of
    /// `target` that many runs take in parts.
    ///
    /// # Errors
    /// Those of reading; usage, if the level of some water is not stated, since no part has all points that
    /// say it.
    pub fn stated_water(&self, target: &Target, is_covered: impl Fn(Point2) -> bool) -> Result<[u64; 2]> {
        let Lines { network, water, .. } = self.read_lines(target)?;
        if let Some(polygon) = water.without_level() {
            return Err(Error::usage(format!(
                "{}: no level is stated, and jobs see the points of their own boxes alone: write all levels first, with \
                 --levels, and flatten with that file",
                polygon.position
            )));
        }
        let vertices = water.stated_vertices(&network);
        let uncovered =
            vertices.iter().filter(|&&vertex| !is_covered(network.vertices[vertex as usize].place));
        Ok([uncovered.count() as u64, vertices.len() as u64])
    }

    /// The box around one of points in which lines and water decide about them.
    pub(crate) fn reach(&self, Bounds { min, max }: &Bounds) -> [Point2; 2] {
        let width = self.flatten.width.filter(|_| self.flatten.raise).unwrap_or(0.0);
        [[min[0] - width, min[1] - width], [max[0] + width, max[1] + width]]
    }

    /// Whether a stored point is in the boxes that limit the input.
    fn is_in_reach(&self, point: &Point, target: &Target) -> bool {
        self.source.bounds.is_none_or(|bounds| bounds.contains(target.coordinates.to_decimal(*point)))
            && self.source.window.is_none_or(|window| window.contains(*point))
    }

    /// The vertices of lines and water that become points, and those of them whose elevation a file states.
    fn added(&self, network: &Network, levels: &Levels, water: &Water, target: &Target) -> [Vec<Point>; 2] {
        let of_water = water.stated_vertices(network);
        let [mut all, mut stated] = [Vec::new(), Vec::new()];
        for (number, vertex) in (0..).zip(&network.vertices) {
            let z = levels.elevations.get(&number).copied().or(vertex.z);
            let point = z.map(|z| [vertex.place[0], vertex.place[1], z]);
            let Some(point) = point
                .filter(|point| self.is_in_reach(point, target))
                .filter(|_| !levels.left_out.contains(&number))
            else {
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
