//! Pictures of configurations: knots, centroid triangulations, and the link of a set of knots (thesis, figure
//! 7.3).

use super::options::Options;
use super::picture::Picture;
use super::projection::Scene;
use super::sheet::{Furniture, Mark, Shape, Units};
use super::svg::{self, Anchor};
use super::{copies, points, ticks};
use spmesh_base::error::{Error, Result};
use spmesh_configurations::{CentroidMesh, Configurations, FARAWAY, Knots};
use spmesh_formats::raster::colour_map::{Colour, hex};
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::{ConfigurationSet, Header};

/// Triangles of the lower degree, the link, its inside, the chosen set, the knots, and triangles of the upper
/// degree.
const LOWER: Colour = [184, 222, 190];
const LINK: Colour = [214, 96, 20];
const INSIDE: Colour = [158, 196, 232];
const CHOSEN: Colour = [130, 50, 160];
const KNOT: Colour = [36, 41, 47];
const UPPER: Colour = [255; 3];

/// Up to this many knots are numbered.
const NUMBERED_MAX: usize = 60;

/// The margin inside the map, with room for numbers. Units: lengths of the picture.
const PAD: f64 = 24.0;

/// Above this many triangles, edges are drawn as hairlines.
const EDGES_MAX: usize = 40_000;

/// The configurations of a stream, and how they are drawn.
struct Diagram<'a> {
    set: &'a ConfigurationSet,
    knots: &'a Knots,
    scene: Scene,
    units: Units,
    options: &'a Options,
}

/// The picture of the configurations of `knots` in a set: the link of [`Options::set`], or else the centroid
/// triangulation of [`Options::order`].
pub(super) fn picture(
    knots: &Knots,
    set: &ConfigurationSet,
    header: &Header,
    options: &Options,
) -> Result<Picture> {
    let coordinates = header.coordinates;
    let units = Units::of(options.crs.as_ref().unwrap_or(&header.crs));
    let places = knots.points().iter().map(|&[x, y]| coordinates.to_world([x, y, 0.0]));
    let mut places: Vec<Point> = places.collect();
    if options.apart {
        places =
            copies::apart(&places, set.degrees.iter().find(|configurations| configurations.degree() == 0));
    }
    let places = places;
    let bounds = Bounds::of_points(&places).unwrap_or(Bounds::of_point([0.0; 3]));
    let scene = Scene::plan(&bounds, options.bounds, PAD, options.width)?;
    let diagram = Diagram { set, knots, scene, units, options };
    match &options.set {
        Some(chosen) => diagram.link(chosen, &places),
        None => diagram.centroids(&places),
    }
}

