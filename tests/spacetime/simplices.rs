//! Cells as simplices.

use std::collections::HashMap;

use spmesh_audit::diagram::check_simplices;
use spmesh_spacetime::diagram4::diagram;
use spmesh_spacetime::slices::{Rule, Subdivision, subdivide};
use spmesh_stream::model::diagram4::Diagram4;
use spmesh_stream::{Event, StreamReader};

use super::{sampled, scattered, volume};
use spmesh_reference::sets::Random;

fn parts(diagram: &Diagram4, rule: Rule) -> Subdivision {
    subdivide(&diagram.points, diagram.values.as_deref(), &diagram.cells, rule, |_| true).unwrap()
}

/// Checks that every facet belongs to one or two simplices; returns how many belong to one.
fn border(simplices: &[[u32; 5]]) -> usize {
    let mut counts: HashMap<Vec<u32>, usize> = HashMap::new();
    for simplex in simplices {
        for left in 0..5 {
            let mut facet: Vec<u32> = (0..5).filter(|&i| i != left).map(|i| simplex[i]).collect();
            facet.sort_unstable();
            *counts.entry(facet).or_default() += 1;
        }
    }
    assert!(counts.values().all(|&count| count <= 2), "a facet of three simplices");
    counts.values().filter(|&&count| count == 1).count()
}

#[test]
fn a_grid_is_as_large_as_its_simplices() {
    let mut random = Random::new(11);
    let box_volume = 24 * 3 * 2 * 3 * 4;
    for share in [1.0, 0.5, 0.2, 0.0] {
        let points = sampled(&mut random, [4, 3, 4, 5], share);
        let (diagram, _) = diagram(points, None).unwrap();
        let pulled = parts(&diagram, Rule::Pulled);
        assert_eq!((pulled.flat, pulled.points.len()), (0, diagram.points.len()));
        let sum: i128 = pulled.simplices.iter().map(|simplex| volume(&pulled.points, simplex, 1.0)).sum();
        assert_eq!(sum, box_volume, "{share}");
        check_simplices(&pulled.points, &pulled.simplices).unwrap();
        border(&pulled.simplices);
    }
}

#[test]
fn barycentric_simplices_of_full_cubes_fit_together() {
    let mut random = Random::new(12);
    let (cubes, _) = diagram(sampled(&mut random, [3, 3, 2, 2], 1.0), None).unwrap();
    let parts = parts(&cubes, Rule::Barycentric);
    assert_eq!(parts.simplices.len(), 4 * 192);
    // Coordinates of barycentres are multiples of a half.
    let sum: i128 = parts.simplices.iter().map(|simplex| volume(&parts.points, simplex, 2.0)).sum();
    assert_eq!((sum, parts.flat), (24 * 4 * 16, 0));
    // The border has 2 * (2 + 2 + 4 + 4) facets of cubes, each divided into 24 tetrahedra.
    assert_eq!(border(&parts.simplices), 24 * 24);
}

#[test]
fn barycentric_simplices_of_scattered_points_fit_together() {
    let mut random = Random::new(13);
    for side in [3, 4, 6] {
        let (diagram, _) = diagram(scattered(&mut random, 60, side), None).unwrap();
        let [pulled, parts] = [Rule::Pulled, Rule::Barycentric].map(|rule| parts(&diagram, rule));
        // The barycentre of a face with 5, 6, 7 or more vertices may be rounded, so the sum of volumes is
        // compared in f64.
        let sum: f64 = parts.simplices.iter().map(|s| float_volume(&parts, s)).sum();
        let whole: i128 = pulled.simplices.iter().map(|s| volume(&pulled.points, s, 1.0)).sum();
        assert!((sum - whole as f64).abs() < 1e-9 * whole as f64, "{sum} {whole}");
        assert_eq!(parts.flat, 0);
        border(&parts.simplices);
        check_simplices(&pulled.points, &pulled.simplices).unwrap();
    }
}

fn float_volume(parts: &Subdivision, simplex: &[u32; 5]) -> f64 {
    // Units of 2^-26 keep determinants within 128-bit integers.
    let rounded: Vec<[f64; 4]> =
        simplex.iter().map(|&v| parts.points[v as usize].map(|x| (x * 67_108_864.0).round())).collect();
    volume(&rounded, &[0, 1, 2, 3, 4], 1.0) as f64 / 2f64.powi(104)
}

#[test]
fn simplices_do_not_depend_on_the_order_of_points() {
    let mut random = Random::new(14);
    let mut points = sampled(&mut random, [3, 3, 3, 3], 0.6);
    let (one, _) = diagram(points.clone(), None).unwrap();
    random.shuffle(&mut points);
    let (other, _) = diagram(points, None).unwrap();
    for rule in [Rule::Pulled, Rule::Barycentric] {
        assert_eq!(parts(&one, rule), parts(&other, rule));
    }
}

#[test]
fn simplices_go_into_a_stream() {
    let diagram = super::with_values(sampled(&mut Random::new(15), [2, 2, 2, 3], 1.0), |p| p[0] + 3.0 * p[3]);
    let parts = parts(&diagram, Rule::Barycentric);
    let mut bytes = Vec::new();
    spmesh_spacetime::dd4::write_simplices(&parts, 7, false, &mut bytes).unwrap();
    let mut reader = StreamReader::new(&bytes[..], "memory").unwrap();
    let (mut points, mut simplices) = (0, Vec::new());
    while let Some(event) = reader.next_event().unwrap() {
        match event {
            Event::Points4(block) => points += block.points.len(),
            Event::Simplices4(block) => simplices.extend(block),
            _ => {}
        }
    }
    assert_eq!((points, simplices), (parts.points.len(), parts.simplices));
}
