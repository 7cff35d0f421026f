//! Points in regions: the writer refuses what the reader refuses, and programs take the kind or name it.

use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_stream::model::bounds::{Point, Region};
use spmesh_stream::{Coordinates, Event, Header, Kind, PointRegion, StreamWriter};

use crate::programs::{outcome, run};
use crate::vectors::{vector, verify};

fn header() -> Header {
    Header::new(Kind::RegionPoints, Coordinates::F64, 3, false)
}

fn region(counts: [u64; 4]) -> Event {
    let [own, first, again, last] = counts;
    Event::Region(PointRegion { bounds: Region::EVERYTHING, own, first, again, last })
}

fn points(count: usize) -> Event {
    Event::Points((0..count).map(|number| [number as f64, 0.0, 1.0]).collect())
}

/// What the writer says about these events and the end.
fn write(events: &[Event]) -> Result<Vec<u8>> {
    let mut writer = StreamWriter::new(Vec::new(), header())?;
    for event in events {
        match event {
            Event::Region(region) => writer.region(region)?,
            Event::Points(points) => writer.points(points)?,
            _ => unreachable!("no other event"),
        }
    }
    writer.end(0, 0)
}

fn refusal(events: &[Event]) -> Error {
    write(events).expect_err("the regions break a rule")
}

#[test]
fn the_writer_keeps_the_rules_of_regions() {
    let cases: [(&[Event], &str); 12] = [
        (&[points(1)], "points before the first region"),
        (&[region([1, 0, 0, 0])], "region 1 states 1 points, 0 follow"),
        (&[region([2, 0, 0, 0]), points(1), region([0; 4])], "region 1 states 2 points, 1 follow"),
        (&[region([2, 0, 0, 0]), points(3)], "region 1 states 2 points, at least 3 follow"),
        (&[region([0; 4]), region([0, 0, 0, 1])], "region 2 has 1 points of earlier regions"),
        (&[region([0, 1, 1, 0])], "region 1 has 1 points of earlier regions, but these share 0"),
        (&[region([0, 1, 0, 0]), points(1), region([0, 0, 1, 1])], "but these share 1"),
        (
            &[region([0, 2, 0, 0]), points(2), region([0, 0, 0, 1]), points(1)],
            "END: 1 points that regions share",
        ),
        (
            &[region([0, 1, 0, 0]), points(1), region([0, 0, 1, 0]), points(1)],
            "END: 1 points that regions share",
        ),
        (&[region([u64::MAX, 0, 0, 0])], "beyond counting"),
        (&[region([0, 1 << 63, 1 << 63, 0])], "beyond counting"),
        (&[region([u64::MAX - 1, 0, 0, 1])], "beyond counting"),
    ];
    for (events, words) in cases {
        let error = refusal(events);
        assert_eq!(error.kind(), ErrorKind::Malformed, "{error}");
        assert!(error.to_string().contains(words), "{error}, expected {words}");
    }
}

#[test]
fn boxes_of_regions_are_neither_empty_nor_nan() {
    let of = |min: Point, max: Point| {
        Event::Region(PointRegion { bounds: Region { min, max }, own: 0, first: 0, again: 0, last: 0 })
    };
    for axis in 0..3 {
        for side in [f64::NAN, 1.0, 2.0, f64::INFINITY] {
            let mut min = [0.0; 3];
            min[axis] = side;
            let error = refusal(&[of(min, [1.0; 3])]);
            assert!(error.to_string().contains("region 1: the box is empty, or a side is NaN"), "{error}");
        }
        let mut max = [1.0; 3];
        max[axis] = f64::NAN;
        assert_eq!(refusal(&[of([0.0; 3], max)]).kind(), ErrorKind::Malformed);
    }
    write(&[of([f64::NEG_INFINITY, 0.0, -0.0], [0.0, f64::MIN_POSITIVE, f64::INFINITY])]).unwrap();
}

#[test]
fn points_of_regions_count_once() {
    let events = [
        region([40_000, 10_000, 0, 0]),
        points(50_000),
        region([0; 4]),
        region([1, 2, 9_000, 1_000]),
        points(10_003),
        region([0, 0, 0, 9_002]),
        points(9_002),
    ];
    let (header, read) = verify(&write(&events).unwrap()).unwrap();
    assert_eq!(header, self::header());
    let Some(Event::End(totals)) = read.last() else { panic!("no END") };
    assert_eq!((totals.points, totals.vertices, totals.merged), (50_003, 0, 0));
    assert_eq!(super::joined(read)[..events.len()], super::joined(events.to_vec())[..]);
    let Event::Region(third) = &events[3] else { unreachable!("it is one") };
    assert_eq!((third.points(), third.new_points()), (10_003, 3));
}

#[test]
fn the_writer_checks_the_number_of_points_in_the_header() {
    let header = Header { points: Some(2), ..header() };
    let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
    let only = PointRegion { bounds: Region::EVERYTHING, own: 1, first: 0, again: 0, last: 0 };
    writer.region(&only).unwrap();
    writer.points(&[[0.0; 3]]).unwrap();
    let error = writer.end(0, 0).expect_err("the header states two points");
    assert!(error.to_string().contains("another number of points"), "{error}");
}

#[test]
fn spinfo_counts_regions_and_copies() {
    let output = run("spinfo", &["-"], &vector("regions-three"));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{text}");
    let expected = [
        "stdin: points in regions",
        "  bounds       (0, 0, 0) to (4.5, 0, 0)",
        "  points       5",
        "  regions      3, largest: 3 points",
        "  copies       3 points, in regions after their first",
    ];
    for line in expected {
        assert!(text.lines().any(|found| found == line), "{line} in {text}");
    }
    assert!(!text.contains("chunked"), "{text}");
    let report = |name: &str| -> serde_json::Value {
        serde_json::from_slice(&run("spinfo", &["--json", "-"], &vector(name)).stdout).unwrap()
    };
    let three = report("regions-three");
    assert_eq!(three["regions"], serde_json::json!({"count": 3, "copies": 3, "points_max": 3}));
    assert_eq!(three["counts"]["points"], 5);
    assert_eq!(report("points-i32-3d")["regions"], serde_json::Value::Null);
}

#[test]
fn programs_that_take_no_regions_name_the_kind() {
    let regions = vector("regions-three");
    for arguments in [
        &["spfinalize", "--octree", "-"][..],
        &["spdelaunay2d", "-"],
        &["spdelaunay2d", "--merge", "-"],
        &["spconvert", "--to", "vtu", "-"],
        &["spconvert", "--to", "ply", "-"],
        &["spdem", "--step", "1", "-o", "heights.tif", "-"],
        &["spview", "-o", "picture.png", "-"],
        &["tess3", "-"],
        &["dd4", "-"],
        &["configgen", "-"],
        &["spinfo", "--audit", "-"],
        &["spinfo", "--audit", "--points", "-", "-"],
    ] {
        let (code, message) = outcome(&run(arguments[0], &arguments[1..], &regions));
        assert_eq!(code, Some(2), "{arguments:?}: {message}");
        assert!(message.contains("points in regions"), "{arguments:?}: {message}");
    }
}
