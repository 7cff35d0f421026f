//! Slices and surfaces.

use std::collections::{HashMap, HashSet};

use spmesh_base::error::{Error, ErrorKind};
use spmesh_formats::drivers::Format;
use spmesh_spacetime::dd4::{Placement, Product};
use spmesh_spacetime::slices::{Slice, Surface, isosurface, slice};
use spmesh_stream::model::cells4::Point4;

use super::{sampled, scattered, volume, with_values};
use spmesh_reference::sets::Random;

/// Facets that belong to one tetrahedron; no facet may belong to more than two.
fn border(slice: &Slice) -> HashSet<[u32; 3]> {
    let mut counts: HashMap<[u32; 3], usize> = HashMap::new();
    for &[a, b, c, d] in &slice.tetrahedra {
        for mut facet in [[a, b, c], [a, b, d], [a, c, d], [b, c, d]] {
            facet.sort_unstable();
            *counts.entry(facet).or_default() += 1;
        }
    }
    assert!(counts.values().all(|&count| count <= 2), "a facet of three tetrahedra");
    counts.into_iter().filter(|&(_, count)| count == 1).map(|(facet, _)| facet).collect()
}

fn float_volume(slice: &Slice) -> f64 {
    let points: Vec<[f64; 3]> = slice.points.iter().map(|p| p.map(|x| (x * 1e9).round())).collect();
    slice.tetrahedra.iter().map(|t| volume(&points, t, 1.0) as f64 / 6e27).sum()
}

/// Whether a facet lies in a side of the box from 0 to `sides`.
fn is_on_box(slice: &Slice, facet: &[u32; 3], sides: [f64; 3]) -> bool {
    let at = |vertex: u32, axis: usize| slice.points[vertex as usize][axis];
    (0..3).any(|axis| [0.0, sides[axis]].iter().any(|&side| facet.iter().all(|&v| at(v, axis) == side)))
}

#[test]
fn slices_of_full_grids_are_exact() {
    let diagram = with_values(sampled(&mut Random::new(31), [4, 3, 3, 4], 1.0), |p| p[0] + 2.0 * p[3]);
    // At 0.25, edges to the centre of a cube are cut in half.
    for time in [0.0, 0.25, 0.5, 1.0, 1.5, 2.0, 2.75, 3.0] {
        let slice = slice(&diagram, time).unwrap();
        let sum: i128 = slice.tetrahedra.iter().map(|t| volume(&slice.points, t, 4.0)).sum();
        assert_eq!(sum, 6 * 64 * 3 * 2 * 2, "{time}");
        assert!(slice.tetrahedra.iter().all(|t| volume(&slice.points, t, 4.0) > 0));
        assert!(border(&slice).iter().all(|facet| is_on_box(&slice, facet, [3.0, 2.0, 2.0])), "{time}");
        let values = slice.values.unwrap();
        for (point, value) in slice.points.iter().zip(values) {
            assert_eq!(value, point[0] + 2.0 * time);
        }
    }
}

#[test]
fn slices_of_sampled_grids_fit_together() {
    let mut random = Random::new(32);
    for share in [0.6, 0.2, 0.0] {
        let diagram = with_values(sampled(&mut random, [4, 4, 3, 4], share), |p| p[1] - p[2] + p[3]);
        for time in [0.0, 0.3, 1.0, 1.7, 2.0, 2.9, 3.0] {
            let slice = slice(&diagram, time).unwrap();
            assert_eq!(slice.flat, 0);
            assert!((float_volume(&slice) - 18.0).abs() < 1e-6, "{share} {time}: {}", float_volume(&slice));
            for facet in border(&slice) {
                let is_near =
                    |v: u32, axis: usize, side: f64| (slice.points[v as usize][axis] - side).abs() < 1e-9;
                let sides = [3.0, 3.0, 2.0];
                let is_on = (0..3).any(|axis| {
                    [0.0, sides[axis]].iter().any(|&side| facet.iter().all(|&v| is_near(v, axis, side)))
                });
                assert!(is_on, "{share} {time}: a gap at {facet:?}");
            }
            for (point, value) in slice.points.iter().zip(slice.values.as_ref().unwrap()) {
                assert!((value - (point[1] - point[2] + time)).abs() < 1e-12);
            }
        }
    }
}

/// Directed edges without a partner; every edge has at most one in each direction.
fn open_edges(surface: &Surface) -> Vec<(u32, u32)> {
    let mut edges = HashSet::new();
    for &[a, b, c] in &surface.triangles {
        for edge in [(a, b), (b, c), (c, a)] {
            assert!(edge.0 != edge.1 && edges.insert(edge), "an edge is passed twice in one direction");
        }
    }
    edges.iter().filter(|&&(a, b)| !edges.contains(&(b, a))).copied().collect()
}

/// Volume inside of a closed surface, positive if it faces outwards.
fn enclosed(surface: &Surface) -> f64 {
    let at = |vertex: u32| surface.points[vertex as usize].map(|x| x - 3.0);
    let sum: f64 = surface
        .triangles
        .iter()
        .map(|triangle| {
            let [p, q, r] = triangle.map(at);
            p[0] * (q[1] * r[2] - q[2] * r[1]) - p[1] * (q[0] * r[2] - q[2] * r[0])
                + p[2] * (q[0] * r[1] - q[1] * r[0])
        })
        .sum();
    sum / 6.0
}

fn squared([x, y, z, _]: Point4) -> f64 {
    (x - 3.0).powi(2) + (y - 3.0).powi(2) + (z - 3.0).powi(2)
}

