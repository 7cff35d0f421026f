//! Reads knots from files: points of any source, or the vertices of a triangle mesh with its triangles.

use std::path::PathBuf;

use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay2::MAX_POINTS;
use spmesh_delaunay::predicates::Point2;
use spmesh_formats::detect::CONFIGGEN;
use spmesh_formats::source::{EventSource, Input, Opened, SourceOptions, name_of, open_planar};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, Crs, Event};

/// The encoding of stored knots.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// How they are stored.
    pub coordinates: Coordinates,
    /// Coordinate reference system.
    pub crs: Crs,
    /// Elevations as they are stored, one per knot, if there are any.
    pub elevations: Option<Vec<f64>>,
}

/// The content of an input.
#[derive(Debug, Clone)]
pub struct Sites {
    /// The name of the input in messages.
    pub name: String,
    /// Knots in stored coordinates, with their numbers in the input as ids.
    pub points: Vec<Point2>,
    /// Triangles over the knots, if the input is a mesh.
    pub triangles: Option<Vec<[u32; 3]>>,
    /// The encoding of the coordinates.
    pub frame: Frame,
    /// Notices for the user.
    pub notices: Vec<String>,
}

/// Reads points of all `paths`, or one triangle mesh; `done` is called with the number of points so far.
///
/// # Errors
/// As [`open_planar`]; input that cannot be read or is malformed; more knots than can be handled.
pub fn read_sites(paths: &[PathBuf], mut done: impl FnMut(u64)) -> Result<Sites> {
    let options =
        SourceOptions { reader: &CONFIGGEN, dims: 2, holds_points: true, ..SourceOptions::default() };
    match open_planar(paths, &options)? {
        Opened::Points(input) => read_points(&input, &mut done),
        Opened::Events(mesh) => read_mesh(mesh, name_of(&paths[0]), &mut done),
    }
}

fn read_points(input: &Input, done: &mut impl FnMut(u64)) -> Result<Sites> {
    let description = input.description();
    let mut sites = Sites {
        name: input.name(),
        points: Vec::new(),
        triangles: None,
        frame: frame(description.coordinates, description.crs.clone(), description.has_elevation),
        notices: input.notices().to_vec(),
    };
    let mut reader = input.read()?;
    let mut batch = Vec::new();
    loop {
        reader.next_batch(&mut batch)?;
        if batch.is_empty() {
            sites.notices.extend(input.withheld_notice());
            return Ok(sites);
        }
        sites.push(&batch)?;
        done(sites.points.len() as u64);
    }
}

fn read_mesh(mut mesh: Box<dyn EventSource>, name: String, done: &mut impl FnMut(u64)) -> Result<Sites> {
    let header = mesh.header();
    let frame = frame(header.coordinates, header.crs.clone(), header.has_elevation);
    let mut sites = Sites { name, points: Vec::new(), triangles: None, frame, notices: Vec::new() };
    let mut triangles = Vec::new();
    while let Some(event) = mesh.next_event()? {
        let Event::Patch(patch) = event else { continue };
        sites.push(&patch.new)?;
        // There are at most MAX_POINTS vertices, so that ids fit.
        triangles.extend(patch.triangles().map(|corners| corners.map(|local| patch.id(local) as u32)));
        done(sites.points.len() as u64);
    }
    sites.triangles = Some(triangles);
    Ok(sites)
}

fn frame(coordinates: Coordinates, crs: Crs, has_elevation: bool) -> Frame {
    Frame { coordinates, crs, elevations: has_elevation.then(Vec::new) }
}

impl Sites {
    /// Sites without knots, for runs whose knots come from elsewhere; `name` appears in messages.
    pub fn none(name: String) -> Sites {
        let frame = frame(Coordinates::F64, Crs::default(), false);
        Sites { name, points: Vec::new(), triangles: None, frame, notices: Vec::new() }
    }

    fn push(&mut self, points: &[Point]) -> Result<()> {
        if points.len() > MAX_POINTS - self.points.len() {
            let message = format!("more than {MAX_POINTS} knots, which is all that can be handled");
            return Err(Error::usage(message).of_input(&self.name));
        }
        self.points.extend(points.iter().map(|&[x, y, _]| [x, y]));
        if let Some(elevations) = &mut self.frame.elevations {
            elevations.extend(points.iter().map(|point| point[2]));
        }
        Ok(())
    }
}
