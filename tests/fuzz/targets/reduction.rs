//! The reduction: any cells, order, threads and tiles give the mesh that the kernel makes of all points.

// Tests of the reduction use more of these modules.
#[allow(dead_code)]
#[path = "../../reduce/balls.rs"]
mod balls;
#[allow(dead_code)]
#[path = "../../reduce/solids.rs"]
mod solids;
#[allow(dead_code)]
#[path = "../../reduce/streams.rs"]
mod streams;

use spmesh_audit::{Audit, Standard};
use spmesh_delaunay::delaunay2;
use spmesh_pipeline::reduce::{Options, Part, merge_tetrahedra, merge_triangles};
use spmesh_reference::sets::Random;
use spmesh_stream::model::bounds::{Point, Region};
use spmesh_stream::{Coordinates, StreamReader};

use crate::points::points;
use streams::{GRID, Tagging};

/// How points are cut: the first five bytes.
struct Cuts {
    random: Random,
    tagging: Tagging,
    threads: usize,
    /// The axis that tiles divide, and the points that borders pass through.
    axis: usize,
    borders: [usize; 2],
    has_weights: bool,
    every_node: bool,
}

/// The cuts, and integer points with many ties.
fn decode<const D: usize>(bytes: &[u8], most: usize, levels: u8) -> Option<(Cuts, Vec<Point>)> {
    let (&[seed, layout, tiles, left, right], rest) = bytes.split_first_chunk()?;
    let level = 1 + (layout >> 4) % levels;
    let tagging = match layout & 7 {
        0 => Tagging::None,
        1 => Tagging::Never,
        2 | 3 => Tagging::Chunked(level),
        4 | 5 => Tagging::Ragged,
        6 => Tagging::Preserved(level),
        _ => Tagging::Forgetful(level),
    };
    let mut rest = rest.to_vec();
    // Two, four or eight bits.
    *rest.first_mut()? %= 3;
    let points: Vec<Point> = points::<D>(&rest, most)
        .into_iter()
        .map(|p| [p[0], p[1], p.get(2).copied().unwrap_or((p[0] as i64 ^ p[1] as i64) as f64)])
        .collect();
    let cuts = Cuts {
        random: Random::new(u64::from(seed)),
        tagging,
        threads: 1 + usize::from(tiles & 3) % 3,
        axis: usize::from(tiles >> 2) % D,
        borders: [usize::from(left), usize::from(right)],
        has_weights: tiles >> 6 & 1 == 1,
        every_node: tiles >> 7 == 1,
    };
    (!points.is_empty()).then_some((cuts, points))
}

impl Cuts {
    /// Three slabs of space, of which the middle one may be empty: with borders through points, so that the
    /// half-open rule matters.
    fn regions<const D: usize>(&self, points: &[Point]) -> [Region<D>; 3] {
        let mut at = self.borders.map(|border| points[border % points.len()][self.axis]);
        at.sort_unstable_by(f64::total_cmp);
        [[f64::NEG_INFINITY, at[0]], at, [at[1], f64::INFINITY]].map(|[low, high]| {
            let mut region = Region { min: [f64::NEG_INFINITY; D], max: [f64::INFINITY; D] };
            (region.min[self.axis], region.max[self.axis]) = (low, high);
            region
        })
    }

    /// The proved results of all slabs that are not empty.
    fn parts<const D: usize>(
        &self,
        points: &[Point],
        code: impl Fn() -> String,
        triangulate: impl Fn(&Options<D>) -> Vec<u8>,
    ) -> Vec<Vec<u8>> {
        let slabs = self.regions(points).into_iter();
        let slabs = slabs.filter(|region| region.min[self.axis] < region.max[self.axis]);
        let of_slab = |region| {
            let part = triangulate(&Options { part: Some(Part::Region(region)), ..self.options() });
            prove(&part, &code);
            part
        };
        slabs.map(of_slab).collect()
    }

    fn options<const D: usize>(&self) -> Options<D> {
        Options { threads: self.threads, every_node: self.every_node, ..Options::default() }
    }
}

