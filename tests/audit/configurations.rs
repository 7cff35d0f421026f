//! The audit of streams of configurations.

use serde_json::{Value, json};
use spmesh_audit::configurations::{ConfigurationSet, Proof, Violation, check};
use spmesh_configurations::{self as configurations, Claim, Configurations, Knots, Rule};
use spmesh_stream::write_configurations;

use super::held;
use crate::programs::{outcome, run};
use crate::vectors::{Vector, load};
use spmesh_reference::sets::Random;

/// Knots on a small grid, so that some are collinear, some cocircular and some coincide.
fn knots(random: &mut Random, count: usize, side: i64) -> Knots {
    let point = |_| [random.integer(0, side - 1) as f64, random.integer(0, side - 1) as f64];
    let mut points: Vec<[f64; 2]> = (0..count).map(point).collect();
    points.extend([[0.0, 0.0], [side as f64, 0.0], [0.0, side as f64]]);
    Knots::new(points).unwrap()
}

fn generated(knots: &Knots, rule: &Rule, flips: usize, degree: usize) -> Vec<Configurations> {
    let mut start = configurations::Start::delaunay(knots).unwrap();
    start.flip_random(knots, flips, 3);
    configurations::generate(knots, start.configurations(), rule, degree).unwrap()
}

fn verdict(knots: &Knots, degrees: &[Configurations]) -> Result<Proof, Violation> {
    let degrees = degrees.iter().map(held::configurations).collect();
    check(&ConfigurationSet { knots: held::knots(knots), degrees, ..ConfigurationSet::default() })
}

fn stream(knots: &Knots, degrees: &[Configurations]) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_configurations(knots.points(), degrees, &mut bytes).unwrap();
    bytes
}

/// The configurations with one boundary replaced or left out.
fn changed(of: &Configurations, at: usize, replacement: Option<[u32; 3]>) -> Configurations {
    let mut result = Configurations::new(of.degree(), of.claim());
    let mut number = 0;
    for group in of.groups() {
        for &boundary in group.triangles.iter().chain(group.infinite) {
            let boundary = if number == at { replacement } else { Some(boundary) };
            number += 1;
            boundary.iter().for_each(|&boundary| result.extend(group.interior, &[boundary]).unwrap());
        }
    }
    result
}

fn relabelled(of: &Configurations, claim: Claim) -> Configurations {
    let mut result = Configurations::new(of.degree(), claim);
    for group in of.groups() {
        result.extend(group.interior, &[group.triangles, group.infinite].concat()).unwrap();
    }
    result
}

#[test]
fn what_rules_make_passes() {
    let mut random = Random::new(7);
    for round in 0..120 {
        let (count, side) = (5 + round % 17, [4, 12, 1 << 20][round % 3]);
        let knots = knots(&mut random, count, side);
        let (rule, flips) =
            [(Rule::Delaunay, 0), (Rule::Random(round as u64), 9), (Rule::Fan, 4)][round / 3 % 3].clone();
        let degrees = generated(&knots, &rule, flips, (count - 1).min(5));
        let proof =
            verdict(&knots, &degrees).unwrap_or_else(|violation| panic!("round {round}: {violation:?}"));
        assert_eq!(proof.degrees.len(), degrees.len());
        let is_delaunay = flips == 0;
        let complete = |degree: &spmesh_audit::configurations::DegreeProof| {
            degree.facets.is_some() && degree.is_counted && degree.has_circles == is_delaunay
        };
        assert!(proof.degrees.iter().all(complete), "round {round}: {proof:?}");
    }
}

#[test]
fn degrees_without_the_one_below_are_proved_as_far_as_they_go() {
    let knots = knots(&mut Random::new(1), 12, 50);
    let mut degrees = generated(&knots, &Rule::Delaunay, 0, 4);
    degrees.remove(2);
    let proof = verdict(&knots, &degrees).unwrap();
    let found: Vec<_> = proof
        .degrees
        .iter()
        .map(|degree| (degree.degree, degree.facets.is_some(), degree.is_counted))
        .collect();
    assert_eq!(found, [(0, true, true), (1, true, true), (3, false, false), (4, true, false)]);
}

