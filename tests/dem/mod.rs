//! `spdem`: rasters against exact arithmetic on each cell, and failures.

mod drawing;
mod failures;
mod files;
mod masks;
mod natural;
mod neighbours;
pub mod outline;
mod pieces;
pub mod pipelines;
mod samples;
mod sheets;
mod sheets_full;
mod sheets_index;
mod tiles;

use std::io::Cursor;

use spmesh_base::error::Result;
use spmesh_formats::raster::{Grid, RasterFormat, RasterOptions};
use spmesh_stream::model::bounds::Bounds;
use spmesh_stream::{Coordinates, Header, Kind, StreamReader, write_triangles};
use spmesh_terrain::dem::{Method, Options, Quantity, Sample, Stats, rasterize};
use spmesh_terrain::files::Destination;

use spmesh_reference::incremental;
use spmesh_reference::sets::Random;

/// A triangle mesh with stored coordinates.
#[derive(Clone)]
pub struct Mesh {
    pub points: Vec<[f64; 3]>,
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// The Delaunay triangulation of integer points, with random elevations from 0 to 999.
    pub fn of(random: &mut Random, points: &[[i64; 2]]) -> Mesh {
        let triangles = incremental::triangles(points);
        let point = |&[x, y]: &[i64; 2]| [x as f64, y as f64, random.integer(0, 999) as f64];
        Mesh { points: points.iter().map(point).collect(), triangles }
    }

    /// The mesh with triangles in random order, each starting with a random corner.
    pub fn shuffled(&self, random: &mut Random) -> Mesh {
        let mut mesh = self.clone();
        random.shuffle(&mut mesh.triangles);
        mesh.triangles.iter_mut().for_each(|triangle| triangle.rotate_left(random.integer(0, 2) as usize));
        mesh
    }

    pub fn stream(&self, coordinates: Coordinates) -> Vec<u8> {
        let mut header = Header::new(Kind::TriangleMesh, coordinates, 2, true);
        header.bounds = Bounds::of_points(&self.points);
        let (mut output, at) = (Vec::new(), |vertex: u32| self.points[vertex as usize]);
        write_triangles(header, &self.triangles, self.points.len(), 0, at, &mut output).unwrap();
        output
    }
}

fn options(quantity: Quantity) -> Options {
    Options {
        quantity,
        sample: Sample::Centre,
        method: Method::Triangle,
        z_factor: None,
        kill: None,
        concave: None,
        mask: None,
        fill: None,
        memory: 1 << 30,
        natural: false,
        vertices_memory: None,
        banks: None,
        raster: RasterOptions::default(),
        crs: None,
    }
}

/// The bytes of a raster file.
fn file(stream: &[u8], format: RasterFormat, grid: &Grid, options: &Options) -> Result<(Vec<u8>, Stats)> {
    let mut reader = StreamReader::new(stream, "mesh")?;
    let mut output = Cursor::new(Vec::new());
    let raster = RasterOptions { format, ..options.raster.clone() };
    let options = Options { raster, ..options.clone() };
    let stats = rasterize(&mut reader, Destination::File(&mut output), grid, &options, |_| {})?;
    Ok((output.into_inner(), stats))
}

/// The values of an ESRI grid, row by row; NaN for no data.
fn values(text: &[u8]) -> Vec<f32> {
    let text = std::str::from_utf8(text).unwrap();
    let numbers = text.lines().skip(6).flat_map(|line| line.split(' ')).map(|word| word.parse().unwrap());
    numbers.map(|value| if value == -9999.0 { f32::NAN } else { value }).collect()
}

/// The values of a raster; NaN for no data.
fn raster(stream: &[u8], grid: &Grid, options: &Options) -> Vec<f32> {
    let (text, stats) = file(stream, RasterFormat::Ascii, grid, options).unwrap();
    let values = values(&text);
    assert_eq!(stats.cells, values.len() as u64);
    assert_eq!(stats.known, values.iter().filter(|value| !value.is_nan()).count() as u64);
    values
}

/// Whether values are bitwise equal, NaN included.
fn is_same(a: &[f32], b: &[f32]) -> bool {
    a.iter().map(|value| value.to_bits()).eq(b.iter().map(|value| value.to_bits()))
}