/// In the plane.
pub fn plane(bytes: &[u8]) {
    let Some((mut cuts, points)) = decode::<2>(bytes, 150, 4) else { return };
    let code = || format!("let points = {points:?}; // {:?}, {} threads", cuts.tagging, cuts.threads);
    let flat: Vec<[f64; 2]> = points.iter().map(|p| [p[0], p[1]]).collect();
    let kernel = delaunay2::triangulate(&flat).expect("finite points");
    let mut expected: Vec<[[i64; 2]; 3]> = kernel
        .simplices()
        .map(|t: [u32; 3]| {
            let t = t.map(|v| flat[v as usize].map(|c| c as i64));
            [[t[0], t[1], t[2]], [t[1], t[2], t[0]], [t[2], t[0], t[1]]].into_iter().min().expect("three")
        })
        .collect();
    expected.sort_unstable();
    let input = streams::stream(&points, GRID, cuts.tagging, &mut cuts.random);
    let (whole, _) = streams::triangulate(&input, &cuts.options()).expect("a stream of points");
    assert_eq!(streams::read_mesh(&whole).triangles, expected, "{}", code());
    prove(&whole, code);
    let parts = cuts.parts(&points, code, |options| streams::triangulate(&input, options).expect("a part").0);
    let readers = parts.iter().map(|part| StreamReader::new(&part[..], "part").expect("a part")).collect();
    let (merged, _) = merge_triangles(readers, Vec::new(), &cuts.options(), |_| ()).expect("parts that fit");
    assert_eq!(streams::read_mesh(&merged).triangles, expected, "merged: {}", code());
    prove(&merged, code);
}

/// In space, also with weights.
pub fn space(bytes: &[u8]) {
    let Some((mut cuts, points)) = decode::<3>(bytes, 60, 2) else { return };
    let code = || format!("let points = {points:?}; // {:?}, {} threads", cuts.tagging, cuts.threads);
    let coordinates = if cuts.tagging == Tagging::Ragged { Coordinates::F64 } else { GRID };
    let input = streams::stream_of(3, &points, coordinates, cuts.tagging, &mut cuts.random);
    if cuts.has_weights {
        let balls = balls::weighted(&input, |p| (p[0] as i64 * 7 + p[2] as i64 * 5) as f64 % 9.0);
        let options = Options { weighted: true, ..cuts.options() };
        let (mesh, _) = solids::tetrahedralize(&balls.stream, &options).expect("a stream of points");
        assert_eq!(solids::read_mesh(&mesh).0, balls::expected(&balls).0, "weighted: {}", code());
        return balls::audit(&mesh).unwrap_or_else(|violation| panic!("{violation}\n{}", code()));
    }
    let expected = solids::expected(&points);
    let (whole, _) = solids::tetrahedralize(&input, &cuts.options()).expect("a stream of points");
    assert_eq!(solids::read_mesh(&whole).0, expected, "{}", code());
    prove(&whole, code);
    let parts =
        cuts.parts(&points, code, |options| solids::tetrahedralize(&input, options).expect("a part").0);
    let readers = parts.iter().map(|part| StreamReader::new(&part[..], "part").expect("a part")).collect();
    let (merged, _) = merge_tetrahedra(readers, Vec::new(), &cuts.options(), |_| ()).expect("parts that fit");
    assert_eq!(solids::read_mesh(&merged).0, expected, "merged: {}", code());
    prove(&merged, code);
}

/// The audit of a stream, which shares no code with the reduction.
fn prove(stream: &[u8], code: impl Fn() -> String) {
    let mut reader = StreamReader::new(stream, "mesh").expect("a header");
    let mut audit = Audit::new(reader.header(), Standard::Canonical, None).expect("a mesh has an audit");
    while let Some(event) = reader.next_event().expect("a stream that was just written") {
        if let Err(violation) = audit.event(&event) {
            panic!("{violation:?}\n{}", code());
        }
    }
}
