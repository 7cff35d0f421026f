//! Smoothed lines of rough terrain: no two segments meet, and lines are smoother.

use spmesh_stream::Coordinates;
use spmesh_terrain::contours::Options;

use super::{Line, lines, options};
use crate::dem::Mesh;
use spmesh_reference::sets::{Random, degenerate, uniform};

/// Whether two segments have a common point, decided exactly.
fn meet([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> bool {
    let coordinate = |[x, y]: [f64; 2]| robust::Coord { x, y };
    let side = |p, q, r| {
        robust::orient2d(coordinate(p), coordinate(q), coordinate(r)).partial_cmp(&0.0).unwrap() as i8
    };
    let is_apart = (0..2).any(|axis| {
        a[axis].max(b[axis]) < c[axis].min(d[axis]) || c[axis].max(d[axis]) < a[axis].min(b[axis])
    });
    !is_apart && side(a, b, c) * side(a, b, d) <= 0 && side(c, d, a) * side(c, d, b) <= 0
}

/// Checks that segments meet only at the point between them in a line.
fn check_apart(lines: &[Line]) -> usize {
    let mut segments = Vec::new();
    for (number, line) in lines.iter().enumerate() {
        let count = line.segments().count();
        segments.extend(line.segments().enumerate().map(|(at, ends)| (number, at, count, ends)));
    }
    for (first, &(line, at, count, ends)) in segments.iter().enumerate() {
        for &(other, place, _, others) in &segments[first + 1..] {
            let is_next = line == other
                && (place == at + 1 || (at == 0 && place + 1 == count && lines[line].is_closed));
            assert!(
                is_next || !meet(ends, others),
                "{ends:?} of line {line} meets {others:?} of line {other}"
            );
        }
    }
    segments.len()
}

/// The mean angle between successive segments.
fn roughness(lines: &[Line]) -> f64 {
    let angles = lines.iter().flat_map(|line| {
        let segments: Vec<[[f64; 2]; 2]> = line.segments().collect();
        let along = |[p, q]: [[f64; 2]; 2]| (q[1] - p[1]).atan2(q[0] - p[0]);
        let turns: Vec<f64> = segments
            .windows(2)
            .map(|pair| {
                let turn = (along(pair[1]) - along(pair[0])).rem_euclid(std::f64::consts::TAU);
                turn.min(std::f64::consts::TAU - turn)
            })
            .collect();
        turns
    });
    let angles: Vec<f64> = angles.collect();
    angles.iter().sum::<f64>() / angles.len() as f64
}

#[test]
fn lines_never_meet() {
    let mut random = Random::new(41);
    let mut count = 0;
    for round in 0..12 {
        // Elevations are random from 0 to 999, or few, so that vertices lie on levels and edges are level.
        let points = match round % 3 {
            0 => uniform(&mut random, 60, 1_000),
            1 => uniform(&mut random, 80, 30),
            _ => degenerate(&mut random, 0, 60),
        };
        let mut mesh = Mesh::of(&mut random, &points);
        let modulus = [1_000.0, 40.0, 3.0, 7.0][round % 4];
        mesh.points.iter_mut().for_each(|[_, _, z]| *z %= modulus);
        let interval = if modulus == 1_000.0 { 90.0 } else { 1.0f64.max(modulus / 12.0) };
        let stream = mesh.stream(Coordinates::F64);
        let smooth = Options { is_smooth: true, ..options(interval, 0.0) };
        let found = lines(&stream, &smooth);
        count += check_apart(&found);
        let shuffled = mesh.shuffled(&mut random).stream(Coordinates::F64);
        assert_eq!(found, lines(&shuffled, &smooth), "{round}");
    }
    assert!(count > 10_000, "{count}");
}

#[test]
fn lines_are_smoother_and_stay_near_their_level() {
    let mut random = Random::new(43);
    let mut mesh = Mesh::of(&mut random, &uniform(&mut Random::new(3), 1_500, 1_000));
    // A hill with noise.
    mesh.points.iter_mut().for_each(|[x, y, z]| {
        *z = 100.0 - ((*x - 500.0).powi(2) + (*y - 500.0).powi(2)).sqrt() / 6.0 + *z % 10.0 * 0.2;
    });
    let stream = mesh.stream(Coordinates::F64);
    let plain = lines(&stream, &options(10.0, 0.0));
    let smooth = lines(&stream, &Options { is_smooth: true, ..options(10.0, 0.0) });
    assert_eq!(plain.len(), smooth.len());
    let [before, after] = [roughness(&plain), roughness(&smooth)];
    assert!(after < 0.4 * before, "{before} {after}");
    for line in &smooth {
        // Triangles are large at the border.
        let is_amid = |[x, y]: &&[f64; 2]| (x - 500.0).hypot(y - 500.0) < 400.0;
        for [x, y] in line.points.iter().filter(is_amid) {
            let height = 100.0 - ((x - 500.0).powi(2) + (y - 500.0).powi(2)).sqrt() / 6.0;
            assert!((height + 0.9 - line.elevation).abs() < 4.5 + 3.0, "{x} {y} {}", line.elevation);
        }
    }
}
