//! Noding against snap rounding by definition, and on sets that are hard for it.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use spmesh_base::random::Random;
use spmesh_delaunay::noding::{
    BEND_BYTES, COORDINATE_MAX, CROSSING_BYTES, LineVertex, Noded, NodingChange, NodingOptions, node_lines,
};
use spmesh_reference::noding::{Place, are_noded, snap_round};

const OPTIONS: NodingOptions =
    NodingOptions { round_elevations: false, crossings_max: 1 << 20, bytes_max: u64::MAX };

type Changes = BTreeMap<String, usize>;

fn node_vertices(lines: &[Vec<LineVertex>], options: &NodingOptions) -> (Noded, Changes) {
    let vertices: Vec<LineVertex> = lines.iter().flatten().copied().collect();
    let mut next = 0;
    let starts: Vec<u32> = lines.iter().map(|line| (next, next += line.len() as u32).0).collect();
    let mut changes = Changes::new();
    let mut note = |change: NodingChange, line: u32, _: Place| {
        assert!((line as usize) < lines.len(), "{change:?} of line {line}");
        *changes.entry(format!("{change:?}")).or_default() += 1;
    };
    let noded = node_lines(Cow::Owned(vertices), &starts, options, &mut note).expect("noded");
    (noded, changes)
}

fn without_elevations(lines: &[Vec<Place>]) -> Vec<Vec<LineVertex>> {
    lines.iter().map(|line| line.iter().map(|&place| LineVertex { place, z: None }).collect()).collect()
}

fn node(lines: &[Vec<Place>]) -> (Noded, Changes) {
    node_vertices(&without_elevations(lines), &OPTIONS)
}

/// Vertices, and segments with their lines.
fn content(noded: &Noded) -> (BTreeSet<Place>, BTreeMap<[Place; 2], usize>) {
    let places: Vec<Place> = noded.vertices.iter().map(|vertex| vertex.place).collect();
    assert!(places.is_sorted_by(|a, b| a < b));
    assert!(noded.segments.is_sorted_by(|a, b| a.ends < b.ends));
    assert!(noded.segments.iter().all(|segment| segment.ends[0] < segment.ends[1]));
    let segments =
        noded.segments.iter().map(|s| (s.ends.map(|end| places[end as usize]), s.line as usize)).collect();
    (places.into_iter().collect(), segments)
}

/// A random place of one of several kinds, which have ties of different sorts.
fn place(random: &mut Random, extent: i64) -> Place {
    [0, 1].map(|_| (random.below(2 * extent as u64 + 1) as i64) - extent)
}

fn lines(random: &mut Random) -> Vec<Vec<Place>> {
    let extent = [2, 5, 12, 40, 1000, 1 << 31, COORDINATE_MAX][random.below(7) as usize];
    let near = [1, extent][random.below(2) as usize];
    let count = 1 + random.below(8);
    (0..count)
        .map(|_| {
            let first = place(random, extent);
            let mut line = vec![first];
            for _ in 0..random.below(5) {
                let step = place(random, near);
                let last = line[line.len() - 1];
                let next = [0, 1].map(|axis| (last[axis] + step[axis]).clamp(-extent, extent));
                line.push(if random.below(6) == 0 { first } else { next });
            }
            line
        })
        .collect()
}

/// Checks along which segments lines state elevations, if they do so at some of their vertices.
fn check_elevations(random: &mut Random, lines: &[Vec<Place>]) {
    let mut vertex = |&place: &Place| LineVertex { place, z: (random.below(3) > 0).then_some(1.0) };
    let stated: Vec<Vec<LineVertex>> =
        lines.iter().map(|line| line.iter().map(&mut vertex).collect()).collect();
    let (noded, _) = node_vertices(&stated, &OPTIONS);
    let place = |end: u32| noded.vertices[end as usize].place;
    let segments = noded.segments.iter().filter(|segment| segment.is_hard);
    let found: BTreeSet<[Place; 2]> = segments.map(|segment| segment.ends.map(place)).collect();
    // Each part as a line of its own: those with elevations at both ends have the least numbers.
    let width = |line: &Vec<LineVertex>| line.len().min(2);
    let windows = stated.iter().flat_map(|line| line.windows(width(line)));
    let (hard, soft): (Vec<_>, Vec<_>) =
        windows.partition(|part| part.len() == 2 && part.iter().all(|vertex| vertex.z.is_some()));
    let places = |part: &&[LineVertex]| part.iter().map(|vertex| vertex.place).collect();
    let parts: Vec<Vec<Place>> = hard.iter().chain(&soft).map(places).collect();
    let (_, segments) = snap_round(&parts);
    let expected = segments.into_iter().filter(|&(_, number)| number < hard.len()).map(|(ends, _)| ends);
    assert_eq!(found, expected.collect(), "{stated:?}");
}

