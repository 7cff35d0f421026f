//! Rows stay with their points, whatever the cells, the threads and the policy for coinciding points.

use std::collections::HashMap;

use spmesh_pipeline::reduce::{Duplicates, Options, Part};
use spmesh_stream::model::attributes::{Attribute, Attributes, NumberType};
use spmesh_stream::model::bounds::{Point, Region};
use spmesh_stream::{Coordinates, Event, Header, StreamReader, StreamWriter};

use super::solids::tetrahedralize;
use super::space_tiles::merge;
use super::streams::{GRID, Tagging, read_mesh, stream, stream_of, threads, triangulate};
use spmesh_reference::sets::{DEGENERATE_FAMILIES, Random, degenerate, uniform};

const TAGGINGS: [Tagging; 7] = [
    Tagging::None,
    Tagging::Never,
    Tagging::Chunked(1),
    Tagging::Chunked(4),
    Tagging::Ragged,
    Tagging::Preserved(2),
    Tagging::Forgetful(3),
];

/// The number of a point in the stream, its elevation and its place, then bytes that follow from the number.
fn row_of(number: u64, [x, y, z]: Point, filling: usize) -> Vec<u8> {
    let mut row = number.to_le_bytes().to_vec();
    [x, y, z].iter().for_each(|value| row.extend(value.to_le_bytes()));
    row.extend((0..filling).map(|i| (number as usize * 31 + i) as u8));
    row
}

/// Number and point of a row, which must be as it was written.
fn parts_of(row: &[u8]) -> (u64, Point) {
    let (words, _) = row.as_chunks::<8>();
    let number = u64::from_le_bytes(words[0]);
    let point = [1, 2, 3].map(|word| f64::from_le_bytes(words[word]));
    assert_eq!(row, row_of(number, point, row.len() - 32), "a damaged row");
    (number, point)
}

/// The same points with rows, which have so many bytes of `filling`.
fn with_rows(points: &[u8], filling: u8) -> Vec<u8> {
    let mut reader = StreamReader::new(points, "points").unwrap();
    let place = Attribute { components: 3, ..Attribute::new("place", NumberType::F64) };
    let filler = Attribute { components: filling, ..Attribute::new("filling", NumberType::U32) };
    let mut list = vec![Attribute::new("number", NumberType::U64), place];
    list.extend((filling > 0).then_some(filler));
    let header = Header { attributes: Attributes::new(list).unwrap(), ..reader.header().clone() };
    let filling = 4 * usize::from(filling);
    let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
    let mut number = 0;
    while let Some(event) = reader.next_event().unwrap() {
        match event {
            Event::Points(points) => {
                let rows: Vec<u8> = (number..)
                    .zip(&points)
                    .flat_map(|(number, &point)| row_of(number, point, filling))
                    .collect();
                number += points.len() as u64;
                writer.points_with_rows(&points, &rows).unwrap();
            }
            Event::Cells(cells) => writer.cells(&cells).unwrap(),
            Event::End(_) => break,
            other => panic!("{other:?} among points"),
        }
    }
    writer.end(0, 0).unwrap()
}

/// All vertices and residual points of a mesh, with number and point of their rows.
fn rows_of(mesh: &[u8]) -> Vec<(Point, u64, Point)> {
    let mut reader = StreamReader::new(mesh, "mesh").unwrap();
    let row_len = reader.header().attributes.row_len();
    let mut found = Vec::new();
    while let Some(event) = reader.next_event().unwrap() {
        let points = match event {
            Event::Patch(patch) => patch.new,
            Event::ResidualPoints(points) => points.into_iter().map(|(_, point)| point).collect(),
            _ => continue,
        };
        let rows = reader.rows().chunks_exact(row_len).map(parts_of);
        found.extend(points.into_iter().zip(rows).map(|(at, (number, of_row))| (at, number, of_row)));
    }
    found
}

