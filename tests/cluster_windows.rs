//! Windows of meshes in parts: products of a window equal those of the whole mesh, and the other parts are
//! not there; and what cannot be had of a part alone is refused.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::programs::{Folder, assert_outcome, outcome, run};
use crate::sources::las_file::LasFile;

/// A step of coordinates, so that centres of cells are exact.
const STEP: f64 = 1.0 / 128.0;
/// Tiles along a side, and the side of a tile in steps.
const TILES: i32 = 3;
const SIDE: i32 = 100;
/// Cells have a side of two steps.
const CELL: i32 = 2;
const CELL_SIDE: &str = "0.015625";

/// A box of the plane: x and y from, x and y to. Units: steps.
type Window = [i32; 4];

/// A mesh in parts, and the same mesh from one pipe.
struct Mesh {
    folder: Folder,
    manifest: Value,
    piped: String,
}

impl Mesh {
    /// A leaf for each tile of 378 points, with a hole in its middle.
    fn new() -> Mesh {
        let folder = Folder::new();
        let mut tiles = Vec::new();
        for (column, row) in (0..TILES).flat_map(|row| (0..TILES).map(move |column| (column, row))) {
            let position = |i: i32| {
                let (x, y) = (i * 79 % SIDE, (i * 57 + i / SIDE * 37) % SIDE);
                [column * SIDE + x, row * SIDE + y, (x * y) % 37 + 5 * column]
            };
            let is_far = |[x, y, _]: &[i32; 3]| (x % SIDE - 50).abs().max((y % SIDE - 50).abs()) > 9;
            let positions: Vec<[i32; 3]> = (0..400).map(position).filter(is_far).collect();
            tiles.push(folder.write(
                &format!("{column}{row}.las"),
                LasFile { scale: [STEP; 3], ..LasFile::of(&positions) }.bytes(),
            ));
        }
        let tiles: Vec<&str> = tiles.iter().map(String::as_str).collect();
        let [plan, parts, mesh] = ["plan.json", "parts", "mesh.json"].map(|name| folder.path(name));
        succeed("spfinalize", &[&["-q", "--plan", &plan, "--leaf-points", "500"][..], &tiles].concat(), &[]);
        succeed("spnode", &["collect", "-q", &plan, "-d", &parts, "-o", &mesh], &[]);
        let points = succeed("spfinalize", &[&["-q"], &tiles[..]].concat(), &[]);
        let piped = folder.write("piped.spm", succeed("spdelaunay2d", &["-q"], &points));
        let manifest = serde_json::from_slice(&fs::read(mesh).unwrap()).unwrap();
        Mesh { folder, manifest, piped }
    }

    /// The boxes of the leaves, and one across the corner where leaves meet.
    fn windows(&self) -> Vec<Window> {
        let leaves = self.parts().filter(|part| part["below"] == 0);
        let mut windows: Vec<Window> = leaves.filter_map(box_of).collect();
        assert_eq!(windows.len(), (TILES * TILES) as usize);
        windows.push([SIDE - 9, SIDE - 11, SIDE + 7, SIDE + 3]);
        windows
    }

    fn parts(&self) -> impl Iterator<Item = &Value> {
        self.manifest["parts"].as_array().unwrap().iter()
    }

    fn file_of(&self, part: &Value) -> String {
        self.folder.path(part["file"].as_str().unwrap())
    }

    /// Another folder that has the manifest, and only the parts that reach into the cells of a window, and
    /// into `reach` cells around them.
    fn only(&self, window: Window, reach: i32) -> (Folder, usize) {
        let (folder, [left, bottom, right, top]) = (Folder::new(), cells_of(window));
        let [left, bottom] = [left, bottom].map(|side| side - reach * CELL);
        let [right, top] = [right, top].map(|side| side + reach * CELL);
        let meets = |[x, y, max_x, max_y]: Window| x <= right && left <= max_x && y <= top && bottom <= max_y;
        let wanted: Vec<&Value> = self.parts().filter(|part| box_of(part).is_some_and(meets)).collect();
        for part in &wanted {
            folder.file(part["file"].as_str().unwrap(), fs::read(self.file_of(part)).unwrap());
        }
        folder.file("mesh.json", fs::read(self.folder.path("mesh.json")).unwrap());
        (folder, wanted.len())
    }
}

/// The box of a part; none without points.
fn box_of(part: &Value) -> Option<Window> {
    let corner = |end: usize, axis: usize| part["box"][end][axis].as_f64().map(|side| side as i32);
    Some([corner(0, 0)?, corner(0, 1)?, corner(1, 0)?, corner(1, 1)?])
}