#[test]
fn balls_are_closed_and_face_outwards() {
    let mut random = Random::new(33);
    for share in [1.0, 0.5] {
        // Values decrease outwards.
        let diagram = with_values(sampled(&mut random, [7, 7, 7, 3], share), |p| -squared(p));
        for (time, level) in [(0.5, -4.5), (1.0, -5.3), (1.0, -4.0), (1.25, -1.0), (2.0, -5.0), (0.0, -2.0)] {
            let surface = isosurface(&slice(&diagram, time).unwrap(), level).unwrap();
            assert!(!surface.triangles.is_empty());
            assert_eq!(open_edges(&surface), [], "{share} {time} {level}");
            let volume = enclosed(&surface);
            let ball = 4.19 * (-level).powf(1.5);
            assert!(volume > 0.2 * ball && volume < 1.2 * ball, "{share} {time} {level}: {volume} {ball}");
        }
    }
}

#[test]
fn surfaces_end_at_the_border_only() {
    let diagram = with_values(sampled(&mut Random::new(34), [7, 7, 7, 2], 1.0), |p| -squared(p));
    let slice = slice(&diagram, 0.5).unwrap();
    for level in [-13.0, -17.0, -9.5] {
        let surface = isosurface(&slice, level).unwrap();
        let open = open_edges(&surface);
        assert!(!open.is_empty());
        for (a, b) in open {
            let [p, q] = [a, b].map(|v| surface.points[v as usize]);
            assert!((0..3).any(|i| p[i] == q[i] && (p[i] == 0.0 || p[i] == 6.0)), "{p:?} {q:?}");
        }
    }
}

#[test]
fn first_last_and_other_times() {
    let mut random = Random::new(35);
    // The first and the last moment have one point each.
    let mut points = scattered(&mut random, 40, 9);
    points.extend([[4.0, 4.0, 4.0, -3.0], [5.0, 4.0, 3.0, 12.0]]);
    let diagram = with_values(points, |p| p[0]);
    for time in [-3.0, 12.0] {
        assert_eq!(slice(&diagram, time).unwrap().tetrahedra, [[0u32; 4]; 0]);
    }
    for time in [-3.5, 12.5, f64::NAN, f64::INFINITY] {
        let error = slice(&diagram, time).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Usage);
        assert!(error.to_string().contains("from -3 to 12"), "{error}");
    }
    let middle = slice(&diagram, 4.0).unwrap();
    assert_eq!(isosurface(&middle, f64::NAN).unwrap_err().kind(), ErrorKind::Usage);
    let without = Slice { values: None, ..middle };
    assert_eq!(isosurface(&without, 1.0).unwrap_err().kind(), ErrorKind::Usage);
}

#[test]
fn products_are_written() {
    let diagram = with_values(sampled(&mut Random::new(36), [3, 3, 3, 3], 0.7), |p| p[0]);
    let product = |product: Product| {
        let mut bytes = Vec::new();
        let notices = product.write(&diagram, &Placement::default(), false, &mut bytes)?;
        Ok((String::from_utf8_lossy(&bytes).into_owned(), notices))
    };
    let text = |product_: Product| product(product_).unwrap_or_else(|e: Error| panic!("{e}"));
    let slice = |format| Product::Slice { time: 0.5, format };
    let surface = |format| Product::Isosurface { time: 0.5, level: 0.7, format };
    let (values, notices) = text(Product::Values(vec![[1.0, 0.0, 2.0, 0.5], [9.0, 0.0, 0.0, 0.0]]));
    assert_eq!(values, "x\ty\tz\tt\tvalue\n1\t0\t2\t0.5\t1\n9\t0\t0\t0\tnan\n");
    assert_eq!(notices, ["1 of 2 sites is outside of the convex hull of the points: nan"]);
    assert!(text(slice(Format::VtkXml)).0.contains("Name=\"value\""));
    let (medit, notices) = text(slice(Format::Medit));
    assert!(medit.contains("Tetrahedra") && notices[0].contains("values"));
    assert!(text(surface(Format::Ply)).0.starts_with("ply\n"));
    assert!(text(surface(Format::Obj)).0.contains("\nf "));
    assert!(text(surface(Format::VtkXml)).0.contains("</VTKFile>"));
    assert!(text(surface(Format::Medit)).0.contains("\nTriangles\n"));
    let (_, notices) = text(Product::Isosurface { time: 0.5, level: 9.0, format: Format::Ply });
    assert_eq!(notices, ["the surface is empty: values in the slice go from 0 to 2, not across 9"]);
    for wrong in
        [slice(Format::Ply), slice(Format::Obj), Product::Slice { time: 7.0, format: Format::VtkXml }]
    {
        assert_eq!(product(wrong.clone()).unwrap_err().kind(), ErrorKind::Usage, "{wrong:?}");
    }
}

#[test]
fn the_appended_data_of_a_slice_are_as_long_as_they_say() {
    let diagram = with_values(sampled(&mut Random::new(37), [2, 2, 2, 2], 1.0), |p| p[0]);
    let slice = slice(&diagram, 0.5).unwrap();
    let mut bytes = Vec::new();
    spmesh_spacetime::dd4::write_slice(&slice, Format::VtkXml, &mut bytes).unwrap();
    let mark = b"encoding=\"raw\">\n_";
    let start = bytes.windows(mark.len()).position(|window| window == mark).unwrap() + mark.len();
    let (points, cells) = (slice.points.len(), slice.tetrahedra.len());
    let mut rest = &bytes[start..];
    for len in [8 * points, 24 * points, 32 * cells, 8 * cells, cells] {
        let (word, data) = rest.split_at(8);
        assert_eq!(u64::from_le_bytes(word.try_into().unwrap()), len as u64);
        rest = &data[len..];
    }
    assert_eq!(rest, b"\n</AppendedData>\n</VTKFile>\n");
}
