//! `spcanopy`: its raster against the steps that it consists of, one by one.

use spmesh_base::random::Random;

use crate::programs::{Folder, assert_outcome, outcome, run};
use crate::sources::las_file::{LasFile, Record, geo_keys};

/// Steps of 0.01 in all files.
const SCALE: f64 = 0.01;

/// A stand of cones on a slope. Some first returns reach far into them; some are below the ground, or noise.
fn forest() -> LasFile {
    let mut random = Random::new(21);
    let trees: Vec<[f64; 3]> =
        (0..12).map(|_| [40.0 * random.unit(), 40.0 * random.unit(), 8.0 + 12.0 * random.unit()]).collect();
    let mut file = LasFile::of(&[]);
    for _ in 0..6000 {
        let [x, y] = [40.0 * random.unit(), 40.0 * random.unit()];
        let crown = trees.iter().map(|[u, v, height]| height - 2.0 * (x - u).hypot(y - v));
        let top = crown.fold(0.0, f64::max);
        let height = if random.below(6) == 0 { top * random.unit() } else { top };
        let class = if random.below(200) == 0 { 7 } else { 5 };
        let height = if class == 7 { 60.0 } else { height - 0.05 };
        let (number, of) = if random.below(5) == 0 { (2, 2) } else { (1, 1) };
        file.records.push(Record {
            position: steps([x, y, ground_at(x) + height]),
            class,
            number,
            of,
            ..Record::default()
        });
    }
    file
}

fn ground_at(x: f64) -> f64 {
    100.0 + 0.25 * x
}

/// The mesh of the ground: wider than the stand.
fn ground() -> Vec<u8> {
    let corner = |x: i32, y: i32| steps([f64::from(x), f64::from(y), ground_at(f64::from(x))]);
    let mut places = Vec::new();
    for x in (-20..=60).step_by(20) {
        places.extend((-20..=60).step_by(20).map(|y| corner(x, y)));
    }
    let points = run("spfinalize", &["-q", "-"], &LasFile::of(&places).bytes());
    run("spdelaunay2d", &["-q"], &points.stdout).stdout
}

/// A place of the world in steps.
fn steps(place: [f64; 3]) -> [i32; 3] {
    place.map(|value| (value / SCALE).round() as i32)
}

/// The values of an ESRI grid; NaN for no data.
fn values(text: &[u8]) -> Vec<f32> {
    let text = std::str::from_utf8(text).unwrap();
    let words = text.lines().skip(6).flat_map(|line| line.split(' '));
    words
        .map(|word| word.parse().unwrap())
        .map(|value| if value == -9999.0 { f32::NAN } else { value })
        .collect()
}

/// A LAS file in which heights below zero are zero.
fn without_negative_heights(mut file: Vec<u8>) -> Vec<u8> {
    let start = u32::from_le_bytes(file[96..100].try_into().unwrap()) as usize;
    let record_len = usize::from(u16::from_le_bytes(file[105..107].try_into().unwrap()));
    for record in file[start..].chunks_exact_mut(record_len) {
        let height = i32::from_le_bytes(record[8..12].try_into().unwrap());
        record[8..12].copy_from_slice(&height.max(0).to_le_bytes());
    }
    file
}

fn succeed(name: &str, arguments: &[&str], input: &[u8]) -> Vec<u8> {
    let output = run(name, arguments, input);
    assert!(output.status.success(), "{name} {arguments:?}: {:?}", outcome(&output));
    output.stdout
}

/// The greatest of two values, of which one may be NaN.
fn highest(a: Vec<f32>, b: &[f32]) -> Vec<f32> {
    a.iter().zip(b).map(|(a, b)| a.max(*b)).collect()
}

/// Whether two rasters are the same, but for rounded heights.
fn alike(found: &[f32], expected: &[f32]) -> bool {
    let same = |(a, b): (&f32, &f32)| (a - b).abs() < 0.02 || a.is_nan() && b.is_nan();
    found.len() == expected.len() && found.iter().zip(expected).all(same)
}

