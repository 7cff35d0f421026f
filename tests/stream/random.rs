//! Streams with random content.

use spmesh_stream::model::bounds::{Bounds, Point, Region};
use spmesh_stream::model::cells::{CellCode, CellTree};
use spmesh_stream::{Coordinates, Crs, Event, Header, Kind, Patch, PointRegion};

use super::{Random, attributes, write_rows};

/// A header with random fields, and coordinates that suit all of them.
fn random_header(random: &mut Random, kind: Kind) -> (Header, CellTree) {
    let dims = match kind {
        Kind::TetrahedralMesh | Kind::PartialTetrahedralMesh | Kind::RegionPoints => 3,
        Kind::Points if random.coin() => 3,
        _ => 2,
    };
    let coordinates = if random.coin() {
        Coordinates::F64
    } else {
        let height = if dims == 3 { 0.01 } else { 1e-3 };
        Coordinates::I32 { scale: [0.01, 0.01, height], offset: [5e5, -4e6, random.below(100) as f64] }
    };
    let mut header = Header::new(kind, coordinates, dims, dims == 2 && random.coin());
    let tree = CellTree::new(dims, 4, [-32.0, 0.0, if dims == 3 { -8.0 } else { 0.0 }], 64.0).unwrap();
    header.tree = (kind.may_have_tree() && (kind == Kind::Points || random.coin())).then_some(tree);
    let region =
        Region::of_sides(&[-32.0, 0.0, -8.0][..dims.into()], &[32.0, 32.0, f64::INFINITY][..dims.into()]);
    header.region = kind.is_partial().then_some(region);
    header.crs = match random.below(3) {
        0 => Crs::Unknown,
        1 => Crs::Wkt("PROJCS[\"\u{fc}\\\t\u{1}\u{7f}\u{2028}\"]".repeat(random.below(9))),
        _ => Crs::GeoKeys {
            directory: vec![1; random.below(20)],
            doubles: Vec::new(),
            ascii: vec![7; random.below(3)],
        },
    };
    header.producer = "x".repeat(random.below(3));
    (header, tree)
}

fn random_point(random: &mut Random, header: &Header) -> Point {
    let mut point: Point = std::array::from_fn(|_| random.below(32) as f64);
    point[0] -= 16.0;
    if matches!(header.coordinates, Coordinates::F64) {
        point = point.map(|x| x + random.below(1 << 20) as f64 / f64::from(1 << 20));
    }
    point[header.coordinates_per_point()..].fill(0.0);
    point
}

/// Points in random order; a cell of the deepest level is tagged once it has no further points.
fn random_points(random: &mut Random, header: &Header, tree: &CellTree) -> Vec<Event> {
    let mut points: Vec<Point> = (0..random.below(300)).map(|_| random_point(random, header)).collect();
    let mut events = Vec::new();
    while !points.is_empty() {
        let rest = points.split_off(points.len().min(1 + random.below(40)));
        let open = |cell: &CellCode| !rest.iter().any(|&point| tree.cell_of(point, 4) == *cell);
        let mut cells: Vec<_> = points.iter().map(|&point| tree.cell_of(point, 4)).filter(open).collect();
        cells.sort();
        cells.dedup();
        events.extend([Event::Points(points), Event::Cells(cells)]);
        points = rest;
    }
    events
}

/// Points that each lie in one or several of a few regions, region by region.
fn random_regions(random: &mut Random, header: &Header) -> Vec<Event> {
    let count = random.below(6);
    let points: Vec<(Point, Vec<usize>)> = (0..if count == 0 { 0 } else { random.below(200) })
        .map(|_| {
            let mut regions: Vec<usize> = (0..count).filter(|_| random.below(4) == 0).collect();
            if regions.is_empty() {
                regions.push(random.below(count));
            }
            (random_point(random, header), regions)
        })
        .collect();
    let mut events = Vec::new();
    for region in 0..count {
        // Own points, then those that come first, again, and last.
        let mut groups: [Vec<Point>; 4] = Default::default();
        for (point, regions) in points.iter().filter(|(_, regions)| regions.contains(&region)) {
            let group = match (regions[0] == region, regions[regions.len() - 1] == region) {
                (true, true) => 0,
                (true, false) => 1,
                (false, false) => 2,
                (false, true) => 3,
            };
            groups[group].push(*point);
        }
        let [own, first, again, last] = groups.each_ref().map(|group| group.len() as u64);
        let low = random_point(random, header);
        let bounds =
            Region { min: [f64::NEG_INFINITY, low[1], low[2]], max: [low[0], low[1] + 1.5, f64::INFINITY] };
        events.push(Event::Region(PointRegion { bounds, own, first, again, last }));
        events.push(Event::Points(groups.concat()));
    }
    events
}

