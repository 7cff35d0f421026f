//! Breaklines and corners.

use super::{knots, output, points, rows};
use crate::programs::{Folder, outcome, run};

/// A roof: its ridge is at x = 43.
fn roof(x: f64, y: f64) -> f64 {
    20.0 - 0.5 * (x - 43.0).abs() + 0.1 * y
}

/// Greatest deviation from the roof near its ridge, and the least step of the slope across the ridge.
fn at_ridge(spline: &[u8]) -> (f64, f64) {
    let folder = Folder::new();
    let beside = |by: f64| (1..40).map(move |y| [43.0 + by, 2.0 * f64::from(y)]);
    let sites: String = beside(-0.05).chain(beside(0.05)).map(|[x, y]| format!("{x} {y}\n")).collect();
    let sites = folder.write("sites.txt", sites);
    let values = rows(&output(&["eval", "-", "--at", &sites], spline));
    let off = values.iter().map(|row| (row[2] - roof(row[0], row[1])).abs()).fold(0.0, f64::max);
    let slopes = rows(&output(&["eval", "-", "--at", &sites, "--kind", "gradient"], spline));
    let step = |at: usize| slopes[at][2] - slopes[39 + at][2];
    (off, (0..39).map(step).fold(f64::INFINITY, f64::min))
}

#[test]
fn roofs_have_sharp_ridges() {
    let folder = Folder::new();
    let (knots, points) =
        (folder.write("knots.txt", knots()), folder.write("points.txt", points(6_000, 3, roof)));
    let smooth = at_ridge(&output(&["fit", "--knots", &knots, &points], &[]));
    assert!(smooth.0 > 0.3 && smooth.1 < 0.5, "{smooth:?}");
    let text = folder.write("ridge.txt", "crease 43 0  43 80\n");
    let json = folder.write(
        "ridge.json",
        r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{},"geometry":
            {"type":"LineString","coordinates":[[43,0],[43,80]]}}]}"#,
    );
    for features in [&text, &json] {
        for knots in [&["--knots", &knots][..], &["--max-knots", "60"]] {
            let spline = output(&[&["fit", "--features", features, &points], knots].concat(), &[]);
            let (off, step) = at_ridge(&spline);
            // Random points leave gaps at the border of the box, which smoothing bridges.
            assert!(off < 0.02 && (0.9..1.1).contains(&step), "{features} {knots:?}: {off}, {step}");
            let audit = run("spinfo", &["--audit", "-"], &spline);
            assert!(audit.status.success(), "{:?}", outcome(&audit));
        }
    }
}

#[test]
fn creases_can_end_smoothly_and_corners_stand_alone() {
    let folder = Folder::new();
    let (knots, points) =
        (folder.write("knots.txt", knots()), folder.write("points.txt", points(6_000, 3, roof)));
    let all = folder.write("all.txt", "smooth-crease 43 20 43 60\ncorner 70 30\nlinear 15 60 30 65\n");
    let spline = output(&["fit", "--knots", &knots, "--features", &all, &points], &[]);
    let twin = String::from_utf8(run("spconvert", &["--to", "text"], &spline).stdout).unwrap();
    let count = |kind: &str| twin.lines().filter(|line| line.starts_with(kind)).count();
    assert!(count("function crease") > 1);
    // The knots of the border, the corner, and the ends of the linear element.
    assert!(count("function vertex") >= 20 + 1 + 2);
}

#[test]
fn features_that_cannot_be_are_refused() {
    let folder = Folder::new();
    let knots = folder.write("knots.txt", knots());
    let points = folder.write("points.txt", points(500, 3, roof));
    let cases = [
        ("crease 10 10 90 70\ncrease 10 70 90 10\n", 2, "crosses"),
        ("crease 10 10\n", 3, "line 1: found 1 vertices"),
        ("ridge 10 10 20 20\n", 3, "line 1: found \"ridge\""),
        ("{\"type\":\"Point\"}", 3, "feature 0"),
    ];
    for (text, code, part) in cases {
        let features = folder.write("features.txt", text);
        let found = run("splinefit", &["fit", "--knots", &knots, "--features", &features, &points], &[]);
        let (found, message) = outcome(&found);
        assert_eq!(found, Some(code), "{text}: {message}");
        assert!(message.contains(part) && !message.contains("panicked"), "{text}: {message}");
    }
    let features = folder.write("features.txt", "crease 43 20 43 60\n");
    let set = run("configgen", &[&knots], &[]).stdout;
    let found = run("splinefit", &["fit", "--knots", "-", "--features", &features, &points], &set);
    let (code, message) = outcome(&found);
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("configurations have their functions already"), "{message}");
}

