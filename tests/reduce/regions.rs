//! Points in overlapping regions have the tetrahedra that the kernel finds for all points at once.

use spmesh_base::error::{ErrorKind, Result};
use spmesh_formats::source::{Description, PointReader};
use spmesh_pipeline::finalize::{
    self, Budget, InRegions, Leaves, Observer, Order, Passes, Spooling, WhenRegions,
};
use spmesh_pipeline::reduce::Options;
use spmesh_stream::model::attributes::Attributes;
use spmesh_stream::model::bounds::{Point, Region};
use spmesh_stream::{Coordinates, Crs, Event, Header, Kind, PointRegion, StreamReader, StreamWriter};

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

/// Collects notices.
#[derive(Default)]
struct Notices(Vec<String>);

impl Observer for Notices {
    fn notice(&mut self, message: &str) {
        self.0.push(message.to_string());
    }
}

/// The points in regions of about `region_points`, and the figures of the run. No notice is expected.
fn in_regions(points: &[Point], region_points: u64, threads: usize) -> (Vec<u8>, finalize::Stats) {
    let mut notices = Notices::default();
    let result = with_notices(points, region_points, threads, &mut notices);
    assert!(notices.0.is_empty(), "{:?}", notices.0);
    result
}

fn with_notices(
    points: &[Point],
    region_points: u64,
    threads: usize,
    notices: &mut Notices,
) -> (Vec<u8>, finalize::Stats) {
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
        // Small leaves, so that regions are complete before all points have come.
        leaves: Leaves::Collapsed { cell_points: 12, level_max: None },
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
        finalize::run(&Memory { description, points: points.to_vec() }, &options, notices, &mut stream);
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
    for seed in (0..60).step_by(2) {
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
    assert!((8..14).contains(&stats.regions), "{stats:?}");
    assert!(stats.region_points < 3 * stats.points, "{stats:?}");
    assert!(stats.region_points_max < 8_000, "{stats:?}");
    assert_eq!(assert_same_set(&points, 4_000, "a gyroid"), stats.regions);
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
fn points_on_a_sphere_are_in_one_region() {
    let mut random = Random::new(11);
    let mut points: Vec<Point> = Vec::new();
    while points.len() < 10_000 {
        let at: Point = [0; 3].map(|_| 2.0 * random.unit() - 1.0);
        let length = at.iter().map(|x| x * x).sum::<f64>().sqrt();
        points.push(at.map(|x| 7.0 * x / length));
    }
    points.push([1e9, 0.0, 0.0]);
    let (_, stats) = in_regions(&points, 1_000, 2);
    assert!(stats.regions < 4 && stats.region_points < 2 * stats.points, "{stats:?}");
}

#[test]
fn points_on_curves_come_in_cells() {
    let cubic = |t: f64| [t, t * t, t * t * t];
    let lines = |t: f64| if t < 0.5 { [t, 0.0, 0.0] } else { [0.0, t, 1.0] };
    let expected = ["about 7.9e8, a mesh of 14.2 GB", "about 3.9e8, a mesh of 7.1 GB"];
    for (point, expected) in [cubic, lines].into_iter().zip(expected) {
        let points: Vec<Point> = (0..40_000).map(|i| point(f64::from(i) / 40_000.0)).collect();
        let mut notices = Notices::default();
        let (stream, stats) = with_notices(&points, 1_000, 2, &mut notices);
        let reader = StreamReader::new(&stream[..], "points").unwrap();
        assert_eq!((reader.header().kind, stats.regions), (Kind::Points, 0));
        assert!(notices.0.len() == 1 && notices.0[0].contains(expected), "{:?}", notices.0);
    }
}

/// A stream of regions, each with its counts and points.
fn regions(regions: &[([u64; 4], &[Point])]) -> Vec<u8> {
    let header = Header::new(Kind::RegionPoints, Coordinates::F64, 3, false);
    let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
    for (number, &([own, first, again, last], points)) in (0..).zip(regions) {
        let (mut min, mut max) = ([f64::NEG_INFINITY; 3], [f64::INFINITY; 3]);
        (min[0], max[0]) = (f64::from(number), f64::from(number + 1));
        writer.region(&PointRegion { bounds: Region { min, max }, own, first, again, last }).unwrap();
        writer.points(points).unwrap();
    }
    writer.end(0, 0).unwrap()
}

#[test]
fn regions_that_disagree_on_points_are_refused() {
    let (a, b) = ([1.0, 2.0, 3.0], [4.0, 5.0, 6.0]);
    for (stream, part) in [
        (regions(&[([0, 2, 0, 0], &[a, b]), ([0, 0, 0, 2], &[a, a])]), "in none"),
        (regions(&[([0, 2, 0, 0], &[a, b]), ([0, 0, 1, 1], &[a, a]), ([0, 0, 0, 1], &[b])]), "coincide"),
        (regions(&[([0, 1, 0, 0], &[a]), ([0, 1, 0, 0], &[a]), ([0, 0, 0, 2], &[a, a])]), "earlier region"),
        (regions(&[([0, 1, 0, 0], &[a]), ([0, 0, 0, 1], &[b])]), "in no earlier region"),
    ] {
        for threads in [1, 3] {
            let options = Options { threads, ..Options::default() };
            let error = tetrahedralize(&stream, &options).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Malformed);
            assert!(error.to_string().contains(part), "{error}");
        }
    }
    let nothing =
        regions(&[([0; 4], &[]), ([4, 0, 0, 0], &[a, b, [0.0; 3], [1.0, 0.0, 9.0]]), ([0; 4], &[])]);
    assert_eq!(tetrahedralize(&nothing, &Options::default()).unwrap().1.vertices, 4);
}

#[test]
fn a_region_that_memory_has_no_room_for_is_refused_before_it_is_read() {
    let points = gyroid(20_000, &mut Random::new(8));
    let (stream, _) = in_regions(&points, 1_000_000, 1);
    let cut = &stream[..stream.len() / 4];
    let options = Options { threads: 1, memory: Some(24 << 20), ..Options::default() };
    let error = tetrahedralize(cut, &options).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Memory, "{error}");
}

#[test]
fn tiny_clusters_beside_a_surface_are_where_they_belong() {
    for tiny in [1e-100, 1e-162, 3e-164, 5e-324] {
        let mut points = gyroid(600, &mut Random::new(9));
        let mut random = Random::new(10);
        points.extend((0..64).map(|_| [0; 3].map(|_| tiny * ((random.bits() % 19) as f64 - 9.0))));
        assert_same_set(&points, 200, &format!("a cluster of {tiny:e}"));
        points.extend([[1e154, 0.0, 3.0], [-1e154, 1e154, 0.0], [0.0, 1.0, 1e300]]);
        assert_same_set(&points, 200, &format!("a cluster of {tiny:e} and points far away"));
    }
}

#[test]
fn a_point_that_an_earlier_region_should_have_is_missed() {
    let points = gyroid(2_000, &mut Random::new(6));
    let (stream, _) = in_regions(&points, 500, 1);
    let mut reader = StreamReader::new(&stream[..], "points").unwrap();
    assert_eq!(reader.header().kind, Kind::RegionPoints);
    let mut writer = StreamWriter::new(Vec::new(), reader.header().clone()).unwrap();
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
    assert!(
        error.to_string().contains("region 3") && error.to_string().contains("no earlier region"),
        "{error}"
    );
}
