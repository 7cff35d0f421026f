//! Coordinate reference systems mean the same, whatever they are written in.

use std::fs;

use spmesh_base::error::ErrorKind;
use spmesh_base::random::Random;
use spmesh_formats::crs::{GeoKeys, Horizontal, Kind, System, Unit, differences, geotiff_keys, requested};
use spmesh_stream::Crs;

use crate::programs::{Folder, outcome, run};

fn wkt(text: &str) -> System {
    System::of(&Crs::Wkt(text.to_string()))
}

fn code(code: &str) -> System {
    System::of(&requested(code).unwrap())
}

/// The keys as a LAS file holds them.
fn crs_of(keys: &GeoKeys) -> Crs {
    Crs::GeoKeys {
        directory: keys.directory.iter().flat_map(|number| number.to_le_bytes()).collect(),
        doubles: keys.doubles.iter().flat_map(|number| number.to_le_bytes()).collect(),
        ascii: keys.texts.clone().into_bytes(),
    }
}

fn of_keys(directory: &[[u16; 4]], doubles: &[f64], texts: &str) -> System {
    let head = [1, 1, 0, directory.len() as u16];
    System::of(&crs_of(&GeoKeys {
        directory: [&head, directory.as_flattened()].concat(),
        doubles: doubles.to_vec(),
        texts: texts.to_string(),
    }))
}

/// The value of a key that is in its entry.
fn short(keys: &GeoKeys, wanted: u16) -> Option<u16> {
    keys.directory.chunks(4).skip(1).find(|key| key[0] == wanted).map(|key| key[3])
}

fn written(system: &System) -> (GeoKeys, Vec<String>) {
    geotiff_keys(system, true)
}

/// ESRI's text of EPSG:2992: no codes, other names, and feet.
const ESRI: &str = r#"PROJCS["NAD_1983_Oregon_Statewide_Lambert_Feet_Intl",GEOGCS["GCS_North_American_1983",DATUM["D_North_American_1983",SPHEROID["GRS_1980",6378137.0,298.257222101]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.017453292519943295]],PROJECTION["Lambert_Conformal_Conic"],PARAMETER["False_Easting",1312335.958005249],PARAMETER["False_Northing",0.0],PARAMETER["Central_Meridian",-120.5],PARAMETER["Standard_Parallel_1",43.0],PARAMETER["Standard_Parallel_2",45.5],PARAMETER["Latitude_Of_Origin",41.75],UNIT["Foot",0.3048]],VERTCS["NAVD_1988_Foot_US",VDATUM["North_American_Vertical_Datum_1988"],PARAMETER["Vertical_Shift",0.0],PARAMETER["Direction",1.0],UNIT["Foot_US",0.3048006096012192]]"#;

#[test]
fn dialects_of_one_system_agree() {
    let (esri, epsg) = (wkt(ESRI), code("EPSG:2992+6360"));
    assert_eq!(differences(&esri, &epsg), [""; 0]);
    assert_eq!(esri.remarks, [""; 0]);
    assert_eq!(epsg.name().as_deref(), Some("EPSG:2992+6360"));
    let keys = of_keys(
        &[[1024, 0, 1, 1], [3072, 0, 1, 2992], [4096, 0, 1, 5703], [4099, 0, 1, 9003], [0; 4]],
        &[],
        "",
    );
    assert_eq!(differences(&keys, &epsg), [""; 0]);
    assert!(keys.remarks[0].contains("the unit of key 4099 is US survey foot"), "{:?}", keys.remarks);
}

#[test]
fn differences_are_named() {
    let of = |a: &str, b: &str| differences(&code(a), &code(b));
    assert_eq!(of("EPSG:32610", "EPSG:32611"), ["central meridian: -123 and -117"]);
    assert_eq!(of("EPSG:2991", "EPSG:2992"), ["unit: metre and foot"]);
    assert_eq!(of("EPSG:32610", "EPSG:26910").len(), 2);
    assert_eq!(of("EPSG:32610", "EPSG:4326"), ["kind: projected and geographic", "unit: metre and degree"]);
    assert_eq!(of("EPSG:2992+6360", "EPSG:2992+5703"), ["unit of heights: US survey foot and metre"]);
    // What only one of them states is no difference.
    assert_eq!(of("EPSG:2992+6360", "EPSG:2992"), [""; 0]);
}