impl Diagram<'_> {
    /// The centroid triangulation of an order, with the knots on top.
    fn centroids(&self, knots: &[Point]) -> Result<Picture> {
        let Some(last) = self.set.degrees.last() else {
            return Ok(self.finish(String::new(), knots, &[], &[], "no configurations".to_string()));
        };
        let order = self.options.order.unwrap_or(last.degree() + 1);
        let upper = self.degree(order.wrapping_sub(1))?;
        // A stream may have a single degree; then the triangles of the lower degree stay blank.
        let missing = (order > 1).then(|| Configurations::new(order - 2, upper.claim()));
        let lower = self.find(order.wrapping_sub(2)).or(missing.as_ref());
        // Centroids in the world: copies that are drawn apart are apart there only.
        let drawn = Knots::new(knots.iter().map(|&[x, y, _]| [x, y]).collect())?;
        let mesh = CentroidMesh::of(&drawn, lower, upper)?;
        let places: Vec<Point> = mesh.vertices.iter().map(|&[x, y]| [x, y, 0.0]).collect();
        let corners = |triangle: &[u32; 3]| triangle.map(|vertex| places[vertex as usize]);
        let (upper, lower) = mesh.triangles.split_at(mesh.from_upper);
        let map = self.rings("upper", UPPER, upper.iter().map(corners))
            + &self.rings("lower", LOWER, lower.iter().map(corners));
        let words: &[Mark] = if lower.is_empty() {
            &[]
        } else {
            &[
                Mark {
                    shape: Shape::Area,
                    colour: UPPER,
                    words: "interior set and one knot of the boundary",
                },
                Mark {
                    shape: Shape::Area,
                    colour: LOWER,
                    words: "interior set and two knots of the boundary",
                },
            ]
        };
        let what = if order == 1 {
            ticks::counted(mesh.triangles.len() as u64, "triangle of the knots", "triangles of the knots")
        } else {
            let count = ticks::counted(mesh.triangles.len() as u64, "triangle", "triangles");
            format!("{count} of the centroids of {order} knots (order {order})")
        };
        Ok(self.finish(map, knots, &[], words, what))
    }

    /// The link of a set and its triangles, on the triangulation of the knots if the stream has it.
    fn link(&self, chosen: &[u32], knots: &[Point]) -> Result<Picture> {
        let mut chosen = chosen.to_vec();
        chosen.sort_unstable();
        if let Some(knot) = chosen.iter().find(|&&knot| knot as usize >= knots.len()) {
            return Err(Error::usage(format!(
                "there is no knot {knot}: the last one is {}",
                knots.len().saturating_sub(1)
            )));
        }
        let names: Vec<String> = chosen.iter().map(u32::to_string).collect();
        let names = names.join(",");
        let links = spmesh_configurations::links(self.knots, self.degree(chosen.len().wrapping_sub(1))?)?;
        let Some(link) = links.find(&chosen).map(|index| links.link(index)) else {
            return Err(Error::usage(format!("the set {names} has no link")));
        };
        let corners = |triangle: [u32; 3]| triangle.map(|knot| knots[knot as usize]);
        let start =
            self.find(0).into_iter().flat_map(Configurations::iter).map(|(triangle, _)| corners(triangle));
        let inside = self.find(chosen.len()).into_iter().flat_map(Configurations::iter);
        let inside: Vec<_> = inside
            .filter(|(_, interior)| *interior == chosen)
            .map(|(triangle, _)| corners(triangle))
            .collect();
        let edges: Vec<[Point; 2]> = link
            .edges()
            .filter(|ends| !ends.contains(&FARAWAY))
            .map(|ends| ends.map(|knot| knots[knot as usize]))
            .collect();
        let map = self.rings("start", UPPER, start)
            + &self.rings("inside", INSIDE, inside.iter().copied())
            + &points::lines("link", LINK, 1.5, &edges, &self.scene);
        let words = [
            Mark { shape: Shape::Dot, colour: CHOSEN, words: "the set of knots" },
            Mark { shape: Shape::Line, colour: LINK, words: "its link" },
            Mark { shape: Shape::Area, colour: INSIDE, words: "the triangles of its link" },
        ];
        let words = &words[..if inside.is_empty() { 2 } else { 3 }];
        let kind = match (link.is_null(), link.is_infinite()) {
            (true, _) => ", which is null",
            (_, true) => ", which goes through the faraway point",
            _ => "",
        };
        Ok(self.finish(map, knots, &chosen, words, format!("link of the set {names}{kind}")))
    }

    /// Adds the knots to a map, and the furniture around it.
    fn finish(
        &self,
        mut map: String,
        knots: &[Point],
        chosen: &[u32],
        marks: &[Mark],
        what: String,
    ) -> Picture {
        let others: Vec<Point> =
            (0..).zip(knots).filter(|(knot, _)| !chosen.contains(knot)).map(|(_, &at)| at).collect();
        let chosen: Vec<Point> = chosen.iter().map(|&knot| knots[knot as usize]).collect();
        map += &points::marks("knots", KNOT, 3.0, &others, &self.scene);
        if !chosen.is_empty() {
            map += &points::marks("set", CHOSEN, 5.5, &chosen, &self.scene);
        }
        if knots.len() <= NUMBERED_MAX {
            map += &self.numbers(knots);
        }
        let count = ticks::counted(knots.len() as u64, "knot", "knots");
        let title = format!("{}: {count}, {what}", self.options.name);
        let frame = self.scene.view.frame();
        let unit = frame.map(|frame| frame.unit).filter(|_| !knots.is_empty());
        let knot = Mark { shape: Shape::Dot, colour: KNOT, words: "knots" };
        let marks: Vec<&Mark> = std::iter::once(&knot).chain(marks).collect();
        let unit = unit.map(|unit| (unit, &self.units.plan[..]));
        let furniture = Furniture { title: &title, legend: None, marks: &marks, unit };
        Picture { svg: self.scene.sheet.svg(&map, &furniture), title, frame }
    }

    fn numbers(&self, knots: &[Point]) -> String {
        let mut text = format!("<g id=\"numbers\" fill=\"{}\">\n", hex(KNOT));
        for (number, &at) in knots.iter().enumerate() {
            let [x, y, _] = self.scene.view.place(at);
            text += &svg::text([x + 6.0, y - 6.0], 11, Anchor::Start, &number.to_string());
        }
        text + "</g>\n"
    }

    fn rings(&self, id: &str, colour: Colour, triangles: impl Iterator<Item = [Point; 3]>) -> String {
        let (mut path, mut count) = (String::new(), 0);
        for corners in triangles.filter(|corners| self.scene.may_show(corners)) {
            path += &svg::ring(&corners.map(|corner| self.scene.view.place(corner)).map(|[x, y, _]| [x, y]));
            count += 1;
        }
        if count == 0 {
            return String::new();
        }
        let width = if count <= EDGES_MAX { 0.6 } else { 0.1 };
        format!(
            "<path id=\"{id}\" fill=\"{}\" stroke=\"#24292f\" stroke-width=\"{width}\" \
             stroke-linejoin=\"round\" \
             vector-effect=\"non-scaling-stroke\" d=\"{path}\"/>\n",
            hex(colour)
        )
    }

    fn find(&self, degree: usize) -> Option<&Configurations> {
        self.set.degrees.iter().find(|configurations| configurations.degree() == degree)
    }

    fn degree(&self, degree: usize) -> Result<&Configurations> {
        self.find(degree).ok_or_else(|| {
            let known: Vec<String> =
                self.set.degrees.iter().map(|configurations| configurations.degree().to_string()).collect();
            let known = known.join(", ");
            Error::usage(format!(
                "an order, or a set, of {} knots needs configurations of one degree less; the stream has degrees {known}",
                degree.wrapping_add(1)
            ))
        })
    }
}
