//! LAS, LAZ and COPC.

use rustix::fs::Mode;
use spmesh_base::error::ErrorKind;
use spmesh_base::limits::{CRS_LEN_MAX, HEADER_BODY_MAX};
use spmesh_formats::crs::name as crs_name;
use spmesh_formats::source::{Filters, Input, SourceOptions};
use spmesh_stream::model::bounds::Bounds;
use spmesh_stream::{Coordinates, Crs};

use super::las_file::{LasFile, Record, geo_keys};
use super::{assert_fails, flat, pass, points, points_of, sample};
use crate::programs::{Folder, outcome, run};

#[test]
fn samples_have_the_points_and_the_box_that_their_headers_state() {
    let samples = [
        ("1_4_w_evlr.las", 1000),
        ("1_4_w_evlr.laz", 1000),
        ("autzen.copc.laz", 107),
        ("autzen.laz", 106),
        ("crop_duplicate.laz", 849),
        ("hextest.las", 8),
        ("point10.las", 1065),
        ("point10.laz", 1065),
        ("pointwise.laz", 1065),
    ];
    for (name, count) in samples {
        let input = Input::open(&[sample(name)], &flat()).unwrap();
        let found = pass(&input).unwrap();
        assert_eq!(found.len(), count, "{name}");
        assert_eq!(input.description().stated_points, Some(count as u64), "{name}");
        assert_eq!(input.description().stated_bounds, Bounds::of_points(&found), "{name}");
        // The text of this file calls a unit of one metre a foot.
        let is_strange = name.starts_with("1_4_w_evlr");
        let notices: Vec<_> =
            input.notices().iter().filter(|text| !(is_strange && text.contains("foot"))).collect();
        assert!(notices.is_empty(), "{name}: {notices:?}");
    }
}

#[test]
fn twins_have_the_same_points() {
    for name in ["point10", "1_4_w_evlr"] {
        let read = |ending| points(&[sample(&format!("{name}.{ending}"))], &flat()).unwrap();
        assert_eq!(read("las"), read("laz"), "{name}");
    }
}

#[test]
fn integers_stay_what_they_are_in_the_file() {
    let positions = [[i32::MIN, i32::MAX, 0], [-1, 1, 7], [i32::MAX, i32::MIN, -7]];
    for format in 0..=10 {
        let mut las = LasFile { format, offset: [1e6, -3.3, 0.1], ..LasFile::of(&positions) };
        las.scale = [0.001; 3];
        let expected: Vec<_> = positions.iter().map(|position| position.map(f64::from)).collect();
        assert_eq!(points_of(las.bytes()).unwrap(), expected, "format {format}");
    }
}

#[test]
fn filters_keep_classes_and_returns() {
    let record =
        |x, class, number, of| Record { position: [x, 0, 0], class, number, of, ..Record::default() };
    // A return number of 0 means unknown, so neither first_only nor last_only may drop the point.
    let records = vec![record(0, 2, 1, 2), record(1, 2, 2, 2), record(2, 5, 1, 1), record(3, 9, 0, 0)];
    for format in [1, 6] {
        let las = LasFile { format, records: records.clone(), ..LasFile::of(&[]) };
        let folder = Folder::new();
        let path = folder.file("a.las", las.bytes());
        let kept = |filters: Filters| -> Vec<i32> {
            let found = points(std::slice::from_ref(&path), &SourceOptions { filters, ..flat() }).unwrap();
            found.iter().map(|point| point[0] as i32).collect()
        };
        let default = Filters::default;
        assert_eq!(kept(default()), [0, 1, 2, 3]);
        assert_eq!(kept(Filters { keep_class: vec![2, 9], ..default() }), [0, 1, 3]);
        assert_eq!(kept(Filters { drop_class: vec![2], ..default() }), [2, 3]);
        assert_eq!(kept(Filters { first_only: true, ..default() }), [0, 2, 3]);
        assert_eq!(kept(Filters { last_only: true, ..default() }), [1, 2, 3]);
    }
}

#[test]
fn bounds_are_closed_and_not_fooled_by_rounding() {
    let folder = Folder::new();
    let path =
        folder.file("a.las", LasFile::of(&[[1002, 0, 0], [1003, 7, 0], [1004, 7, 0], [1005, 8, 0]]).bytes());
    let infinite = f64::INFINITY;
    let bounds = Some(Bounds { min: [10.03, 0.0, -infinite], max: [10.05, 0.07, infinite] });
    let path = std::slice::from_ref(&path);
    let found = points(path, &SourceOptions { bounds, ..flat() }).unwrap();
    assert_eq!(found, [[1003.0, 7.0, 0.0], [1004.0, 7.0, 0.0]]);
    let bounds = Some(Bounds { min: [0.0, 0.0, 0.5], max: [99.0, 99.0, 0.25] });
    let empty = SourceOptions { bounds, ..flat() };
    assert_fails(points(path, &empty), ErrorKind::Usage, &["from [0.0, 0.0, 0.5]", "is empty"]);
}

