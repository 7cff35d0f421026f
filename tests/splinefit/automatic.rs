//! Fits without flags: knots that follow noise and density, places with several points, stretched
//! coordinates, and the domain.

use super::{output, rows, stats};
use crate::programs::{Folder, outcome, run};
use spmesh_reference::sets::Random;

/// Franke's function on the unit square.
pub(super) fn franke(x: f64, y: f64) -> f64 {
    let [a, b] = [9.0 * x, 9.0 * y];
    let bump = |u: f64, v: f64| (-(u * u + v * v)).exp();
    0.75 * bump((a - 2.0) / 2.0, (b - 2.0) / 2.0)
        + 0.75 * (-(a + 1.0).powi(2) / 49.0 - (b + 1.0) / 10.0).exp()
        + 0.5 * bump((a - 7.0) / 2.0, (b - 3.0) / 2.0)
        - 0.2 * bump(a - 4.0, b - 7.0)
}

/// Random places in the unit square, with values.
pub(super) fn sample(
    count: usize,
    seed: u64,
    mut value: impl FnMut(f64, f64, &mut Random) -> f64,
) -> Vec<[f64; 3]> {
    let mut random = Random::new(seed);
    let mut one = || {
        let [x, y] = [random.unit(), random.unit()];
        [x, y, value(x, y, &mut random)]
    };
    (0..count).map(|_| one()).collect()
}

/// Noise that is about normal, with a standard deviation of one.
pub(super) fn noise(random: &mut Random) -> f64 {
    (0..12).map(|_| random.unit()).sum::<f64>() - 6.0
}

pub(super) fn text(points: &[[f64; 3]]) -> String {
    points.iter().map(|[x, y, z]| format!("{x:?} {y:?} {z:?}\n")).collect()
}

/// The values of a spline at places.
fn values(spline: &[u8], places: &[[f64; 3]], kind: &str) -> Vec<f64> {
    let folder = Folder::new();
    let sites = folder.write("sites.txt", text(places));
    let found = rows(&output(&["eval", "-", "--at", &sites, "--kind", kind], spline));
    found.iter().map(|row| row[2]).collect()
}

/// The root mean square difference from the values of places in the domain, which most must be.
fn rms(spline: &[u8], places: &[[f64; 3]]) -> f64 {
    let found = values(spline, places, "value");
    let off: Vec<f64> =
        found.iter().zip(places).map(|(found, [.., z])| found - z).filter(|off| !off.is_nan()).collect();
    assert!(off.len() * 20 > places.len() * 19, "{} of {}", off.len(), places.len());
    (off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64).sqrt()
}

#[test]
fn knots_end_where_residuals_are_noise() {
    // A relief of a kilometre, known to five centimetres.
    let hill = |x: f64, y: f64| 1000.0 * (3.0 * x).sin() * (3.0 * y).sin();
    let points = sample(3_000, 1, |x, y, random| hill(x, y) + 0.05 * noise(random));
    let found = stats(&[], text(&points).as_bytes());
    assert_eq!(found["stop"], "noise", "{found}");
    assert!(found["functions"].as_u64().unwrap() < 3_000, "{found}");
    let told = found["noise"].as_f64().unwrap();
    assert!((0.045..0.055).contains(&told), "{told}");
    let run = run("splinefit", &["fit"], text(&points).as_bytes());
    assert!(outcome(&run).1.contains("more knots predict no better, what is left is noise"));
    let off = rms(&run.stdout, &sample(500, 2, |x, y, _| hill(x, y)));
    assert!(off < 0.07, "{off}");
}