/// Patches with random imports and finalization, then a residual of the live vertices. A tetrahedral mesh has
/// labels that lag behind its vertices, or none.
fn random_mesh(random: &mut Random, header: &Header) -> Vec<Event> {
    let mut live: Vec<(u64, Point)> = Vec::new();
    let mut events = Vec::new();
    let mut first_id = 0;
    let per_simplex = header.kind.vertices_per_simplex();
    let has_labels = header.kind == Kind::TetrahedralMesh && random.coin();
    let mut unlabelled = 0;
    for _ in 0..random.below(20) {
        let new: Vec<Point> = (0..random.below(8)).map(|_| random_point(random, header)).collect();
        let imported: Vec<_> = live.iter().copied().filter(|_| random.below(3) == 0).collect();
        let vertices = new.len() + imported.len();
        let mut simplices = Vec::new();
        for _ in 0..if vertices < per_simplex { 0 } else { random.below(6) } {
            let start = random.below(vertices);
            simplices.extend((0..per_simplex).map(|i| ((start + i) % vertices) as u32));
        }
        let finalized: Vec<u32> = (0..vertices as u32).filter(|_| random.below(3) == 0).collect();
        let imported = imported.iter().map(|&(id, _)| id).collect();
        let patch = Patch { first_id, new, imported, simplices, finalized, ..Patch::default() };
        live.extend(patch.new.iter().zip(first_id..).map(|(&point, id)| (id, point)));
        live.retain(|&(id, _)| !patch.finalized.iter().any(|&local| patch.id(local) == id));
        first_id += patch.new.len() as u64;
        unlabelled += patch.new.len();
        events.push(Event::Patch(patch));
        if has_labels {
            let count = random.below(unlabelled + 1);
            unlabelled -= count;
            events.push(Event::Labels((0..count).map(|_| random.next()).collect()));
        }
    }
    if has_labels {
        events.push(Event::Labels((0..unlabelled).map(|_| random.next() % 9).collect()));
    }
    if !header.kind.is_partial() {
        let imported: Vec<u64> = live.iter().map(|&(id, _)| id).collect();
        let finalized = (0..imported.len() as u32).collect();
        events.push(Event::Patch(Patch { first_id, imported, finalized, ..Patch::default() }));
    } else {
        let mut residual: Vec<_> = live.iter().map(|&(id, point)| (Some(id), point)).collect();
        residual.extend((0..random.below(5)).map(|_| (None, random_point(random, header))));
        let ends = residual.len() as u32;
        let corners = header.kind.vertices_per_wall() as u32;
        let walls = (corners..=ends).flat_map(|end| end - corners..end).collect();
        events.extend([Event::ResidualPoints(residual), Event::Walls(walls)]);
    }
    events
}

/// A complete and well-formed stream with random content.
pub(super) fn random_stream(seed: u64) -> (Header, Vec<Event>, Vec<u8>) {
    let mut random = Random(seed);
    let kinds = [
        Kind::Points,
        Kind::TriangleMesh,
        Kind::PartialTriangleMesh,
        Kind::TetrahedralMesh,
        Kind::PartialTetrahedralMesh,
        Kind::RegionPoints,
    ];
    let kind = kinds[random.below(kinds.len())];
    let (mut header, tree) = random_header(&mut random, kind);
    let events = match kind {
        Kind::Points => random_points(&mut random, &header, &tree),
        Kind::RegionPoints => random_regions(&mut random, &header),
        _ => random_mesh(&mut random, &header),
    };
    let mut points = Vec::new();
    for event in &events {
        match event {
            Event::Points(block) => points.extend(block),
            Event::Patch(patch) => points.extend(&patch.new),
            Event::ResidualPoints(block) => {
                points.extend(block.iter().filter(|(id, _)| id.is_none()).map(|&(_, point)| point));
            }
            _ => {}
        }
    }
    let counted = events.iter().map(|event| match event {
        Event::Region(region) => region.new_points(),
        _ => 0,
    });
    let (input_points, merged) = match kind {
        Kind::Points => (points.len() as u64, 0),
        Kind::RegionPoints => (counted.sum(), 0),
        _ => {
            let merged = random.below(9) as u64;
            (points.len() as u64 + merged, merged)
        }
    };
    header.points = random.coin().then_some(input_points);
    header.bounds = if random.coin() { Bounds::of_points(&points) } else { None };
    let end = spmesh_stream::Totals { points: input_points, merged, ..Default::default() };
    if random.coin() {
        header.attributes = attributes::random_attributes(&mut random);
    }
    let all = [&events[..], &[Event::End(end)]].concat();
    let bytes = write_rows(&header, &all, &attributes::rows_of(&header, &all)).unwrap();
    (header, events, bytes)
}
