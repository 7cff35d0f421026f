//! A mesh in parts: leaves and inner nodes, whose residuals are streams of their own, together have the
//! simplices of one run, each of them once.

use std::io::{Cursor, Read};
use std::sync::Arc;

use spmesh_audit::{Audit, Standard};
use spmesh_pipeline::reduce::{
    Options, Outputs, Part, Stats, join_tetrahedra, join_triangles, tetrahedralize_part, triangulate_part,
};
use spmesh_stream::model::bounds::{Point, Region};
use spmesh_stream::{Coordinates, JoinedMesh, PartName, PartSize, StreamReader, Totals};

use super::solids::{self, fits_a_grid};
use super::streams::{GRID, Tagging, read_mesh, stream_of, triangulate};
use spmesh_base::error::Result;
use spmesh_reference::clouds::{FAMILIES, mixture, of};
use spmesh_reference::sets::{DEGENERATE_FAMILIES, Random, degenerate};

/// A part that was made: its mesh, its residual unless it is the root, and its vertices of its own.
struct Made {
    name: PartName,
    mesh: Vec<u8>,
    residual: Option<Vec<u8>>,
    own: u64,
    simplices: u64,
}

/// Makes the parts of a random tree over space or the plane.
struct Tree<'a, const D: usize> {
    points: &'a [Point],
    input: &'a [u8],
    options: Options<D>,
    random: &'a mut Random,
    made: Vec<Made>,
    merged: u64,
    read: u64,
}

type Ran = Result<(Outputs<Vec<u8>>, Stats)>;

fn leaf<const D: usize>(input: &[u8], outputs: Outputs<Vec<u8>>, options: &Options<D>) -> Ran {
    let reader = StreamReader::new(Cursor::new(input.to_vec()), "points")?;
    // The dimensions are known here, but not to the compiler.
    let Options { duplicates, threads, name, .. } = *options;
    match options.part {
        Some(Part::Stored(region)) if D == 2 => {
            let part = Some(Part::Stored(Region::between(region.in_space().min, region.in_space().max)));
            let options = Options { duplicates, threads, name, part, ..Options::<2>::default() };
            triangulate_part(reader, outputs, &options, |_| ())
        }
        Some(Part::Stored(region)) => {
            let part = Some(Part::Stored(region.in_space()));
            let options = Options { duplicates, threads, name, part, ..Options::<3>::default() };
            tetrahedralize_part(reader, outputs, &options, |_| ())
        }
        _ => panic!("a leaf has a box"),
    }
}

fn join<const D: usize>(inputs: &[&[u8]], outputs: Outputs<Vec<u8>>, options: &Options<D>) -> Ran {
    let readers = inputs.iter().map(|input| StreamReader::new(*input, "residual")).collect::<Result<_>>()?;
    let Some(Part::Stored(region)) = options.part else { panic!("a node has a box") };
    let region = region.in_space();
    let name = options.name;
    if D == 2 {
        let part = Some(Part::Stored(Region::between(region.min, region.max)));
        join_triangles(readers, outputs, &Options { name, part, ..Options::default() })
    } else {
        join_tetrahedra(
            readers,
            outputs,
            &Options { name, part: Some(Part::Stored(region)), ..Options::default() },
        )
    }
}

