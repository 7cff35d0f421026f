//! Pictures of configurations: the counts of drawn elements agree with the stream.

use spmesh_configurations::{CentroidMesh, Knots, links};
use spmesh_stream::ConfigurationSet;
use spmesh_stream::StreamReader;
use spmesh_view::Options;

use super::svg::{named, parse, within};
use super::{grid, output, picture};

fn stream() -> Vec<u8> {
    output("configgen", &["--degree", "2", "-"], grid(5).as_bytes())
}

fn set(stream: &[u8]) -> ConfigurationSet {
    ConfigurationSet::read(&mut StreamReader::new(stream, "knots").unwrap()).unwrap()
}

#[test]
fn centroid_triangulations_of_any_order_are_drawn() {
    let stream = stream();
    let set = set(&stream);
    assert_eq!(set.degrees.len(), 3);
    for order in 1..=3 {
        let options = Options { order: Some(order), ..Options::new("knots") };
        let picture = picture(&stream, &options);
        let elements = parse(&picture.svg);
        let lower = (order > 1).then(|| &set.degrees[order - 2]);
        let mesh = CentroidMesh::of(&Knots::new(set.points.clone()).unwrap(), lower, &set.degrees[order - 1])
            .unwrap();
        let drawn = |id: &str| named(&elements, id).map_or(0, |path| path.rings().len());
        assert_eq!(drawn("upper"), mesh.from_upper);
        assert_eq!(drawn("upper") + drawn("lower"), mesh.triangles.len());
        assert_eq!(within(&elements, "knots", "circle").len(), 25);
        assert_eq!(within(&elements, "numbers", "text").len(), 25);
        let upper = &named(&elements, "upper").unwrap().rings()[0];
        let expected =
            mesh.triangles[0].map(|vertex| picture.frame.unwrap().place(mesh.vertices[vertex as usize]));
        let is_near =
            |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]).abs() < 0.01 && (a[1] - b[1]).abs() < 0.01;
        assert!(upper.iter().zip(&expected).all(is_near));
    }
    let greatest = Options { order: Some(3), ..Options::new("knots") };
    assert_eq!(picture(&stream, &Options::new("knots")).svg, picture(&stream, &greatest).svg);
}

#[test]
fn links_of_sets_are_drawn() {
    let stream = stream();
    let set = set(&stream);
    let links = links(&Knots::new(set.points.clone()).unwrap(), &set.degrees[1]).unwrap();
    let link = links.iter().find(|link| !link.is_infinite() && link.polygon.len() > 4).unwrap();
    let options = Options { set: Some(vec![link.set[1], link.set[0]]), ..Options::new("knots") };
    let elements = parse(&picture(&stream, &options).svg);
    assert_eq!(named(&elements, "link").unwrap().rings().len(), link.polygon.len());
    assert_eq!(named(&elements, "inside").unwrap().rings().len(), link.polygon.len() - 2);
    assert_eq!(named(&elements, "start").unwrap().rings().len(), set.degrees[0].len());
    assert_eq!(within(&elements, "set", "circle").len(), 2);
    assert_eq!(within(&elements, "knots", "circle").len(), 23);
}

#[test]
fn splines_have_their_knots_and_configurations() {
    let spline = output("splinefit", &["fit"], grid(12).as_bytes());
    let elements = parse(&picture(&spline, &Options::new("spline")).svg);
    assert!(named(&elements, "upper").is_some() && named(&elements, "lower").is_none());
    assert!(within(&elements, "knots", "circle").len() > 8);
}

/// Twice the signed area of a ring.
fn area(ring: &[[f64; 2]]) -> f64 {
    ring.iter().zip(ring.iter().cycle().skip(1)).map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum()
}

#[test]
fn copies_of_knots_are_drawn_apart() {
    let knots = grid(4);
    let sharp: Vec<&str> = knots.lines().chain(["100 100 0", "100 100 0", "100 100 0"]).collect();
    let pulled = output("configgen", &["--pull-apart", "all", "-"], knots.as_bytes());
    let repeated = output("configgen", &["-"], sharp.join("\n").as_bytes());
    for (stream, count, distinct, flat) in [(&pulled, 32, 16, 0), (&repeated, 19, 17, usize::MAX)] {
        let places = |apart: bool| {
            let options = Options { order: Some(1), apart, ..Options::new("knots") };
            let elements = parse(&picture(stream, &options).svg);
            let knots = within(&elements, "knots", "circle").len();
            (knots, named(&elements, "upper").unwrap().rings())
        };
        assert_eq!(places(false).0, distinct);
        let (knots, triangles) = places(true);
        assert_eq!(knots, count);
        assert_eq!(triangles.len(), set(stream).degrees[0].len());
        // Triangles are counterclockwise in the plane, and y goes down in pictures. So flat triangles have
        // opened to the right side, and no other one has turned over.
        let wrong = triangles.iter().filter(|ring| area(ring) >= 0.0).count();
        assert!(wrong <= flat, "{wrong} of {} triangles are flat or turned over", triangles.len());
    }
    // A link of a pulled knot, and the centroids of pairs, are drawn too.
    for options in [
        Options { set: Some(vec![5]), apart: true, ..Options::new("knots") },
        Options { order: Some(2), apart: true, ..Options::new("knots") },
    ] {
        let elements = parse(&picture(&pulled, &options).svg);
        assert_eq!(within(&elements, "numbers", "text").len(), 32);
    }
}
