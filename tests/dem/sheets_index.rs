//! What describes the rasters of `--tiles`, and what stands beside rasters or in their tags.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::values;
use crate::programs::{Folder, assert_outcome, cloud, mesh_of_cloud, outcome, run};

/// Cells of an ESRI grid: numbers of columns and rows, least x and y, and the values.
fn grid(text: &[u8]) -> ([usize; 2], [f64; 2], Vec<f32>) {
    let number = |line: usize| -> f64 {
        let line = std::str::from_utf8(text).unwrap().lines().nth(line).unwrap();
        line.split(' ').nth(1).unwrap().parse().unwrap()
    };
    ([0, 1].map(|line| number(line) as usize), [2, 3].map(number), values(text))
}

/// The values of attributes of an element, which is the first of its name.
fn attributes<const N: usize>(xml: &str, element: &str, names: [&str; N]) -> [usize; N] {
    let (_, rest) = xml.split_once(&format!("<{element} ")).unwrap();
    names.map(|name| {
        let (_, value) = rest.split_once(&format!("{name}=\"")).unwrap();
        value.split_once('"').unwrap().0.parse().unwrap()
    })
}

fn element<'x>(xml: &'x str, name: &str) -> &'x str {
    xml.split_once(&format!("<{name}>")).unwrap().1.split_once(&format!("</{name}>")).unwrap().0
}

#[test]
fn a_virtual_raster_of_tiles_is_the_whole() {
    let (folder, mesh) = (Folder::new(), mesh_of_cloud(300));
    let write = |flags: &[&str], name: &str| {
        let path = folder.path(name);
        let all: Vec<&str> = ["--step", "500", "--kill", "20000", "--crs", "EPSG:32610"]
            .into_iter()
            .chain(flags.iter().copied())
            .chain(["-o", &path])
            .collect();
        let output = run("spdem", &all, &mesh);
        assert!(output.status.success(), "{:?}", outcome(&output));
    };
    write(&[], "whole.asc");
    write(&["--tiles", "30000", "--buffer", "1500", "--full", "--tile-index", "vrt,gti"], "t/a & b.asc");
    let ([columns, rows], [left, bottom], expected) = grid(&fs::read(folder.path("whole.asc")).unwrap());
    let vrt = fs::read_to_string(folder.path("t/a & b.vrt")).unwrap();
    let [across, down] = attributes(&vrt, "VRTDataset", ["rasterXSize", "rasterYSize"]);
    let mut found = vec![f32::NAN; across * down];
    for source in vrt.split("<ComplexSource>").skip(1) {
        let (_, name) = source.split_once("<SourceFilename relativeToVRT=\"1\">").unwrap();
        let name = name.split_once('<').unwrap().0.replace("&amp;", "&");
        let (size, _, cells) = grid(&fs::read(folder.path(&format!("t/{name}"))).unwrap());
        let [x, y, width, height] = attributes(source, "DstRect", ["xOff", "yOff", "xSize", "ySize"]);
        assert_eq!([width, height], size);
        for (at, value) in cells.into_iter().enumerate().filter(|(_, value)| !value.is_nan()) {
            found[(y + at / width) * across + x + at % width] = value;
        }
    }
    let place: Vec<f64> =
        element(&vrt, "GeoTransform").split(", ").map(|word| word.parse().unwrap()).collect();
    let [x, y] = [(left - place[0]) / 500.0, (place[3] - bottom) / 500.0 - rows as f64].map(|n| n as usize);
    for (row, expected) in expected.chunks_exact(columns).enumerate() {
        assert!(super::is_same(&found[(y + row) * across + x..][..columns], expected), "{row}");
    }
    let known = |values: &[f32]| values.iter().filter(|value| !value.is_nan()).count();
    assert_eq!(known(&found), known(&expected));
    assert!(element(&vrt, "SRS") == "EPSG:32610");

    // The GTI has the place of the VRT, and the files of the GeoJSON.
    let gti = fs::read_to_string(folder.path("t/a & b.gti")).unwrap();
    let index = element(&gti, "IndexDataset").replace("&amp;", "&");
    assert!(Path::new(&index).is_absolute() && Path::new(&index).ends_with("t/a & b.geojson"), "{index}");
    assert_eq!(element(&gti, "GeoTransform").replace(',', ", "), element(&vrt, "GeoTransform"));
    assert_eq!([element(&gti, "XSize"), element(&gti, "YSize")], [across, down].map(|n| n.to_string()));
    let index: Value = serde_json::from_slice(&fs::read(folder.path("t/a & b.geojson")).unwrap()).unwrap();
    assert_eq!(index["crs"]["properties"]["name"], "urn:ogc:def:crs:EPSG::32610");
    let features = index["features"].as_array().unwrap();
    assert_eq!(features.len(), vrt.matches("<ComplexSource>").count());
    for feature in features {
        let name = feature["properties"]["location"].as_str().unwrap();
        assert_eq!(feature["properties"]["name"], name.trim_end_matches(".asc"));
        let ([columns, rows], [left, bottom], _) =
            grid(&fs::read(folder.path(&format!("t/{name}"))).unwrap());
        let ring: Vec<[f64; 2]> =
            serde_json::from_value(feature["geometry"]["coordinates"][0].clone()).unwrap();
        let (right, top) = (left + 500.0 * columns as f64, bottom + 500.0 * rows as f64);
        let corners = [[left, bottom], [right, bottom], [right, top], [left, top], [left, bottom]];
        assert_eq!(ring, corners, "{name}");
    }
}