#[test]
fn copies_are_counted() {
    let points = vec![[0.0, 0.0], [4.0, 0.0], [0.0, 4.0], [1.0, 1.0], [0.0, 0.0], [0.0, 0.0]];
    let knots = Knots::new(points).unwrap();
    let proof = verdict(&knots, &generated(&knots, &Rule::Delaunay, 0, 2)).unwrap();
    assert_eq!((proof.knots, proof.places, proof.multiplicity_max), (6, 4, 3));
}

#[test]
fn configurations_of_another_rule_are_not_delaunay() {
    let knots = knots(&mut Random::new(2), 14, 1 << 16);
    for degree in 0..3 {
        let mut degrees = generated(&knots, &Rule::Random(4), 8, 2);
        degrees[degree] = relabelled(&degrees[degree], Claim::Delaunay);
        let violation = verdict(&knots, &degrees).expect_err("it is not Delaunay");
        assert_eq!((violation.claim, violation.degree), ("circles", degree), "{violation:?}");
    }
}

#[test]
fn every_missing_configuration_is_noticed() {
    let knots = knots(&mut Random::new(3), 9, 100);
    let degrees = generated(&knots, &Rule::Random(1), 5, 3);
    for degree in 0..degrees.len() {
        let all = degrees[degree].len() + degrees[degree].infinite_len();
        for at in 0..all {
            let mut damaged = degrees.clone();
            damaged[degree] = changed(&degrees[degree], at, None);
            let violation = verdict(&knots, &damaged).expect_err("one is missing");
            assert!(matches!(violation.claim, "facets" | "centroids"), "{violation:?}");
        }
    }
}

#[test]
fn every_exchanged_knot_is_noticed() {
    let knots = knots(&mut Random::new(4), 8, 100);
    let degrees = generated(&knots, &Rule::Delaunay, 0, 2);
    for degree in 0..degrees.len() {
        let mut number = 0;
        let plain: Vec<Configurations> =
            degrees.iter().map(|degree| relabelled(degree, Claim::Any)).collect();
        for group in degrees[degree].groups() {
            for &[a, b, c] in group.triangles.iter().chain(group.infinite) {
                let others =
                    (0..knots.len() as u32).filter(|v| ![a, b, c].contains(v) && !group.interior.contains(v));
                for other in others {
                    let mut damaged = plain.clone();
                    damaged[degree] = changed(&plain[degree], number, Some([a, other, c]));
                    assert!(verdict(&knots, &damaged).is_err(), "{a} {b} {c}: {other}");
                }
                number += 1;
            }
        }
    }
}

#[test]
fn a_degree_alone_must_have_its_orientation_and_its_border() {
    let knots = knots(&mut Random::new(6), 9, 1 << 10);
    let only = relabelled(&generated(&knots, &Rule::Delaunay, 0, 2)[2], Claim::Any);
    assert!(verdict(&knots, std::slice::from_ref(&only)).is_ok());
    let [a, b, c] = only.iter().next().unwrap().0;
    let violation = verdict(&knots, &[changed(&only, 0, Some([a, c, b]))]).expect_err("clockwise");
    assert!(violation.message.contains("not counterclockwise"), "{violation:?}");
    let is_infinite = |group: &configurations::Group| !group.infinite.is_empty();
    let before = only.groups().take_while(|group| !is_infinite(group));
    let at: usize = before.map(|group| group.triangles.len()).sum();
    let group = only.groups().find(is_infinite).unwrap();
    let at = at + group.triangles.len();
    let [p, q, faraway] = group.infinite[0];
    for damaged in [None, Some([q, p, faraway])] {
        let violation = verdict(&knots, &[changed(&only, at, damaged)]).expect_err("no border");
        assert_eq!(violation.claim, "centroids");
        assert!(
            violation.message.contains("border of the centroid triangulation of order 3"),
            "{violation:?}"
        );
    }
}

#[test]
fn other_knots_are_noticed_by_the_circles() {
    let mut random = Random::new(8);
    let knots = knots(&mut random, 20, 1 << 20);
    let degrees = generated(&knots, &Rule::Delaunay, 0, 2);
    let mut points = knots.points().to_vec();
    points[5] = [points[5][0] + 4e5, points[5][1] - 3e5];
    assert!(verdict(&Knots::new(points).unwrap(), &degrees).is_err());
}