/// The sides of the cells that cover a window.
fn cells_of([left, bottom, right, top]: Window) -> Window {
    let [left, bottom] = [left, bottom].map(|side| side.div_euclid(CELL) * CELL);
    let [right, top] = [right, top].map(|side| -(-side).div_euclid(CELL) * CELL);
    [left, bottom, right, top]
}

/// A box in the world, as flags take it.
fn text_of(window: Window) -> String {
    window.map(|side| format!("{}", f64::from(side) * STEP)).join(",")
}

fn succeed(tool: &str, arguments: &[&str], input: &[u8]) -> Vec<u8> {
    let output = run(tool, arguments, input);
    assert!(output.status.success(), "{tool} {arguments:?}: {:?}", outcome(&output));
    output.stdout
}

/// Points in a window, many of them above vertices and edges, with z above and below all of the mesh.
fn points_in([left, bottom, right, top]: Window) -> LasFile {
    let (width, height) = (right - left + 1, top - bottom + 1);
    let point = |i: i32| [left + i * 37 % width, bottom + i * 71 % height, (i * 53) % 900 - 100];
    let corners = [[left, bottom, 300], [right, top, 300]];
    let points: Vec<[i32; 3]> = (0..500).map(point).chain(corners).collect();
    LasFile { scale: [STEP; 3], ..LasFile::of(&points) }
}

/// All products of a mesh in a window, by their flags.
fn products(mesh: &str, window: Window, folder: &Folder) -> BTreeMap<String, Vec<u8>> {
    let bounds = text_of(window);
    let mut products = BTreeMap::new();
    for flags in [
        &[][..],
        &["--kind", "slope"],
        &["--kind", "aspect", "--method", "zevenbergen"],
        &["--kind", "slope", "--method", "triangle", "--kill", "0.1", "--fill", "4"],
        &["--kind", "hillshade"],
        &["--kill", "0.1", "--fill", "4"],
        &["--kind", "hillshade", "--kill", "0.1", "--fill", "2"],
        &["--sample", "mean"],
        &["--sample", "max", "--kind", "slope"],
    ] {
        let grid = ["-q", "--step", CELL_SIDE, "--format", "asc", "--bounds", &bounds, mesh];
        products.insert(flags.join(" "), succeed("spdem", &[&grid[..], flags].concat(), &[]));
    }
    let [x, y, max_x, max_y] = window.map(|side| f64::from(side) * STEP);
    let mask = format!("POLYGON(({x} {y},{max_x} {y},{max_x} {max_y},{x} {max_y},{x} {y}))");
    let mask = folder.write("mask.wkt", mask);
    let masked = ["-q", "--step", CELL_SIDE, "--format", "asc", "--kind", "slope", "--mask", &mask, mesh];
    products.insert("--mask".into(), succeed("spdem", &masked, &[]));
    let lines = ["-q", "--contours", "0.03", "--format", "geojsonl", "--mask", &mask, mesh];
    let text = String::from_utf8(succeed("spdem", &lines, &[])).unwrap();
    // Lines come in the order in which they become complete.
    let mut lines: Vec<&str> = text.lines().collect();
    lines.sort_unstable();
    products.insert("--contours".into(), lines.join("\n").into_bytes());
    let (las, output) = (folder.write("points.las", points_in(window).bytes()), folder.path("heights.las"));
    succeed("spheight", &["-q", "--ground", mesh, &las, "-o", &output], &[]);
    products.insert("spheight".into(), fs::read(&output).unwrap());
    let canopy = folder.path("canopy.asc");
    succeed("spcanopy", &["-q", "--ground", mesh, &las, "--step", CELL_SIDE, "-o", &canopy], &[]);
    products.insert("spcanopy".into(), fs::read(&canopy).unwrap());
    products
}

#[test]
fn products_of_a_window_are_those_of_the_whole_mesh() {
    let mesh = Mesh::new();
    for window in mesh.windows() {
        // Holes are filled from four cells away, and slopes there follow from the next ones.
        let (few, count) = mesh.only(window, 5);
        assert!(count <= mesh.parts().count(), "{window:?}");
        let expected = products(&mesh.piped, window, &few);
        for (flags, found) in products(&few.path("mesh.json"), window, &few) {
            assert!(found == expected[&flags], "{window:?} {flags}: {}", String::from_utf8_lossy(&found));
        }
    }
}