#[test]
fn classes_of_text_are_a_usage_error() {
    let folder = Folder::new();
    let path = folder.file("a.xyz", "1 2 3\n");
    let filters = Filters { keep_class: vec![2], ..Filters::default() };
    let options = SourceOptions { filters, ..flat() };
    assert_fails(Input::open(&[path], &options), ErrorKind::Usage, &["a.xyz", "classes are unknown"]);
}

#[test]
fn systems_are_named_compared_and_shared() {
    let name = |file| crs_name(&Input::open(&[sample(file)], &flat()).unwrap().description().crs);
    assert_eq!(name("autzen.laz").as_deref(), Some("EPSG:2994"));
    assert_eq!(name("autzen.copc.laz").as_deref(), Some("EPSG:2992+6360"));
    assert_eq!(name("hextest.las"), None);
    let wkt =
        r#"PROJCS["UTM (zone 10)",GEOGCS["WGS 84",AUTHORITY["EPSG","4326"]],AUTHORITY["EPSG","32610"]]"#;
    assert_eq!(crs_name(&Crs::Wkt(wkt.into())).as_deref(), Some("EPSG:32610"));
    let newer = r#"PROJCRS["x",BASEGEOGCRS["y",ID["EPSG",4326]],ID["EPSG",32610]]"#;
    assert_eq!(crs_name(&Crs::Wkt(newer.into())).as_deref(), Some("EPSG:32610"));

    let folder = Folder::new();
    let file = |name: &str, projection| {
        folder.file(name, LasFile { projection, ..LasFile::of(&[[1, 1, 1]]) }.bytes())
    };
    let keys = file("keys.las", vec![geo_keys(32610)]);
    let text = file("text.las", vec![(2112, wkt.as_bytes().to_vec())]);
    let other = file("other.las", vec![geo_keys(26910)]);
    let none = file("none.las", vec![]);
    let input = Input::open(&[none, keys.clone(), text], &flat()).unwrap();
    assert!(matches!(input.description().crs, Crs::GeoKeys { .. }));
    assert!(input.notices()[0].contains("none.las: states no coordinate reference system"));
    assert_fails(
        Input::open(&[keys, other], &flat()),
        ErrorKind::Usage,
        &["keys.las", "other.las", "EPSG:32610", "EPSG:26910"],
    );
}

#[test]
fn systems_too_long_for_a_stream_are_left_out_and_the_notice_says_so() {
    let open = |len: usize| {
        let mut bytes = LasFile { format: 6, ..LasFile::of(&[[1, 2, 3]]) }.bytes();
        let start = bytes.len() as u64;
        bytes[235..243].copy_from_slice(&start.to_le_bytes());
        bytes[243..247].copy_from_slice(&1u32.to_le_bytes());
        bytes.extend([0, 0]);
        bytes.extend(b"LASF_Projection\0");
        bytes.extend(2112u16.to_le_bytes());
        bytes.extend((len as u64).to_le_bytes());
        bytes.extend([0; 32]);
        bytes.extend(vec![b'x'; len]);
        let folder = Folder::new();
        let path = folder.file("a.las", bytes);
        let input = Input::open(std::slice::from_ref(&path), &flat()).unwrap();
        let run = crate::programs::run("spfinalize", &[path.to_str().unwrap()], &[]);
        assert!(run.status.success(), "{len}: {:?}", crate::programs::outcome(&run));
        (input.description().crs.clone(), input.notices().to_vec())
    };
    for len in [70_000, CRS_LEN_MAX] {
        let (crs, notices) = open(len);
        assert_eq!(crs, Crs::Wkt("x".repeat(len)));
        assert!(notices.len() == 1 && notices[0].contains("cannot be read"), "{notices:?}");
    }
    for len in [CRS_LEN_MAX + 1, HEADER_BODY_MAX, HEADER_BODY_MAX + 1] {
        let (crs, notices) = open(len);
        assert_eq!(crs, Crs::Unknown);
        assert!(notices[0].contains(&format!("is {len} bytes long")), "{notices:?}");
    }
}