#[test]
fn small_sets_are_noded_as_defined() {
    check_small_sets(20_261_125, 4_000);
}

#[test]
#[ignore = "long: run with -- --ignored"]
fn many_small_sets_are_noded_as_defined() {
    check_small_sets(1, 200_000);
}

fn check_small_sets(seed: u64, cases: u32) {
    println!("seed {seed}");
    let mut random = Random::new(seed);
    for case in 0..cases {
        let lines = lines(&mut random);
        let (noded, _) = node(&lines);
        let (vertices, segments) = content(&noded);
        let all: Vec<[Place; 2]> = segments.keys().copied().collect();
        assert_eq!((vertices, segments), snap_round(&lines), "case {case}: {lines:?}");
        for (index, &one) in all.iter().enumerate() {
            assert!(all[..index].iter().all(|&other| are_noded(one, other)), "case {case}: {lines:?}");
        }
        check_elevations(&mut random, &lines);
    }
}

#[test]
fn crowded_sets_are_noded_as_defined() {
    let seed = 7;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    for case in 0..60 {
        let extent = [6, 30, 300, 1 << 20][case % 4];
        let mut lines: Vec<Vec<Place>> = (0..14).flat_map(|_| lines(&mut random)).collect();
        lines.retain(|line| line.iter().flatten().all(|value| value.abs() <= extent));
        // Bundles of long segments: through one place, through one corner of pixels, and beside each other.
        for number in 0..30 {
            let [x, y] = place(&mut random, extent);
            let (i, j) = (number % 6, number / 6);
            lines.push(match case % 3 {
                0 => vec![[x, y], [2 - x, 2 - y]],
                1 => vec![[x, y], [1 - x, 1 - y]],
                _ => vec![[-extent, i - 3], [extent, j - 3]],
            });
        }
        let (vertices, segments) = content(&node(&lines).0);
        let expected = snap_round(&lines);
        assert_eq!((vertices, segments), expected, "case {case}");
    }
}

#[test]
fn order_and_direction_do_not_matter() {
    let mut random = Random::new(3);
    for case in 0..1000 {
        let mut lines: Vec<Vec<LineVertex>> = without_elevations(&lines(&mut random));
        for vertex in lines.iter_mut().flatten() {
            vertex.z = (random.below(3) > 0).then(|| random.below(5) as f64 * 0.7);
        }
        let (noded, changes) = node_vertices(&lines, &OPTIONS);
        for index in (1..lines.len()).rev() {
            lines.swap(index, random.below(index as u64 + 1) as usize);
        }
        lines.iter_mut().for_each(|line| line.reverse());
        let (again, changes_again) = node_vertices(&lines, &OPTIONS);
        assert_eq!(noded.vertices, again.vertices, "case {case}: {lines:?}");
        assert!(noded.segments.iter().map(|s| s.ends).eq(again.segments.iter().map(|s| s.ends)));
        assert_eq!(changes, changes_again);
    }
}

#[test]
fn changes_are_counted() {
    let count = |lines: &[Vec<Place>], name: &str| node(lines).1.get(name).copied().unwrap_or(0);
    let cross = [vec![[0, 0], [10, 10]], vec![[0, 10], [10, 0]]];
    assert_eq!((count(&cross, "Crossing"), count(&cross, "Touch")), (1, 0));
    let touch = [vec![[0, 0], [10, 0]], vec![[5, 0], [5, 8]]];
    assert_eq!((count(&touch, "Crossing"), count(&touch, "Touch")), (0, 1));
    let overlap = [vec![[0, 0], [10, 0]], vec![[5, 0], [20, 0]]];
    assert_eq!((count(&overlap, "Overlap"), count(&overlap, "Touch")), (1, 0));
    let spike = [vec![[0, 0], [10, 0], [0, 0], [0, 5], [0, 5]]];
    assert_eq!((count(&spike, "Spike"), count(&spike, "Overlap"), count(&spike, "ZeroLength")), (1, 0, 1));
    assert_eq!(count(&[vec![[1, 1]], vec![[2, 2], [2, 2]]], "SingleVertex"), 2);
    assert_eq!(node(&[vec![[1, 1]], vec![[0, 0], [2, 2]]]).0.segments.len(), 2);
}

