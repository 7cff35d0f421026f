//! Initial inputs that are made: by the writers of the project, and from pieces.

use std::fs;
use std::io::Cursor;

use spmesh_convert::{Options, convert};
use spmesh_formats::drivers::Format;
use spmesh_formats::sink::{NPY_F64, npy_header};
use spmesh_formats::source::{Input, SourceOptions};

use crate::commands::made;
use crate::samples::{INDEXED_LAS, LINES_GPKG, POLYGONS, SYSTEMS, Samples, blobs, data};
use las_file::LasFile;

// The tests of sources use more of these modules.
#[allow(dead_code)]
#[path = "../../sources/las_file.rs"]
mod las_file;
#[allow(dead_code)]
#[path = "../../sources/lax_writer.rs"]
mod lax_writer;

/// Points of small files.
const LAS_POINTS: [[i32; 3]; 3] = [[0, 0, 5], [100, 20, 7], [40, 300, 6]];

/// Samples that are made.
#[derive(Debug, Clone, Copy)]
pub enum Made {
    /// LAS and LAZ, among them a few points of each format, so that most changes are in the header.
    Las,
    /// Points and meshes of Isenburg's binary formats.
    Binary,
    /// Arrays of numpy.
    Npy,
    /// An index of LAStools.
    Lax,
    /// Lines and polygons of all formats but databases.
    Lines,
    /// Tables and shapes.
    Shapefile,
    /// The geometries of a database, one after the other.
    Wkb,
    /// Coordinate reference systems.
    Crs,
    /// A plan of many jobs.
    Plan,
    /// What a job did.
    Report,
    /// A mesh in parts.
    Manifest,
    /// What a sweep did.
    Summary,
    /// A GeoTIFF.
    Raster,
}

impl Made {
    /// The samples.
    pub fn load(self) -> Vec<Vec<u8>> {
        match self {
            Made::Las => {
                let small = |format| LasFile { format, ..LasFile::of(&LAS_POINTS) };
                let plain = (0..=10).map(|format| small(format).bytes());
                let compressed = [0, 1, 2, 3, 6, 7, 8].map(|format| small(format).compressed(2));
                plain.chain(compressed).chain(Samples::Files(&["las", "laz"]).load()).collect()
            }
            Made::Binary => vec![
                converted("points.spm", Format::Spb),
                converted("mesh.spm", Format::Smb),
                converted("points.spm", Format::Spa),
            ],
            Made::Npy => npy(),
            Made::Lax => vec![lax()],
            Made::Lines => {
                let files = ["lines.geojson", "embankment.geojson", "water.geojson", "lines.txt"];
                let files = files.into_iter().map(data);
                files.chain(POLYGONS.iter().map(|text| text.as_bytes().to_vec())).collect()
            }
            Made::Shapefile => shapefiles(),
            Made::Wkb => {
                let database = fs::read(LINES_GPKG).expect("a sample");
                vec![blobs(&database).into_iter().flat_map(|blob| database[blob].to_vec()).collect()]
            }
            Made::Crs => {
                let keys = [1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 26910].map(u16::to_le_bytes);
                let keys = [&[24, 0, 0, 0][..], keys.as_flattened()].concat();
                SYSTEMS.iter().map(|text| text.as_bytes().to_vec()).chain([keys, data("lines.prj")]).collect()
            }
            Made::Plan => vec![made("plan.json")],
            Made::Report => vec![made("parts/NODE2.json"), made("parts/NODE4.json")],
            Made::Manifest => vec![made("manifest.json")],
            Made::Summary => vec![made("summary.tsv")],
            Made::Raster => vec![made("raster.tif")],
        }
    }
}

fn converted(name: &str, to: Format) -> Vec<u8> {
    let mut output = Vec::new();
    let options = Options::default();
    convert(Cursor::new(made(name)), name, to, &mut output, &options, |_| ()).expect("it has the format");
    output
}

fn npy() -> Vec<Vec<u8>> {
    let numbers = |count: u64| -> Vec<u8> { (0..count).flat_map(|i| (i as f64).to_le_bytes()).collect() };
    vec![
        [npy_header(NPY_F64, &[4, 3]), numbers(12)].concat(),
        [npy_header("<i4", &[6, 2]), numbers(6)].concat(),
        [npy_header("[('x', '<f8'), ('y', '<f8'), ('c', '|u1')]", &[3]), numbers(7)].concat(),
    ]
}

fn lax() -> Vec<u8> {
    let options = SourceOptions { dims: 2, ..SourceOptions::default() };
    let input = Input::open(&[INDEXED_LAS.into()], &options).expect("a sample");
    let coordinates = input.description().coordinates;
    let (mut reader, mut batch, mut points) = (input.read().expect("a sample"), Vec::new(), Vec::new());
    while reader.next_batch(&mut batch).is_ok() && !batch.is_empty() {
        points.extend(batch.iter().map(|&point| {
            let [x, y, _] = coordinates.to_world(point);
            [x, y]
        }));
    }
    let corner = |pick: fn(f64, f64) -> f64, start: f64| {
        [0, 1].map(|axis| points.iter().map(|point| point[axis]).fold(start, pick) as f32)
    };
    let (min, max) = (corner(f64::min, f64::INFINITY), corner(f64::max, f64::NEG_INFINITY));
    lax_writer::index(&points, min, max, lax_writer::Layout { levels: 3, points_min: 9, gap: 2 })
}

fn shapefiles() -> Vec<Vec<u8>> {
    let pair = |table: Vec<u8>, shapes: &str| {
        [(table.len() as u16).to_le_bytes().to_vec(), table, data(shapes)].concat()
    };
    vec![
        pair(Vec::new(), "lines.shp"),
        pair(data("water.dbf"), "water.shp"),
        pair(data("water_lines.dbf"), "water_lines.shp"),
    ]
}
