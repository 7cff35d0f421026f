//! `spview`: pictures against the streams that they show; failures.

mod configurations;
mod failures;
mod kinds;
mod moments;
mod outline;
mod page;
mod pixels;
mod render;
mod shapes;
mod svg;

use spmesh_base::error::Result;
use spmesh_stream::StreamReader;
use spmesh_view::{Moments, Options, Picture, draw};

use crate::programs::{outcome, run};

/// All pictures of a stream.
fn pictures(stream: &[u8], options: &Options, moments: Moments) -> Result<Vec<Picture>> {
    let mut reader = StreamReader::new(stream, "stream")?;
    let mut pictures = Vec::new();
    let mut take = |picture: &Picture| {
        let Picture { title, svg, frame } = picture;
        pictures.push(Picture { title: title.clone(), svg: svg.clone(), frame: *frame });
        Ok(())
    };
    draw(&mut reader, options, moments, &mut take, |_| {})?;
    Ok(pictures)
}

/// The picture after the last event of a stream.
fn picture(stream: &[u8], options: &Options) -> Picture {
    let mut pictures = pictures(stream, options, Moments::default()).unwrap();
    assert_eq!(pictures.len(), 1);
    pictures.remove(0)
}

/// The output of a program, which must succeed.
fn output(name: &str, arguments: &[&str], input: &[u8]) -> Vec<u8> {
    let output = run(name, arguments, input);
    assert!(output.status.success(), "{name} {arguments:?}: {:?}", outcome(&output));
    output.stdout
}

/// The mesh of points given as lines of text.
fn mesh_of(points: &str) -> Vec<u8> {
    output("spdelaunay2d", &[], &output("spfinalize", &["--cell-points", "60", "-"], points.as_bytes()))
}

/// Lines of the points of a grid, moved so that no four are cocircular.
fn grid(side: u64) -> String {
    let point = |i: u64| (i % side * 100 + i * 37 % 23, i / side * 100 + i * 53 % 29, i * 71 % 97);
    (0..side * side).map(point).map(|(x, y, z)| format!("{x} {y} {z}\n")).collect()
}

/// Number of triangles of a mesh.
fn triangles(stream: &[u8]) -> u64 {
    let mut reader = StreamReader::new(stream, "mesh").unwrap();
    while reader.next_event().unwrap().is_some() {}
    reader.totals().simplices
}