#[test]
fn whole_systems_become_codes() {
    let codes = |system: &System| {
        let (keys, losses) = written(system);
        assert_eq!(losses, [""; 0]);
        [1024, 2048, 3072, 4096, 4099].map(|key| short(&keys, key).unwrap_or(0))
    };
    assert_eq!(codes(&code("EPSG:7415")), [1, 0, 28992, 5709, 0]);
    assert_eq!(codes(&code("EPSG:2992+6360")), [1, 0, 2992, 6360, 0]);
    assert_eq!(codes(&code("EPSG:4326")), [2, 4326, 0, 0, 0]);
    assert_eq!(codes(&code("EPSG:4979")), [2, 4979, 0, 0, 0]);
    // Without codes: a datum that is known, and heights that are.
    assert_eq!(codes(&wkt(ESRI)), [1, 4269, 32767, 6360, 0]);
    // Slopes have no vertical system.
    assert_eq!(short(&geotiff_keys(&code("EPSG:7415"), false).0, 4096), None);
    let ellipsoidal = of_keys(&[[1024, 0, 1, 1], [3072, 0, 1, 25832], [4096, 0, 1, 5019]], &[], "");
    assert_eq!(short(&written(&ellipsoidal).0, 4096), Some(4937));
}

#[test]
fn what_a_raster_cannot_say_is_reported() {
    for text in ["LOCAL_CS[\"here\",UNIT[\"metre\",1]]", "", "PROJCS[\"x\"", "ENGCRS[\"here\"]"] {
        let system = wkt(text);
        let (keys, _) = written(&system);
        assert_eq!(keys, GeoKeys::default(), "{text}");
        assert_eq!(system.remarks.len(), 1, "{text}");
    }
    let krovak = code("EPSG:5514");
    let krovak =
        System { horizontal: krovak.horizontal.map(|known| Horizontal { code: None, ..known }), ..krovak };
    let (keys, losses) = written(&krovak);
    assert_eq!(keys, GeoKeys::default());
    assert!(losses[0].contains("Krovak"), "{losses:?}");
    let mut cubits = wkt(ESRI);
    cubits.vertical.as_mut().unwrap().unit = Unit { name: "cubit".into(), size: 0.45, ..Unit::metre() };
    cubits.vertical.as_mut().unwrap().unit.code = None;
    assert!(written(&cubits).1[0].contains("cubit"));
    // The code of a system in metres on a definition in feet.
    let wrong =
        wkt(&ESRI.replace("UNIT[\"Foot\",0.3048]]", "UNIT[\"Foot\",0.3048],AUTHORITY[\"EPSG\",\"2991\"]]"));
    let (keys, losses) = written(&wrong);
    assert_eq!((short(&keys, 3072), short(&keys, 3076)), (Some(32767), Some(9002)));
    assert!(losses[0].contains("EPSG:2991") && losses[0].contains("unit: foot and metre"), "{losses:?}");
}

/// Every projected system of the dataset whose method GeoTIFF has survives keys without its code.
#[test]
fn projections_survive_user_defined_keys() {
    let (mut count, mut lost) = (0, 0);
    for number in 2000..32767 {
        let Ok(crs) = requested(&format!("EPSG:{number}")) else { continue };
        let system = System::of(&crs);
        assert_eq!(
            system.remarks.iter().filter(|remark| !remark.contains("no place")).count(),
            0,
            "{number}"
        );
        let Some(Horizontal { kind: Kind::Projected(..), .. }) = system.horizontal else { continue };
        let horizontal = system.horizontal.clone().map(|known| Horizontal { code: None, ..known });
        let (keys, losses) = written(&System { horizontal, ..System::default() });
        count += 1;
        if !losses.is_empty() {
            lost += 1;
            continue;
        }
        let read = System::of(&crs_of(&keys));
        assert_eq!(differences(&read, &system), [""; 0], "EPSG:{number}");
        assert_eq!(read.horizontal.as_ref().map(|known| known.code), Some(None));
    }
    assert!(count > 5000 && lost * 20 < count, "{lost} of {count}");
}