/// The point that a policy chooses from those at one place, in the order of the stream.
fn chosen(policy: Duplicates, group: &[(u64, f64)]) -> u64 {
    let by_elevation = |a: &&(u64, f64), b: &&(u64, f64)| a.1.total_cmp(&b.1);
    let first = &group[0];
    match policy {
        Duplicates::Lowest => group.iter().min_by(by_elevation).unwrap_or(first).0,
        // The first of the highest; `max_by` would give the last.
        Duplicates::Highest => group.iter().min_by(|a, b| by_elevation(b, a)).unwrap_or(first).0,
        _ => first.0,
    }
}

#[test]
fn vertices_keep_the_rows_of_the_points_that_the_policy_chooses() {
    let policies = [Duplicates::First, Duplicates::Lowest, Duplicates::Highest, Duplicates::Mean];
    for seed in 0..6 {
        let mut random = Random::new(seed);
        let places = match seed {
            0 | 1 => uniform(&mut random, 300, 12 + 1000 * seed as i64),
            _ => degenerate(&mut random, seed as usize % DEGENERATE_FAMILIES, 250),
        };
        // Each place comes up to three times, with elevations of which some are equal.
        let copies = places.iter().flat_map(|p| std::iter::repeat_n(p, 1 + (p[0] ^ p[1]) as usize % 3));
        let mut points: Vec<Point> = copies.map(|p| [p[0] as f64, p[1] as f64, 0.0]).collect();
        points.iter_mut().for_each(|point| point[2] = random.integer(0, 3) as f64);
        random.shuffle(&mut points);
        for tagging in TAGGINGS {
            let coordinates = if seed % 2 == 0 { GRID } else { Coordinates::F64 };
            let plain = stream(&points, coordinates, tagging, &mut random);
            let input = with_rows(&plain, [0, 2, 240][seed as usize % 3]);
            for policy in policies {
                check_policy(&plain, &input, policy);
            }
        }
    }
}

fn check_policy(plain: &[u8], input: &[u8], duplicates: Duplicates) {
    let mut groups: HashMap<[u64; 2], Vec<(u64, f64)>> = HashMap::new();
    for (at, number, _) in rows_of_points(input) {
        groups.entry([at[0].to_bits(), at[1].to_bits()]).or_default().push((number, at[2]));
    }
    for threads in [1, 3] {
        let options = Options { duplicates, threads, ..Options::default() };
        let (mesh, _) = triangulate(input, &options).unwrap();
        let (without, _) = triangulate(plain, &options).unwrap();
        assert_eq!(read_mesh(&mesh), read_mesh(&without), "rows change nothing else");
        let rows = rows_of(&mesh);
        assert_eq!(rows.len(), groups.len());
        for (at, number, of_row) in rows {
            let group = &groups[&[at[0].to_bits(), at[1].to_bits()]];
            assert_eq!(number, chosen(duplicates, group), "{duplicates:?} of {group:?}");
            assert_eq!(of_row[..2], at[..2]);
            assert!(duplicates == Duplicates::Mean || of_row[2] == at[2]);
        }
    }
}

/// Points of a stream, with number and point of their rows.
fn rows_of_points(stream: &[u8]) -> Vec<(Point, u64, Point)> {
    let mut reader = StreamReader::new(stream, "points").unwrap();
    let row_len = reader.header().attributes.row_len();
    let mut found = Vec::new();
    while let Some(event) = reader.next_event().unwrap() {
        if let Event::Points(points) = event {
            let rows = reader.rows().chunks_exact(row_len).map(parts_of);
            found.extend(points.into_iter().zip(rows).map(|(at, (number, of_row))| (at, number, of_row)));
        }
    }
    found
}