#[test]
fn any_text_may_stand_for_a_system() {
    let wkt = "PROJCS[\"Zône 10\u{1F30D}\",GEOGCS[\"y\",AUTHORITY[\"EPSG\",\"4326\"]], ID (\"EPSG\",32610)]";
    for text in [wkt.to_string(), wkt.replace("ID ", "AUTHORITY"), wkt.replace("ID ", "AUTHÖRITY")] {
        for (start, _) in text.char_indices() {
            for (end, _) in text.char_indices().filter(|&(end, _)| end >= start) {
                let _ = crs_name(&Crs::Wkt(text[start..end].into()));
            }
        }
        for junk in ["ID", "\u{e9}", "[", "\""] {
            for (at, _) in text.char_indices() {
                let _ = crs_name(&Crs::Wkt(format!("{}{junk}{}", &text[..at], &text[at..])));
            }
        }
    }
    assert_eq!(crs_name(&Crs::Wkt(wkt.into())).as_deref(), Some("EPSG:32610"));
    for text in ["PROJCS[\"x\",ID", "PROJCS[\"x\",AUTHORITY", "PROJCS[\"x\",ID[", "PROJCS[\"x\",I\u{e9}"] {
        assert_eq!(crs_name(&Crs::Wkt(text.into())).as_deref().unwrap_or("x"), "x", "{text}");
    }
}

#[test]
fn truncated_files_are_errors_with_a_position() {
    assert_fails(
        Input::open(&[sample("truncated.las")], &flat()),
        ErrorKind::Malformed,
        &["truncated.las", "record 0 at byte 229", "1065 points"],
    );
    let laz = std::fs::read(sample("point10.laz")).unwrap();
    assert_fails(points_of(&laz[..laz.len() / 2]), ErrorKind::Malformed, &["chunk table", "ends at byte"]);
}

#[test]
fn more_points_than_any_file_holds_are_refused() {
    let mut laz = std::fs::read(sample("autzen.copc.laz")).unwrap();
    for count in [u64::MAX, u64::MAX / 36 + 1, u64::MAX / 36 - 1, 1 << 40] {
        laz[247..255].copy_from_slice(&count.to_le_bytes());
        assert_fails(points_of(&laz), ErrorKind::Malformed, &[&count.to_string()]);
    }
}

#[test]
fn points_that_the_header_does_not_state_are_told_of() {
    let notices = |bytes: &[u8]| {
        let folder = Folder::new();
        let input = Input::open(&[folder.file("a.laz", bytes)], &flat()).unwrap();
        assert!(pass(&input).unwrap().is_empty());
        input.notices().to_vec()
    };
    for (name, count_at) in [("point10.las", 107), ("point10.laz", 107), ("pointwise.laz", 107)] {
        let mut bytes = std::fs::read(sample(name)).unwrap();
        bytes[count_at..count_at + 4].fill(0);
        assert!(notices(&bytes)[0].contains("states no points, although"), "{name}");
        let points_start = u32::from_le_bytes(bytes[96..100].try_into().unwrap()) as usize;
        bytes.truncate(points_start);
        assert_eq!(notices(&bytes), [""; 0], "{name}");
        bytes.extend((points_start as u64 + 8).to_le_bytes());
        bytes.extend([0; 8]);
        assert_eq!(notices(&bytes), [""; 0], "{name}");
    }
}

/// The sample with `change` added to the number of points that its header states.
fn with_count(name: &str, change: i64) -> Vec<u8> {
    let mut bytes = std::fs::read(sample(name)).unwrap();
    let legacy = u32::from_le_bytes(bytes[107..111].try_into().unwrap());
    if legacy > 0 {
        bytes[107..111].copy_from_slice(&legacy.checked_add_signed(change as i32).unwrap().to_le_bytes());
    } else {
        let count = u64::from_le_bytes(bytes[247..255].try_into().unwrap());
        bytes[247..255].copy_from_slice(&count.checked_add_signed(change).unwrap().to_le_bytes());
    }
    bytes
}

#[test]
fn a_count_that_is_too_small_is_told_of_or_refused() {
    let folder = Folder::new();
    for (name, count) in [("hextest.las", 8), ("point10.las", 1065), ("1_4_w_evlr.las", 1000)] {
        let input = Input::open(&[folder.file("a.las", with_count(name, -2))], &flat()).unwrap();
        let told = format!("states {} points, but {count} records fit before byte", count - 2);
        assert!(input.notices()[0].contains(&told), "{:?}", input.notices());
        assert_eq!(pass(&input).unwrap().len(), count - 2);
    }
    for name in
        ["1_4_w_evlr.laz", "autzen.laz", "autzen.copc.laz", "lareunion.laz", "point10.laz", "pointwise.laz"]
    {
        assert_fails(points_of(with_count(name, -1)), ErrorKind::Malformed, &["point"]);
    }
}

