//! Link triangulation by every rule, from any triangulation: assertions hold and facets match.

use super::{check_circles, check_facets, knots};
use spmesh_audit::configurations::FacetCounts;
use spmesh_configurations::{self as configurations, Configurations, Knots, Rule, Start};
use spmesh_reference::configurations::lines;
use spmesh_reference::sets::Random;

/// Statistics of one run.
#[derive(Debug, Default)]
struct Tally {
    links: usize,
    null: usize,
    configurations: usize,
    largest: usize,
}

/// A random rule for `count` knots.
fn random_rule(random: &mut Random, count: usize) -> Rule {
    let mut values = |scale: f64| -> Vec<f64> { (0..count).map(|_| random.unit() * scale).collect() };
    let (data, more) = (values(1.0), values(10.0));
    match random.integer(0, 7) {
        0 => Rule::Delaunay,
        1 => Rule::MinWeight,
        2 => Rule::Ear,
        3 => Rule::Fan,
        4 => Rule::Aligned(random.unit() * 180.0),
        5 => Rule::Data(data),
        6 => Rule::Gradients(data.into_iter().zip(more).map(|(x, y)| [x, y]).collect()),
        _ => Rule::Random(random.bits()),
    }
}

/// Random knots: in general position, on a small grid, or with copies.
fn random_knots(random: &mut Random) -> Vec<[f64; 2]> {
    let count = random.integer(9, 28) as usize;
    let family = random.integer(0, 3);
    let side = if family == 1 { 6 } else { 3 };
    let mut points: Vec<[f64; 2]> = (0..count)
        .map(|_| match family {
            1 | 2 => [random.integer(0, side) as f64, random.integer(0, side) as f64],
            _ => [random.unit(), random.unit()],
        })
        .collect();
    points.extend([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    points
}

/// Runs up to `degree` with a random rule for each degree, and checks every step.
fn run(seed: u64, degree: usize, tally: &mut Tally) {
    let mut random = Random::new(seed);
    let points = random_knots(&mut random);
    let knots = knots(&points);
    let mut start = Start::delaunay(&knots).expect("not on a line");
    start.flip_random(&knots, random.integer(0, 40) as usize, random.bits());
    if random.integer(0, 3) == 0 {
        start.flip_aligned(&knots, random.unit() * 180.0);
    }
    let mut lower = start.configurations();
    let finite: Vec<[u32; 3]> = lower.iter().map(|(boundary, _)| boundary).collect();
    let again = Start::of_triangles(&knots, &finite).expect("a triangulation of the hull");
    assert_eq!(again.configurations().len(), lower.len());
    for k in 1..=degree.min(points.len() - 3) {
        let rule = random_rule(&mut random, points.len());
        let context = |error| format!("seed {seed}, degree {k}, {rule:?}: {error}");
        let upper =
            configurations::link_triangulate(&knots, &lower, &rule).map_err(context).expect("simple links");
        let counts = check_facets(&lower, &upper).map_err(context).expect("facets that match");
        check_counts(&knots, &lower, &upper, counts, tally);
        assert_eq!(infinite(&upper), lines(&points, k), "seed {seed}, degree {k}, {rule:?}");
        lower = upper;
    }
}

fn infinite(configurations: &Configurations) -> Vec<([u32; 2], Vec<u32>)> {
    let of_group = |group: configurations::Group<'_>| -> Vec<_> {
        group.infinite.iter().map(|&[p, q, _]| ([p, q], group.interior.to_vec())).collect()
    };
    let mut all: Vec<_> = configurations.groups().flat_map(of_group).collect();
    all.sort();
    all
}

/// Compares the counts of links with configurations and facets.
fn check_counts(
    knots: &Knots,
    lower: &Configurations,
    upper: &Configurations,
    counts: FacetCounts,
    tally: &mut Tally,
) {
    let links = configurations::links(knots, lower).expect("closed links");
    let (mut null, mut triangles, mut edges) = (0, 0, 0);
    for link in links.iter() {
        null += usize::from(link.is_null());
        triangles += link.polygon.len() - 2;
        edges += if link.is_null() { 0 } else { link.edges().count() };
        tally.largest = tally.largest.max(link.polygon.len());
    }
    assert_eq!(triangles, upper.len() + upper.infinite_len());
    assert_eq!((null, edges), (counts.both_lower, counts.one_each), "null links, edges of others");
    assert_eq!(3 * triangles, counts.one_each + 2 * counts.both_upper);
    tally.links += links.len();
    tally.null += null;
    tally.configurations += upper.len();
}

/// Runs of each of the four long tests, which run in parallel.
const RUNS: u64 = 500;
const RUNS_QUICK: u64 = 12;

/// Runs `count` seeds, starting with `first`. The links must be varied: more than `null_min` null links per
/// run on average.
fn any_rule(first: u64, count: u64, null_min: u64) {
    let mut tally = Tally::default();
    (first..first + count).for_each(|seed| run(seed, 6, &mut tally));
    let is_varied = tally.null as u64 > null_min * count && tally.links > 3 * tally.null && tally.largest > 8;
    assert!(is_varied, "{tally:?}");
}

#[test]
fn any_rule_from_any_triangulation() {
    any_rule(0, RUNS_QUICK, 4);
}

#[test]
#[ignore = "long: run with -- --ignored"]
fn any_rule_from_any_triangulation_of_the_first_quarter() {
    any_rule(0, RUNS, 16);
}

#[test]
#[ignore = "long: run with -- --ignored"]
fn any_rule_from_any_triangulation_of_the_second_quarter() {
    any_rule(RUNS, RUNS, 16);
}

#[test]
#[ignore = "long: run with -- --ignored"]
fn any_rule_from_any_triangulation_of_the_third_quarter() {
    any_rule(2 * RUNS, RUNS, 16);
}

#[test]
#[ignore = "long: run with -- --ignored"]
fn any_rule_from_any_triangulation_of_the_fourth_quarter() {
    any_rule(3 * RUNS, RUNS, 16);
}

#[test]
fn the_rule_decides() {
    let mut random = Random::new(9);
    let points: Vec<[f64; 2]> = (0..40).map(|_| [random.unit(), random.unit()]).collect();
    let knots = knots(&points);
    let start = configurations::delaunay(&knots).expect("triangles");
    let level = |rule: &Rule| {
        configurations::link_triangulate(&knots, &start, rule).expect("links of a triangulation")
    };
    let length = |configurations: &Configurations| -> f64 {
        let edge = |a: u32, b: u32| {
            let (p, q) = (knots.at(a), knots.at(b));
            (p[0] - q[0]).hypot(p[1] - q[1])
        };
        configurations.iter().map(|([a, b, c], _)| edge(a, b) + edge(b, c) + edge(c, a)).sum()
    };
    let across = |configurations: &Configurations, axis: usize| -> f64 {
        let extent = |a: u32, b: u32| (knots.at(a)[axis] - knots.at(b)[axis]).abs();
        configurations.iter().map(|([a, b, c], _)| extent(a, b) + extent(b, c) + extent(c, a)).sum()
    };
    let [least, delaunay, ear, fan] =
        [Rule::MinWeight, Rule::Delaunay, Rule::Ear, Rule::Fan].map(|rule| length(&level(&rule)));
    assert!(least < delaunay && least < ear && least < fan, "{least} {delaunay} {ear} {fan}");
    let (along_x, along_y) = (level(&Rule::Aligned(0.0)), level(&Rule::Aligned(90.0)));
    assert!(across(&along_x, 1) < across(&along_y, 1) && across(&along_y, 0) < across(&along_x, 0));
    let by_x = level(&Rule::Data(points.iter().map(|p| p[0]).collect()));
    assert_eq!(across(&by_x, 0), across(&along_y, 0), "level lines of x are parallel to y");
    let slopes = points.iter().map(|p| [p[1], 0.0]).collect();
    assert_ne!(
        level(&Rule::Gradients(slopes)).iter().collect::<Vec<_>>(),
        along_x.iter().collect::<Vec<_>>()
    );
    assert_eq!(level(&Rule::Random(4)), level(&Rule::Random(4)));
    assert_ne!(level(&Rule::Random(4)), level(&Rule::Random(5)));
    assert!(check_circles(&knots, &level(&Rule::Delaunay)).is_ok());
    assert!(check_circles(&knots, &level(&Rule::Ear)).is_err());
}

#[test]
fn a_fan_has_all_diagonals_at_one_knot() {
    let points: Vec<[f64; 2]> =
        (0..7).map(|i| (f64::from(i) * 0.9).sin_cos().into()).chain([[0.0, 0.0]]).collect();
    let knots = knots(&points);
    let start = configurations::delaunay(&knots).expect("triangles");
    let fan = configurations::link_triangulate(&knots, &start, &Rule::Fan).expect("a convex polygon");
    let of_centre = fan.groups().find(|group| group.interior == [7]).expect("the centre");
    assert!(of_centre.triangles.len() == 5 && of_centre.triangles.iter().all(|triangle| triangle[0] == 0));
}

#[test]
fn flips_do_what_they_say() {
    let mut random = Random::new(2);
    let points: Vec<[f64; 2]> = (0..60).map(|_| [random.unit(), random.unit()]).collect();
    let knots = knots(&points);
    let original = Start::delaunay(&knots).expect("triangles");
    let mut start = original.clone();
    assert_eq!(start.flip_random(&knots, 25, 7), 25);
    let mut again = original.clone();
    again.flip_random(&knots, 25, 7);
    assert_eq!(start.configurations(), again.configurations(), "the seed decides");
    assert_ne!(start.configurations(), original.configurations());
    let slope = |configurations: &Configurations| -> f64 {
        let rise = |a: u32, b: u32| {
            let (p, q) = (knots.at(a), knots.at(b));
            ((p[0] - q[0]) / (p[0] - q[0]).hypot(p[1] - q[1])).abs()
        };
        configurations.iter().map(|([a, b, c], _)| rise(a, b) + rise(b, c) + rise(c, a)).sum()
    };
    let mut aligned = original.clone();
    assert!(aligned.flip_aligned(&knots, 90.0) > 0);
    assert!(slope(&aligned.configurations()) < slope(&original.configurations()));
    assert_eq!(aligned.flip_aligned(&knots, 90.0), 0, "nothing is left to be done");
}

#[test]
fn bad_starts_and_rules_are_errors() {
    let square = knots(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.0, 1.0]]);
    let star: [[u32; 3]; 4] = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
    let start = Start::of_triangles(&square, &star).expect("a triangulation");
    let refused =
        |triangles: &[[u32; 3]]| Start::of_triangles(&square, triangles).expect_err("bad").to_string();
    assert!(refused(&[[0, 1, 9]]).contains("triangle 0: unknown knot 9"));
    assert!(refused(&[[1, 0, 4]]).contains("flat or clockwise"));
    assert!(refused(&[[0, 2, 4]]).contains("flat or clockwise"));
    assert!(refused(&star[..3]).contains("not convex"));
    assert!(refused(&[[0, 1, 2], [0, 2, 3]]).contains("knot 4: no triangle"));
    assert!(
        refused(&[star[0], star[1], star[2], star[3], [0, 1, 2]]).contains("two triangles are to the left")
    );
    let degree_0 = start.configurations();
    let rule = Rule::Data(vec![1.0]);
    let error = configurations::link_triangulate(&square, &degree_0, &rule).expect_err("one value");
    assert_eq!(error.to_string(), "1 values for 5 knots: one each is needed");
    assert!(configurations::link_triangulate(&square, &degree_0, &Rule::Aligned(f64::NAN)).is_err());
}

#[test]
fn facets_of_other_degrees_do_not_match() {
    let mut random = Random::new(3);
    let points: Vec<[f64; 2]> = (0..20).map(|_| [random.unit(), random.unit()]).collect();
    let knots = knots(&points);
    let mut start = Start::delaunay(&knots).expect("triangles");
    let all = configurations::generate(&knots, start.configurations(), &Rule::Delaunay, 2).expect("degrees");
    assert!(check_facets(&all[0], &all[1]).is_ok() && check_facets(&all[1], &all[2]).is_ok());
    assert!(check_facets(&all[0], &all[2]).is_err(), "degrees that do not follow");
    start.flip_random(&knots, 1, 1);
    let error = check_facets(&start.configurations(), &all[1]).expect_err("another triangulation");
    assert!(error.to_string().contains("proposition 6.2.1"), "{error}");
    let other = configurations::link_triangulate(&knots, &all[0], &Rule::Ear).expect("links");
    assert!(check_facets(&other, &all[2]).is_err(), "another degree 1");
}
