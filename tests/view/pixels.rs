//! Pixels against expected colours computed from their world coordinates.

use spmesh_stream::Coordinates;
use spmesh_view::{Fill, Form, Moments, Options, Picture};
use tiny_skia::Pixmap;

use super::svg::{lightness, named, parse};
use super::{mesh_of, picture, pictures};
use crate::dem::Mesh;
use crate::programs::cloud;
use spmesh_reference::sets::{Random, uniform};

/// A picture as pixels.
pub(super) fn pixels(picture: &Picture) -> Pixmap {
    Pixmap::decode_png(&picture.png().unwrap()).unwrap()
}

pub(super) fn colour(pixmap: &Pixmap, column: u32, row: u32) -> [u8; 3] {
    let pixel = pixmap.pixel(column, row).unwrap();
    assert_eq!(pixel.alpha(), 255);
    [pixel.red(), pixel.green(), pixel.blue()]
}

/// The rectangle of the map: left, upper, right, lower.
pub(super) fn map(picture: &Picture) -> [u32; 4] {
    let elements = parse(&picture.svg);
    let at = elements.iter().position(|element| element.name == "clipPath").unwrap();
    let [x, y, width, height] =
        ["x", "y", "width", "height"].map(|name| elements[at + 1].number(name) as u32);
    [x, y, x + width, y + height]
}

/// The signed distance of a point from a directed line, positive on the left.
fn left_of([a, b]: [[f64; 2]; 2], p: [f64; 2]) -> f64 {
    let along = [b[0] - a[0], b[1] - a[1]];
    (along[0] * (p[1] - a[1]) - along[1] * (p[0] - a[0])) / along[0].hypot(along[1])
}

/// The distance of a point from the border of a counterclockwise convex polygon, negative outside.
fn depth(polygon: &[[f64; 2]], p: [f64; 2]) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    polygon.iter().zip(next).map(|(&a, &b)| left_of([a, b], p)).fold(f64::INFINITY, f64::min)
}

/// The convex hull, counterclockwise.
fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a.partial_cmp(b).unwrap());
    let chain = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for p in points {
            while chain.len() > 1 && left_of([chain[chain.len() - 2], chain[chain.len() - 1]], p) <= 0.0 {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let lower = chain(&mut points.iter().copied());
    let upper = chain(&mut points.iter().rev().copied());
    [lower, upper].concat()
}

/// Checks that pixels inside a hull are coloured and pixels outside are white. Pixels near the border are not
/// checked.
fn check_cover(picture: &Picture, hull: &[[f64; 2]]) {
    let (pixmap, frame) = (pixels(picture), picture.frame.unwrap());
    let [left, upper, right, lower] = map(picture);
    let mut counts = [0; 2];
    for (column, row) in (upper..lower).flat_map(|row| (left..right).map(move |column| (column, row))) {
        let at = frame.world([f64::from(column) + 0.5, f64::from(row) + 0.5]);
        let depth = depth(hull, at) / frame.unit;
        if depth.abs() > 1.5 {
            let is_white = colour(&pixmap, column, row) == [255; 3];
            assert_eq!(is_white, depth < 0.0, "{column}, {row}: {depth}");
            counts[usize::from(is_white)] += 1;
        }
    }
    assert!(counts.iter().all(|&count| count > 200), "{counts:?}");
}

#[test]
fn pixels_are_coloured_where_triangles_are() {
    let mut random = Random::new(3);
    let points = uniform(&mut random, 60, 400);
    let mesh = Mesh::of(&mut random, &points);
    let hull = hull(mesh.points.iter().map(|&[x, y, _]| [x, y]).collect());
    for form in [Form::Vector, Form::Raster] {
        let options = Options { form, width: 400, fill: Some(Fill::Time), ..Options::new("mesh") };
        check_cover(&picture(&mesh.stream(Coordinates::F64), &options), &hull);
    }
}

#[test]
fn many_triangles_leave_no_holes() {
    let stream = mesh_of(&cloud(15_000));
    let corners = |line: &str| {
        let mut numbers = line.split(' ').map(|number| number.parse().unwrap());
        [numbers.next().unwrap(), numbers.next().unwrap()]
    };
    let hull = hull(cloud(15_000).lines().map(corners).collect());
    let picture = picture(&stream, &Options { width: 640, fill: Some(Fill::Time), ..Options::new("mesh") });
    assert!(picture.svg.contains("data:image/png;base64,"), "painted, not drawn");
    check_cover(&picture, &hull);
}

#[test]
fn elevations_of_a_plane_are_lighter_from_side_to_side() {
    let corners = [[0.0, 0.0, 10.0], [100.0, 0.0, 90.0], [100.0, 80.0, 90.0], [0.0, 80.0, 10.0]];
    let mesh = Mesh { points: corners.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]] };
    let options =
        Options { form: Form::Raster, width: 500, fill: Some(Fill::Elevation), ..Options::new("plane") };
    let picture = picture(&mesh.stream(Coordinates::F64), &options);
    let (pixmap, [left, upper, right, lower]) = (pixels(&picture), map(&picture));
    for row in [upper + 10, (upper + lower) / 2, lower - 10] {
        let lights: Vec<f64> =
            (left + 8..right - 8).map(|column| lightness(colour(&pixmap, column, row))).collect();
        assert!(lights.windows(2).all(|pair| pair[0] <= pair[1] + 0.9), "{lights:?}");
        assert!(lights[lights.len() - 1] - lights[0] > 150.0);
    }
}

