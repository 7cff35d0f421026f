//! From a stream to pictures of its end or of earlier moments.

use std::io::Read;

use super::cells::Cells;
use super::front::Front;
use super::layer::Layer;
use super::options::{Fill, Moments, Options};
use super::picture::Picture;
use super::points::{self, DrawnPoint};
use super::projection::{PAD, Scene};
use super::sheet::{Furniture, Legend, Mark, Shape, Units};
use super::shown::{Shown, percentiles, some_of};
use super::style::{Colours, Style};
use super::triangles::{self, Triangle};
use super::{configurations, options, svg, ticks};
use spmesh_base::error::Result;
use spmesh_configurations::Knots;
use spmesh_delaunay::predicates::Point2;
use spmesh_formats::outline::{ConcaveOutline, EdgeLimit, Waiting};
use spmesh_formats::raster::colour_map::Colour;
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::model::cells::CellCode;
use spmesh_stream::{
    ConfigurationSet, ConstraintEdges, Coordinates, Event, Header, Kind, Patch, StreamReader,
};

/// Live vertices, and residual points.
const LIVE: Mark = Mark { shape: Shape::Dot, colour: [214, 40, 40], words: "live vertices" };
const RESIDUAL: Mark = Mark { shape: Shape::Dot, colour: [214, 40, 40], words: "residual points" };
/// The border of the triangles so far, and walls.
const BORDER: Mark =
    Mark { shape: Shape::Line, colour: [230, 120, 0], words: "border of the triangles so far" };
const WALLS: Mark = Mark { shape: Shape::Line, colour: [230, 120, 0], words: "walls" };
/// Edges on segments of a constrained mesh.
const LINES: Mark = Mark { shape: Shape::Line, colour: [230, 30, 40], words: "edges on lines" };
/// Final and open cells.
const CLOSED: Colour = [59, 82, 139];
const FINAL: Mark = Mark {
    shape: Shape::Area,
    colour: CLOSED,
    words: "final cell: middle by its first point, border by its last",
};
const OPEN: Mark = Mark { shape: Shape::Area, colour: [255; 3], words: "open cell" };

/// Memory for triangles that wait for the outline; further ones wait in a temporary file. Units: bytes.
const OUTLINE_MEMORY: u64 = 1 << 28;

/// Receives a complete picture.
pub type Take<'a> = dyn FnMut(&Picture) -> Result<()> + 'a;

/// Draws a stream and calls `take` with the pictures of `moments`; without [`Moments::at`], the last one
/// shows the end. Calls `progress` with the number of points or vertices read. Reads the stream to its end in
/// any case.
///
/// Memory: see [`super`].
///
/// # Errors
/// Usage, if the stream cannot be drawn in the plane, or lacks what the options ask for; if it is malformed
/// or truncated; those of `take`.
pub fn draw<R: Read>(
    reader: &mut StreamReader<R>,
    options: &Options,
    moments: Moments,
    take: &mut Take,
    mut progress: impl FnMut(u64),
) -> Result<()> {
    let header = reader.header().clone();
    options::check(&header, options, &moments).map_err(|error| error.of_input(reader.name()))?;
    if header.kind.has_knots() {
        let mut set = ConfigurationSet::read(reader)?;
        let knots = Knots::new(std::mem::take(&mut set.points)).map_err(|e| e.of_input(reader.name()))?;
        let picture = configurations::picture(&knots, &set, &header, options);
        return take(&picture?);
    }
    let mut drawing =
        Drawing::new(&header, options, moments).map_err(|error| error.of_input(reader.name()))?;
    while let Some(event) = reader.next_event()? {
        drawing.event(event, reader.rows(), take).map_err(|error| reader.locate(error))?;
        progress(reader.totals().points.max(reader.totals().vertices));
    }
    drawing.end(take)
}

/// The scene of a box of the world.
fn scene_of(bounds: &Bounds, options: &Options) -> Result<Scene> {
    if options.oblique {
        Scene::oblique(bounds, options.width)
    } else {
        Scene::plan(bounds, options.bounds, PAD, options.width)
    }
}

/// The state of a picture while the stream is read.
struct Drawing<'a> {
    options: &'a Options,
    moments: Moments,
    kind: Kind,
    units: Units,
    coordinates: Coordinates,
    shown: Shown,
    style: Style,
    scene: Option<Scene>,
    /// The number of points, if the header states it; then the colours of time agree in all pictures.
    count: Option<u64>,
    /// The range of elevations, if the header states it.
    stated: Option<[f64; 2]>,
    /// Finds triangles with a long edge.
    long_edges: EdgeLimit,
    /// Finds the triangles outside of the concave outline.
    outline: Option<ConcaveOutline>,
    triangles: Layer<Triangle>,
    points: Layer<DrawnPoint>,
    front: Front,
    cells: Option<Cells>,
    residual: Vec<Point>,
    walls: Vec<[Point; 2]>,
    /// The edges on segments, to be drawn on top.
    constraint_edges: ConstraintEdges,
    lines: Vec<[Point; 2]>,
    /// Number of triangles so far, or of points.
    done: u64,
    /// The value of `done` at the last picture.
    taken: Option<u64>,
    is_over: bool,
}

