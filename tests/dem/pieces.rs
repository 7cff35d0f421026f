//! Rasters of meshes that are made in parts or from several files have no seams.

use super::values;
use crate::programs::{Folder, outcome, run};
use spmesh_reference::sets::Random;

/// Points with two decimals, many of them on a grid, so that many are cocircular.
fn survey() -> Vec<[f64; 3]> {
    let mut random = Random::new(8);
    let mut point = |i: i64| match i % 2 {
        0 => [random.integer(0, 100) * 100, random.integer(0, 100) * 100, random.integer(0, 5_000)],
        _ => [random.integer(0, 10_000), random.integer(0, 10_000), random.integer(0, 5_000)],
    };
    (0..6_000).map(|i| point(i).map(|number| number as f64 / 100.0)).collect()
}

fn lines<'a>(points: impl IntoIterator<Item = &'a [f64; 3]>) -> String {
    points.into_iter().map(|[x, y, z]| format!("{x} {y} {z}\n")).collect()
}

fn succeeded(name: &str, arguments: &[&str], input: &[u8]) -> Vec<u8> {
    let output = run(name, arguments, input);
    let (code, message) = outcome(&output);
    assert_eq!(code, Some(0), "{name} {arguments:?}: {message}");
    output.stdout
}

fn raster(mesh: &[u8]) -> Vec<u8> {
    let text = succeeded("spdem", &["--step", "0.25", "--format", "asc"], mesh);
    assert!(values(&text).iter().filter(|value| !value.is_nan()).count() > 150_000);
    text
}

const DUPLICATES: [&str; 2] = ["--duplicates", "lowest"];

#[test]
fn rasters_of_merged_pieces_are_those_of_the_whole() {
    let (folder, points) = (Folder::new(), survey());
    let text = lines(&points);
    let stream = succeeded("spfinalize", &["--cell-points", "100", "-"], text.as_bytes());
    let whole = raster(&succeeded("spdelaunay2d", &DUPLICATES, &stream));
    for borders in [vec![-1.0, 50.0, 101.0], vec![-1.0, 31.7, 33.33, 101.0]] {
        let pieces: Vec<String> = borders
            .windows(2)
            .enumerate()
            .map(|(number, x)| {
                let region = format!("{},-1,{},101", x[0], x[1]);
                let arguments = [&DUPLICATES[..], &["--partial", "--region", &region]].concat();
                folder.write(&format!("{number}.spm"), succeeded("spdelaunay2d", &arguments, &stream))
            })
            .collect();
        let pieces: Vec<&str> = pieces.iter().map(String::as_str).collect();
        let merged = succeeded("spdelaunay2d", &[&["--merge"], &pieces[..]].concat(), b"");
        assert!(raster(&merged) == whole, "{borders:?}");
    }
}

#[test]
fn rasters_of_several_files_have_no_seams() {
    let (folder, points) = (Folder::new(), survey());
    let all = folder.write("all.xyz", lines(&points));
    let tile = |number: usize| {
        let inside =
            points.iter().filter(|[x, y, _]| usize::from(*x >= 40.0) + 2 * usize::from(*y >= 60.0) == number);
        folder.write(&format!("{number}.xyz"), lines(inside))
    };
    let tiles: Vec<String> = (0..4).map(tile).collect();
    let of = |names: &[&str]| {
        let stream = succeeded("spfinalize", &[&["--cell-points", "100"], names].concat(), b"");
        raster(&succeeded("spdelaunay2d", &DUPLICATES, &stream))
    };
    let names: Vec<&str> = tiles.iter().map(String::as_str).collect();
    let [a, b, c, d] = names[..] else { panic!("four tiles") };
    assert!(of(&[&all]) == of(&[a, b, c, d]) && of(&[&all]) == of(&[c, a, d, b]));
}