#[test]
fn the_nearest_of_hidden_triangles_is_painted() {
    // Random elevations, seen obliquely, so that triangles hide others.
    let mut random = Random::new(11);
    let points = uniform(&mut random, 80, 300);
    let mesh = Mesh::of(&mut random, &points);
    // With pictures of moments, both forms leave room for all triangles to come.
    let moments = Moments { at: None, every: Some(u64::MAX) };
    let of = |form| {
        let options =
            Options { form, width: 400, oblique: true, fill: Some(Fill::Elevation), ..Options::new("mesh") };
        pixels(&pictures(&mesh.stream(Coordinates::F64), &options, moments).unwrap()[0])
    };
    let (drawn, painted) = (of(Form::Vector), of(Form::Raster));
    assert_eq!((drawn.width(), drawn.height()), (painted.width(), painted.height()));
    // Drawn triangles have one colour and edges, painted ones are smooth; but both leave the same pixels
    // white.
    let is_white =
        |pixmap: &Pixmap, at: usize| pixmap.pixels()[at].red() > 250 && pixmap.pixels()[at].green() > 250;
    let differing = (0..drawn.pixels().len()).filter(|&at| is_white(&drawn, at) != is_white(&painted, at));
    assert!(differing.count() < drawn.pixels().len() / 100);
}

#[test]
fn degenerate_streams_have_pictures() {
    let empty = Mesh { points: Vec::new(), triangles: Vec::new() };
    let one =
        Mesh { points: vec![[0.0, 0.0, 1.0], [3.0, 0.0, 2.0], [0.0, 4.0, 5.0]], triangles: vec![[0, 1, 2]] };
    let scaled = |factor: f64, offset: f64| Mesh {
        points: one.points.iter().map(|at| at.map(|number| number * factor + offset)).collect(),
        triangles: one.triangles.clone(),
    };
    let needle =
        Mesh { points: vec![[0.0, 0.0, 0.0], [1e6, 0.0, 0.0], [5e5, 1e-9, 9.0]], triangles: vec![[0, 1, 2]] };
    let meshes = [empty, one.clone(), scaled(1e300, 0.0), scaled(1e-300, 0.0), scaled(1e-3, 4e6), needle];
    let forms = [(Form::Auto, false), (Form::Raster, false), (Form::Auto, true), (Form::Raster, true)];
    for (number, mesh) in meshes.iter().enumerate() {
        for (form, oblique) in forms {
            let options = Options { form, oblique, width: 320, ..Options::new("mesh") };
            let picture = picture(&mesh.stream(Coordinates::F64), &options);
            let text = &picture.svg;
            assert!(!text.contains("NaN") && !text.contains("inf\""), "{number} {form:?} {oblique}: {text}");
            assert!(named(&parse(text), "furniture").is_some());
            let pixmap = pixels(&picture);
            let dark = pixmap.pixels().iter().any(|pixel| pixel.red() < 200);
            assert!(dark, "there is a title at least");
        }
    }
    for points in ["# none\n", "1 1 1\n", "1 1 1\n2 2 2\n", "1 1 1\n2 2 2\n3 3 3\n"] {
        let stream = super::output("spfinalize", &["-"], points.as_bytes());
        let of_points = picture(&stream, &Options { width: 320, ..Options::new("points") });
        assert!(!of_points.svg.contains("NaN"), "{points:?}");
        let of_mesh = picture(&mesh_of(points), &Options { width: 320, ..Options::new("mesh") });
        assert!(!of_mesh.svg.contains("NaN"), "{points:?}");
        pixels(&of_points);
        pixels(&of_mesh);
    }
}

#[test]
fn many_points_are_all_painted() {
    // All points of a cloud except a square in its middle.
    let is_amid = |line: &&str| {
        let numbers: Vec<f64> = line.split(' ').map(|number| number.parse().unwrap()).collect();
        numbers[..2].iter().all(|number| (30_000.0..60_000.0).contains(number))
    };
    let text: String =
        cloud(26_000).lines().filter(|line| !is_amid(line)).map(|line| format!("{line}\n")).collect();
    let stream = super::output("spfinalize", &["-"], text.as_bytes());
    let options = Options { cells: false, width: 640, ..Options::new("points") };
    let picture = picture(&stream, &options);
    assert!(picture.svg.contains("data:image/png;base64,"), "painted, not drawn");
    let (pixmap, frame, [left, upper, right, lower]) =
        (pixels(&picture), picture.frame.unwrap(), map(&picture));
    let mut near = vec![false; pixmap.pixels().len()];
    for line in text.lines() {
        let mut numbers = line.split(' ').map(|number| number.parse::<f64>().unwrap());
        let [x, y] = frame.place([numbers.next().unwrap(), numbers.next().unwrap()]);
        assert_ne!(colour(&pixmap, x as u32, y as u32), [255; 3], "{line}");
        for (column, row) in (-2..=2).flat_map(|row| (-2..=2).map(move |column| (column, row))) {
            near[(y as i64 + row) as usize * pixmap.width() as usize + (x as i64 + column) as usize] = true;
        }
    }
    let mut far = 0;
    for (column, row) in (upper..lower).flat_map(|row| (left..right).map(move |column| (column, row))) {
        if !near[(row * pixmap.width() + column) as usize] {
            assert_eq!(colour(&pixmap, column, row), [255; 3], "{column}, {row}");
            far += 1;
        }
    }
    assert!(far > 1_000, "{far}");
}