#[test]
fn collections_state_places_in_degrees_only_where_these_are_known() {
    let folder = Folder::new();
    let degrees: String = cloud(100)
        .lines()
        .map(|line| {
            let numbers: Vec<f64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
            format!("{} {} {}\n", 7.0 + numbers[0] / 1e6, 46.0 + numbers[1] / 1e6, numbers[2])
        })
        .collect();
    let points = run("spfinalize", &["-"], degrees.as_bytes()).stdout;
    let mesh = run("spdelaunay2d", &[], &points).stdout;
    let json =
        |name: &str| -> Value { serde_json::from_slice(&fs::read(folder.path(name)).unwrap()).unwrap() };
    for (crs, is_placed) in [("EPSG:4326", true), ("EPSG:4258", false)] {
        let path = folder.path("s/dem.tif");
        let flags = [
            "--step",
            "0.002",
            "--tiles",
            "0.02",
            "--tile-index",
            "stac",
            "--date",
            "2021-06-15",
            "--crs",
            crs,
        ];
        let output = run("spdem", &[&flags[..], &["-o", &path]].concat(), &mesh);
        assert!(output.status.success(), "{:?}", outcome(&output));
        let collection = json("s/dem.collection.json");
        let place = &collection["extent"]["spatial"]["bbox"][0];
        let links = collection["links"].as_array().unwrap();
        let items: Vec<&str> = links
            .iter()
            .filter(|link| link["rel"] == "item")
            .map(|link| link["href"].as_str().unwrap().trim_start_matches("./"))
            .collect();
        let tiles = folder.names("s").into_iter().filter(|name| name.ends_with(".tif"));
        assert_eq!(tiles.map(|name| name.replace(".tif", ".json")).collect::<Vec<_>>().len(), items.len());
        for name in items {
            let item = json(&format!("s/{name}"));
            let bounds = &item["properties"]["proj:bbox"];
            assert_eq!(item["properties"]["proj:code"], crs);
            assert_eq!(item["properties"]["datetime"], "2021-06-15T00:00:00Z");
            assert_eq!(item["bbox"], if is_placed { bounds.clone() } else { Value::Null });
            assert_eq!(item["geometry"].is_null(), !is_placed);
            let corner: Vec<f64> =
                name.trim_end_matches(".json").split('_').skip(1).map(|word| word.parse().unwrap()).collect();
            assert!((bounds[0].as_f64().unwrap() - corner[0]).abs() < 0.0201, "{name} {bounds}");
            assert!(item["assets"]["data"]["href"] == format!("./{}", name.replace(".json", ".tif")));
        }
        let west = place[0].as_f64().unwrap();
        assert!(if is_placed { (6.9..7.0001).contains(&west) } else { west == -180.0 }, "{place}");
        fs::remove_dir_all(folder.path("s")).unwrap();
    }
}

#[test]
fn items_of_tiles_without_data_are_removed() {
    let (folder, mesh) = (Folder::new(), mesh_of_cloud(30));
    let (path, old) = (folder.path("t/a.tif"), folder.file("t/a_200000_0.json", "old"));
    let flags = ["--step", "2000", "--tiles", "50000", "--tile-index", "stac", "--date", "2021-06-15"];
    let bounds = ["--bounds", "0,0,240000,90000", "-o", &path];
    assert_outcome("spdem", &[&flags[..], &bounds[..]].concat(), &mesh, 0, "without data were not written");
    assert!(!old.exists() && folder.names("t").contains(&"a_0_0.json".to_string()));
}