#[test]
fn the_inside_of_a_leaf_needs_the_parts_above_it_alone() {
    let mesh = Mesh::new();
    for [left, bottom, right, top] in mesh.windows() {
        let window = [left + 2 * CELL, bottom + 2 * CELL, right - 2 * CELL, top - 2 * CELL];
        let (few, count) = mesh.only(window, 0);
        let is_across = right - left < SIDE / 2;
        assert!(is_across || count <= 4, "{count} of {} parts", mesh.parts().count());
        succeed(
            "spdem",
            &["-q", "--step", CELL_SIDE, "--bounds", &text_of(window), &few.path("mesh.json")],
            &[],
        );
    }
    // There is nothing to read where the mesh is not.
    let far = [-900, -900, -800, -800];
    let (few, count) = mesh.only(far, 0);
    assert_eq!(count, 0);
    let last = mesh.parts().last().unwrap();
    few.file(last["file"].as_str().unwrap(), fs::read(mesh.file_of(last)).unwrap());
    let blank =
        ["-q", "--step", CELL_SIDE, "--bounds", &text_of(far), "--format", "asc", &few.path("mesh.json")];
    let text = String::from_utf8(succeed("spdem", &blank, &[])).unwrap();
    assert!(text.lines().skip(6).flat_map(str::split_whitespace).all(|cell| cell == "-9999"), "{text}");
}

/// Rows of cells of an ESRI grid.
fn rows_of(text: &[u8]) -> Vec<Vec<String>> {
    let text = String::from_utf8_lossy(text);
    text.lines().skip(6).map(|line| line.split_whitespace().map(str::to_string).collect()).collect()
}

/// The cells of a window are those of the whole raster, also at its border: of a mesh in parts, and of one
/// stream.
#[test]
fn rasters_of_windows_are_one_raster() {
    let mesh = Mesh::new();
    let all = [0, 0, TILES * SIDE, TILES * SIDE];
    for flags in [
        &["--kind", "slope"][..],
        &["--kill", "0.1", "--fill", "4"],
        &["--kill", "0.1", "--fill", "3", "--kind", "slope", "--method", "triangle"],
        &["--kill", "0.1", "--fill", "2", "--kind", "hillshade"],
    ] {
        let drawn = |[left, bottom, right, top]: Window, others: &[&str]| {
            // From centre to centre, so that no rounding adds a cell.
            let bounds = text_of([left + 1, bottom + 1, right - 1, top - 1]);
            let grid = ["-q", "--step", CELL_SIDE, "--bounds", &bounds, "--format", "asc"];
            succeed("spdem", &[&grid[..], flags, others].concat(), &[])
        };
        let whole = rows_of(&drawn(all, &[&mesh.piped]));
        let mut known = 0;
        for window in mesh.windows().into_iter().map(cells_of) {
            let [left, bottom, right, top] = window;
            let (few, _) = mesh.only(window, 5);
            let bytes = drawn(window, &[&few.path("mesh.json")]);
            let found = rows_of(&bytes);
            for (row, y) in (bottom..top).step_by(CELL as usize).rev().enumerate() {
                for (column, x) in (left..right).step_by(CELL as usize).enumerate() {
                    let from_top = ((all[3] - y) / CELL - 1) as usize;
                    let expected = whole.get(from_top).and_then(|cells| cells.get((x / CELL) as usize));
                    let expected = expected.map_or("-9999", String::as_str);
                    assert_eq!(found[row][column], expected, "{flags:?} {window:?}: {x}, {y}");
                    known += usize::from(expected != "-9999");
                }
            }
            assert!(drawn(window, &[&mesh.piped]) == bytes, "{flags:?} {window:?}");
            let sheet = few.path("sheet.asc");
            drawn(window, &[&mesh.piped, "--tiles", "1,1", "-o", &sheet]);
            assert!(fs::read(few.path("sheet_0_0.asc")).unwrap() == bytes, "{flags:?} {window:?}");
            drawn(window, &[&mesh.piped, "--tiles", "2,1", "-o", &sheet]);
            let [west, east] =
                ["sheet_0_0.asc", "sheet_1_0.asc"].map(|name| rows_of(&fs::read(few.path(name)).unwrap()));
            assert!(west.into_iter().zip(east).map(|(west, east)| [west, east].concat()).eq(found));
        }
        assert!(known > 15_000, "{flags:?}: {known}");
    }
}

