//! `sptiles`: tiles of a level fit together, by decoders that share no code with the program.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde_json::Value;
use spmesh_base::random::Random;

use crate::programs::{Folder, assert_outcome, outcome, run};

const STEPS: f64 = 32_767.0;

/// Level, column and row.
type Name = (u32, u32, u32);

/// Points as bits, so that they are compared to the last one.
type Bits = [u64; 3];

/// The points on the west, south, east and north border of a tile, and its triangles' number.
struct Decoded {
    borders: [BTreeSet<Bits>; 4],
    triangles: usize,
}

/// Hills in EPSG:25832, around a corner of tiles.
fn hills(count: u32) -> String {
    let mut random = Random::new(17);
    let mut below = |end: u64| random.below(end) as f64 / 100.0;
    let mut text = String::new();
    for _ in 0..count {
        let (x, y) = (below(300_000), below(200_000));
        let z = 300.0 + 40.0 * (x / 300.0).sin() * (y / 200.0).cos() + below(100);
        text += &format!("{:.2} {:.2} {z:.2}\n", 566_000.0 + x, 5_930_000.0 + y);
    }
    text
}

fn mesh_of(points: &str, crs: &str) -> Vec<u8> {
    let points = run("spfinalize", &["-q", "--cell-points", "500", "--crs", crs, "-"], points.as_bytes());
    assert!(points.status.success(), "{:?}", outcome(&points));
    run("spdelaunay2d", &["-q"], &points.stdout).stdout
}

/// All files of a pyramid by their names.
fn pyramid(mesh: &[u8], flags: &[&str]) -> BTreeMap<String, Vec<u8>> {
    let folder = Folder::new();
    let out = folder.path("tiles");
    let made =
        run("sptiles", &[flags, &["-", "-q", "--memory", "128M", "--out-dir", out.as_str()]].concat(), mesh);
    assert!(made.status.success(), "{:?}", outcome(&made));
    let mut files = BTreeMap::new();
    collect(Path::new(&out), "", &mut files);
    files
}

fn collect(folder: &Path, start: &str, files: &mut BTreeMap<String, Vec<u8>>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let name = format!("{start}{}", entry.file_name().to_str().unwrap());
        match entry.file_type().unwrap().is_dir() {
            true => collect(&entry.path(), &format!("{name}/"), files),
            false => drop(files.insert(name, std::fs::read(entry.path()).unwrap())),
        }
    }
}

/// West, south, east and north of a tile of the geographic scheme.
fn sides((level, x, y): Name) -> [f64; 4] {
    let width = 180.0 / f64::from(1u32 << level);
    let [x, y] = [x, y].map(f64::from);
    [x * width - 180.0, y * width - 90.0, (x + 1.0) * width - 180.0, (y + 1.0) * width - 90.0]
}

/// A reader of little-endian numbers.
struct Bytes<'b>(&'b [u8]);

impl Bytes<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let (start, rest) = self.0.split_at(N);
        self.0 = rest;
        start.try_into().unwrap()
    }

    fn count(&mut self) -> usize {
        u32::from_le_bytes(self.take()) as usize
    }

    fn shorts(&mut self, count: usize) -> Vec<usize> {
        (0..count).map(|_| u16::from_le_bytes(self.take()).into()).collect()
    }

    fn deltas(&mut self, count: usize) -> Vec<i32> {
        let mut last = 0;
        let codes = self.shorts(count).into_iter().map(|code| code as i32);
        codes.map(|code| (last += (code >> 1) ^ -(code & 1), last).1).collect()
    }
}

fn quantized(bytes: &[u8], name: Name) -> Decoded {
    let mut bytes = Bytes(bytes);
    let centre = [0, 1, 2].map(|_| f64::from_le_bytes(bytes.take()));
    let [low, high] = [0, 1].map(|_| f64::from(f32::from_le_bytes(bytes.take())));
    let sphere = [0, 1, 2, 3].map(|_| f64::from_le_bytes(bytes.take()));
    let horizon = [0, 1, 2].map(|_| f64::from_le_bytes(bytes.take()));
    let length = |a: &[f64]| a.iter().map(|x| x * x).sum::<f64>().sqrt();
    assert!((6.3e6..6.4e6).contains(&length(&centre)) && sphere[3] > 0.0 && length(&horizon) >= 1.0 - 1e-9);
    let count = bytes.count();
    let [u, v, q] = [0, 1, 2].map(|_| bytes.deltas(count));
    assert!([&u, &v, &q].into_iter().flatten().all(|step| (0..=32_767).contains(step)));
    let triangles = bytes.count();
    let mut next = 0;
    for code in bytes.shorts(3 * triangles) {
        assert!(code <= next);
        next += usize::from(code == 0);
    }
    assert_eq!(next, count, "each vertex is in a triangle");
    let [west, south, east, north] = sides(name);
    let along = |step: i32, min: f64, max: f64| {
        let part = f64::from(step) / STEPS;
        if part == 1.0 { max } else { min + part * (max - min) }
    };
    let place = |number: usize| {
        let height = low + f64::from(q[number]) * (high - low) / STEPS;
        [along(u[number], west, east), along(v[number], south, north), height].map(f64::to_bits)
    };
    let on = [(&u, 0), (&v, 0), (&u, 32_767), (&v, 32_767)];
    let borders = on.map(|(axis, step)| {
        let stated: BTreeSet<usize> = (0..bytes.count()).map(|_| bytes.shorts(1)[0]).collect();
        assert!(stated.iter().copied().eq((0..count).filter(|&number| axis[number] == step)));
        stated.into_iter().map(place).collect()
    });
    Decoded { borders, triangles }
}

