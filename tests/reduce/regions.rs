//! Points in overlapping regions have the tetrahedra that the kernel finds for all points at once.

use spmesh_base::error::{ErrorKind, Result};
use spmesh_formats::source::{Description, PointReader};
use spmesh_pipeline::finalize::{self, Budget, InRegions, Leaves, Order, Passes, Spooling, WhenRegions};
use spmesh_pipeline::reduce::Options;
use spmesh_stream::model::attributes::Attributes;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, Crs, Event, Kind, StreamReader};

use super::solids::{bits, expected, fits_a_grid, read_mesh, tetrahedralize};
use super::space::assert_proven;
use super::streams::GRID;
use spmesh_reference::clouds::{FAMILIES, mixture, of};
use spmesh_reference::sets::Random;

/// Points in memory as an input.
struct Memory {
    description: Description,
    points: Vec<Point>,
}

struct MemoryReader<'a>(std::slice::Chunks<'a, Point>);

impl PointReader for MemoryReader<'_> {
    fn next_batch(&mut self, batch: &mut Vec<Point>) -> Result<()> {
        batch.clear();
        batch.extend_from_slice(self.0.next().unwrap_or_default());
        Ok(())
    }

    fn invalid(&self) -> u64 {
        0
    }
}

impl Passes for Memory {
    fn description(&self) -> &Description {
        &self.description
    }

    fn read(&self) -> Result<Box<dyn PointReader + '_>> {
        Ok(Box::new(MemoryReader(self.points.chunks(333))))
    }
}

/// The points in regions of about `region_points`, and how many regions a point is in at most.
fn in_regions(points: &[Point], region_points: u64, threads: usize) -> (Vec<u8>, finalize::Stats) {
    let description = Description {
        coordinates: if fits_a_grid(points) { GRID } else { Coordinates::F64 },
        dims: 3,
        has_elevation: false,
        crs: Crs::Unknown,
        stated_bounds: None,
        stated_points: None,
        attributes: Attributes::default(),
    };
    let threads = threads.try_into().unwrap();
    let options = finalize::Options {
        leaves: Leaves::Collapsed { cell_points: 1_000, level_max: None },
        order: Order::Chunked,
        compress: false,
        thin: None,
        budget: Budget::of_engine(1 << 20).unwrap(),
        temp_dir: None,
        spooling: Spooling::Auto,
        regions: InRegions { when: WhenRegions::Always, points: region_points, threads },
        weighted: None,
    };
    let mut stream = Vec::new();
    let stats =
        finalize::run(&Memory { description, points: points.to_vec() }, &options, &mut (), &mut stream);
    (stream, stats.unwrap())
}

fn assert_same_set(points: &[Point], region_points: u64, what: &str) -> u64 {
    let (stream, stats) = in_regions(points, region_points, 1);
    assert!(stream == in_regions(points, region_points, 3).0, "{what}: threads change the regions");
    let tetrahedra = expected(points);
    let mut distinct: Vec<_> = points.iter().map(|&point| bits(point)).collect();
    distinct.sort_unstable();
    distinct.dedup();
    let (mesh, counts) = tetrahedralize(&stream, &Options { threads: 1, ..Options::default() }).unwrap();
    let (set, vertices) = read_mesh(&mesh);
    assert!(set == tetrahedra, "{what}: {} of {} tetrahedra", set.len(), tetrahedra.len());
    assert_eq!(vertices, distinct.len(), "{what}");
    assert_eq!(counts.vertices + counts.merged, points.len() as u64, "{what}");
    let three = tetrahedralize(&stream, &Options { threads: 3, ..Options::default() }).unwrap().0;
    assert!(mesh == three, "{what}: threads change the mesh");
    if !tetrahedra.is_empty() && points.len() < 120 {
        let coordinates = if fits_a_grid(points) { GRID } else { Coordinates::F64 };
        assert_proven(&mesh, points, coordinates);
    }
    stats.regions
}