#[test]
fn damaged_definitions_are_read_or_refused() {
    let mut random = Random::new(23);
    let texts =
        [ESRI.to_string(), epsg_text("EPSG:7415"), epsg_text("EPSG:3857"), epsg_text("EPSG:2992+6360")];
    for _ in 0..20_000 {
        let mut bytes = texts[random.below(4) as usize].clone().into_bytes();
        for _ in 0..1 + random.below(4) {
            let at = random.below(bytes.len() as u64) as usize;
            match random.below(3) {
                0 => bytes.truncate(at + 1),
                1 => bytes[at] = b"[]\",()AI0-\xc3"[random.below(11) as usize],
                _ => drop(bytes.drain(at..(at + 40).min(bytes.len()))),
            }
            if bytes.is_empty() {
                break;
            }
        }
        let system = wkt(&String::from_utf8_lossy(&bytes));
        let _ = (written(&system), system.name());
        let mut numbers: Vec<u16> = (0..4 * random.below(12)).map(|_| random.below(40_000) as u16).collect();
        for (place, number) in numbers.iter_mut().enumerate() {
            *number = match place % 4 {
                0 => [1024, 2048, 2050, 2054, 3072, 3075, 3076, 3078, 3081, 4096, 4099]
                    [random.below(11) as usize],
                1 => [0, 34736, 34737][random.below(3) as usize],
                _ => *number,
            };
        }
        let keys = GeoKeys { directory: numbers, doubles: vec![1.5, f64::NAN, 0.0], texts: "a|b|".into() };
        let system = System::of(&crs_of(&keys));
        let _ = (written(&system), system.name());
    }
}

fn epsg_text(argument: &str) -> String {
    let Crs::Wkt(text) = requested(argument).unwrap() else { panic!("{argument} is no text") };
    text
}

#[test]
fn systems_are_requested_by_code_text_or_file() {
    let folder = Folder::new();
    let file = folder.file("a.prj", format!("{ESRI}\n"));
    let by_file = System::of(&requested(file.to_str().unwrap()).unwrap());
    assert_eq!(by_file, wkt(ESRI));
    assert_eq!(System::of(&requested(ESRI).unwrap()), wkt(ESRI));
    assert_eq!(code("epsg:25832+7837").name().as_deref(), Some("EPSG:25832+7837"));
    for (argument, what) in [
        ("EPSG:1", "not in the EPSG dataset"),
        ("EPSG:x", "expected a code"),
        ("EPSG:25832+25833", "no system of heights"),
        ("EPSG:5703+25832", "no system of x and y"),
        ("EPSG:5703", "no system of x and y"),
        ("PROJCS[\"x\"", "cannot be read"),
        ("LOCAL_CS[\"x\"]", "no place"),
    ] {
        let error = requested(argument).unwrap_err();
        assert!(error.kind() == ErrorKind::Usage && error.to_string().contains(what), "{argument}: {error}");
    }
    assert_eq!(requested("/no/such.prj").unwrap_err().kind(), ErrorKind::Io);
}

/// A slope of one: ten metres of height on as many metres in feet.
const SLOPE: &str =
    "0 0 0\n32.808398950131235 0 10\n0 32.808398950131235 0\n32.808398950131235 32.808398950131235 10\n";

#[test]
fn slopes_shades_and_pictures_use_the_units() {
    let mesh = |crs: &[&str]| {
        let points = run("spfinalize", &[&["-"], crs].concat(), SLOPE.as_bytes());
        assert!(points.status.success(), "{:?}", outcome(&points));
        run("spdelaunay2d", &[], &points.stdout).stdout
    };
    let slope = |crs: &[&str], own: &[&str]| {
        let args = ["--kind", "slope", "--step", "8", "--format", "asc"];
        let grid = run("spdem", &[&args, own].concat(), &mesh(crs));
        let text = String::from_utf8(grid.stdout).unwrap();
        // The middle of five rows: the outermost cells have no neighbours.
        text.lines().nth(6 + 2).unwrap().split(' ').nth(2).unwrap().parse::<f64>().unwrap()
    };
    let (feet, mixed) = (["--crs", "EPSG:2992+8228"], ["--crs", "EPSG:2992+5703"]);
    let plain = (10f64 / 32.808398950131235).atan().to_degrees();
    for (crs, expected) in [(&[][..], plain), (&feet, plain), (&mixed, 45.0)] {
        assert!((slope(crs, &[]) - expected).abs() < 1e-4, "{crs:?}");
        assert!((slope(&[], crs) - expected).abs() < 1e-4, "{crs:?}");
    }
    let picture = |crs: &[&str]| String::from_utf8(run("spview", &[], &mesh(crs)).stdout).unwrap();
    assert!(picture(&[]).contains(" units</text>") && picture(&[]).contains(">Elevation</text>"));
    assert!(picture(&mixed).contains(" ft</text>") && picture(&mixed).contains(">Elevation (m)</text>"));
}

