//! Every kind of picture as PNG: the renderer refuses elements and attributes that it does not know.

use std::collections::BTreeSet;
use std::sync::Arc;

use spmesh_formats::source::{Mask, Surface};
use spmesh_view::{Fill, Form, Moments, Options, Picture, SolidOptions, When, draw_solid};

use super::svg::parse;
use super::{grid, mesh_of, output, pictures};

/// Attributes that only some kinds of pictures have, each with its element.
const RARE: [[&str; 2]; 14] = [
    ["circle", "fill"],
    ["circle", "r"],
    ["g", "clip-path"],
    ["g", "fill"],
    ["g", "stroke-opacity"],
    ["image", "href"],
    ["path", "class"],
    ["path", "clip-rule"],
    ["path", "color"],
    ["path", "stroke-linecap"],
    ["path", "stroke-linejoin"],
    ["path", "stroke-opacity"],
    ["rect", "stroke"],
    ["text", "text-anchor"],
];

/// Renders a picture, and adds the attributes in it.
fn check(picture: &Picture, seen: &mut BTreeSet<[String; 2]>) {
    let png = picture.png().unwrap_or_else(|error| panic!("{}: {error}", picture.title));
    assert!(png.starts_with(b"\x89PNG"));
    for element in parse(&picture.svg) {
        seen.extend(element.attributes.into_keys().map(|name| [element.name.clone(), name]));
    }
}

/// Options of all kinds, for any stream; not all go with each.
fn choices() -> Vec<Options> {
    let plain = Options { width: 320, ..Options::new("a <b> & \"é\" 漢") };
    let ring = vec![[100.0, 100.0], [900.0, 200.0], [500.0, 900.0]];
    let mask = Some(Arc::new(Mask { polygons: vec![vec![ring]] }));
    let mut choices = Vec::new();
    for form in [Form::Vector, Form::Raster] {
        let plain = Options { form, ..plain.clone() };
        let fills = [Fill::None, Fill::Elevation, Fill::Hillshade, Fill::Relief, Fill::Time];
        choices.extend(fills.map(|fill| Options { fill: Some(fill), ..plain.clone() }));
        choices.extend([
            Options { mask: mask.clone(), ..plain.clone() },
            Options { oblique: true, ..plain.clone() },
            Options { oblique: true, edges: When::Never, ..plain.clone() },
            Options { cells: false, ..plain.clone() },
            Options { range: Some([20.0, 60.0]), middle: Some(40.0), ..plain },
        ]);
    }
    choices.extend((1..=2).map(|order| Options { order: Some(order), apart: true, ..plain.clone() }));
    choices.push(Options { set: Some(vec![5]), ..plain });
    choices
}

#[test]
fn each_kind_of_picture_can_be_rendered() {
    let points = output("spfinalize", &["--cell-points", "40", "-"], grid(12).as_bytes());
    let part = output("spdelaunay2d", &["--partial", "--region", "0,0,800,800"], &points);
    let knots = output("configgen", &["--degree", "1", "-"], grid(4).as_bytes());
    let mut streams = vec![mesh_of(&grid(12)), points, part, knots];
    streams.extend(crate::vectors::load("pass", "txt").into_iter().map(|vector| vector.bytes));
    let mut seen = BTreeSet::new();
    let (mut count, choices) = (0, choices());
    for (number, stream) in streams.iter().enumerate() {
        let moments = [Moments::default(), Moments { at: Some(20), every: None }];
        // Of the test vectors, the default is enough.
        let choices = if number < 4 { &choices[..] } else { &choices[3..4] };
        for (options, moments) in choices.iter().flat_map(|options| moments.map(|moments| (options, moments)))
        {
            // A stream may not go with the options, which is tested elsewhere.
            for picture in pictures(stream, options, moments).unwrap_or_default() {
                check(&picture, &mut seen);
                count += 1;
            }
        }
    }
    assert!(count > 80, "{count}");
    let surface = Surface {
        points: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        normals: Vec::new(),
        triangles: vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]],
        colours: vec![None; 4],
    };
    let options = SolidOptions { name: "solid".to_string(), width: 320, eye: [30.0, 20.0] };
    check(&draw_solid(&surface, &options).unwrap(), &mut seen);
    let missing: Vec<_> = RARE.iter().filter(|pair| !seen.contains(&pair.map(str::to_string))).collect();
    assert!(missing.is_empty(), "no picture has {missing:?}");
}