#[test]
fn knots_end_where_residuals_are_rounding_errors() {
    // The side of the square, a corner, and the coefficients of the plane. Where coordinates have few digits,
    // values along a slope have.
    let planes = [
        (1.0, 0.0, [0.0, 3.0, -1.0]),
        (1.0, 0.0, [0.1, 0.0, 0.0]),
        (1e3, 0.0, [1e9, 2.0, 1.0]),
        (1e-3, 5e5, [0.0, 1.0, 1.0]),
    ];
    for (number, (side, corner, [c, a, b])) in planes.into_iter().enumerate() {
        let moved = |[x, y, _]: &[f64; 3]| {
            let [x, y] = [corner + side * x, corner + side * y];
            [x, y, c + a * x + b * y]
        };
        let points: Vec<[f64; 3]> = sample(2_000, 17, |_, _, _| 0.0).iter().map(moved).collect();
        let found = stats(&[], text(&points).as_bytes());
        assert_eq!(found["stop"], "rounding", "{number}: {found}");
        assert!(found["functions"].as_u64().unwrap() < 1_000, "{found}");
    }
    let points = text(&sample(500, 17, |x, y, _| x + y));
    let (_, message) = outcome(&run("splinefit", &["fit"], points.as_bytes()));
    assert!(message.contains("what is left are rounding errors of the values"), "{message}");
}

#[test]
fn errors_fall_with_the_cube_of_the_distance_where_there_is_no_noise() {
    let of = |count| {
        let points = sample(count, 3, |x, y, _| franke(x, y));
        let inner: Vec<[f64; 3]> =
            sample(400, 4, |_, _, _| 0.0).iter().map(|p| [0.1 + 0.8 * p[0], 0.1 + 0.8 * p[1], 0.0]).collect();
        let inner: Vec<[f64; 3]> = inner.iter().map(|&[x, y, _]| [x, y, franke(x, y)]).collect();
        rms(&output(&["fit", "-q"], text(&points).as_bytes()), &inner)
    };
    let [few, many] = [of(300), of(1_200)];
    assert!(few < 3e-3 && many < few / 6.0, "{few}, {many}");
}

#[test]
fn points_of_one_place_are_one_with_their_weight() {
    let mut random = Random::new(7);
    let (mut all, mut means, mut weights) = (Vec::new(), Vec::new(), String::new());
    for [x, y, z] in sample(60, 5, |x, y, _| franke(x, y)) {
        let count = 20 + (random.unit() * 10.0) as usize;
        let own: Vec<f64> = (0..count).map(|_| z + 0.1 * noise(&mut random)).collect();
        all.extend(own.iter().map(|&z| [x, y, z]));
        means.push([x, y, own.iter().sum::<f64>() / count as f64]);
        weights += &format!("{count}\n");
    }
    let folder = Folder::new();
    let weights = folder.write("weights.txt", weights);
    let found = run("splinefit", &["fit"], text(&all).as_bytes());
    let (code, message) = outcome(&found);
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("at 60 places; points of one place differ by "), "{message}");
    let known = output(&["fit", "-q", "--weights", &weights, "-"], text(&means).as_bytes());
    let [found, known] = [&found.stdout, &known].map(|spline| values(spline, &means, "value"));
    for (found, known) in found.iter().zip(known) {
        assert!((found - known).abs() < 1e-9, "{found}, {known}");
    }
    let told = stats(&[], text(&all).as_bytes())["pure_error"].as_f64().unwrap();
    assert!((0.09..0.11).contains(&told), "{told}");
}

#[test]
fn knots_follow_the_density_of_points() {
    let mut random = Random::new(8);
    let centres = [[0.0, 0.0], [0.0, 1000.0], [1000.0, 0.0]];
    let mut cluster = |count: usize| -> Vec<[f64; 3]> {
        let mut one = |[x, y]: [f64; 2]| {
            let [x, y] = [x + noise(&mut random), y + noise(&mut random)];
            [x, y, x.sin() * y.cos()]
        };
        centres.into_iter().flat_map(|centre| (0..count).map(|_| one(centre)).collect::<Vec<_>>()).collect()
    };
    let (points, sites) = (cluster(100), cluster(40));
    let spline = output(&["fit", "-q"], text(&points).as_bytes());
    let off = rms(&spline, &sites);
    assert!(off < 0.1, "{off}");
    let functions = stats(&[], text(&points).as_bytes())["functions"].as_u64().unwrap();
    assert!(functions < 40 * 300, "{functions}");
}

