//! Positions and colours of triangles, edges, points and cells that are drawn as single elements.

use std::collections::HashSet;

use spmesh_stream::{Coordinates, Event, StreamReader};
use spmesh_view::{Fill, Form, Options, When};

use super::svg::{Element, named, parse, within};
use super::{grid, mesh_of, output, picture};
use crate::dem::Mesh;
use spmesh_reference::sets::{Random, uniform};

fn random_mesh(count: usize, side: i64) -> Mesh {
    let mut random = Random::new(7);
    let points = uniform(&mut random, count, side);
    Mesh::of(&mut random, &points)
}

fn options(fill: Fill) -> Options {
    Options { fill: Some(fill), stretch: None, ..Options::new("mesh") }
}

/// The triangles of a picture.
fn triangles(elements: &[Element]) -> Vec<&Element> {
    let paths = within(elements, "map", "path");
    paths.into_iter().filter(|path| path.attributes.contains_key("color")).collect()
}

#[test]
fn every_triangle_is_drawn_once_where_it_is() {
    let mesh = random_mesh(300, 5_000);
    let coordinates = Coordinates::I32 { scale: [0.25; 3], offset: [400_000.25, -9.0, 0.0] };
    let picture = picture(&mesh.stream(coordinates), &options(Fill::Time));
    let elements = parse(&picture.svg);
    let frame = picture.frame.unwrap();
    let hundredths = |at: [f64; 2]| at.map(|length| (length * 100.0).round() as i64);
    let mut expected: Vec<Vec<[i64; 2]>> = mesh
        .triangles
        .iter()
        .map(|triangle| {
            let world = triangle.map(|vertex| coordinates.to_world(mesh.points[vertex as usize]));
            world.map(|[x, y, _]| hundredths(frame.place([x, y]))).to_vec()
        })
        .collect();
    let mut found: Vec<Vec<[i64; 2]>> = triangles(&elements)
        .iter()
        .map(|triangle| triangle.rings().remove(0).into_iter().map(hundredths).collect())
        .collect();
    let [_, _, width, height] = view_box(&elements);
    assert!(
        found.iter().flatten().all(|[x, y]| (0..=100 * width).contains(x) && (0..=100 * height).contains(y))
    );
    expected.sort_unstable();
    found.sort_unstable();
    assert_eq!(found, expected);
}

fn view_box(elements: &[Element]) -> [i64; 4] {
    let numbers = elements[0].attributes["viewBox"].split(' ').map(|number| number.parse().unwrap());
    numbers.collect::<Vec<i64>>().try_into().unwrap()
}

#[test]
fn colours_are_in_the_order_of_what_they_mean() {
    let mesh = random_mesh(200, 900);
    let stream = mesh.stream(Coordinates::F64);
    let elements = parse(&picture(&stream, &options(Fill::Time)).svg);
    let lights: Vec<f64> = triangles(&elements).iter().map(|path| path.lightness("color")).collect();
    assert!(lights.len() > 300 && lights.windows(2).all(|pair| pair[0] <= pair[1] + 0.6), "{lights:?}");
    assert!(lights[lights.len() - 1] > lights[0] + 100.0);
    let elements = parse(&picture(&stream, &options(Fill::Elevation)).svg);
    let mean = |triangle: &[u32; 3]| triangle.iter().map(|&v| mesh.points[v as usize][2]).sum::<f64>();
    let mut lights: Vec<(f64, f64)> = mesh
        .triangles
        .iter()
        .zip(triangles(&elements))
        .map(|(triangle, path)| (mean(triangle), path.lightness("color")))
        .collect();
    lights.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(lights.windows(2).all(|pair| pair[0].1 <= pair[1].1 + 0.9), "{lights:?}");
    // Values beyond the given range have the colour of its end.
    let low = Options { range: Some([-9.0, -1.0]), ..options(Fill::Elevation) };
    let elements = parse(&picture(&stream, &low).svg);
    assert!(triangles(&elements).iter().all(|path| path.attributes["color"] == "#faccfa"));
}