#[test]
fn no_family_depends_on_regions() {
    let mut regions = 0;
    for (number, family) in FAMILIES.into_iter().enumerate() {
        for count in [5, 20, 90, 300] {
            let mut random = Random::new((number * 1000 + count) as u64);
            let points = of(&mut random, family, count);
            for region_points in [10, 40] {
                let what = format!("{family:?} of {count}, {region_points} a region");
                regions += assert_same_set(&points, region_points, &what);
            }
        }
    }
    assert!(regions > 500, "{regions} regions");
}

#[test]
fn mixtures_and_copies_equal_the_kernel() {
    for seed in 0..60 {
        let mut random = Random::new(9000 + seed);
        let mut points = mixture(&mut random, 10 + 8 * seed as usize);
        points.extend_from_within(..points.len() / 3);
        random.shuffle(&mut points);
        assert_same_set(&points, 10 + seed, &format!("mixture {seed}"));
    }
}

/// Points on a surface that winds through a cube.
fn gyroid(count: usize, random: &mut Random) -> Vec<Point> {
    let mut points = Vec::new();
    while points.len() < count {
        let mut at: Point = [0; 3].map(|_| 12.0 * random.unit());
        for _ in 0..8 {
            let [x, y, z] = at;
            let value = x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos();
            let slopes = [
                x.cos() * y.cos() - z.sin() * x.sin(),
                y.cos() * z.cos() - x.sin() * y.sin(),
                z.cos() * x.cos() - y.sin() * z.sin(),
            ];
            let square: f64 = slopes.iter().map(|slope| slope * slope).sum();
            at = std::array::from_fn(|axis| at[axis] - value * slopes[axis] / square.max(1e-3));
        }
        points.push(at);
    }
    points
}

#[test]
fn points_on_a_surface_are_in_few_regions() {
    let points = gyroid(20_000, &mut Random::new(5));
    let (_, stats) = in_regions(&points, 4_000, 2);
    assert!(stats.regions == 10, "{stats:?}");
    assert!(stats.region_points < 3 * stats.points, "{stats:?}");
    assert!(stats.region_points_max < 8_000, "{stats:?}");
    assert_eq!(assert_same_set(&points, 4_000, "a gyroid"), 10);
    let far = [points, vec![[1e9, -1e9, 1e9]]].concat();
    assert_same_set(&far, 4_000, "a gyroid and a point far away");
}

#[test]
fn few_points_and_flat_ones_are_one_region() {
    for points in [
        vec![],
        vec![[1.0, 2.0, 3.0]],
        vec![[1.0, 2.0, 3.0]; 50],
        (0..50).map(|i| [f64::from(i), 0.0, 0.0]).collect(),
        (0..100).map(|i| [f64::from(i % 10), f64::from(i / 10), 4.0]).collect(),
    ] {
        let (stream, _) = in_regions(&points, 10, 2);
        let (mesh, _) = tetrahedralize(&stream, &Options::default()).unwrap();
        assert!(read_mesh(&mesh).0.is_empty());
    }
}

#[test]
fn a_point_that_an_earlier_region_should_have_is_missed() {
    let points = gyroid(2_000, &mut Random::new(6));
    let (stream, _) = in_regions(&points, 500, 1);
    let mut reader = StreamReader::new(&stream[..], "points").unwrap();
    assert_eq!(reader.header().kind, Kind::RegionPoints);
    let mut writer = spmesh_stream::StreamWriter::new(Vec::new(), reader.header().clone()).unwrap();
    let mut number = 0;
    while let Some(event) = reader.next_event().unwrap() {
        match event {
            Event::Region(region) => {
                writer.region(&region).unwrap();
                number += 1;
            }
            Event::Points(mut points) => {
                if number == 3 {
                    points.last_mut().unwrap()[0] += 1e-9;
                }
                writer.points(&points).unwrap();
            }
            _ => {}
        }
    }
    let damaged = writer.end(0, 0).unwrap();
    let error = tetrahedralize(&damaged, &Options::default()).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Malformed);
    assert!(error.to_string().contains("region 2 is in none before"), "{error}");
}