impl<const D: usize> Tree<'_, D> {
    /// Makes the nodes of a region that is cut `depth` times at random, and returns the number of the
    /// highest; `None` if no points are there.
    fn node(&mut self, region: Region<D>, depth: usize) -> Option<u32> {
        let inside = self.points.iter().filter(|&&point| region.contains(point)).count();
        let is_root = region == Region::EVERYTHING;
        let first = self.made.len() as u32;
        if inside == 0 && !is_root {
            return None;
        }
        let children = match self.cut(region).filter(|_| depth > 0) {
            None => Vec::new(),
            Some(halves) => halves.into_iter().filter_map(|half| self.node(half, depth - 1)).collect(),
        };
        let number = self.made.len() as u32;
        let below = number - first;
        let name = PartName { node: self.random.integer(0, 1 << 62) as u64, below };
        let options = Options { part: Some(Part::Stored(region)), name: Some(name), ..self.options };
        let outputs = Outputs { mesh: Vec::new(), residual: (!is_root).then(Vec::new) };
        let ran = if children.is_empty() {
            leaf::<D>(self.input, outputs, &options)
        } else {
            let residual = |child: &u32| self.made[*child as usize].residual.as_deref().unwrap();
            join::<D>(&children.iter().map(residual).collect::<Vec<_>>(), outputs, &options)
        };
        let (Outputs { mesh, residual }, stats) = ran.unwrap();
        if children.is_empty() {
            assert_eq!(stats.points, inside as u64);
            (self.read, self.merged) = (self.read + stats.points, self.merged + stats.merged);
        }
        let (own, simplices) = (stats.vertices - stats.shared, stats.simplices);
        self.made.push(Made { name, mesh, residual, own, simplices });
        Some(number)
    }

    fn cut(&mut self, region: Region<D>) -> Option<[Region<D>; 2]> {
        let axis = self.random.integer(0, D as i64 - 1) as usize;
        let number = self.random.integer(0, self.points.len().max(1) as i64 - 1);
        let border = self.points.get(number as usize)?[axis];
        let [mut lower, mut upper] = [region; 2];
        (lower.max[axis], upper.min[axis]) = (border, border);
        (lower.min[axis] < border && border < upper.max[axis]).then_some([lower, upper])
    }

    /// Some of the parts as one stream.
    fn joined(self, is_wanted: impl Fn(usize) -> bool) -> Vec<u8> {
        let size = |(place, made): (usize, &Made)| {
            let &Made { name, own: vertices, simplices, .. } = made;
            PartSize { name, is_wanted: is_wanted(place), vertices, simplices }
        };
        let sizes: Vec<PartSize> = self.made.iter().enumerate().map(size).collect();
        let wanted: Vec<bool> = sizes.iter().map(|size| size.is_wanted).collect();
        let stated = Totals { points: self.read, merged: self.merged, ..Totals::default() };
        let meshes: Arc<Vec<Vec<u8>>> = Arc::new(self.made.into_iter().map(|made| made.mesh).collect());
        let mut header = StreamReader::new(&meshes[0][..], "part").unwrap().header().clone();
        (header.part, header.bounds) = (None, None);
        let open = move |place: usize| {
            assert!(wanted[place], "a part that is not wanted is not opened");
            let bytes: Box<dyn Read + Send> = Box::new(Cursor::new(meshes[place].clone()));
            Ok((bytes, format!("part {place}")))
        };
        let mut bytes = Vec::new();
        JoinedMesh::new(header, sizes, stated, Box::new(open)).unwrap().read_to_end(&mut bytes).unwrap();
        bytes
    }
}

/// The stream of all parts of a random tree over the points.
fn in_parts<const D: usize>(
    points: &[Point],
    coordinates: Coordinates,
    depth: usize,
    threads: usize,
    random: &mut Random,
) -> Vec<u8> {
    with_tree::<D, _>(points, coordinates, depth, threads, random, |tree| tree.joined(|_| true))
}

fn with_tree<const D: usize, T>(
    points: &[Point],
    coordinates: Coordinates,
    depth: usize,
    threads: usize,
    random: &mut Random,
    take: impl FnOnce(Tree<D>) -> T,
) -> T {
    let tagging = [Tagging::None, Tagging::Chunked(2), Tagging::Ragged][random.integer(0, 2) as usize];
    let input = stream_of(D as u8, points, coordinates, tagging, random);
    let options = Options { threads, ..Options::default() };
    let (made, merged, read) = (Vec::new(), 0, 0);
    let mut tree = Tree::<D> { points, input: &input, options, random, made, merged, read };
    tree.node(Region::EVERYTHING, depth).unwrap();
    assert_eq!(tree.read, points.len() as u64);
    let own: u64 = tree.made.iter().map(|made| made.own).sum();
    assert_eq!(own + tree.merged, points.len() as u64, "each point is a vertex of one part, or merged");
    take(tree)
}

fn assert_proven(bytes: &[u8]) {
    let mut reader = StreamReader::new(bytes, "joined").unwrap();
    let mut audit = Audit::new(reader.header(), Standard::Canonical, None).unwrap();
    while let Some(event) = reader.next_event().unwrap() {
        audit.event(&event).unwrap();
    }
}

#[test]
fn parts_of_the_plane_are_the_triangles_of_one_run() {
    for (seed, family) in (0..).zip((0..DEGENERATE_FAMILIES).cycle().take(60)) {
        let mut random = Random::new(seed);
        let mut points: Vec<Point> = degenerate(&mut random, family, 20 + 6 * seed as usize)
            .iter()
            .map(|p| [p[0] as f64, p[1] as f64, (p[0] ^ p[1]) as f64])
            .collect();
        points.extend_from_within(..points.len() / 9);
        random.shuffle(&mut points);
        for coordinates in [GRID, Coordinates::F64] {
            let input = stream_of(2, &points, coordinates, Tagging::None, &mut random);
            let whole = read_mesh(&triangulate(&input, &Options::default()).unwrap().0);
            for threads in [1, 3] {
                let joined = in_parts::<2>(&points, coordinates, 5, threads, &mut random);
                let parts = read_mesh(&joined);
                assert_eq!(parts.triangles, whole.triangles, "{family:?}, seed {seed}");
                assert_eq!(parts.vertices.len(), whole.vertices.len());
                if !whole.triangles.is_empty() {
                    assert_proven(&joined);
                }
            }
        }
    }
}