#[test]
fn spinfo_says_what_there_is_and_what_was_proved() {
    let vector = load("pass", "txt").into_iter().find(|vector| vector.name == "configurations").unwrap();
    let output = run("spinfo", &["--audit", "-"], &vector.bytes);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{text}");
    for line in [
        "stdin: configurations",
        "  coordinates  2D, i32, scale (0.5, 0.5, 0.25), offset (0, 0, 0)",
        "  points       4",
        "  configurations 13",
        "  degree 0     3 configurations (delaunay), 3 infinite, 1 interior sets",
        "  degree 1     1 configurations (delaunay), 6 infinite, 4 interior sets",
        "audit passed",
        "  knots        4 at 4 places, at most 1 at one",
        "  degree 0     circles, facets (0 below, 0 shared, 9 above), centroid triangulation, counts",
    ] {
        assert!(text.lines().any(|found| found == line), "{line} in\n{text}");
    }
    let output = run("spinfo", &["--audit", "--json", "-"], &vector.bytes);
    let object: Value = serde_json::from_slice(&output.stdout).unwrap();
    let degree = json!({"degree": 1, "standing": "delaunay", "finite": 1, "infinite": 6, "interior_sets": 4});
    assert_eq!(object["configurations"][1], degree);
    assert_eq!(object["audit"]["ok"], true);
    assert_eq!(object["audit"]["proof"]["degrees"][1]["centroids"], true);
    assert_eq!(object["counts"]["configurations"], 13);
}

#[test]
fn spinfo_fails_with_the_degree_and_the_place() {
    let knots = knots(&mut Random::new(9), 9, 64);
    let mut degrees = generated(&knots, &Rule::Delaunay, 0, 2);
    degrees[1] = changed(&degrees[1], 2, None);
    let bytes = stream(&knots, &degrees);
    let output = run("spinfo", &["--audit", "-"], &bytes);
    let (code, message) = outcome(&output);
    assert_eq!(code, Some(4), "{message}");
    assert!(message.contains("stdin: degree 1: facets check failed: facet "), "{message}");
    assert!(String::from_utf8(output.stdout).unwrap().contains("FAILED in degree 1"));
    let output = run("spinfo", &["--audit", "--json", "-"], &bytes);
    let object: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&object["audit"]["ok"], &object["audit"]["violation"]["degree"]), (&json!(false), &json!(1)));
    assert!(run("spinfo", &["-"], &bytes).status.success(), "nothing was to be proved");
}

#[test]
fn functions_must_name_pairs_with_links() {
    let is_meant = |vector: &Vector| vector.name == "configurations-functions";
    let twin = load("pass", "txt").into_iter().find(is_meant).unwrap().expected;
    let audit = |twin: &str| {
        let stream = run("spconvert", &["--to", "spm"], twin.as_bytes());
        assert!(stream.status.success(), "{:?}", outcome(&stream));
        run("spinfo", &["--audit", "-"], &stream.stdout)
    };
    let proven = audit(&twin);
    assert!(proven.status.success(), "{:?}", outcome(&proven));
    let report = String::from_utf8(proven.stdout).unwrap();
    assert!(report.contains("functions    6, whose pairs have links"), "{report}");
    // A fifth knot is in no configuration.
    let knot = twin.replacen("degree 1", "v 100 100 0\ndegree 1", 1).replacen("points 4", "points 5", 1);
    assert!(audit(&knot).status.success());
    let (code, message) = outcome(&audit(&knot.replacen("term 1 2 1", "term 1 5 1", 1)));
    assert_eq!(code, Some(4), "{message}");
    assert!(message.contains("functions check failed: function 0 has a term of the pair 0, 4"), "{message}");
}

#[test]
fn tools_that_take_no_configurations_refuse_them() {
    let vector = load("pass", "txt").into_iter().find(|vector| vector.name == "configurations").unwrap();
    for arguments in [
        &["spfinalize", "-"][..],
        &["spdelaunay2d", "-"],
        &["spdelaunay2d", "--merge", "-"],
        &["tess3", "-"],
        &["dd4", "-"],
        &["spconvert", "--to", "obj", "-"],
        &["spinfo", "--audit", "--points", "-", "-"],
        &["spinfo", "--audit", "--count-violations", "-"],
    ] {
        let (code, message) = outcome(&run(arguments[0], &arguments[1..], &vector.bytes));
        assert_eq!(code, Some(2), "{arguments:?}: {message}");
        assert!(message.contains("configurations"), "{arguments:?}: {message}");
    }
}
