//! Knots, configurations, functions and their basis, with the coordinate frame; reads and writes streams.

use std::io::Write;
use std::path::Path;

use super::beyond::Beyond;
use super::breaklines;
use super::certainty::Certainty;
use super::frame::Frame;
use super::options::Options;
use crate::bases::Basis;
use crate::fitting::SplineSpace;
use spmesh_base::error::{Error, Result};
use spmesh_configurations::{Configurations, Knots};
use spmesh_delaunay::predicates::Point2;
use spmesh_formats::detect::SPLINEFIT;
use spmesh_formats::source::{EventSource, Opened, SourceOptions, name_of, open_knots};
use spmesh_stream::model::functions::Function;
use spmesh_stream::{
    Collector, ConfigurationSet, Content, Header, Kind, configurations_header, write_content,
};

/// Functions with their knots and configurations, in a coordinate frame.
#[derive(Debug)]
pub struct Layout {
    /// The coordinate frame of the knots.
    pub frame: Frame,
    /// The knots, in stored coordinates.
    pub knots: Knots,
    /// Configurations of one degree less than the functions.
    pub configurations: Configurations,
    /// Functions as sums of B-splines; empty if they are the B-splines of links.
    pub functions: Vec<Function>,
    /// The basis that evaluates all functions.
    pub basis: Basis,
}

/// A spline: functions with coefficients.
#[derive(Debug)]
pub struct Spline {
    /// The functions.
    pub layout: Layout,
    /// A coefficient for each function. Units: those of elevations.
    pub coefficients: Vec<f64>,
    /// How sure it is, for attributes that are errors.
    pub certainty: Option<Certainty>,
    /// Limits other than the domain.
    pub beyond: Beyond,
}

impl Layout {
    /// The layout of a spline space with knots in the given frame.
    pub(super) fn of_space(space: SplineSpace, frame: Frame) -> Layout {
        let SplineSpace { knots, configurations, functions, basis, .. } = space;
        Layout { frame, knots, configurations, functions, basis }
    }

    /// The functions over knots that the program has placed, with the features of the options.
    pub(super) fn even(places: Vec<Point2>, options: &Options, frame: &Frame) -> Result<Layout> {
        let space = match (frame.stretch(), options.polylines.is_empty()) {
            (Some(stretch), _) => SplineSpace::displaced(stretch.places(places), stretch.displacement())?,
            (None, true) => SplineSpace::of(places)?,
            (None, false) => breaklines::space(&places, options)?,
        };
        Ok(Layout::of_space(space, frame.clone()))
    }

    /// The same functions in world coordinates, if they are stretched.
    pub(super) fn unstretched(&self) -> Result<Option<Layout>> {
        let Some(stretch) = self.frame.stretch() else { return Ok(None) };
        let Layout { frame, knots, configurations, functions, .. } = self;
        let knots = Knots::new(knots.points().iter().map(|&stored| stretch.undo(stored)).collect())?;
        let basis = Basis::of_functions(&knots, configurations, functions)?;
        let (configurations, functions) = (configurations.clone(), functions.clone());
        Ok(Some(Layout { frame: Frame::world(frame.crs.clone()), knots, configurations, functions, basis }))
    }

    /// Builds a layout from a set of knots. Of several degrees, it takes the configurations for splines of
    /// degree `degree`. If that is `None`, it takes those of the functions listed, or else the highest
    /// degree.
    fn of_set(set: ConfigurationSet, header: &Header, degree: Option<usize>) -> Result<Layout> {
        let ConfigurationSet { points, mut degrees, functions, .. } = set;
        let wanted = match degree {
            Some(0) => {
                return Err(Error::usage(
                    "splines of degree 0 have jumps at every edge: take degree 1 or higher",
                ));
            }
            Some(degree) => Some(degree - 1),
            None if !functions.is_empty() => Some(1),
            None => degrees.last().map(Configurations::degree),
        };
        let Some(at) = degrees.iter().position(|known| Some(known.degree()) == wanted) else {
            let needed = wanted.unwrap_or_default();
            return Err(Error::usage(format!(
                "there are no configurations of degree {needed}, which splines of degree {} are made of",
                needed + 1
            )));
        };
        let configurations = degrees.swap_remove(at);
        let functions = if configurations.degree() == 1 { functions } else { Vec::new() };
        let (frame, place) = Frame::of(header.coordinates, header.crs.clone());
        let knots = Knots::new(points.into_iter().map(place).collect())?;
        let basis = match functions.is_empty() {
            true => Basis::new(&knots, &configurations)?,
            false => Basis::of_functions(&knots, &configurations, &functions)?,
        };
        Ok(Layout { frame, knots, configurations, functions, basis })
    }

