//! `spdem --contours`: lines against exact arithmetic on each triangle, and failures.

mod degenerate;
mod exact;
mod failures;
mod memory;
mod outline;
mod pipelines;
mod smooth;

use serde_json::Value;
use spmesh_base::error::Result;
use spmesh_stream::{Coordinates, StreamReader};
use spmesh_terrain::contours::{Levels, LineFormat, Options, Stats, contour};

/// Integer coordinates equal to those of the world.
const WHOLE: Coordinates = Coordinates::I32 { scale: [1.0; 3], offset: [0.0; 3] };

/// A written line; a ring does not repeat its first point at the end.
#[derive(Debug, Clone, PartialEq, PartialOrd)]
struct Line {
    elevation: f64,
    is_closed: bool,
    is_depression: bool,
    points: Vec<[f64; 2]>,
}

impl Line {
    fn of(feature: &Value) -> Line {
        assert_eq!(
            (&feature["type"], &feature["geometry"]["type"]),
            (&"Feature".into(), &"LineString".into())
        );
        let number = |value: &Value| value.as_f64().expect("a number");
        let points = feature["geometry"]["coordinates"].as_array().expect("points");
        let mut points: Vec<[f64; 2]> =
            points.iter().map(|point| [0, 1].map(|axis| number(&point[axis]))).collect();
        let [is_closed, is_depression] = ["is_closed", "depression"]
            .map(|name| feature["properties"][name].as_bool().expect("a property"));
        assert!(points.windows(2).all(|pair| pair[0] != pair[1]), "{points:?}");
        if is_closed {
            assert_eq!(points.first(), points.last());
            points.pop();
        }
        assert!(points.len() > 1);
        Line { elevation: number(&feature["properties"]["elevation"]), is_closed, is_depression, points }
    }

    /// From each point to the next.
    fn segments(&self) -> impl Iterator<Item = [[f64; 2]; 2]> + '_ {
        let count = self.points.len() - usize::from(!self.is_closed);
        (0..count).map(|i| [self.points[i], self.points[(i + 1) % self.points.len()]])
    }
}

/// All lines of a file.
fn parse(text: &[u8], format: LineFormat) -> Vec<Line> {
    let text = std::str::from_utf8(text).unwrap();
    let json = |text: &str| -> Value { serde_json::from_str(text).unwrap() };
    match format {
        LineFormat::GeoJsonLines => text.lines().map(|line| Line::of(&json(line))).collect(),
        LineFormat::GeoJson => {
            let collection = json(text);
            assert_eq!(collection["type"], "FeatureCollection");
            collection["features"].as_array().unwrap().iter().map(Line::of).collect()
        }
    }
}

fn options(interval: f64, base: f64) -> Options {
    Options::new(Levels::new(interval, base).unwrap())
}

fn try_lines(stream: &[u8], options: &Options) -> Result<(Vec<Line>, Stats)> {
    let (mut text, format) = (Vec::new(), LineFormat::GeoJsonLines);
    let stats = contour(&mut StreamReader::new(stream, "mesh")?, &mut text, format, options, |_| {})?;
    let lines = parse(&text, format);
    assert_eq!(stats.lines, lines.len() as u64);
    assert_eq!(stats.rings, lines.iter().filter(|line| line.is_closed).count() as u64);
    assert_eq!(stats.points, lines.iter().map(|line| line.points.len() as u64).sum::<u64>());
    Ok((lines, stats))
}

/// The lines of a mesh, sorted.
fn lines(stream: &[u8], options: &Options) -> Vec<Line> {
    let (mut lines, _) = try_lines(stream, options).unwrap();
    lines.sort_by(|a, b| a.partial_cmp(b).unwrap());
    lines
}