#[test]
fn parts_hand_rows_over() {
    let mut random = Random::new(5);
    let points: Vec<Point> =
        uniform(&mut random, 900, 500).iter().map(|p| [p[0] as f64, p[1] as f64, p[0] as f64]).collect();
    let input = with_rows(&stream(&points, GRID, Tagging::Chunked(3), &mut random), 3);
    let mut sides = vec![f64::NEG_INFINITY, 100.0, 260.0, f64::INFINITY];
    sides.dedup();
    let mut parts = Vec::new();
    for x in sides.windows(2) {
        let region = Region { min: [x[0], f64::NEG_INFINITY], max: [x[1], f64::INFINITY] };
        let options = Options { part: Some(Part::Region(region)), ..threads(2) };
        parts.push(triangulate(&input, &options).unwrap().0);
        let rows = rows_of(parts.last().unwrap());
        assert!(!rows.is_empty() && rows.iter().all(|&(at, _, of_row)| at == of_row));
    }
    let readers = || parts.iter().map(|part| StreamReader::new(&part[..], "part").unwrap()).collect();
    let (merged, _) =
        spmesh_pipeline::reduce::merge_triangles(readers(), Vec::new(), &Options::default(), |_| ()).unwrap();
    let rows = rows_of(&merged);
    assert_eq!(rows.len(), points.len());
    assert!(rows.iter().all(|&(at, _, of_row)| at == of_row));
    assert_eq!(read_mesh(&merged), {
        let mut whole = read_mesh(&triangulate(&input, &threads(1)).unwrap().0);
        whole.vertices = read_mesh(&merged).vertices;
        whole
    });
}

#[test]
fn parts_of_other_attributes_are_refused() {
    let points: Vec<Point> = (0..40).map(|i| [f64::from(i % 7), f64::from(i * i % 11), 0.0]).collect();
    let plain = stream(&points, GRID, Tagging::None, &mut Random::new(1));
    let part = |input: &[u8], min: f64, max: f64| {
        let region = Region { min: [min, f64::NEG_INFINITY], max: [max, f64::INFINITY] };
        triangulate(input, &Options { part: Some(Part::Region(region)), ..threads(1) }).unwrap().0
    };
    let parts = [part(&plain, f64::NEG_INFINITY, 3.0), part(&with_rows(&plain, 0), 3.0, f64::INFINITY)];
    let readers = parts.iter().map(|part| StreamReader::new(&part[..], "part").unwrap()).collect();
    let error = spmesh_pipeline::reduce::merge_triangles(readers, Vec::new(), &Options::default(), |_| ())
        .unwrap_err();
    assert!(error.to_string().contains("differ in their attributes"), "{error}");
}

#[test]
fn tetrahedra_keep_rows() {
    for (seed, tagging) in [Tagging::None, Tagging::Chunked(2), Tagging::Preserved(1)].into_iter().enumerate()
    {
        let mut random = Random::new(seed as u64);
        let side = [4, 9, 1000][seed];
        let points: Vec<Point> =
            (0..400).map(|_| [0; 3].map(|_: i64| random.integer(0, side) as f64)).collect();
        let input = with_rows(&stream_of(3, &points, GRID, tagging, &mut random), 5);
        let first: HashMap<[u64; 3], u64> = rows_of_points(&input)
            .into_iter()
            .rev()
            .map(|(at, number, _)| (at.map(f64::to_bits), number))
            .collect();
        let (whole, _) = tetrahedralize(&input, &Options { threads: 2, ..Options::default() }).unwrap();
        let region = |min: f64, max: f64| Region {
            min: [min, f64::NEG_INFINITY, f64::NEG_INFINITY],
            max: [max, f64::INFINITY, f64::INFINITY],
        };
        let middle = (side / 2) as f64;
        let parts = [region(f64::NEG_INFINITY, middle), region(middle, f64::INFINITY)].map(|region| {
            let options = Options { part: Some(Part::Region(region)), ..Options::default() };
            tetrahedralize(&input, &options).unwrap().0
        });
        let (merged, _) = merge(&parts, None).unwrap();
        for mesh in [&whole, &merged] {
            let rows = rows_of(mesh);
            assert_eq!(rows.len(), first.len());
            for (at, number, of_row) in rows {
                assert_eq!((at, number), (of_row, first[&at.map(f64::to_bits)]));
            }
        }
    }
}
