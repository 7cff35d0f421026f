//! Checks every promise of a finalized stream. Boxes of cells are computed from location codes and the header
//! alone; no code is shared with the engine.

use spmesh_pipeline::finalize::{Options, Order};
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::{Crs, Event, Header, StreamReader};

use super::sets::Set;

/// A cell as integers: its range of codes at level 62 / dims, and its box.
pub(super) struct Tagged {
    pub(super) codes: std::ops::Range<u128>,
    pub(super) min: Point,
    pub(super) max: Point,
}

impl Tagged {
    pub(super) fn new(header: &Header, code: u64) -> Tagged {
        let tree = header.tree.expect("tags need a tree");
        let dims = usize::from(tree.dims());
        let level = (63 - code.leading_zeros() as usize) / dims;
        let step = tree.side() / (1u64 << level) as f64;
        let (mut min, mut max) = ([f64::NEG_INFINITY; 3], [f64::INFINITY; 3]);
        for axis in 0..dims {
            let index: u64 = (0..level).map(|bit| (code >> (bit * dims + axis) & 1) << bit).sum();
            min[axis] = tree.origin()[axis] + index as f64 * step;
            max[axis] = tree.origin()[axis] + (index + 1) as f64 * step;
        }
        let shift = (62 / dims - level) * dims;
        Tagged { codes: u128::from(code) << shift..u128::from(code + 1) << shift, min, max }
    }

    pub(super) fn contains(&self, point: &Point) -> bool {
        (0..3).all(|axis| self.min[axis] <= point[axis] && point[axis] < self.max[axis])
    }
}

/// The contents of a stream, in order.
pub(super) struct Decoded {
    pub(super) header: Header,
    pub(super) points: Vec<Point>,
    /// Tags, each with the number of points before it.
    pub(super) tags: Vec<(usize, Tagged)>,
}

pub(super) fn decode(stream: &[u8]) -> Decoded {
    let mut reader = StreamReader::new(stream, "test").expect("a stream");
    let header = reader.header().clone();
    let (mut points, mut tags) = (Vec::new(), Vec::new());
    while let Some(event) = reader.next_event().expect("a sound stream") {
        match event {
            Event::Points(more) => points.extend(more),
            Event::Cells(cells) => {
                tags.extend(cells.iter().map(|cell| (points.len(), Tagged::new(&header, cell.0))));
            }
            Event::End(totals) => assert_eq!(totals.points, points.len() as u64),
            other => panic!("{other:?} in a points stream"),
        }
    }
    Decoded { header, points, tags }
}

/// The tagged cells, in the order of the tree.
pub(super) fn codes(decoded: &Decoded) -> Vec<(u128, u128)> {
    let mut codes: Vec<_> = decoded.tags.iter().map(|(_, cell)| (cell.codes.start, cell.codes.end)).collect();
    codes.sort_unstable();
    codes
}

pub(super) fn sorted(points: &[Point]) -> Vec<[u64; 3]> {
    let mut bits: Vec<_> = points.iter().map(|point| point.map(|value| (value + 0.0).to_bits())).collect();
    bits.sort_unstable();
    bits
}

/// Checks every promise of a finalized stream of `input`.
pub(super) fn check(set: &Set, options: &Options, stream: &[u8]) -> Decoded {
    let decoded = decode(stream);
    let Decoded { header, points, tags } = &decoded;
    let name = set.name;
    assert_eq!(header.points, Some(set.points.len() as u64), "{name}");
    assert_eq!(header.bounds, Bounds::of_points(&set.points), "{name}");
    assert_eq!(header.chunked, options.order == Order::Chunked && !set.points.is_empty(), "{name}");
    assert_eq!(header.crs, Crs::Wkt("LOCAL_CS[\"test\"]".into()));
    assert_eq!(sorted(points), sorted(&set.points), "{name}: every point comes out once");
    let by_x = ByX::new(points);
    for (before, cell) in tags {
        let late = by_x.inside(cell).into_iter().find(|at| at >= before).map(|at| points[at]);
        assert_eq!(late, None, "{name}: after the tag of its cell");
    }
    let mut ranges: Vec<_> = tags.iter().map(|(_, cell)| cell.codes.clone()).collect();
    ranges.sort_unstable_by_key(|range| range.start);
    assert!(
        ranges.windows(2).all(|pair| pair[0].end == pair[1].start),
        "{name}: tags neither overlap nor gap"
    );
    let root = 1u128 << (62 / u32::from(set.dims) * u32::from(set.dims));
    assert_eq!(
        (ranges[0].start, ranges[ranges.len() - 1].end),
        (root, 2 * root),
        "{name}: tags fill the cube"
    );
    match options.order {
        Order::Preserved => assert_eq!(points, &set.points, "{name}: the order is preserved"),
        Order::Chunked => check_chunks(set, &decoded),
    }
    decoded
}

/// Points by x: what is in a cell is found among the points of its columns alone, as streams have ten
/// thousands of cells.
struct ByX<'a> {
    points: &'a [Point],
    order: Vec<usize>,
}

impl ByX<'_> {
    fn new(points: &[Point]) -> ByX<'_> {
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by(|&a, &b| points[a][0].total_cmp(&points[b][0]));
        ByX { points, order }
    }

    /// The numbers of the points in a cell, in ascending order.
    fn inside(&self, cell: &Tagged) -> Vec<usize> {
        let until = |x: f64| self.order.partition_point(|&at| self.points[at][0] < x);
        let columns = &self.order[until(cell.min[0])..until(cell.max[0])];
        let mut inside: Vec<usize> =
            columns.iter().copied().filter(|&at| cell.contains(&self.points[at])).collect();
        inside.sort_unstable();
        inside
    }
}

/// The points of a cell stand right before its tag, in the order of the input.
pub(super) fn check_chunks(set: &Set, decoded: &Decoded) {
    let by_x = ByX::new(&set.points);
    let mut start = 0;
    for (end, cell) in &decoded.tags {
        let expected: Vec<Point> = by_x.inside(cell).into_iter().map(|at| set.points[at]).collect();
        assert_eq!(decoded.points[start..*end], expected, "{}: chunk", set.name);
        start = *end;
    }
    assert_eq!(start, decoded.points.len(), "{}: a tag follows the last point", set.name);
}