#[test]
fn parts_of_space_are_the_tetrahedra_of_one_run() {
    let families = FAMILIES.into_iter().map(|family| (Some(family), 70));
    for (seed, (family, count)) in (0..).zip(families.chain((0..20).map(|k| (None, 20 + 10 * k)))) {
        let mut random = Random::new(500 + seed);
        let mut points = match family {
            Some(family) => of(&mut random, family, count),
            None => mixture(&mut random, count),
        };
        points.extend_from_within(..points.len() / 9);
        random.shuffle(&mut points);
        let coordinates = if fits_a_grid(&points) { GRID } else { Coordinates::F64 };
        let joined = in_parts::<3>(&points, coordinates, 4, 1 + seed as usize % 3, &mut random);
        let (set, _) = solids::read_mesh(&joined);
        assert!(set == solids::expected(&points), "{family:?}, seed {seed}");
        if !set.is_empty() {
            assert_proven(&joined);
        }
    }
}

/// Some parts make a stream that keeps all rules, with their simplices alone.
#[test]
fn some_parts_are_a_mesh_of_their_simplices() {
    for (seed, family) in (0..).zip((0..DEGENERATE_FAMILIES).cycle().take(40)) {
        let mut random = Random::new(900 + seed);
        let points = degenerate(&mut random, family, 40 + 9 * seed as usize);
        let points: Vec<Point> =
            points.iter().map(|p| [p[0] as f64, p[1] as f64, (p[0] ^ p[1]) as f64]).collect();
        let mask = random.integer(0, 1 << 62) as u64;
        let is_wanted = |place: usize| mask >> (place % 63) & 1 == 1;
        let (joined, mut expected) = with_tree::<2, _>(&points, GRID, 5, 1, &mut random, |tree| {
            let wanted = tree.made.iter().enumerate().filter(|(place, _)| is_wanted(*place));
            let triangles = wanted.flat_map(|(_, made)| read_mesh(&made.mesh).triangles);
            let triangles: Vec<_> = triangles.collect();
            (tree.joined(is_wanted), triangles)
        });
        let mut found: Vec<_> = read_mesh(&joined).triangles.into_iter().collect();
        found.sort_unstable();
        expected.sort_unstable();
        assert_eq!(found, expected, "seed {seed}");
    }
}

#[test]
fn few_points_are_meshes_in_parts_too() {
    let points: [Point; 5] = [[0.0; 3], [8.0, 0.0, 1.0], [0.0, 8.0, 2.0], [8.0, 8.0, 3.0], [3.0, 2.0, 9.0]];
    for count in 0..=points.len() {
        for seed in 0..8 {
            let mut random = Random::new(seed);
            let input = stream_of(2, &points[..count], GRID, Tagging::None, &mut random);
            let whole = read_mesh(&triangulate(&input, &Options::default()).unwrap().0);
            let parts = read_mesh(&in_parts::<2>(&points[..count], GRID, 4, 1, &mut random));
            assert_eq!(parts.triangles, whole.triangles, "{count} points");
            assert_eq!(parts.vertices.len(), count);
        }
    }
}

#[test]
fn residuals_of_other_places_are_refused() {
    let points: Vec<Point> =
        (0..200).map(|i| [f64::from(i * 37 % 101), f64::from(i * 53 % 97), 0.0]).collect();
    let input = stream_of(2, &points, GRID, Tagging::None, &mut Random::new(1));
    let half = |low: f64, high: f64, below: u32| {
        let region = Region { min: [low, f64::NEG_INFINITY], max: [high, f64::INFINITY] };
        let options: Options = Options {
            part: Some(Part::Stored(region)),
            name: Some(PartName { node: 1, below }),
            ..Options::default()
        };
        let outputs = Outputs { mesh: Vec::new(), residual: Some(Vec::new()) };
        leaf::<2>(&input, outputs, &options).unwrap().0.residual.unwrap()
    };
    let inf = f64::INFINITY;
    let root = |residuals: &[&[u8]]| {
        let options: Options = Options {
            part: Some(Part::Stored(Region::EVERYTHING)),
            name: Some(PartName { node: 3, below: 2 }),
            ..Options::default()
        };
        let outputs = Outputs { mesh: Vec::new(), residual: None };
        join::<2>(residuals, outputs, &options).map(|_| ()).map_err(|error| error.to_string())
    };
    let (west, east) = (half(-inf, 50.0, 0), half(50.0, inf, 0));
    assert!(root(&[&west, &east]).is_ok());
    let refused = [(half(50.0, inf, 1), "residuals of 3 parts, expected 2"), (half(40.0, inf, 0), "overlap")];
    for (other, message) in refused {
        let error = root(&[&west, &other]).unwrap_err();
        assert!(error.contains(message), "{error}");
    }
    for cut in [west.len() - 1, west.len() / 2, 100] {
        assert!(root(&[&west[..cut], &east]).is_err());
    }
}