#[test]
fn canopies_are_the_highest_of_their_layers() {
    let folder = Folder::new();
    folder.file("ground.spm", ground());
    folder.file("forest.laz", forest().compressed(1000));
    let (ground, file, heights) =
        (folder.path("ground.spm"), folder.path("forest.laz"), folder.path("heights.las"));
    succeed("spheight", &["-q", "--ground", &ground, &file, "--replace-z", "-o", &heights], &[]);
    folder.file("heights.las", without_negative_heights(std::fs::read(&heights).unwrap()));
    let cells = ["--step", "0.5", "--bounds", "0,0,40,40", "--format", "asc"];
    let layer = |filters: &[&str], flags: &[&str]| {
        let filters = [&["-q", "--first-only", "--drop-class", "7,18", &heights], filters].concat();
        let points = succeed("spfinalize", &filters, &[]);
        let mesh = succeed("spdelaunay2d", &["-q", "--duplicates", "highest"], &points);
        values(&succeed("spdem", &[&["-q"], &cells[..], flags].concat(), &mesh))
    };
    let bottom = layer(&[], &[]);
    let out = folder.path("canopy.asc");
    let canopy = |flags: &[&str]| {
        let cells = &cells[..4];
        succeed("spcanopy", &[&["-q", "--ground", &ground, &file, "-o", &out], cells, flags].concat(), &[]);
        values(&std::fs::read(&out).unwrap())
    };
    let mut expected = bottom.clone();
    for threshold in ["2,", "5,", "10,", "15,"] {
        expected = highest(expected, &layer(&["--keep-z", threshold], &["--kill", "2"]));
    }
    let found = canopy(&[]);
    assert!(alike(&found, &expected));
    // Pits are filled: cells that are far below their neighbours.
    let pits = |values: &[f32]| {
        let side = 80;
        let is_pit = |cell: &usize| {
            let around = [cell - 1, cell + 1, cell - side, cell + side];
            around.iter().filter(|&&other| values[other] > values[*cell] + 2.0).count() >= 3
        };
        (side + 1..values.len() - side - 1).filter(is_pit).count()
    };
    assert!(pits(&bottom) > 30 && pits(&found) * 10 < pits(&bottom), "{} {}", pits(&bottom), pits(&found));
    let two = canopy(&["--layers", "8", "--max-edge", "3"]);
    let expected = highest(bottom, &layer(&["--keep-z", "8,"], &["--kill", "3"]));
    assert!(alike(&two, &expected));
    // On a plane, elevations are its own and heights. Points below the ground stay there.
    let elevations = canopy(&["--elevations"]);
    for (cell, (elevation, height)) in elevations.iter().zip(&found).enumerate() {
        let ground = ground_at(0.5 * (cell % 80) as f64 + 0.25) as f32;
        assert_eq!(elevation.is_nan(), height.is_nan());
        let is_near = (-0.07..0.02).contains(&(elevation - ground - height));
        assert!(is_near || height.is_nan(), "{elevation} {height}");
    }
    // Noise has a class, and is too high.
    assert!(alike(&canopy(&["--drop-class", "2", "--max-height", "25"]), &found));
    assert!(!alike(&canopy(&["--drop-class", "2"]), &found));
    // Neither memory nor threads show.
    for flags in [["--memory", "80M", "--threads", "1"].as_slice(), &["--threads", "3"]] {
        let again = canopy(flags);
        assert!(again.iter().zip(&found).all(|(again, found)| again.to_bits() == found.to_bits()));
    }
}

#[test]
fn wrong_requests_are_refused() {
    let folder = Folder::new();
    folder.file("ground.spm", ground());
    folder.file("a.las", forest().bytes());
    let stated = LasFile { projection: vec![geo_keys(2154)], ..forest() };
    folder.file("b.las", stated.bytes());
    folder.file("c.xyz", "1 2 3\n4 5 6\n");
    let [ground, a, b, text, out] =
        ["ground.spm", "a.las", "b.las", "c.xyz", "out.tif"].map(|name| folder.path(name));
    let with = |more: &[&'static str]| {
        [&["--ground", &ground, &a, "-o", &out][..], more]
            .concat()
            .iter()
            .map(ToString::to_string)
            .collect::<Vec<_>>()
    };
    for (arguments, code, part) in [
        (with(&["--layers", "-1"]), 2, "--layers"),
        (with(&["--layers", "nan"]), 2, "--layers"),
        (with(&["--max-edge", "0"]), 2, "--max-edge"),
        (with(&["--step", "0"]), 2, "above zero"),
        (with(&["--memory", "64M", "--threads", "1"]), 5, "give 77M"),
    ] {
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        assert_outcome("spcanopy", &arguments, &[], code, part);
    }
    assert_outcome("spcanopy", &["--ground", &ground, "-o", &out], &[], 2, "no input");
    assert_outcome("spcanopy", &["--ground", &ground, &text, "-o", &out], &[], 3, "LAS");
    assert_outcome("spcanopy", &["--ground", &a, &a, "-o", &out], &[], 3, "a.las");
    assert_outcome("spcanopy", &["--ground", &ground, &a, "-o", &a], &[], 2, "replace the input");
    let mesh =
        run("spdelaunay2d", &["-q"], &run("spfinalize", &["-q", "--crs", "EPSG:32631", &a], &[]).stdout)
            .stdout;
    assert_outcome("spcanopy", &["--ground", "-", &b, "-o", &out], &mesh, 2, "coordinate reference system");
    assert_eq!(folder.names("").iter().filter(|name| name.starts_with("out")).count(), 0);
}

/// No points above the ground, or none at all.
#[test]
fn bare_ground_has_a_canopy_of_zero() {
    let folder = Folder::new();
    folder.file("ground.spm", ground());
    let places: Vec<[i32; 3]> =
        (0..100).map(|i| steps([f64::from(i % 10), f64::from(i / 10), 90.0])).collect();
    folder.file("low.las", LasFile::of(&places).bytes());
    folder.file("none.las", LasFile::of(&[]).bytes());
    let [ground, low, none, out] =
        ["ground.spm", "low.las", "none.las", "out.asc"].map(|name| folder.path(name));
    let canopy = |file: &str| {
        let flags = ["-q", "--ground", &ground, file, "--step", "1", "--bounds", "0,0,9,9", "-o", &out];
        succeed("spcanopy", &flags, &[]);
        values(&std::fs::read(&out).unwrap())
    };
    assert_eq!(canopy(&low), vec![0.0; 81]);
    let flags = ["--ground", &ground, &low, "--step", "1", "-o", &out];
    assert_outcome("spcanopy", &flags, &[], 0, "100 of 100 points are below the ground");
    assert!(canopy(&none).iter().all(|value| value.is_nan()));
}
