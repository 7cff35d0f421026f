//! Pictures of moments of a stream, and the copy that `spview --tee` passes on.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use spmesh_base::upstream::mark;
use spmesh_stream::{Event, StreamReader};
use spmesh_view::{Moments, Options};

use super::svg::{named, parse, within};
use super::{grid, mesh_of, output, pictures, triangles};
use crate::programs::{Folder, outcome, run};

/// The numbers of live vertices and of open edges after a number of triangles.
fn front(stream: &[u8], at: u64) -> (usize, usize) {
    let mut reader = StreamReader::new(stream, "mesh").unwrap();
    let (mut live, mut is_final) = (HashSet::new(), HashSet::new());
    let mut edges: HashMap<[u64; 2], u32> = HashMap::new();
    let mut done = 0;
    'stream: while let Some(event) = reader.next_event().unwrap() {
        let Event::Patch(patch) = event else { continue };
        live.extend((0..patch.new.len() as u64).map(|new| patch.first_id + new));
        for triangle in patch.triangles() {
            if done == at {
                break 'stream;
            }
            let [a, b, c] = triangle.map(|local| patch.id(local));
            for [a, b] in [[a, b], [b, c], [c, a]] {
                *edges.entry([a.min(b), a.max(b)]).or_default() += 1;
            }
            done += 1;
        }
        for &local in &patch.finalized {
            live.remove(&patch.id(local));
            is_final.insert(patch.id(local));
        }
    }
    let open =
        edges.iter().filter(|(ends, count)| **count == 1 && !ends.iter().any(|end| is_final.contains(end)));
    (live.len(), open.count())
}

#[test]
fn moments_show_what_is_live_then() {
    let stream = mesh_of(&grid(20));
    let total = triangles(&stream);
    let mut open_counts = Vec::new();
    for at in [0, 1, 7, total / 3, total / 2, total - 1] {
        let moments = Moments { at: Some(at), every: None };
        let pictures = pictures(&stream, &Options::new("mesh"), moments).unwrap();
        assert_eq!(pictures.len(), 1);
        let elements = parse(&pictures[0].svg);
        let drawn = within(&elements, "map", "path");
        let shown = drawn.iter().filter(|path| path.attributes.contains_key("color")).count();
        assert_eq!(shown as u64, at);
        let border = named(&elements, "border").map_or(0, |path| path.rings().len());
        let (live, open) = front(&stream, at);
        assert_eq!((within(&elements, "live", "circle").len(), border), (live, open), "after {at}");
        open_counts.push(open);
    }
    assert!(open_counts.iter().any(|&open| open > 10), "{open_counts:?}");
    let end = pictures(&stream, &Options::new("mesh"), Moments::default()).unwrap().remove(0);
    assert!(named(&parse(&end.svg), "live").is_none());
}

#[test]
fn snapshots_come_after_each_number_and_at_the_end() {
    let stream = mesh_of(&grid(12));
    let last = pictures(&stream, &Options::new("mesh"), Moments::default()).unwrap().remove(0);
    let total = triangles(&stream);
    // If the last moment is the end of the stream, the end has no second picture.
    for (every, count) in [(100, total.div_ceil(100)), (total.div_ceil(2), 2), (total, 1), (total + 1, 1)] {
        let count = count as usize;
        let moments = Moments { at: None, every: Some(every) };
        let all = pictures(&stream, &Options::new("mesh"), moments).unwrap();
        assert_eq!(all.len(), count, "every {every}");
        assert_eq!(all[count - 1].svg, last.svg);
        for (number, picture) in all[..count - 1].iter().enumerate() {
            let after = every * (number as u64 + 1);
            assert!(picture.title.contains(&format!("after {after} triangles")), "{}", picture.title);
        }
    }
    let moments = Moments { at: Some(150), every: Some(100) };
    assert_eq!(pictures(&stream, &Options::new("mesh"), moments).unwrap().len(), 2);
}

#[test]
fn a_pipe_goes_through_unchanged() {
    let folder = Folder::new();
    let points = output("spfinalize", &["--cell-points", "40", "-"], grid(20).as_bytes());
    let pattern = folder.path("shots-%03d.png");
    let arguments = ["--tee", "--snapshot", "every=150", "--width", "320", "-o", &pattern];
    let passed = run("spview", &arguments, &points);
    assert!(passed.status.success() && passed.stdout == points, "{:?}", outcome(&passed));
    assert_eq!(folder.names(""), ["shots-001.png", "shots-002.png", "shots-003.png"]);
    let whole = folder.path("whole.png");
    output("spview", &["--width", "320", "-o", &whole, "-"], &points);
    let read = |name: &str| std::fs::read(folder.path(name)).unwrap();
    assert!(read("shots-003.png") == read("whole.png"));
    assert!(read("shots-002.png") != read("whole.png"));
}