#[test]
fn very_different_sides_are_made_equal() {
    let points = sample(300, 9, |x, y, _| franke(x, y));
    let scaled = |points: &[[f64; 3]], by: f64| -> Vec<[f64; 3]> {
        points.iter().map(|&[x, y, z]| [x, by * y, z]).collect()
    };
    let sites = sample(100, 10, |x, y, _| franke(x, y));
    let square = rms(&output(&["fit", "-q"], text(&points).as_bytes()), &sites);
    for by in [1e-6, 10.0, 1e6] {
        let points = text(&scaled(&points, by));
        let found = run("splinefit", &["fit"], points.as_bytes());
        let (code, message) = outcome(&found);
        assert_eq!(code, Some(0), "{message}");
        assert!(message.contains("the sides of the box of points tell"), "{message}");
        let off = rms(&found.stdout, &scaled(&sites, by));
        assert!(off < 1.1 * square, "{by}: {off}, {square}");
        passes_audit(&found.stdout);
    }
    // Ten times slower along 30 degrees.
    let along = |x: f64, y: f64| (20.0 * (y * 0.75f64.sqrt() - 0.5 * x)).sin() + x;
    let points = text(&sample(300, 11, |x, y, _| along(x, y)));
    let sites = sample(100, 12, |x, y, _| along(x, y));
    let of = |flags: &[&str]| rms(&output(&[&["fit", "-q"], flags].concat(), points.as_bytes()), &sites);
    assert!(of(&["--anisotropy", "8:30"]) < 0.5 * of(&[]));
    assert_eq!(of(&["--anisotropy", "1"]), of(&[]));
}

fn passes_audit(spline: &[u8]) {
    let (code, message) = outcome(&run("spinfo", &["--audit"], spline));
    assert_eq!(code, Some(0), "{message}");
}

#[test]
fn stretched_splines_pass_the_audit() {
    for (number, origin) in [(18, [0.0, 0.0]), (19, [5e5, -3e6])] {
        let points = sample(200, number, |x, y, random| franke(x, y) + 0.01 * noise(random));
        let moved = points.iter().map(|[x, y, z]| [origin[0] + 300.0 * x, origin[1] + 200.0 * y, *z]);
        let points = text(&moved.collect::<Vec<_>>());
        for flags in [
            &["--anisotropy", "3.3"][..],
            &["--anisotropy", "7:30"],
            &["--anisotropy", "0.2:-77"],
            &["--anisotropy", "auto"],
            &["--anisotropy", "rescale", "--widen", "500"],
            &["--anisotropy", "2:60", "--step", "40"],
            &["--anisotropy", "2:60", "--tol", "0.05"],
        ] {
            passes_audit(&output(&[&["fit", "-q"], flags].concat(), points.as_bytes()));
        }
    }
}

#[test]
fn the_domain_is_the_hull_of_points_widened() {
    // A band along a diagonal.
    let band: Vec<[f64; 3]> =
        sample(200, 13, |_, _, _| 0.0).iter().map(|[x, y, _]| [*x, x + 0.02 * y, *x]).collect();
    let corners = [[0.1, 0.9, 0.0], [0.9, 0.1, 0.0], [0.5, 0.4, 0.0]];
    let spline = output(&["fit", "-q"], text(&band).as_bytes());
    assert!(values(&spline, &corners, "value").iter().all(|value| value.is_nan()));
    assert!(values(&spline, &band, "value").iter().all(|value| !value.is_nan()));
    let wide = output(&["fit", "-q", "--widen", "0.2"], text(&band).as_bytes());
    let found = values(&wide, &corners, "value");
    assert!(found[0].is_nan() && found[1].is_nan() && (found[2] - 0.5).abs() < 1e-6, "{found:?}");
}

#[test]
fn three_points_give_their_plane() {
    let points = [[0.6, 0.2, 0.8], [0.04, 0.016, 0.1], [0.8, 0.9, -0.2]];
    let spline = output(&["fit", "-q"], text(&points).as_bytes());
    let middle = [0, 1, 2].map(|axis| points.iter().map(|point| point[axis]).sum::<f64>() / 3.0);
    for (found, [.., z]) in values(&spline, &[points[0], middle], "value").iter().zip([points[0], middle]) {
        assert!((found - z).abs() < 1e-9, "{found}, {z}");
    }
}