impl<'a> Drawing<'a> {
    fn new(header: &Header, options: &'a Options, moments: Moments) -> Result<Drawing<'a>> {
        let coordinates = header.coordinates;
        let world = |bounds: Bounds| Bounds {
            min: coordinates.to_world(bounds.min),
            max: coordinates.to_world(bounds.max),
        };
        let stated = header.bounds.map(world).or(options.extent);
        let is_mesh = header.kind != Kind::Points;
        let has_elevation = header.dims == 3 || header.has_elevation;
        let anywhere = Bounds::of_point([0.0; 3]);
        let scene = (stated.is_some() || options.bounds.is_some())
            .then(|| scene_of(&stated.unwrap_or(anywhere), options))
            .transpose()?;
        let shown = Shown::of(&header.attributes, options)?;
        let units = Units::of(options.crs.as_ref().unwrap_or(&header.crs));
        let has_elevation = has_elevation && matches!(shown, Shown::Elevation);
        let has_cells = matches!(shown, Shown::Elevation)
            && options.cells
            && !is_mesh
            && options.fill.is_none_or(|fill| fill == Fill::Time);
        let tree = header.tree.filter(|tree| has_cells && tree.dims() == 2);
        let cells = tree.zip(scene.as_ref()).map(|(tree, scene)| Cells::new(tree, coordinates, scene));
        Ok(Drawing {
            style: Style::of(
                options,
                &shown,
                &units,
                has_elevation,
                if is_mesh { "triangles" } else { "points" },
            ),
            front: Front::new(moments.at.is_some() || moments.every.is_some()),
            options,
            moments,
            kind: header.kind,
            units,
            coordinates,
            shown,
            scene,
            count: header.points.filter(|_| !is_mesh),
            stated: stated.filter(|_| has_elevation).map(|bounds| [bounds.min[2], bounds.max[2]]),
            long_edges: EdgeLimit::new(options.kill, &coordinates),
            outline: options
                .concave
                .map(|length| ConcaveOutline::new(length, &coordinates, OUTLINE_MEMORY, None)),
            triangles: Layer::new(options.form),
            points: Layer::new(options.form),
            cells,
            residual: Vec::new(),
            walls: Vec::new(),
            constraint_edges: ConstraintEdges::default(),
            lines: Vec::new(),
            done: 0,
            taken: None,
            is_over: false,
        })
    }

    fn event(&mut self, event: Event, rows: &[u8], take: &mut Take) -> Result<()> {
        match event {
            _ if self.is_over => Ok(()),
            Event::Points(points) => {
                (0..).zip(points).try_for_each(|(number, point)| self.point(point, rows, number, take))
            }
            Event::Cells(cells) => cells.into_iter().try_for_each(|cell| self.tag(cell)),
            Event::Patch(patch) => self.patch(&patch, rows, take),
            Event::ResidualPoints(points) => {
                let world = points.into_iter().map(|(_, stored)| self.coordinates.to_world(stored));
                self.residual.extend(world);
                Ok(())
            }
            Event::Walls(ends) => {
                let wall = |ends: &[u32]| [0, 1].map(|end| self.residual[ends[end] as usize]);
                self.walls.extend(ends.chunks_exact(2).map(wall));
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn end(&mut self, take: &mut Take) -> Result<()> {
        if self.is_over {
            return Ok(());
        }
        if let Some(outline) = self.outline.take() {
            let mut inside = outline.finish()?;
            while let Some(Waiting { ids, corners, number }) = inside.next_triangle()? {
                self.push(Triangle { ids, corners, number })?;
            }
        }
        take(&self.picture(":")?)
    }

    /// Takes a triangle, which is kept for later if it may be outside of the outline.
    fn triangle(&mut self, triangle: Triangle, places: [Point2; 3]) -> Result<()> {
        if let Some(outline) = &mut self.outline {
            let Triangle { ids, corners, number } = triangle;
            // A triangle that is not drawn has edges of the outline, too. Without places, it is never drawn.
            let is_killed = self.long_edges.is_exceeded(places);
            let corners = if is_killed { [[f64::NAN; 3]; 3] } else { corners };
            if outline.take(places, Waiting { ids, corners, number })? {
                return Ok(());
            }
        }
        if self.long_edges.is_exceeded(places) { Ok(()) } else { self.push(triangle) }
    }

    /// Draws a triangle, unless a value is unknown.
    fn push(&mut self, triangle: Triangle) -> Result<()> {
        if triangle.corners.iter().any(|corner| corner[2].is_nan()) {
            return Ok(());
        }
        self.triangles.push(triangle, self.scene.as_ref(), &self.style)
    }

    fn patch(&mut self, patch: &Patch, rows: &[u8], take: &mut Take) -> Result<()> {
        let (coordinates, shown) = (self.coordinates, &self.shown);
        let place = |number: usize, stored: Point| shown.place(coordinates.to_world(stored), rows, number);
        self.front.begin(patch, place)?;
        for (ends, _) in self.constraint_edges.enter(patch) {
            let ends = ends.map(|local| self.front.place(local));
            if self.scene.as_ref().is_none_or(|scene| scene.may_show(&ends)) {
                self.lines.push(ends);
            }
        }
        for local in patch.triangles() {
            self.take_due(take)?;
            if self.is_over {
                return Ok(());
            }
            let (triangle, places) = self.front.triangle(local, self.done);
            self.triangle(triangle, places)?;
            self.done += 1;
        }
        self.front.end();
        Ok(())
    }

    fn point(&mut self, stored: Point, rows: &[u8], number: usize, take: &mut Take) -> Result<()> {
        self.take_due(take)?;
        if self.is_over {
            return Ok(());
        }
        let at = self.shown.place(self.coordinates.to_world(stored), rows, number);
        let point = DrawnPoint { at, number: self.done };
        match (&mut self.cells, &self.scene) {
            (Some(cells), Some(scene)) => {
                cells.point(stored, self.done, scene);
                self.points.push_few(point, scene);
            }
            _ if at[2].is_nan() => {}
            _ => self.points.push(point, self.scene.as_ref(), &self.style)?,
        }
        self.done += 1;
        Ok(())
    }

    fn tag(&mut self, cell: CellCode) -> Result<()> {
        self.cells.as_mut().map_or(Ok(()), |cells| cells.finalize(cell))
    }

    /// Takes the picture that is due before the next triangle or point.
    fn take_due(&mut self, take: &mut Take) -> Result<()> {
        let Moments { at, every } = self.moments;
        let is_last = at == Some(self.done);
        let is_due = every.is_some_and(|every| self.done > 0 && self.done.is_multiple_of(every));
        if (is_last || is_due) && self.taken != Some(self.done) {
            self.taken = Some(self.done);
            take(&self.picture(" after")?)?;
            self.is_over = is_last;
        }
        Ok(())
    }

    /// The picture now. In its title, `relation` stands between the name of the stream and the counts.
    fn picture(&self, relation: &str) -> Result<Picture> {
        let scene = match self.scene {
            _ if self.is_tight() => self.tight_scene()?,
            Some(scene) => scene,
            None => {
                let seen = self.triangles.bounds.or(self.points.bounds).unwrap_or(Bounds::of_point([0.0; 3]));
                scene_of(&seen, self.options)?
            }
        };
        let (mut map, legend) =
            if self.kind == Kind::Points { self.map_of_points(&scene)? } else { self.map_of_mesh(&scene)? };
        if let Some(mask) = &self.options.mask {
            let place = |[x, y]: Point2| {
                let [x, y, _] = scene.view.place([x, y, 0.0]);
                [x, y]
            };
            map = svg::clipped(&map, mask.polygons.iter(), place);
        }
        let marks = self.marks(&scene, &mut map);
        let title = format!("{}{relation} {}", self.options.name, self.what());
        let frame = scene.view.frame();
        // An empty picture has no scale.
        let unit = frame.map(|frame| frame.unit).filter(|_| self.done > 0 || self.scene.is_some());
        let marks: Vec<&Mark> = marks.iter().collect();
        let unit = unit.map(|unit| (unit, &self.units.plan[..]));
        let furniture = Furniture { title: &title, legend, marks: &marks, unit };
        Ok(Picture { svg: scene.sheet.svg(&map, &furniture), title, frame })
    }

    /// Whether the picture is an oblique view of the kept triangles alone, so that it can be fitted to them.
    fn is_tight(&self) -> bool {
        self.options.oblique && self.moments == Moments::default() && !self.triangles.kept.is_empty()
    }

    fn tight_scene(&self) -> Result<Scene> {
        let corners = || self.triangles.kept.iter().flat_map(|triangle| triangle.corners);
        let bounds = corners().map(Bounds::of_point).reduce(Bounds::union);
        Scene::oblique_of(&bounds.unwrap_or(Bounds::of_point([0.0; 3])), corners(), self.options.width)
    }

    /// Triangles and vertices so far, or those of the whole mesh.
    fn counts(&self) -> [u64; 2] {
        let whole = self.options.whole.map(|totals| [totals.simplices, totals.vertices]);
        whole.unwrap_or([self.done, self.front.count()])
    }

    /// The counts in the title.
    fn what(&self) -> String {
        if self.kind == Kind::Points {
            return ticks::counted(self.done, "point", "points");
        }
        let [done, vertices] = self.counts();
        let vertices = ticks::counted(vertices, "vertex", "vertices");
        // A hillshade has no legend to name it.
        let shade = if self.options.fill == Some(Fill::Hillshade) { ", hillshade" } else { "" };
        format!("{}, {vertices}{shade}", ticks::counted(done, "triangle", "triangles"))
    }

    fn map_of_mesh(&self, scene: &Scene) -> Result<(String, Option<Legend>)> {
        let layer = &self.triangles;
        let painted = layer.painted(scene, &self.style);
        let canvas = layer.canvas.as_ref().or(painted.as_ref());
        let fill = self.style.fill(canvas.is_some());
        let seen = layer.bounds.map(|bounds| [bounds.min[2], bounds.max[2]]);
        let elevations = self.stated.or(seen).unwrap_or([0.0; 2]);
        let colours = self.style.colours(fill, elevations, self.done, |percents| match canvas {
            Some(canvas) => percentiles(some_of(canvas.values()).map(|value| (value, 1.0)), percents),
            None => percentiles(layer.kept.iter().flat_map(triangles::weighted), percents),
        });
        let map = match canvas {
            Some(canvas) => {
                svg::image(scene.sheet.corner, &canvas.pixels(|value, shade| colours.of(value, shade))?)
            }
            None => triangles::vectors(&layer.kept, scene, &self.style, &colours),
        };
        Ok((map, colours.legend().filter(|_| self.counts()[0] > 0)))
    }

    fn map_of_points(&self, scene: &Scene) -> Result<(String, Option<Legend>)> {
        let (layer, fill) = (&self.points, self.style.point_fill());
        let seen = layer.bounds.map(|bounds| [bounds.min[2], bounds.max[2]]);
        let elevations = self.stated.or(seen).unwrap_or([0.0; 2]);
        let painted = layer.painted(scene, &self.style);
        let canvas = layer.canvas.as_ref().or(painted.as_ref());
        let count = self.count.unwrap_or(self.done);
        let colours = self.style.colours(fill, elevations, count, |percents| match canvas {
            Some(canvas) => percentiles(some_of(canvas.values()).map(|value| (value, 1.0)), percents),
            None => percentiles(layer.kept.iter().map(|point| (point.at[2], 1.0)), percents),
        });
        let map = match (&self.cells, canvas) {
            (Some(cells), _) => {
                cells.vectors(scene, &colours) + &points::vectors(&layer.kept, scene, &self.style, None)
            }
            (None, Some(canvas)) => svg::image(
                scene.sheet.corner,
                &canvas.pixels(|value, shade| self.point_colour(&colours, value, shade))?,
            ),
            (None, None) => points::vectors(&layer.kept, scene, &self.style, Some(&colours)),
        };
        Ok((map, colours.legend().filter(|_| self.done > 0)))
    }

    /// The colour of a point; dark if points show no value.
    fn point_colour(&self, colours: &Colours, value: f64, shade: f64) -> Colour {
        if self.style.point_fill() == Fill::None { [36, 41, 47] } else { colours.of(value, shade) }
    }

    /// Draws borders, live vertices and residual points on the map, and returns the marks for its legend.
    fn marks(&self, scene: &Scene, map: &mut String) -> Vec<Mark> {
        let mut marks = Vec::new();
        if let Some(cells) = &self.cells {
            let kinds = cells.counts().into_iter().zip([FINAL, OPEN]);
            marks.extend(kinds.filter(|(count, _)| *count > 0).map(|(_, mark)| mark));
        }
        let (border, vertices) = (self.front.border(), self.front.vertices());
        let is_partial = !self.residual.is_empty();
        let dots = if is_partial { (RESIDUAL, &self.residual) } else { (LIVE, &vertices) };
        let lines = if is_partial { (WALLS, &self.walls) } else { (BORDER, &border) };
        if !self.lines.is_empty() {
            *map += &points::lines("lines", LINES.colour, 2.5, &self.lines, scene);
            marks.push(LINES);
        }
        if !lines.1.is_empty() {
            *map += &points::lines("border", lines.0.colour, 1.5, lines.1, scene);
            marks.push(lines.0);
        }
        if !dots.1.is_empty() {
            *map += &points::marks("live", dots.0.colour, 3.0, dots.1, scene);
            marks.push(dots.0);
        }
        marks
    }
}