#[test]
fn wrong_indexes_and_numbers_are_refused() {
    let (folder, mesh) = (Folder::new(), mesh_of_cloud(30));
    let path = folder.path("a.tif");
    let refused = |flags: &[&str], part: &str| {
        let all: Vec<&str> = ["--step", "5000"].iter().chain(flags).copied().chain(["-o", &path]).collect();
        assert_outcome("spdem", &all, &mesh, 2, part);
    };
    refused(&["--tile-index", "vrt"], "--tiles");
    refused(&["--tiles", "1,1", "--tile-index", "shp"], "[possible values: vrt, gti, geojson, stac]");
    refused(&["--tiles", "1,1", "--tile-index", "stac"], "give --date");
    refused(
        &["--tiles", "1,1", "--tile-index", "stac", "--date", "2021-02-30"],
        "expected a day or a second in UTC",
    );
    refused(&["--type", "byte", "--scale", "0.1"], "give another --type, --scale or --offset");
    refused(&["--type", "int16", "--no-data", "nan"], "int16 holds integers from -32768 to 32767");
    refused(&["--type", "int16", "--scale", "0"], "the scale must be above zero");
    refused(&["--scale", "0.1"], "--type");
    refused(&["--type", "float32", "--scale", "0.1"], "are for integers");
    refused(&["--type", "int16", "--predictor", "float"], "take horizontal");
    refused(&["--compression", "none", "--predictor", "float"], "leave out --predictor");
    refused(&["--type", "int16", "--format", "asc"], "are for GeoTIFF");
    refused(&["--kind", "hillshade", "--type", "int16"], "pictures are bytes");
    refused(&["--contours", "5", "--type", "int16"], "cannot be used with");
    refused(&["--no-data", "1e39"], "a finite number of 32 bits");
    refused(&["--kind", "slope", "--crs", "EPSG:4326"], "give --z-factor");
    refused(&["--kind", "slope", "--z-factor", "0"], "--z-factor takes a number above zero");
    refused(&["--z-factor", "2"], "--z-factor is for slopes");
    assert_eq!(folder.names(""), Vec::<String>::new());
}

#[test]
fn slopes_over_degrees_take_a_factor() {
    let (folder, mesh) = (Folder::new(), mesh_of_cloud(100));
    let slopes = |flags: &[&str]| {
        let path = folder.path("slope.asc");
        let all: Vec<&str> = ["-q", "--step", "2000", "--kind", "slope"]
            .iter()
            .chain(flags)
            .copied()
            .chain(["-o", &path])
            .collect();
        let output = run("spdem", &all, &mesh);
        assert!(output.status.success(), "{:?}", outcome(&output));
        values(&fs::read(&path).unwrap())
    };
    for method in ["horn", "triangle"] {
        let plain = slopes(&["--method", method]);
        let scaled = slopes(&["--method", method, "--z-factor", "300", "--crs", "EPSG:4326"]);
        let expected = |slope: &f32| (f64::from(*slope).to_radians().tan() * 300.0).atan().to_degrees();
        assert!(plain.iter().any(|slope| *slope > 0.01));
        for (slope, scaled) in plain.iter().zip(&scaled) {
            assert_eq!(slope.is_nan(), scaled.is_nan());
            assert!(
                slope.is_nan() || (expected(slope) - f64::from(*scaled)).abs() < 1e-4,
                "{slope} {scaled}"
            );
        }
    }
}

#[test]
fn an_esri_grid_has_its_system_beside_it() {
    let (folder, mesh) = (Folder::new(), mesh_of_cloud(30));
    let path = folder.path("a.asc");
    let text = "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],\
                PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]";
    let flags = ["--step", "5000", "--crs", text];
    assert_outcome("spdem", &[&flags[..], &["-q", "-o", &path]].concat(), &mesh, 0, "");
    assert_eq!(fs::read_to_string(folder.path("a.prj")).unwrap().trim_end(), text);
    // The text of the EPSG dataset is WKT 2, which programs do not read there: version 1 says the same.
    let utm = folder.path("utm.asc");
    assert_outcome("spdem", &["--step", "5000", "--crs", "EPSG:32610", "-q", "-o", &utm], &mesh, 0, "");
    let text = fs::read_to_string(folder.path("utm.prj")).unwrap();
    assert!(
        text.starts_with("PROJCS[\"WGS 84 / UTM zone 10N\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\""),
        "{text}"
    );
    assert!(text.contains("PARAMETER[\"central_meridian\",-123]"), "{text}");
    // It has no name for this projection.
    let other = folder.path("b.asc");
    let lost = "an ESRI grid cannot hold the coordinate reference system EPSG:3857";
    assert_outcome("spdem", &["--step", "5000", "--crs", "EPSG:3857", "-o", &other], &mesh, 0, lost);
    assert!(!folder.names("").contains(&"b.prj".to_string()));
    let input = folder.write("a.spm", &mesh);
    assert_outcome("spdem", &[&flags[..], &["--format", "asc", &input]].concat(), b"", 0, "with -o NAME.asc");
    assert_outcome("spdem", &["--step", "5000", "-o", &folder.path("c.asc")], &mesh, 0, "");
    assert!(!folder.names("").contains(&"c.prj".to_string()));
}