#[test]
fn programs_say_what_they_cannot_hold() {
    let folder = Folder::new();
    let tif = folder.path("a.tif");
    let points = run("spfinalize", &["--crs", "EPSG:4978", "-"], SLOPE.as_bytes());
    let mesh = run("spdelaunay2d", &[], &points.stdout).stdout;
    let run = run("spdem", &["-o", &tif], &mesh);
    assert!(String::from_utf8_lossy(&run.stderr).contains("cannot hold the geocentric system"));
    // Without a system, there are no keys that readers would take for a local one.
    let bytes = fs::read(&tif).unwrap();
    assert!(!bytes.windows(2).any(|tag| tag == 34735u16.to_le_bytes()));
}

/// Keys of the system that the name is all that is known of, in metres or feet.
fn local(unit: u16) -> System {
    let name = "Lambert-93|";
    let keys = [[1024, 0, 1, 1], [1026, 34737, name.len() as u16, 0], [2048, 0, 1, 4171], [3076, 0, 1, unit]];
    of_keys(&keys, &[], name)
}

#[test]
fn projected_coordinates_without_a_projection_are_no_degrees() {
    let system = local(9001);
    let horizontal = system.horizontal.as_ref().unwrap();
    assert_eq!((&horizontal.name[..], horizontal.is_angular()), ("Lambert-93", false));
    assert_eq!(horizontal.unit, Unit::metre());
    assert_eq!(system.remarks.len(), 1, "{:?}", system.remarks);
    // What GDAL reads as a local system of this name.
    let (keys, losses) = written(&system);
    assert_eq!((short(&keys, 1024), short(&keys, 3076), losses), (Some(1), Some(9001), Vec::new()));
    assert_eq!(differences(&system, &local(9001)), [""; 0]);
    assert_eq!(differences(&system, &local(9003)), ["unit: metre and US survey foot"]);
    assert_eq!(differences(&system, &code("EPSG:2154")).len(), 1);
    // Without a name, and without the type of the model.
    let bare = of_keys(&[[1024, 0, 1, 1], [2048, 0, 1, 4171]], &[], "");
    assert!(bare.horizontal.is_none() && bare.remarks.len() == 1);
    let of = |model: u16, unit: u16| {
        let keys = [[1024, 0, 1, model], [1026, 34737, 5, 0], [2048, 0, 1, 4171], [3076, 0, 1, unit]];
        of_keys(&keys, &[], "here|").horizontal.unwrap()
    };
    assert!(of(0, 0).is_angular() && of(2, 9001).is_angular());
    assert!(!of(0, 9001).is_angular() && !of(32767, 9001).is_angular());
}

/// Systems that state the unit of heights, but not from where they count.
fn units_of_heights() -> [System; 3] {
    let head = [[1024, 0, 1, 1], [3072, 0, 1, 32617]];
    let of = |more: &[[u16; 4]], texts: &str| of_keys(&[&head[..], more].concat(), &[], texts);
    let datum = "VERT_DATUM[\"unknown\",2005],UNIT[\"US survey foot\",0.304800609601219]";
    let projected = epsg_text("EPSG:32617");
    [
        of(&[[4099, 0, 1, 9003]], ""),
        of(&[[4096, 0, 1, 32767], [4097, 34737, 8, 0], [4098, 0, 1, 32767], [4099, 0, 1, 9003]], "unknown|"),
        wkt(&format!("COMPD_CS[\"a + unknown\",{projected},VERT_CS[\"unknown\",{datum}]]")),
    ]
}

#[test]
fn a_unit_of_heights_is_no_system_of_heights() {
    for system in units_of_heights() {
        assert_eq!(system.name().as_deref(), Some("EPSG:32617"));
        assert_eq!(system.vertical.as_ref().map(|heights| heights.unit.code), Some(Some(9003)));
        let (keys, losses) = written(&system);
        let found = [3072, 4096, 4097, 4098, 4099].map(|key| short(&keys, key));
        assert_eq!((found, losses), ([Some(32617), None, None, None, None], Vec::new()));
        assert_eq!(differences(&system, &code("EPSG:32617+6360")), [""; 0]);
        assert_eq!(differences(&system, &code("EPSG:32617+5703")).len(), 1);
    }
}