#[test]
fn every_edge_is_drawn_once() {
    let mesh = random_mesh(150, 700);
    let edges: HashSet<[u32; 2]> = mesh
        .triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    let elements = parse(&picture(&mesh.stream(Coordinates::F64), &options(Fill::None)).svg);
    assert!(triangles(&elements).is_empty());
    let drawn = named(&elements, "edges").unwrap().rings();
    assert!(drawn.iter().all(|line| line.len() == 2));
    assert_eq!(drawn.len(), edges.len());
    let never = Options { edges: When::Never, ..options(Fill::Relief) };
    assert!(named(&parse(&picture(&mesh.stream(Coordinates::F64), &never).svg), "edges").is_none());
}

#[test]
fn windows_leave_out_what_cannot_be_seen() {
    let mesh = random_mesh(400, 1_000);
    let window = spmesh_formats::raster::Window { min: [200.0, 300.0], max: [500.0, 450.0] };
    let options = Options { bounds: Some(window), ..options(Fill::Elevation) };
    let elements = parse(&picture(&mesh.stream(Coordinates::F64), &options).svg);
    let meets = |triangle: &&[u32; 3]| {
        let corners = triangle.map(|vertex| mesh.points[vertex as usize]);
        (0..2).all(|axis| {
            let [low, high] = [window.min[axis], window.max[axis]];
            corners.iter().any(|at| at[axis] >= low) && corners.iter().any(|at| at[axis] <= high)
        })
    };
    assert_eq!(triangles(&elements).len(), mesh.triangles.iter().filter(meets).count());
    let [_, _, width, height] = view_box(&elements);
    assert!(width == 1_000 && height < 700, "{height}");
}

#[test]
fn seen_from_one_side_all_triangles_are_on_the_sheet() {
    let mesh = random_mesh(120, 600);
    let options = Options { oblique: true, ..options(Fill::Elevation) };
    let picture = picture(&mesh.stream(Coordinates::F64), &options);
    assert_eq!(picture.frame, None);
    let elements = parse(&picture.svg);
    assert_eq!(triangles(&elements).len(), mesh.triangles.len());
    assert!(named(&elements, "scale").is_none());
    let [_, _, width, height] = view_box(&elements);
    for corner in triangles(&elements).iter().flat_map(|path| path.rings().remove(0)) {
        assert!((0.0..=width as f64).contains(&corner[0]) && (0.0..=height as f64).contains(&corner[1]));
    }
}

#[test]
fn cells_have_the_times_of_their_points() {
    let stream = output("spfinalize", &["--cell-points", "40", "-"], grid(20).as_bytes());
    let picture = picture(&stream, &Options::new("points"));
    let elements = parse(&picture.svg);
    let rectangles = within(&elements, "cells", "rect");
    let mut reader = StreamReader::new(&stream[..], "points").unwrap();
    let (mut tagged, mut count) = (HashSet::new(), 0);
    let tree = reader.header().tree.unwrap();
    let mut points = Vec::new();
    while let Some(event) = reader.next_event().unwrap() {
        match event {
            Event::Points(more) => points.extend(more),
            Event::Cells(cells) => tagged.extend(cells),
            Event::End(totals) => count = totals.points,
            _ => {}
        }
    }
    let holds = |cell: &&spmesh_stream::model::cells::CellCode| {
        let (min, max) = tree.corners(**cell);
        points.iter().any(|at| (0..2).all(|axis| min[axis] <= at[axis] && at[axis] < max[axis]))
    };
    let with_points = tagged.iter().filter(holds).count();
    assert!(with_points > 8 && count == 400);
    // Each tagged cell with points has two rectangles: a border and a middle.
    assert_eq!(rectangles.len(), 2 * with_points);
    for pair in rectangles.chunks(2) {
        assert!(
            pair[1].lightness("fill") <= pair[0].lightness("fill") + 0.6,
            "the last point before the first"
        );
        assert!(pair[1].number("width") < pair[0].number("width"));
    }
    assert_eq!(within(&elements, "points", "circle").len(), 400);
    assert!(within(&elements, "open", "rect").is_empty());
}