/// Where the blocks of a stream start, END included.
fn starts(stream: &[u8]) -> Vec<usize> {
    let mut reader = StreamReader::new(stream, "points").unwrap();
    let mut starts = vec![reader.bytes_read() as usize];
    while reader.next_event().unwrap().is_some() {
        starts.push(reader.bytes_read() as usize);
    }
    assert_eq!(starts.pop(), Some(stream.len()));
    starts
}

/// Of a malformed stream, the blocks before the fault are passed on: no damaged block, and no END.
#[test]
fn damaged_blocks_are_not_passed_on() {
    let folder = Folder::new();
    let points = output("spfinalize", &["--cell-points", "40", "-"], grid(20).as_bytes());
    let picture = folder.path("picture.png");
    let starts = starts(&points);
    for block in [0, starts.len() / 2, starts.len() - 1] {
        let start = starts[block];
        let mut damaged = points.clone();
        damaged[start + 20] ^= 1;
        for input in [&damaged[..], &points[..start + 20]] {
            let passed = run("spview", &["--tee", "-o", &picture], input);
            let (code, message) = outcome(&passed);
            assert_eq!(code, Some(3), "block {block}: {message}");
            assert!(message.contains(&format!("block {block} at byte {start}")), "{message}");
            let mark = &mark(3)[..];
            assert!(passed.stdout == [&points[..start], mark].concat(), "block {block}");
            let (code, message) = outcome(&run("spdelaunay2d", &[], &passed.stdout));
            assert_eq!((code, &message[..]), (Some(3), ""));
        }
    }
    // What follows END is not right either.
    let longer = [&points[..], b"x"].concat();
    let passed = run("spview", &["--tee", "-o", &picture], &longer);
    assert_eq!(outcome(&passed).0, Some(3));
    assert!(passed.stdout.len() < points.len() && !Path::new(&picture).exists());
}

/// A picture that cannot be written leaves the stream without its END.
#[test]
fn a_failed_picture_fails_the_pipe() {
    let points = output("spfinalize", &["-"], grid(20).as_bytes());
    let passed = run("spview", &["--tee", "--format", "png", "-o", "/dev/full"], &points);
    assert_eq!(outcome(&passed).0, Some(1));
    assert_eq!(outcome(&run("spdelaunay2d", &[], &passed.stdout)), (Some(1), String::new()));
}

#[test]
fn parts_of_a_stream_are_counts_of_it() {
    let folder = Folder::new();
    let mesh = mesh_of(&grid(12));
    let total = triangles(&mesh);
    let mesh = folder.write("mesh.spm", mesh);
    let points = folder.write("points.spm", output("spfinalize", &["-"], grid(12).as_bytes()));
    let title = |arguments: &[&str]| {
        let svg = String::from_utf8(output("spview", arguments, &[])).unwrap();
        svg.split("<title>").nth(1).unwrap().split("</title>").next().unwrap().to_string()
    };
    assert!(
        title(&["--at", "0.5", &mesh])
            .starts_with(&format!("mesh.spm after {} triangles, ", total.div_ceil(2)))
    );
    assert!(title(&["--at", "17", &mesh]).starts_with("mesh.spm after 17 triangles, "));
    assert!(title(&["--at", "1.0", &mesh]).starts_with(&format!("mesh.spm: {total} triangles, ")));
    assert_eq!(title(&["--at", "0.25", &points]), "points.spm after 36 points");
    assert_eq!(title(&["--at", "5000", &points]), "points.spm: 144 points");
}

#[test]
fn residuals_of_partial_meshes_are_shown() {
    let points = output("spfinalize", &["--cell-points", "30", "-"], grid(16).as_bytes());
    let part = output("spdelaunay2d", &["--partial", "--region", "0,0,800,800"], &points);
    let elements = parse(&super::picture(&part, &Options::new("part")).svg);
    let mut reader = StreamReader::new(&part[..], "part").unwrap();
    while reader.next_event().unwrap().is_some() {}
    let totals = reader.totals();
    assert!(totals.residual_points > 5 && totals.walls > 5);
    assert_eq!(within(&elements, "live", "circle").len() as u64, totals.residual_points);
    assert_eq!(named(&elements, "border").unwrap().rings().len() as u64, totals.walls);
}