#[test]
fn numbers_that_stand_for_no_value_are_named() {
    let mut points = sample(100, 14, |x, y, _| franke(x, y));
    points.extend([[0.5, 0.5, -9999.0], [0.2, 0.7, -9999.0], [0.1, 0.1, 1e30]]);
    let (code, message) = outcome(&run("splinefit", &["fit"], text(&points).as_bytes()));
    assert_eq!(code, Some(3), "{message}");
    assert!(message.contains("2 points have z = -9999, 1 point has z = 1e30"), "{message}");
    assert!(message.contains("--no-data -9999") && message.contains("--no-data 1e30"), "{message}");
    let flags = ["fit", "--no-data", "-9999", "--no-data", "1e30"];
    let found = run("splinefit", &flags, text(&points).as_bytes());
    let (code, message) = outcome(&found);
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("left out 3 points without data"), "{message}");
    assert_eq!(found.stdout, output(&["fit", "-q"], text(&points[..100]).as_bytes()));
}

#[test]
fn values_end_at_a_distance_or_go_on_linearly() {
    let folder = Folder::new();
    let points = sample(150, 25, |x, y, _| 2.0 * x - y);
    let (path, spline) = (folder.write("points.txt", text(&points)), folder.path("spline.spm"));
    output(&["fit", "-q", &path, "-o", &spline], &[]);
    let sites = [[0.5, 0.5], [1.2, 0.4], [-3.0, 2.0], [0.5, -1.0], [1.04, 0.5]];
    let list = folder.write("sites.txt", sites.map(|[x, y]| format!("{x} {y}\n")).concat());
    let of = |flags: &[&str]| -> Vec<Vec<f64>> {
        rows(&output(&[&["eval", &spline, "--at", &list], flags].concat(), &[]))
    };
    assert!((3..5).contains(&of(&[]).iter().filter(|row| row[2].is_nan()).count()));
    for ([x, y], row) in sites.iter().zip(of(&["--extrapolate", "linear"])) {
        assert!((row[2] - (2.0 * x - y)).abs() < 1e-9, "{row:?}");
    }
    let near = |[x, y]: &[f64; 2]| points.iter().any(|p| (p[0] - x).hypot(p[1] - y) <= 0.1);
    let found = of(&["--extrapolate", "linear", "--points", &path, "--max-distance", "0.1"]);
    for (site, row) in sites.iter().zip(found) {
        assert_eq!(row[2].is_nan(), !near(site), "{row:?}");
    }
    let (array, whole) = (folder.path("near.npy"), folder.path("whole.npy"));
    let grid = ["eval", &spline, "--step", "0.125", "--bounds", "-1,-1,2,2", "-o"];
    output(
        &[&grid[..], &[&array, "--points", &path, "--max-distance", "0.1", "--extrapolate", "linear"]]
            .concat(),
        &[],
    );
    output(&[&grid[..], &[&whole, "--extrapolate", "linear"]].concat(), &[]);
    let [array, whole] = [array, whole].map(|path| {
        let bytes = std::fs::read(path).unwrap();
        let numbers = bytes[bytes.len() - 24 * 24 * 8..].chunks_exact(8);
        numbers.map(|number| f64::from_le_bytes(number.try_into().unwrap())).collect::<Vec<f64>>()
    });
    for (cell, (near_value, value)) in array.iter().zip(&whole).enumerate() {
        let place = [(cell % 24) as f64 * 0.125 - 0.9375, 1.9375 - (cell / 24) as f64 * 0.125];
        assert!((value - (2.0 * place[0] - place[1])).abs() < 1e-9, "{place:?}: {value}");
        assert_eq!(near_value.is_nan(), !near(&place), "{place:?}");
    }
    let (code, message) =
        outcome(&run("splinefit", &["eval", &spline, "--at", &list, "--max-distance", "1"], &[]));
    assert_eq!(code, Some(2), "{message}");
}
