//! Thinning keeps the right point of each cell, whatever the order of the points and the memory.

use std::collections::HashMap;

use spmesh_base::error::ErrorKind;
use spmesh_pipeline::finalize::{Options, Order, Thin, run};

use super::*;
use crate::programs::{Folder, assert_outcome};

fn thinning(text: &str) -> Options {
    Options { thin: Some(text.parse().expect("a rule")), ..options(collapsed(50), Order::Preserved) }
}

/// The points that remain, by a search of all points of each cell. Coordinates are integers of centimetres.
fn expected(set: &Set, cell: i64, rule: &str) -> Vec<Point> {
    let corner = [50_000_000, 400_000_000, 0];
    let mut cells: HashMap<Vec<i64>, Vec<usize>> = HashMap::new();
    let world = |point: &Point, axis: usize| point[axis] as i64 + corner[axis];
    for (number, point) in set.points.iter().enumerate() {
        let key = (0..usize::from(set.dims)).map(|axis| world(point, axis).div_euclid(cell)).collect();
        cells.entry(key).or_default().push(number);
    }
    let rank = |number: &usize| {
        let point = &set.points[*number];
        match rule {
            "lowest" => point[2] as i64,
            "highest" => -point[2] as i64,
            "first" => 0,
            _ => (0..usize::from(set.dims))
                .map(|axis| (2 * world(point, axis).rem_euclid(cell) - cell).pow(2))
                .sum(),
        }
    };
    // Of equal ranks, `min_by_key` takes the first.
    let mut kept: Vec<usize> =
        cells.values().map(|cell| *cell.iter().min_by_key(|number| rank(number)).expect("a point")).collect();
    kept.sort_unstable();
    kept.into_iter().map(|number| set.points[number]).collect()
}

#[test]
fn each_cell_keeps_the_point_that_a_search_finds() {
    for name in ["random", "clustered", "swaths permuted", "duplicates", "lattice", "all equal", "space"] {
        let set = sets().into_iter().find(|set| set.name == name).expect("a set of this name");
        for (cell, steps) in [("0.1", 10), ("0.16", 16), ("3", 300), ("250.5", 25_050)] {
            for rule in ["lowest", "highest", "first", "nearest-centre"] {
                let options = thinning(&format!("{cell}:{rule}"));
                let (stream, stats) = finalize(&set, &options);
                let expected = expected(&set, steps, rule);
                let thinned = Set { points: expected, ..self::set(set.name, set.dims, GRID, Vec::new()) };
                let decoded = check(&thinned, &options, &stream);
                assert_eq!(decoded.points, thinned.points, "{name} {cell}:{rule}");
                assert_eq!(stats.thinned, (set.points.len() - thinned.points.len()) as u64);
            }
        }
    }
}

#[test]
fn decimals_on_borders_belong_to_the_upper_cell() {
    // 0.3 / 0.1 is less than 3 in f64, and 0.7 / 0.1 less than 7.
    let points = (0..30).map(|i| [f64::from(i) / 10.0, 0.0, 1.0]).collect();
    let set = set("tenths", 2, Coordinates::F64, points);
    assert_eq!(finalize(&set, &thinning("0.1")).1.thinned, 0);
    assert_eq!(finalize(&set, &thinning("0.3:first")).1.points, 10);
}

#[test]
fn cells_that_do_not_fit_the_budget_are_a_memory_error() {
    let set = set("random", 2, GRID, integer_points(40_000, 1, 1 << 30));
    let options = Options { budget: Budget::of_engine(1 << 20).expect("enough"), ..thinning("0.5") };
    let error = run(&Memory::new(&set), &options, &mut (), &mut Vec::new()).expect_err("too many cells");
    assert_eq!(error.kind(), ErrorKind::Memory);
    assert!(error.to_string().contains("larger cells"), "{error}");
    let coarse = Options { thin: thinning("1000000").thin, ..options };
    run(&Memory::new(&set), &coarse, &mut (), &mut Vec::new()).expect("few cells");
}

#[test]
fn rules_that_make_no_sense_are_usage_errors() {
    for (text, part) in [("0", "no side"), ("-1", "no side"), ("1:middle", "unknown rule"), ("x", "no side")]
    {
        let error = text.parse::<Thin>().expect_err("it makes no sense");
        assert!(error.contains(part), "{error}");
    }
    let set = set("far", 2, Coordinates::F64, vec![[1e20, 0.0, 0.0]]);
    let error = run(&Memory::new(&set), &thinning("1"), &mut (), &mut Vec::new()).expect_err("too small");
    assert!(error.kind() == ErrorKind::Usage && error.to_string().contains("too small"), "{error}");
    let folder = Folder::new();
    let flat = folder.write("a.xy", "1 2\n1.5 2\n");
    assert_outcome("spfinalize", &["--thin", "1", &flat], &[], 2, "no elevation");
    assert_outcome("spfinalize", &["--thin", "1:first", "--stats", &flat], &[], 0, "points dropped: thin");
}

#[test]
fn filters_come_first_and_attributes_stay_with_their_points() {
    let folder = Folder::new();
    let lines: String =
        (0..3000).map(|i| format!("{} {} {} {i}\n", i % 50, i / 50 % 50, i * 7919 % 101)).collect();
    let path = folder.write("a.csv", format!("x y z number\n{lines}"));
    let flags = ["--thin=10:lowest", "--keep-z=50,", "--attributes=number", "--preserve", &path];
    let stream = crate::programs::run("spfinalize", &flags, &[]).stdout;
    let text = crate::programs::run("spconvert", &["--to", "text"], &stream).stdout;
    let text = String::from_utf8(text).expect("text");
    let mut least: HashMap<(i32, i32), (i32, i32)> = HashMap::new();
    for i in 0..3000 {
        let (x, y, z) = (i % 50, i / 50 % 50, i * 7919 % 101);
        let kept = least.entry((x / 10, y / 10)).or_insert((i32::MAX, 0));
        if z >= 50 && z < kept.0 {
            *kept = (z, i);
        }
    }
    let mut numbers: Vec<i32> = least.values().map(|kept| kept.1).collect();
    numbers.sort_unstable();
    let points = text.lines().filter(|line| line.starts_with("a "));
    let found: Vec<i32> =
        points.map(|line| line.split_whitespace().last().expect("a number").parse().expect("one")).collect();
    assert_eq!(found, numbers);
}
