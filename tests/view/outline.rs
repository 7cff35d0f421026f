//! Pictures of a part of a mesh, and the range of colours.

use std::sync::Arc;

use spmesh_formats::source::Mask;
use spmesh_stream::Coordinates;
use spmesh_view::{Fill, Form, Moments, Options};

use super::pixels::{colour, map, pixels};
use super::svg::{parse, within};
use super::{grid, mesh_of, output, picture, pictures};
use crate::dem::Mesh;
use crate::programs::{Folder, assert_outcome};
use spmesh_reference::sets::Random;

/// Integer coordinates equal to those of the world.
const WHOLE: Coordinates = Coordinates::I32 { scale: [1.0; 3], offset: [0.0; 3] };

/// Number of triangles in a picture.
fn drawn(stream: &[u8], options: &Options) -> usize {
    let elements = parse(&picture(stream, options).svg);
    within(&elements, "map", "path").iter().filter(|path| path.attributes.contains_key("color")).count()
}

#[test]
fn triangles_outside_are_left_out() {
    let mesh = Mesh::lake(&mut Random::new(6));
    let elevation = Options { fill: Some(Fill::Elevation), ..Options::new("mesh") };
    for (length, oblique) in [(2.0, false), (4.0, false), (4.0, true), (9.0, false)] {
        let inside = mesh.inside(length * length);
        for coordinates in [WHOLE, Coordinates::F64] {
            let stream = mesh.stream(coordinates);
            let concave = Options { concave: Some(length), oblique, ..elevation.clone() };
            assert_eq!(drawn(&stream, &concave), inside.triangles.len(), "{length}");
            let is_short = |triangle: &&[u32; 3]| {
                (0..3).all(|i| {
                    let [p, q] = [i, (i + 1) % 3].map(|i| mesh.points[triangle[i] as usize]);
                    (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2) <= length * length
                })
            };
            let short = mesh.triangles.iter().filter(is_short).count();
            let killed = Options { kill: Some(length), oblique, ..elevation.clone() };
            assert_eq!(drawn(&stream, &killed), short, "{length}");
            let both = Options { concave: Some(length), ..killed };
            assert_eq!(drawn(&stream, &both), short, "{length}");
        }
    }
}

#[test]
fn pixels_outside_of_the_mask_are_white() {
    let stream = mesh_of(&grid(9));
    let rings = vec![
        vec![[100.0, 100.0], [700.0, 150.0], [600.0, 700.0], [200.0, 600.0]],
        vec![[300.0, 300.0], [500.0, 300.0], [400.0, 500.0]],
    ];
    let is_in = |[x, y]: [f64; 2]| {
        let is_left = |[a, b]: [[f64; 2]; 2]| (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) > 0.0;
        let is_in_ring =
            |ring: &Vec<[f64; 2]>| (0..ring.len()).all(|i| is_left([ring[i], ring[(i + 1) % ring.len()]]));
        is_in_ring(&rings[0]) && !is_in_ring(&rings[1])
    };
    for form in [Form::Vector, Form::Raster] {
        let mask = Some(Arc::new(Mask { polygons: vec![rings.clone()] }));
        let options = Options { form, mask, width: 400, fill: Some(Fill::Time), ..Options::new("mesh") };
        let picture = picture(&stream, &options);
        let (pixmap, frame, [left, upper, right, lower]) =
            (pixels(&picture), picture.frame.unwrap(), map(&picture));
        let mut counts = [0; 2];
        for (column, row) in (upper..lower).flat_map(|row| (left..right).map(move |column| (column, row))) {
            let at = |x: f64, y: f64| frame.world([f64::from(column) + x, f64::from(row) + y]);
            let corners =
                [at(-0.6, -0.6), at(1.6, -0.6), at(-0.6, 1.6), at(1.6, 1.6), at(0.5, 0.5)].map(is_in);
            if corners == [corners[0]; 5] {
                let is_white = colour(&pixmap, column, row) == [255; 3];
                assert_eq!(is_white, !corners[0], "{form:?} {column} {row}");
                counts[usize::from(is_white)] += 1;
            }
        }
        assert!(counts.iter().all(|&count| count > 5_000), "{counts:?}");
    }
}