#[test]
fn points_without_cells_have_the_colours_themselves() {
    let stream = output("spfinalize", &["--cell-points", "40", "-"], grid(12).as_bytes());
    for (fill, cells) in [(None, false), (Some(Fill::Elevation), true), (Some(Fill::None), true)] {
        let options = Options { fill, cells, ..Options::new("points") };
        let elements = parse(&picture(&stream, &options).svg);
        let circles = within(&elements, "points", "circle");
        assert_eq!(circles.len(), 144);
        assert!(named(&elements, "cells").is_none());
        assert_eq!(circles.iter().all(|dot| dot.attributes.contains_key("fill")), fill != Some(Fill::None));
    }
    let space = output("spfinalize", &["--octree", "-"], grid(9).as_bytes());
    let elements = parse(&picture(&space, &Options::new("space")).svg);
    assert_eq!(within(&elements, "points", "circle").len(), 81);
}

#[test]
fn the_furniture_says_what_is_shown() {
    let mesh = mesh_of(&grid(15));
    let picture = picture(&mesh, &Options::new("a<b>&\"c\".spm"));
    let elements = parse(&picture.svg);
    let words: Vec<&str> =
        within(&elements, "furniture", "text").iter().map(|element| &element.text[..]).collect();
    assert!(
        words.contains(&"Elevation (all: 0 to 96)") && words.iter().any(|text| text.ends_with(" units")),
        "{words:?}"
    );
    let count = super::triangles(&mesh);
    assert_eq!(picture.title, format!("a<b>&\"c\".spm: {count} triangles, 225 vertices"));
    let numbers: Vec<f64> = words.iter().filter_map(|text| text.parse().ok()).collect();
    assert!(numbers.len() >= 3 && numbers.windows(2).all(|pair| pair[0] < pair[1]), "{words:?}");
    assert!(named(&elements, "map").is_some() && named(&elements, "scale").is_some());
    let image = Options { form: Form::Raster, ..Options::new("mesh") };
    let elements = parse(&super::picture(&mesh, &image).svg);
    assert_eq!(within(&elements, "map", "image").len(), 1);
}

#[test]
fn the_ending_of_a_name_says_the_format() {
    let (folder, mesh) = (crate::programs::Folder::new(), mesh_of(&grid(6)));
    let written = |name: &str| {
        output("spview", &["-o", &folder.path(name), "-"], &mesh);
        std::fs::read(folder.path(name)).unwrap()
    };
    let svg = output("spview", &["-"], &mesh);
    assert!(written("mesh.svg") == svg && written("no-ending") == svg && svg.starts_with(b"<svg "));
    assert!(written("mesh.PNG").starts_with(b"\x89PNG\r\n"));
    let page = String::from_utf8(written("mesh.html")).unwrap();
    assert!(
        page.to_lowercase().starts_with("<!doctype html>")
            && page.contains(std::str::from_utf8(&svg).unwrap())
    );
}

#[test]
fn edges_on_lines_are_drawn_once() {
    let vectors = crate::vectors::load("pass", "txt");
    let vector = vectors.iter().find(|vector| vector.name.ends_with("constrained-square")).unwrap();
    for form in [Form::Vector, Form::Raster] {
        let drawn = picture(&vector.bytes, &Options { form, ..Options::new("square") });
        let elements = parse(&drawn.svg);
        let lines = &named(&elements, "lines").unwrap().attributes["d"];
        assert_eq!(lines.matches('M').count(), 2, "{lines}");
        assert!(drawn.svg.contains("edges on lines"));
    }
}