#[test]
fn features_far_from_the_points_are_refused_before_they_take_memory() {
    let folder = Folder::new();
    let knots = folder.write("knots.txt", knots());
    let points = folder.write("points.txt", points(500, 3, roof));
    let ways: [&[&str]; 3] = [&["--knots", &knots], &["--step", "20"], &[]];
    for far in ["1e300", "-1e300", "1e9", "1e6", "1000"] {
        for way in ways {
            for text in [
                format!("# far\ncrease 10 10 20 {far}\n"),
                format!("\ncorner {far} 5\n"),
                format!("{{\"type\":\"LineString\",\"coordinates\":[[10,10],[20,{far}]]}}"),
            ] {
                let features = folder.write("features.txt", &text);
                let arguments = [&["fit", "--features", &features, &points], way].concat();
                let (code, message) = outcome(&run("splinefit", &arguments, &[]));
                assert_eq!(code, Some(2), "{arguments:?}: {message}");
                let place =
                    if text.starts_with('{') { "features.txt: feature 0" } else { "features.txt: line 2" };
                for part in [place, "is far from the points", "ogr2ogr -clipsrc"] {
                    assert!(message.contains(part), "{text} {way:?}: {message}");
                }
            }
        }
    }
    // A little outside is well.
    let features = folder.write("features.txt", "crease 43 -5 43 85\n");
    output(&["fit", "--step", "20", "--features", &features, &points], &[]);
}

#[test]
fn features_need_no_more_knots_than_asked_for() {
    let folder = Folder::new();
    let points = folder.write("points.txt", points(500, 3, roof));
    let vertices: String = (0..=70).map(|i| format!(" {} {}", 10 + i, 20 + i % 2)).collect();
    let features = folder.write("features.txt", format!("crease{vertices}\n"));
    let (code, message) =
        outcome(&run("splinefit", &["fit", "--max-knots", "40", "--features", &features, &points], &[]));
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("the features need 71 knots, at most 40"), "{message}");
    output(&["fit", "--max-knots", "80", "--features", &features, &points], &[]);
}

#[test]
fn features_are_in_the_system_of_the_points() {
    let folder = Folder::new();
    let points = folder.write("points.txt", points(500, 3, roof));
    let text = folder.write("ridge.txt", "crease 43 0 43 80\n");
    let crs = |code: u32| format!(r#""crs":{{"type":"name","properties":{{"name":"EPSG:{code}"}}}},"#);
    let line = r#""type":"LineString","coordinates":[[43,0],[43,80]]"#;
    let write = |name: &str, crs: &str| folder.write(name, format!("{{{crs}{line}}}"));
    let fit = |features: &str| {
        run(
            "splinefit",
            &["fit", "--step", "20", "--crs", "EPSG:25832", "--features", features, &points],
            &[],
        )
    };
    let expected = fit(&text).stdout;
    assert!(!expected.is_empty());
    assert!(fit(&write("same.geojson", &crs(25832))).stdout == expected);
    for (name, crs, part) in [
        ("other.geojson", crs(25833), "the lines are in EPSG:25833, the points in EPSG:25832 ("),
        ("degrees.geojson", String::new(), "the lines are in EPSG:4326 (GeoJSON without the member crs)"),
    ] {
        let (code, message) = outcome(&fit(&write(name, &crs)));
        assert_eq!(code, Some(2), "{message}");
        assert!(message.contains(part), "{message}");
    }
}