/// Positions that two neighbours share are on their border.
fn glb(bytes: &[u8]) -> (BTreeSet<Bits>, usize) {
    let len = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let json: Value = serde_json::from_slice(&bytes[20..20 + len]).unwrap();
    let shift = [0, 1, 2].map(|axis| json["nodes"][0]["translation"][axis].as_f64().unwrap());
    let binary = &bytes[28 + len..];
    let count = |number: usize| json["accessors"][number]["count"].as_u64().unwrap() as usize;
    let number = |at: usize| f64::from(f32::from_le_bytes(binary[at..at + 4].try_into().unwrap()));
    let place =
        |vertex: usize| [0, 1, 2].map(|axis| (number(12 * vertex + 4 * axis) + shift[axis]).to_bits());
    ((0..count(0)).map(place).collect(), count(1) / 3)
}

fn name_of(file: &str, ending: &str) -> Option<Name> {
    let parts: Vec<u32> = file.strip_suffix(ending)?.split('/').map(|part| part.parse().unwrap()).collect();
    Some((parts[0], parts[1], parts[2]))
}

#[test]
fn borders_of_neighbours_are_the_same_to_the_last_bit() {
    let files = pyramid(&mesh_of(&hills(3000), "EPSG:25832"), &["--tolerance", "0.5", "--normals"]);
    let tiles: BTreeMap<Name, Decoded> = files
        .iter()
        .filter_map(|(file, bytes)| name_of(file, ".terrain").map(|name| (name, quantized(bytes, name))))
        .collect();
    let mut shared = 0;
    for (&(level, x, y), tile) in &tiles {
        for (dx, dy, mine, theirs) in [(1, 0, 2, 0), (0, 1, 3, 1)] {
            // The first level has a flat square where no mesh is.
            let Some(other) = tiles.get(&(level, x + dx, y + dy)).filter(|_| level > 0) else { continue };
            assert!(
                tile.borders[mine] == other.borders[theirs],
                "{level}/{x}/{y} and the tile {dx} {dy} of it"
            );
            shared += tile.borders[mine].len();
        }
    }
    let finest = tiles.keys().next_back().unwrap().0;
    let of_finest = tiles.iter().filter(|(name, _)| name.0 == finest);
    assert!(shared > 500 && of_finest.clone().count() > 50, "{shared} {}", of_finest.count());
    assert!(of_finest.map(|(_, tile)| tile.triangles).sum::<usize>() > 3000);
    let layer: Value = serde_json::from_slice(&files["layer.json"]).unwrap();
    let mut named = BTreeSet::new();
    for (level, rectangles) in (0..).zip(layer["available"].as_array().unwrap()) {
        for rectangle in rectangles.as_array().unwrap() {
            let [x0, y0, x1, y1] =
                ["startX", "startY", "endX", "endY"].map(|key| rectangle[key].as_u64().unwrap() as u32);
            named.extend((x0..=x1).flat_map(|x| (y0..=y1).map(move |y| (level, x, y))));
        }
    }
    assert!(named.into_iter().eq(tiles.into_keys()));
}

#[test]
fn positions_of_gltf_on_borders_are_the_same_to_the_last_bit() {
    let files = pyramid(&mesh_of(&hills(3000), "EPSG:25832"), &["--tolerance", "0.5", "--to", "3dtiles"]);
    let quantized = pyramid(&mesh_of(&hills(3000), "EPSG:25832"), &["--tolerance", "0.5"]);
    let tiles: BTreeMap<Name, _> = files
        .iter()
        .filter_map(|(file, bytes)| name_of(file, ".glb").map(|name| (name, glb(bytes))))
        .collect();
    let finest = tiles.keys().next_back().unwrap().0;
    for (&(level, x, y), (positions, _)) in tiles.iter().filter(|(name, _)| name.0 == finest) {
        let Some((others, _)) = tiles.get(&(level, x + 1, y)) else { continue };
        // Quantized meshes have as many points there, but for those that their heights make one.
        let tile = &quantized[&format!("{level}/{x}/{y}.terrain")];
        let border = self::quantized(tile, (level, x, y)).borders[2].len();
        assert!(positions.intersection(others).count() >= border, "{level}/{x}/{y}");
    }
    let tileset: Value = serde_json::from_slice(&files["tileset.json"]).unwrap();
    let mut named = BTreeSet::new();
    let mut nodes = vec![&tileset["root"]];
    while let Some(node) = nodes.pop() {
        named.extend(node["content"]["uri"].as_str().and_then(|uri| name_of(uri, ".glb")));
        nodes.extend(node["children"].as_array().into_iter().flatten());
    }
    assert!(named.into_iter().eq(tiles.into_keys()));
}