#[test]
fn colours_span_what_most_of_the_picture_shows() {
    // A level square of a hundred rows, which rise by one, with a spike in a corner.
    let side = 101u32;
    let height = |x: u32, y: u32| if x == 0 && y == 0 { 5_000.0 } else { f64::from(y) };
    let points =
        (0..side * side).map(|i| [f64::from(i % side), f64::from(i / side), height(i % side, i / side)]);
    let square = |i: u32| [[i, i + 1, i + side + 1], [i, i + side + 1, i + side]];
    let triangles = (0..side * (side - 1)).filter(|i| i % side < side - 1).flat_map(square).collect();
    let stream = Mesh { points: points.collect(), triangles }.stream(WHOLE);
    for form in [Form::Vector, Form::Raster] {
        let stretched = Options { form, fill: Some(Fill::Elevation), ..Options::new("mesh") };
        let svg = picture(&stream, &stretched).svg;
        assert!(
            svg.contains("Elevation (all: 0 to 5000)") && svg.matches("class=\"tip\"").count() == 2,
            "{form:?}"
        );
        // The middle of the colour map is where it would be without the spike.
        let middle = |options: &Options| {
            let picture = picture(&stream, &Options { edges: spmesh_view::When::Never, ..options.clone() });
            let (pixmap, [left, upper, right, lower]) = (pixels(&picture), map(&picture));
            colour(&pixmap, (left + right) / 2, (upper + lower) / 2).map(i32::from)
        };
        let ranged = Options { range: Some([2.0, 98.0]), ..stretched.clone() };
        let [found, expected] = [&stretched, &ranged].map(middle);
        assert!((0..3).all(|i| (found[i] - expected[i]).abs() <= 6), "{found:?} {expected:?}");
        let whole = Options { stretch: None, ..stretched.clone() };
        let svg = picture(&stream, &whole).svg;
        assert!(!svg.contains("(all:") && !svg.contains("class=\"tip\""));
        let low = Options { stretch: Some([0.0, 50.0]), ..stretched };
        assert_eq!(picture(&stream, &low).svg.matches("class=\"tip\"").count(), 1);
    }
}

#[test]
fn outlines_are_refused_where_there_are_none() {
    let folder = Folder::new();
    folder.file("mask.wkt", "POLYGON((0 0,500 0,500 500,0 0))");
    let mask = &folder.path("mask.wkt")[..];
    let mesh = mesh_of(&grid(8));
    let points = output("spfinalize", &["-"], grid(8).as_bytes());
    let null = ["-o", "/dev/null"];
    for (flags, input, code, part) in [
        (vec!["--mask", mask, "--concave", "150", "--kill", "300", "--stretch", "5,95"], &mesh, 0, ""),
        (vec!["--mask", mask], &points, 0, ""),
        (vec!["--concave", "9"], &points, 2, "points have no edges"),
        (vec!["--kill", "0"], &mesh, 2, "--kill takes a length above zero"),
        (vec!["--concave", "9", "--at", "5"], &mesh, 2, "leave out --concave, or --at"),
        (vec!["--mask", mask, "--oblique"], &mesh, 2, "leave out --oblique"),
        (vec!["--stretch", "5,3"], &mesh, 2, "two percentages"),
        (vec!["--stretch", "5,30", "--range", "0,9"], &mesh, 2, "cannot be used with"),
        (vec!["--stretch", "none"], &mesh, 0, ""),
    ] {
        assert_outcome("spview", &[&flags[..], &null].concat(), input, code, part);
    }
    // Colours of snapshots agree.
    let options = Options { stretch: None, ..Options::new("mesh") };
    assert_eq!(pictures(&mesh, &options, Moments { at: None, every: Some(40) }).unwrap().len(), 3);
}