#[test]
fn elevations_are_stated_or_interpolated() {
    let vertex = |x, y, z| LineVertex { place: [x, y], z };
    let lines = [
        vec![vertex(0, 0, Some(10.0)), vertex(10, 0, Some(20.0))],
        // Crosses at x = 4, without elevations.
        vec![vertex(4, -5, None), vertex(4, 5, None)],
        // Crosses at x = 7, with elevations that differ.
        vec![vertex(7, -5, Some(0.0)), vertex(7, 5, Some(1.0))],
        // States an elevation on the first line.
        vec![vertex(5, 0, Some(3.0)), vertex(5, 9, None)],
        vec![vertex(0, 0, Some(9.0))],
    ];
    let (noded, changes) = node_vertices(&lines, &OPTIONS);
    let z = |x, y| noded.vertices.iter().find(|v| v.place == [x, y]).expect("a vertex").z;
    assert_eq!((z(0, 0), z(10, 0), z(5, 0), z(5, 9)), (Some(9.0), Some(20.0), Some(3.0), None));
    assert_eq!(z(4, 0), Some(9.0 + (3.0 - 9.0) * 0.8));
    assert_eq!(z(7, 0), Some(0.5));
    assert_eq!(z(4, 5), None);
    assert_eq!(changes["ConflictingElevation"], 2);
    let rounded = node_vertices(&lines, &NodingOptions { round_elevations: true, ..OPTIONS }).0;
    assert!(rounded.vertices.iter().filter_map(|v| v.z).all(|z| z.fract() == 0.0));
}

#[test]
fn too_many_crossings_are_refused() {
    let lines: Vec<Vec<Place>> =
        (0..100).flat_map(|i| [vec![[i, -1], [i, 100]], vec![[-1, i], [100, i]]]).collect();
    let vertices: Vec<LineVertex> = without_elevations(&lines).concat();
    let starts: Vec<u32> = (0..200).map(|line| 2 * line).collect();
    let node = |crossings_max| {
        let options = NodingOptions { crossings_max, ..OPTIONS };
        node_lines(Cow::Borrowed(&vertices), &starts, &options, &mut |_, _, _| {})
    };
    assert_eq!(node(10_000).unwrap().vertices.len(), 10_000 + 400);
    let error = node(9_999).unwrap_err();
    assert!(error.to_string().contains("more than 9999 crossings"), "{error}");
    // Each crossing bends two lines.
    let within = |bytes_max| {
        let options = NodingOptions { bytes_max, ..OPTIONS };
        node_lines(Cow::Borrowed(&vertices), &starts, &options, &mut |_, _, _| {})
    };
    let most = 10_000 * (CROSSING_BYTES + 2 * BEND_BYTES);
    assert!(within(most).is_ok());
    assert!(within(most - 1).unwrap_err().to_string().contains("10000 crossings and 20000 bends so far"));
    let options = OPTIONS;
    let far = [LineVertex { place: [COORDINATE_MAX + 1, 0], z: None }];
    assert!(node_lines(Cow::Borrowed(&far), &[0], &options, &mut |_, _, _| {}).is_err());
    assert!(node_lines(Cow::Borrowed(&[]), &[], &options, &mut |_, _, _| {}).unwrap().vertices.is_empty());
}

/// None of these takes more than a moment, which a quadratic method would.
#[test]
fn hard_sets_take_no_quadratic_time() {
    let n = 50_000;
    let mut random = Random::new(5);
    let one_place = vec![vec![[3, 3]; n as usize]];
    let collinear: Vec<Vec<Place>> = (0..n).map(|i| vec![[i, 2 * i], [i + 1000, 2 * i + 2000]]).collect();
    let mut far = || [1 << 31, -(1 << 31)][random.below(2) as usize];
    let star = (0..n).map(|i| vec![[0, 0], [far(), i * 9973 - n * 5000]]).collect();
    let parallel = (0..n).map(|i| vec![[-(1 << 31), i], [1 << 31, i + 77]]).collect();
    let mut long: Vec<Vec<Place>> = (0..n).map(|i| vec![[10 * i, 0], [10 * i + 5, 7]]).collect();
    long.push(vec![[0, 4], [10 * n, 4]]);
    // All through the corner of four pixels, and none ends near it.
    let corner = (0..n / 100).map(|i| vec![[-100_000 - i, i], [100_001 + i, 1 - i]]).collect();
    let expected = [(1, 0), (0, 0), (n + 1, n), (2 * n, n), (3 * n + 2, 0), (0, 0)];
    for (lines, (vertices, segments)) in
        [one_place, collinear, star, parallel, long, corner].iter().zip(expected)
    {
        let start = std::time::Instant::now();
        let noded = node(lines).0;
        println!(
            "{} vertices, {} segments, {:?}",
            noded.vertices.len(),
            noded.segments.len(),
            start.elapsed()
        );
        assert!(vertices == 0 || noded.vertices.len() as i64 == vertices, "{}", noded.vertices.len());
        assert!(segments == 0 || noded.segments.len() as i64 == segments, "{}", noded.segments.len());
    }
}