#[test]
fn pictures_of_a_window_are_those_of_the_whole_mesh() {
    let mesh = Mesh::new();
    // The order of triangles is that of the parts, and the title has the name of the file.
    let joined = succeed("spconvert", &["--to", "spm", &mesh.folder.path("mesh.json")], &[]);
    let whole = Folder::new();
    let whole = whole.file("mesh.json", joined).display().to_string();
    for window in mesh.windows().into_iter().step_by(3) {
        let (few, _) = mesh.only(window, 0);
        for flags in [&[][..], &["--raster"], &["--fill", "none"]] {
            let bounds = text_of(window);
            let picture = |input: &str| {
                let window = ["-q", "--format", "svg", "--bounds", &bounds, input];
                succeed("spview", &[&window[..], flags].concat(), &[])
            };
            let (found, expected) = (picture(&few.path("mesh.json")), picture(&whole));
            assert!(found == expected, "{window:?} {flags:?}");
        }
    }
}

#[test]
fn products_that_need_everything_read_everything() {
    let mesh = Mesh::new();
    let window = mesh.windows()[4];
    let (few, bounds) = (mesh.only(window, 0).0, text_of(window));
    let (manifest, las) = (few.path("mesh.json"), few.write("points.las", points_in(window).bytes()));
    let output = few.path("heights.las");
    let near = ["--ground", &manifest, &las, "--outside", "nearest", "-o", &output];
    for (tool, flags) in [
        ("spdem", &["--step", CELL_SIDE, "--bounds", &bounds, "--concave", "0.2", &manifest][..]),
        ("spview", &["--bounds", &bounds, "--fill", "time", &manifest]),
        ("spview", &["--bounds", &bounds, "--at", "0.5", &manifest]),
        ("spheight", &near),
    ] {
        assert_outcome(tool, flags, &[], 1, ".spm");
    }
}

#[test]
fn points_outside_of_the_box_of_their_header_are_refused() {
    let mesh = Mesh::new();
    let (window, manifest) = (mesh.windows()[0], mesh.folder.path("mesh.json"));
    let mut las = points_in(window).bytes();
    // The greatest x.
    las[179..187].copy_from_slice(&0.5f64.to_le_bytes());
    let (las, output) = (mesh.folder.write("wrong.las", las), mesh.folder.path("heights.las"));
    let heights = ["--ground", &manifest, &las, "-o", &output];
    assert_outcome("spheight", &heights, &[], 3, "wrong.las: points lie outside of the box");
    let canopy = ["--ground", &manifest, &las, "--step", CELL_SIDE, "-o", &mesh.folder.path("canopy.tif")];
    assert_outcome("spcanopy", &canopy, &[], 3, "points lie outside of the box");
    let whole = ["--ground", &mesh.piped, &las, "-o", &output];
    assert_outcome("spheight", &whole, &[], 0, "");
}

#[test]
fn a_part_alone_is_refused_where_its_neighbours_count() {
    let mesh = Mesh::new();
    let part = mesh.file_of(mesh.parts().next().unwrap());
    let las = mesh.folder.write("points.las", points_in(mesh.windows()[0]).bytes());
    let [output, lines] = ["output.las", "lines.geojson"].map(|name| mesh.folder.path(name));
    let line = "{\"type\":\"LineString\",\"coordinates\":[[0.1,0.1],[0.7,0.8]]}";
    let roads = mesh.folder.write("roads.geojson", line);
    let grid = ["--step", CELL_SIDE, "--bounds", "0,0,1,1", &part];
    for flags in [
        &["--kind", "slope"][..],
        &["--kind", "aspect"],
        &["--kind", "hillshade"],
        &["--kind", "shaded-relief"],
        &["--kind", "shaded-relief", "--range", "0,1"],
        &["--fill", "2"],
        &["--concave", "1"],
        &["--sample", "mean"],
    ] {
        assert_outcome("spdem", &[&grid[..], flags].concat(), &[], 2, "give the manifest");
    }
    for (tool, flags) in [
        ("spdem", &["--contours", "0.05", &part, "-o", &lines][..]),
        ("spheight", &["--ground", &part, &las, "-o", &output]),
        ("spheight", &["--ground", &part, &las, "--replace-z", "-o", &output]),
        ("spcanopy", &["--ground", &part, &las, "--step", CELL_SIDE]),
        ("spconstrain", &["--lines", &roads, &part]),
        ("spconstrain", &["--kill", "1", &part]),
        ("spview", &["--concave", "1", &part]),
    ] {
        assert_outcome(tool, flags, &[], 2, "give the manifest");
    }
    assert!(!Path::new(&output).exists() && !Path::new(&lines).exists());
    for flags in [&[][..], &["--kind", "slope", "--method", "triangle"], &["--kill", "1"]] {
        succeed("spdem", &[&grid[..], flags].concat(), &[]);
    }
    succeed("spview", &["-q", &part], &[]);
    succeed("spconvert", &["--to", "text", &part], &[]);
}