#[test]
fn points_do_not_extend_into_other_data() {
    let other = ["record 1000 at byte 32305", "states 1001 points", "other data start at byte 32305"];
    assert_fails(points_of(with_count("1_4_w_evlr.las", 1)), ErrorKind::Malformed, &other);
    // Waveforms follow the first 500 points.
    let mut waveforms = with_count("1_4_w_evlr.las", 0);
    waveforms[227..235].copy_from_slice(&(2305 + 500 * 30u64).to_le_bytes());
    assert_fails(
        points_of(waveforms),
        ErrorKind::Malformed,
        &["record 500", "other data start at byte 17305"],
    );
    for name in
        ["hextest.las", "1_4_w_evlr.laz", "autzen.laz", "autzen.copc.laz", "point10.laz", "pointwise.laz"]
    {
        assert_fails(points_of(with_count(name, 1)), ErrorKind::Malformed, &["point"]);
    }
}

#[test]
fn pipes_are_spooled_and_the_notice_says_so() {
    let folder = Folder::new();
    let path = folder.root().join("pipe.laz");
    rustix::fs::mkfifoat(rustix::fs::CWD, &path, Mode::RUSR | Mode::WUSR).unwrap();
    let content = std::fs::read(sample("point10.laz")).unwrap();
    let writer = std::thread::spawn({
        let path = path.clone();
        move || std::fs::write(path, content).unwrap()
    });
    let options = SourceOptions { temp_dir: Some(folder.root().to_path_buf()), ..flat() };
    let input = Input::open(&[path], &options).unwrap();
    writer.join().unwrap();
    assert_eq!(pass(&input).unwrap(), points(&[sample("point10.laz")], &flat()).unwrap());
    assert_eq!(pass(&input).unwrap().len(), 1065);
    assert!(input.notices()[0].contains("spooled"), "{:?}", input.notices());
    assert_eq!(std::fs::read_dir(folder.root()).unwrap().count(), 1, "the spool has no name");
}

#[test]
fn files_of_several_kinds_are_one_input() {
    let folder = Folder::new();
    let text = folder.file("a.xyz", "0.5 0.25 3\n");
    let las = folder.file("b.las", LasFile::of(&[[100, 200, 300]]).bytes());
    let input = Input::open(&[text, las], &flat()).unwrap();
    assert_eq!(input.description().coordinates, Coordinates::F64);
    assert!(input.description().has_elevation);
    assert_eq!(pass(&input).unwrap(), [[0.5, 0.25, 3.0], [1.0, 2.0, 3.0]]);
}

#[test]
fn vertices_of_meshes_are_points() {
    let three = [[1.0, 2.0, 3.0], [2.0, 2.0, 3.0], [1.0, 1.0, -1.5]];
    let vertices = "v 1 2 3\nv 2 2 3\nv 1 1 -1.5\n";
    for obj in [
        format!("# OBJ of x\n{vertices}"),
        format!("o cube\n{vertices}"),
        format!("{vertices}vn 0 0 1\n"),
        format!("# x\n{vertices}f 1 2 3\n"),
    ] {
        assert_eq!(points_of(&obj).unwrap(), three, "{obj}");
    }
    let header = "element vertex 3\nproperty double x\nproperty float y\nproperty double z\n";
    let faces = "element face 1\nproperty list uchar int vertex_indices\n";
    let rows = "1 2 3\n2 2 3\n1 1 -1.5\n";
    for end in ["\n", "\r\n"] {
        let alone = format!("ply\nformat ascii 1.0\n{header}end_header\n{rows}").replace('\n', end);
        assert_eq!(points_of(&alone).unwrap(), three);
        let mesh =
            format!("ply\nformat ascii 1.0\n{header}{faces}end_header\n{rows}3 0 1 2\n").replace('\n', end);
        assert_eq!(points_of(&mesh).unwrap(), three);
        let cut = mesh.find("1 1 -1.5").unwrap();
        assert_fails(points_of(&mesh[..cut]), ErrorKind::Malformed, &["points: "]);
    }
    assert_fails(points_of("ply\nformat ascii 1.0\n"), ErrorKind::Malformed, &["end_header"]);
    assert_fails(points_of("o x\nv 1 2 3\nv 1 nought 3\n"), ErrorKind::Malformed, &["line 3"]);
}