    /// Reads a stream of configurations, or of a spline. The coefficients are empty if it has none.
    pub(super) fn read(
        mut source: Box<dyn EventSource>,
        name: &str,
        degree: Option<usize>,
    ) -> Result<(Layout, Vec<f64>)> {
        let header = source.header().clone();
        let mut collector = Collector::new(&header);
        while let Some(event) = source.next_event()? {
            collector.event(&event).map_err(|error| source.locate(error))?;
        }
        let finish = || {
            let mut set = collector.finish();
            let coefficients = std::mem::take(&mut set.coefficients);
            Ok::<_, Error>((Layout::of_set(set, &header, degree)?, coefficients))
        };
        finish().map_err(|error| error.of_input(name))
    }

    /// Opens a file of configurations, or of a spline. The coefficients are empty if it has none.
    ///
    /// # Errors
    /// Usage, if the file is something else; those of [`open_knots`].
    pub fn open(path: &Path) -> Result<(Layout, Vec<f64>)> {
        let name = name_of(path);
        match open_knots(path, &SourceOptions { reader: &SPLINEFIT, dims: 2, ..SourceOptions::default() })? {
            Opened::Events(source) => Layout::read(source, &name, None),
            Opened::Points(_) => {
                Err(Error::usage("these are points, expected a spline: splinefit fit makes one of them")
                    .of_input(name))
            }
        }
    }

    /// Number of distinct places of knots.
    pub fn places(&self) -> usize {
        (0..self.knots.len() as u32).filter(|&id| self.knots.rank(id) == 0).count()
    }
}

impl Spline {
    /// A spline without errors.
    pub fn new(layout: Layout, coefficients: Vec<f64>) -> Spline {
        Spline { layout, coefficients, certainty: None, beyond: Beyond::default() }
    }

    /// Opens a file ("-" is standard input).
    ///
    /// # Errors
    /// Usage, if the file is not a spline; those of [`Layout::open`].
    pub fn open(path: &Path) -> Result<Spline> {
        let (layout, coefficients) = Layout::open(path)?;
        if coefficients.is_empty() {
            let what = "configurations without coefficients: splinefit fit --knots makes a spline of them";
            return Err(Error::usage(what).of_input(name_of(path)));
        }
        if coefficients.len() != layout.basis.len() {
            let (found, needed) = (coefficients.len(), layout.basis.len());
            let what = format!("{found} coefficients for {needed} functions: one each is needed");
            return Err(Error::malformed(what).of_input(name_of(path)));
        }
        Ok(Spline::new(layout, coefficients))
    }

    /// One function of the basis of a file ("-" is standard input), which may be configurations without
    /// coefficients.
    ///
    /// # Errors
    /// Usage, if there is no such function; those of [`Layout::open`].
    pub fn open_function(path: &Path, function: u32) -> Result<Spline> {
        let (layout, _) = Layout::open(path)?;
        let count = layout.basis.len();
        let mut coefficients = vec![0.0; count];
        match coefficients.get_mut(function as usize) {
            Some(coefficient) => *coefficient = 1.0,
            None => {
                let what = format!("there is no function {function}: {count} functions are numbered from 0");
                return Err(Error::usage(what).of_input(name_of(path)));
            }
        }
        Ok(Spline::new(layout, coefficients))
    }

    /// Writes the spline as a stream, whose blocks may be compressed.
    ///
    /// # Errors
    /// As [`write_content`].
    pub fn write(&self, compress: bool, output: impl Write) -> Result<()> {
        let Layout { frame, knots, configurations, functions, .. } = &self.layout;
        let header = Header {
            kind: Kind::Splines,
            compressed: compress,
            producer: concat!("splinefit ", env!("CARGO_PKG_VERSION")).to_string(),
            ..configurations_header(knots.points(), frame.coordinates, frame.crs.clone())
        };
        let content = Content {
            functions,
            coefficients: &self.coefficients,
            ..Content::of(knots.points(), std::slice::from_ref(configurations))
        };
        write_content(header, content, output)
    }
}