#[test]
fn tiles_follow_from_the_set_of_points() {
    let points = hills(1500);
    let mut lines: Vec<&str> = points.lines().collect();
    lines.reverse();
    let reversed = lines.join("\n");
    for to in ["quantized-mesh", "3dtiles"] {
        let flags = ["--tolerance", "1", "--normals", "--to", to];
        let first = pyramid(&mesh_of(&points, "EPSG:25832"), &[&flags[..], &["--threads", "1"]].concat());
        assert!(
            first == pyramid(&mesh_of(&reversed, "EPSG:25832"), &[&flags[..], &["--threads", "2"]].concat())
        );
    }
}

#[test]
fn small_meshes_become_pyramids() {
    let of = |points: &str| pyramid(&mesh_of(points, "EPSG:4326"), &["--tolerance", "1", "--level-max", "3"]);
    // A triangle over four tiles of level 3, with a corner on a meridian between tiles.
    let files = of("-10 -5 100\n22.5 -5 200\n0 20 300\n");
    let tiles =
        files.iter().filter_map(|(file, bytes)| name_of(file, ".terrain").map(|name| quantized(bytes, name)));
    assert_eq!(
        (files.len(), tiles.map(|tile| tile.triangles).sum::<usize>() > 12),
        (15, true),
        "{:?}",
        files.keys()
    );
    // Points of one line, and none, have no triangles: there is a flat first level.
    for points in ["1 1 5\n2 2 5\n3 3 5\n", "1 1 5\n", "# none\n"] {
        let files = of(points);
        assert!(
            files.keys().eq(["0/0/0.terrain", "0/1/0.terrain", "layer.json"]),
            "{points:?} {:?}",
            files.keys()
        );
    }
}

#[test]
fn what_has_no_place_is_refused_with_a_remedy() {
    let folder = Folder::new();
    let refused = |points: &str, crs: &str, flags: &[&str], code: i32, part: &str| {
        let mesh = match crs {
            "" => {
                run("spdelaunay2d", &["-q"], &run("spfinalize", &["-q", "-"], points.as_bytes()).stdout)
                    .stdout
            }
            crs => mesh_of(points, crs),
        };
        let out = folder.path("tiles");
        let all = [&["-", "-q", "--out-dir", out.as_str(), "--tolerance", "1"][..], flags].concat();
        assert_outcome("sptiles", &all, &mesh, code, part);
        assert!(!Path::new(&out).join("layer.json").exists());
    };
    let near = "500000 5400000 1\n500100 5400000 2\n500000 5400100 3\n";
    refused(near, "", &[], 2, "give it with --crs");
    refused(near, "EPSG:31467", &[], 2, "is not near WGS 84");
    refused("-179.9 1 1\n179.9 1 2\n0 2 3\n", "EPSG:4326", &[], 2, "crosses longitude 180");
    refused(near, "EPSG:4326", &[], 3, "is the CRS right?");
    refused(near, "EPSG:25832", &["--level-max", "24"], 2, "beyond 23");
    let mesh = mesh_of(near, "EPSG:25832");
    let out = folder.path("negative");
    let negative = ["-", "--out-dir", out.as_str(), "--tolerance", "-1"];
    assert_outcome("sptiles", &negative, &mesh, 2, "give a number from 0 on");
}

#[test]
fn an_earlier_pyramid_is_not_replaced_in_parts() {
    let folder = Folder::new();
    let mesh = mesh_of("500000 5400000 1\n500100 5400000 2\n500000 5400100 3\n", "EPSG:25832");
    let out = folder.path("tiles");
    for (format, description) in [("quantized-mesh", "layer.json"), ("3dtiles", "tileset.json")] {
        let all = ["-", "-q", "--to", format, "--out-dir", &out, "--tolerance", "1"];
        assert_outcome("sptiles", &all, &mesh, 0, "");
        let before = std::fs::read(Path::new(&out).join(description)).unwrap();
        assert_outcome("sptiles", &all, &mesh, 2, "is there: remove the folder");
        assert!(std::fs::read(Path::new(&out).join(description)).unwrap() == before);
    }
}