#[test]
fn wrong_kinds_of_files_get_advice() {
    assert_fails(points_of(b"\x1f\x8b\x08\0\0\0"), ErrorKind::Malformed, &["gzip data ends early", "byte 6"]);
    assert_fails(points_of(b""), ErrorKind::Malformed, &["empty"]);
    assert_fails(points_of(b"# .PCD v0.7\nVERSION .7\n"), ErrorKind::Malformed, &["PCD", "pdal"]);
    let late = format!("{}f 1 2 3\n", "v 1 2 3\n".repeat(10_000));
    assert_eq!(points_of(late).unwrap().len(), 10_000);
    assert_eq!(points_of(b"v 1 2 3\nv 4 5 6\n").unwrap().len(), 2);
    assert_fails(points_of(b"abc\0"), ErrorKind::Malformed, &["zero byte at byte 3"]);
    let folder = Folder::new();
    assert_fails(Input::open(&[folder.root().to_path_buf()], &flat()), ErrorKind::Usage, &["folder"]);
    assert_fails(Input::open(&["no/such.laz".into()], &flat()), ErrorKind::Io, &["no/such.laz"]);
    assert_fails(Input::open(&["-".into(), "-".into()], &flat()), ErrorKind::Usage, &["more than once"]);
}

/// The order of files decides nothing about their common system, nor about a raster of their points.
#[test]
fn the_common_system_is_the_one_that_states_most() {
    let folder = Folder::new();
    let keys = |more: &[u16]| {
        let keys = [&[1, 1, 0, 2 + more.len() as u16 / 4, 1024, 0, 1, 1, 3072, 0, 1, 32617], more].concat();
        (34735, keys.iter().flat_map(|key| key.to_le_bytes()).collect::<Vec<u8>>())
    };
    let file = |name: &str, more: &[u16]| {
        let las = LasFile { projection: vec![keys(more)], ..LasFile::of(&[[0, 0, 0], [9, 0, 0], [0, 9, 9]]) };
        folder.write(name, las.bytes())
    };
    let bare = file("bare.las", &[]);
    let unit = file("unit.las", &[4099, 0, 1, 9001]);
    let whole = file("whole.las", &[4096, 0, 1, 5703]);
    let name_of = |files: &[&str]| {
        let paths: Vec<_> = files.iter().map(|file| file.into()).collect();
        crs_name(&Input::open(&paths, &flat()).unwrap().description().crs)
    };
    for files in
        [[&bare, &unit, &whole], [&whole, &unit, &bare], [&unit, &whole, &bare], [&bare, &whole, &unit]]
    {
        assert_eq!(name_of(&files.map(|file| &file[..])).as_deref(), Some("EPSG:32617+5703"), "{files:?}");
    }
    assert_eq!(name_of(&[&bare, &unit]).as_deref(), Some("EPSG:32617"));
    // Files that say nothing of x and y may still say what heights are.
    let heights = |name: &str, code: u16| {
        let keys = [1, 1, 0, 1, 4096, 0, 1, code].iter().flat_map(|key: &u16| key.to_le_bytes()).collect();
        folder.write(name, LasFile { projection: vec![(34735, keys)], ..LasFile::of(&[[0, 0, 0]]) }.bytes())
    };
    let nothing = folder.write("nothing.las", LasFile::of(&[[0, 0, 0]]).bytes());
    let (navd, egm) = (heights("navd.las", 5703), heights("egm.las", 5773));
    for files in [[&nothing, &navd], [&navd, &nothing]] {
        assert_eq!(name_of(&files.map(|file| &file[..])).as_deref(), Some("EPSG:5703"), "{files:?}");
    }
    for files in [[&egm, &navd], [&navd, &egm], [&whole, &egm], [&egm, &whole]] {
        assert_fails(Input::open(&files.map(Into::into), &flat()), ErrorKind::Usage, &["heights: "]);
    }
    let mesh = run("spdelaunay2d", &[], &run("spfinalize", &[&unit], &[]).stdout).stdout;
    let raster = run("spdem", &["--step", "0.01", "-o", "-"], &mesh);
    assert_eq!(outcome(&raster).0, Some(0), "{:?}", outcome(&raster));
    let item = b"role=\"unittype\">metre</Item>";
    assert!(raster.stdout.windows(item.len()).any(|bytes| bytes == item));
}
