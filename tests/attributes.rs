//! Attributes of points from files through every program, against records that are taken apart by hand.

use serde_json::Value;
use spmesh_stream::model::attributes::Attributes;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Event, StreamReader};

use crate::programs::{Folder, assert_outcome, outcome, run, sample};
use crate::sources::las_file::LasFile;

/// The output of a program that succeeds.
fn output_of(name: &str, arguments: &[&str], input: &[u8]) -> Vec<u8> {
    let output = run(name, arguments, input);
    assert!(output.status.success(), "{name}: {:?}", outcome(&output));
    output.stdout
}

/// Attributes, and the points of a stream with their rows: stored coordinates of points, or new vertices.
fn rows_of(stream: &[u8]) -> (Attributes, Vec<(Point, Vec<u8>)>) {
    let mut reader = StreamReader::new(stream, "stream").unwrap();
    let attributes = reader.header().attributes.clone();
    let mut found = Vec::new();
    while let Some(event) = reader.next_event().unwrap() {
        let points = match event {
            Event::Points(points) => points,
            Event::Patch(patch) => patch.new,
            _ => continue,
        };
        let rows = reader.rows().chunks_exact(attributes.row_len().max(1)).map(<[u8]>::to_vec);
        found.extend(points.into_iter().zip(rows));
    }
    (attributes, found)
}

/// The same in an order that depends on the points and rows alone.
fn sorted(mut rows: Vec<(Point, Vec<u8>)>) -> Vec<(Point, Vec<u8>)> {
    rows.sort_unstable_by(|a, b| a.0.partial_cmp(&b.0).unwrap().then_with(|| a.1.cmp(&b.1)));
    rows
}

/// The points of a LAS file, taken apart by the offsets in the specification: a row has intensity, class,
/// return number, flags and source.
fn by_hand(file: &[u8]) -> Vec<(Point, Vec<u8>)> {
    let u32_at = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
    let (start, format) = (u32_at(96), file[104]);
    let len = usize::from(u16::from_le_bytes([file[105], file[106]]));
    let count = if format < 6 { u32_at(107) } else { u32_at(247) };
    file[start..start + count * len]
        .chunks_exact(len)
        .map(|record| {
            let axis = |at: usize| f64::from(i32::from_le_bytes(record[at..at + 4].try_into().unwrap()));
            let mut row = record[12..14].to_vec();
            if format < 6 {
                row.extend([record[15] & 0x1f, record[14] & 7, record[15] >> 5]);
                row.extend(&record[18..20]);
            } else {
                row.extend([record[16], record[14] & 15, record[15] & 15]);
                row.extend(&record[20..22]);
            }
            ([axis(0), axis(4), axis(8)], row)
        })
        .collect()
}

const FIELDS: &str = "intensity,classification,return_number,class_flags,point_source_id";

#[test]
fn rows_of_las_and_laz_are_those_of_their_records() {
    for (las, laz) in [("point10.las", "point10.laz"), ("1_4_w_evlr.las", "1_4_w_evlr.laz")] {
        let records = by_hand(&std::fs::read(sample(las)).unwrap());
        assert!(records.len() > 900);
        for file in [las, laz] {
            for flags in [&[][..], &["--preserve"], &["--level", "3"], &["--spool", "always"]] {
                let file = sample(file);
                let arguments = [&["--attributes", FIELDS, &file], flags].concat();
                let stream = output_of("spfinalize", &arguments, &[]);
                let (attributes, rows) = rows_of(&stream);
                assert_eq!(attributes.names().replace(", ", ","), FIELDS);
                if las == "point10.las" {
                    assert!(sorted(rows) == sorted(records.clone()), "{file} {flags:?}");
                } else {
                    // Its axes have different scales, so coordinates are no longer those of the records.
                    let in_order = |rows: &[(Point, Vec<u8>)]| {
                        let mut rows: Vec<Vec<u8>> = rows.iter().map(|(_, row)| row.clone()).collect();
                        if flags != ["--preserve"] {
                            rows.sort_unstable();
                        }
                        rows
                    };
                    assert!(in_order(&rows) == in_order(&records), "{file} {flags:?}");
                }
            }
        }
    }
}

/// All layers of a LAZ file of format 8 are decompressed. The numbers are those that laspy 2 reads.
#[test]
fn layers_of_laz_are_decompressed() {
    let file = sample("crop_duplicate.laz");
    let stream = output_of("spfinalize", &["--preserve", "--attributes", "all", &file], &[]);
    let (attributes, rows) = rows_of(&stream);
    let numbers = |name: &str, point: usize| {
        let (attribute, place) = attributes.find(name).unwrap();
        attribute.numbers(&rows[point].1[place]).map(|number| number.to_f64()).collect::<Vec<_>>()
    };
    assert_eq!([0, 1, 2].map(|point| numbers("intensity", point)[0]), [22.0, 25.0, 17.0]);
    assert_eq!([0, 1, 2].map(|point| numbers("scan_angle", point)[0]), [622.0, 582.0, 583.0]);
    assert_eq!(numbers("gps_time", 1), [348_920_637.665_689_23]);
    assert_eq!(numbers("rgb", 2), [10_496.0, 13_824.0, 11_520.0]);
    assert_eq!(numbers("nir", 2), [35_584.0]);
    assert_eq!(numbers("Deviation", 0), [2560.0]);
    let (angle, place) = attributes.find("scan_angle").unwrap();
    assert_eq!(angle.value(&rows[0].1[place]), Some(622.0 * 0.006));
}

#[test]
fn filters_drop_rows_with_their_points() {
    let file = sample("point10.las");
    let all = by_hand(&std::fs::read(&file).unwrap());
    let class = all[0].1[2];
    let expected = sorted(all.into_iter().filter(|(_, row)| row[2] == class).collect());
    let class = class.to_string();
    let stream = output_of("spfinalize", &["--attributes", FIELDS, "--keep-class", &class, &file], &[]);
    assert_eq!(sorted(rows_of(&stream).1), expected);
}

#[test]
fn requests_that_cannot_be_met_are_refused() {
    let folder = Folder::new();
    let (las, laz) = (sample("point10.las"), sample("crop_duplicate.laz"));
    let refused = |attributes: &str, files: &[&str], part: &str| {
        assert_outcome("spfinalize", &[&["--attributes", attributes], files].concat(), &[], 2, part);
    };
    refused("nir", &[&las], "point10.las: no attribute \"nir\" (--attributes): the file has intensity, ");
    refused("intensity,intensity", &[&las], "two attributes \"intensity\"");
    refused("nir", &[&laz, &las], "point10.las: no attribute");
    let text = folder.write("a.csv", "x,y,z,t\n0,0,0,1\n1,0,0,2\n0,1,0,3\n");
    let ply = folder.write(
        "a.ply",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
         property int t\nend_header\n5 5 5 -7\n",
    );
    refused("t", &[&text, &ply], "another type, scale or unit of the attribute t");
    // All that every file has, with a notice about the rest.
    let output = run("spfinalize", &["--attributes", "all", &laz, &las], &[]);
    assert!(output.status.success());
    assert!(outcome(&output).1.contains("has no attribute nir, which is left out"), "{:?}", outcome(&output));
}

#[test]
fn columns_of_text_are_attributes() {
    let named = "x;y;z;height above;class\n0;0;1;2.5;7\n4;0;1;;8\n0;4;1;-1e300;9\n";
    let stream =
        output_of("spfinalize", &["--preserve", "--attributes", "class,height above", "-"], named.as_bytes());
    let (attributes, rows) = rows_of(&stream);
    let heights = attributes.column("height above").unwrap();
    let values: Vec<f64> = rows.iter().map(|(_, row)| heights.of(row, 0)).collect();
    assert_eq!((values[0], values[2], values[1].is_nan()), (2.5, -1e300, true));
    let bare =
        output_of("spfinalize", &["--preserve", "--attributes", "column5", "-"], b"1 2 3 4 5\n6 7 8 9 10\n");
    let (attributes, rows) = rows_of(&bare);
    let column = attributes.column("column5").unwrap();
    assert_eq!([column.of(&rows[0].1, 0), column.of(&rows[1].1, 0)], [5.0, 10.0]);
    let wrong = "x,y,z,name,t\n0,0,0,oak,1\n1,0,0,elm,oops\n";
    assert_outcome(
        "spfinalize",
        &["--attributes", "name", "-"],
        wrong.as_bytes(),
        3,
        "line 2: found \"oak\" in column 4",
    );
    assert_outcome("spfinalize", &["--attributes", "t", "-"], wrong.as_bytes(), 3, "line 3: found \"oops\"");
}

#[test]
fn names_of_columns_without_points_offer_attributes() {
    let folder = Folder::new();
    let (none, some) =
        (folder.write("none.csv", "x,y,z,t\n"), folder.write("some.csv", "x,y,z,t\n0,0,0,7\n"));
    for files in [&[&none[..]][..], &[&none, &some]] {
        let stream = output_of("spfinalize", &[&["--attributes", "t"], files].concat(), &[]);
        let (attributes, rows) = rows_of(&stream);
        assert_eq!((attributes.names(), rows.len()), ("t".to_string(), files.len() - 1));
    }
}

#[test]
fn properties_of_ply_are_attributes_and_come_back() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n\
               property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float quality\n\
               end_header\n0 0 1 255 0 7 0.5\n4 0 1 1 2 3 nan\n0 4 1 4 5 6 -inf\n";
    let points = output_of("spfinalize", &["--preserve", "--attributes", "all", "-"], ply.as_bytes());
    let (attributes, rows) = rows_of(&points);
    assert_eq!(attributes.names(), "rgb, quality");
    assert_eq!(rows[1].1, [&[1, 2, 3][..], &f32::NAN.to_le_bytes()].concat());
    for encoding in [&["--ascii"][..], &[]] {
        let written = output_of("spconvert", &[&["--to", "ply"], encoding].concat(), &points);
        assert_eq!(
            rows_of(&output_of("spfinalize", &["--preserve", "--attributes", "all", "-"], &written)),
            (attributes.clone(), rows.clone())
        );
    }
    let mesh = output_of("spdelaunay2d", &[], &points);
    let obj = String::from_utf8(output_of("spconvert", &["--to", "obj"], &mesh)).unwrap();
    assert!(obj.contains("v 0 0 1 1 0 0.027450980392156862\n"), "{obj}");
    let written = output_of("spconvert", &["--to", "ply", "--ascii"], &mesh);
    let back = run("spconvert", &["--to", "spm"], &written);
    assert!(outcome(&back).1.contains("attributes of a mesh in PLY are not read: rgb, quality dropped"));
    let colours = ["--attributes", "rgb", "--to", "ply", "--ascii", &sample("crop_duplicate.laz")];
    let written = String::from_utf8(output_of("spconvert", &colours, &[])).unwrap();
    assert!(
        written.contains("property ushort red\n") && written.contains(" 15360 19712 16896\n"),
        "{written}"
    );
    let vtu = output_of("spconvert", &["--to", "vtu"], &mesh);
    let text = String::from_utf8_lossy(&vtu);
    assert!(text.contains(
        "<DataArray type=\"UInt8\" Name=\"rgb\" NumberOfComponents=\"3\" format=\"appended\" offset=\"0\"/>"
    ));
    // Nine bytes of colours, then twelve of qualities, each after their length.
    let values = vtu.windows(8).position(|bytes| bytes == 9u64.to_le_bytes()).unwrap() + 8;
    let mut colours: Vec<&[u8]> = vtu[values..values + 9].chunks(3).collect();
    colours.sort_unstable();
    assert_eq!(colours, [[1, 2, 3], [4, 5, 6], [255, 0, 7]]);
}

/// Arrays of VTK in raw, base64 and compressed form; the numbers that come back are those that went in.
#[test]
fn arrays_of_vtk_are_attributes() {
    let points = output_of("spfinalize", &["--attributes", "all", &sample("crop_duplicate.laz")], &[]);
    let (attributes, rows) = rows_of(&points);
    let vtu = output_of("spconvert", &["--to", "vtu"], &points);
    let back = output_of("spfinalize", &["--preserve", "--attributes", "all", "-"], &vtu);
    let (names, again) = rows_of(&back);
    assert_eq!(names.names(), attributes.names());
    let rows_only = |rows: Vec<(Point, Vec<u8>)>| rows.into_iter().map(|(_, row)| row).collect::<Vec<_>>();
    assert!(rows_only(rows) == rows_only(again));
    let (attributes, rows) = rows_of(&output_of(
        "spfinalize",
        &["--preserve", "--attributes", "all", &sample("vtk_zlib.vtu")],
        &[],
    ));
    assert_eq!(attributes.names(), "t, v");
    let numbers = attributes.column("t").unwrap();
    let times: Vec<f64> = rows.iter().map(|(_, row)| numbers.of(row, 0)).collect();
    assert_eq!(times, (0..40).map(f64::from).collect::<Vec<_>>());
    let text = "<?xml version=\"1.0\"?><VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"3\"><PointData>\
                <DataArray type=\"Int64\" Name=\"a&lt;b\">9007199254740993 -1 5</DataArray>\
                <DataArray type=\"String\" Name=\"s\">0 0 0</DataArray>\
                <DataArray type=\"Float32\" Name=\"v\" NumberOfComponents=\"2\">1 2 3 4 nan 6</DataArray></PointData>\
                <Points><DataArray type=\"Float64\" NumberOfComponents=\"3\">0 0 1 4 0 1 0 4 1</DataArray></Points>\
                </Piece></PolyData></VTKFile>";
    let (attributes, rows) =
        rows_of(&output_of("spfinalize", &["--preserve", "--attributes", "all", "-"], text.as_bytes()));
    assert_eq!(attributes.names(), "a<b, v");
    let first =
        [&9_007_199_254_740_993i64.to_le_bytes()[..], &1f32.to_le_bytes(), &2f32.to_le_bytes()].concat();
    assert_eq!(rows[0].1, first);
    let short = text.replace("9007199254740993 -1 5", "9007199254740993 -1");
    assert_outcome("spfinalize", &["--attributes", "v", "-"], short.as_bytes(), 0, "");
    assert_outcome("spfinalize", &["--attributes", "a<b", "-"], short.as_bytes(), 3, "array a<b");
}

/// A mesh of a grid of points whose attribute is 10 x + y, and unknown in one corner.
fn slanted() -> Vec<u8> {
    let mut text = String::from("x,y,z,value,class\n");
    for (x, y) in (0..9).flat_map(|x| (0..9).map(move |y| (x, y))) {
        let value = if (x, y) == (8, 8) { String::new() } else { (10 * x + y).to_string() };
        text += &format!("{x},{y},0,{value},{}\n", x % 3);
    }
    let points = output_of("spfinalize", &["--attributes", "value,class", "-"], text.as_bytes());
    output_of("spdelaunay2d", &[], &points)
}

#[test]
fn attributes_are_drawn_as_rasters() {
    let mesh = slanted();
    let cells = ["--bounds", "0,0,8,8", "--step", "1", "--format", "asc"];
    let raster = |arguments: &[&str]| {
        let text = String::from_utf8(output_of("spdem", &[&cells, arguments].concat(), &mesh)).unwrap();
        let rows =
            text.lines().skip_while(|line| line.starts_with(|first: char| first.is_ascii_alphabetic()));
        rows.map(|row| row.split_whitespace().map(|value| value.parse().unwrap()).collect())
            .collect::<Vec<Vec<f64>>>()
    };
    let linear = raster(&["--attribute", "value"]);
    for (row, y) in linear.iter().zip((0..8).rev()) {
        for (value, x) in row.iter().zip(0..8) {
            let expected = 10.0 * (f64::from(x) + 0.5) + f64::from(y) + 0.5;
            // The triangle at the unknown corner is left out.
            assert!(
                (value - expected).abs() < 1e-4 || ((x, y) == (7, 7) && *value == -9999.0),
                "{x} {y}: {value}"
            );
        }
    }
    let nearest = raster(&["--attribute", "class", "--interpolation", "nearest"]);
    for row in &nearest {
        for (value, x) in row.iter().zip(0..8) {
            assert!([f64::from(x % 3), f64::from((x + 1) % 3)].contains(value));
        }
    }
    assert_outcome(
        "spdem",
        &[&cells[..], &["--attribute", "height"]].concat(),
        &mesh,
        2,
        "no attribute \"height\": they have value, class",
    );
}

#[test]
fn attributes_are_shown_in_pictures() {
    let mesh = slanted();
    let svg = String::from_utf8(output_of("spview", &["--colour-by", "value"], &mesh)).unwrap();
    assert!(svg.contains(">value (all: 0 to 87)<"), "the legend names the attribute and its range");
    assert_outcome(
        "spview",
        &["--colour-by", "rgb"],
        &mesh,
        2,
        "no attribute \"rgb\": they have value, class",
    );
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n\
               property uchar red\nproperty uchar green\nproperty uchar blue\n\
               end_header\n0 0 1 255 0 0\n4 0 1 255 0 0\n0 4 1 255 0 0\n";
    let points = output_of("spfinalize", &["--attributes", "rgb", "-"], ply.as_bytes());
    let mesh = output_of("spdelaunay2d", &[], &points);
    let svg = String::from_utf8(output_of("spview", &["--colour-by", "rgb"], &mesh)).unwrap();
    assert!(svg.contains("#ff0000"), "red triangles");
}

#[test]
fn spinfo_lists_attributes() {
    let file = sample("crop_duplicate.laz");
    let points = output_of("spfinalize", &["--attributes", "scan_angle,rgb", &file], &[]);
    let report: Value = serde_json::from_slice(&output_of("spinfo", &["--json", "-"], &points)).unwrap();
    assert_eq!(report["attributes"][0]["scale"], 0.006);
    assert_eq!(report["attributes"][1]["components"], 3);
    let text = String::from_utf8(output_of("spinfo", &["-"], &points)).unwrap();
    assert!(text.contains("scan_angle, i16 * 0.006 + 0, degree"), "{text}");
}

/// Compressed or not, in text or not: the same attributes.
#[test]
fn conversions_keep_attributes() {
    let file = sample("crop_duplicate.laz");
    let points = output_of("spfinalize", &["--attributes", "all", &file], &[]);
    let compressed = output_of("spfinalize", &["--compress", "--attributes", "all", &file], &[]);
    assert!(compressed.len() < points.len() * 2 / 3, "{} of {} bytes", compressed.len(), points.len());
    let text = output_of("spconvert", &["--to", "text"], &points);
    assert!(output_of("spconvert", &["--to", "text"], &compressed) == text);
    assert!(
        output_of("spconvert", &["--to", "spm"], &text) == output_of("spconvert", &["--to", "spm"], &points)
    );
    assert_eq!(rows_of(&output_of("spconvert", &["--to", "spm"], &text)), rows_of(&points));
}

/// A LAS file with an array of three i16 per point, with a scale and an unknown value for each component.
fn las_with_array(scales: [f64; 3], unknown: [i64; 3], arrays: &[[i16; 3]]) -> Vec<u8> {
    let positions: Vec<[i32; 3]> = (0..arrays.len() as i32).map(|x| [x, x * x, 0]).collect();
    let plain = LasFile { format: 0, ..LasFile::of(&positions) }.bytes();
    let mut description = vec![0; 192];
    // An array of three i16, with an unknown value and a scale.
    description[2..4].copy_from_slice(&[24, 0b1001]);
    description[4..8].copy_from_slice(b"flow");
    for component in 0..3 {
        let at = 8 * component;
        description[40 + at..48 + at].copy_from_slice(&unknown[component].to_le_bytes());
        description[112 + at..120 + at].copy_from_slice(&scales[component].to_le_bytes());
    }
    let (head, records) = plain.split_at(227);
    let mut file =
        [head, &[0; 2], b"LASF_Spec\0\0\0\0\0\0\0", &[4, 0, 192, 0], &[0; 32], &description].concat();
    let start = file.len() as u32;
    file[96..100].copy_from_slice(&start.to_le_bytes());
    file[100..104].copy_from_slice(&1u32.to_le_bytes());
    file[105..107].copy_from_slice(&26u16.to_le_bytes());
    for (record, array) in records.chunks(20).zip(arrays) {
        file.extend(record);
        array.iter().for_each(|number| file.extend(number.to_le_bytes()));
    }
    file
}

#[test]
fn components_of_an_array_keep_their_own_scales() {
    let folder = Folder::new();
    let arrays = [[10, 20, 30], [1, 2, 3], [-5, 2, 7]];
    let read = |scales, unknown, choice: &str| {
        let file = folder.file("a.las", las_with_array(scales, unknown, &arrays));
        rows_of(&output_of(
            "spfinalize",
            &["--preserve", "--attributes", choice, file.to_str().unwrap()],
            &[],
        ))
    };
    let (attributes, rows) = read([0.5, 2.0, 3.0], [1, 2, 3], "flow_1,flow_2,flow_3");
    for (component, expected) in
        [[5.0, f64::NAN, -2.5], [40.0, f64::NAN, f64::NAN], [90.0, f64::NAN, 21.0]].iter().enumerate()
    {
        let column = attributes.column(&format!("flow_{}", component + 1)).unwrap();
        for ((_, row), expected) in rows.iter().zip(expected) {
            let found = column.of(row, 0);
            assert!(found == *expected || found.is_nan() && expected.is_nan(), "{component}: {found}");
        }
    }
    let (attributes, rows) = read([0.5; 3], [7; 3], "flow");
    let last = attributes.column("flow:3").unwrap();
    assert_eq!((last.of(&rows[0].1, 0), last.of(&rows[2].1, 0).is_nan()), (15.0, true));
}

#[test]
fn delimiters_within_quotation_marks_end_no_field() {
    let text = "\"q,r\",x,y,z,\"a \"\n5,0,0,1,7\n\"5\",1,0,2,8\n\"6,5\",0,1,3,9\n";
    let (attributes, rows) =
        rows_of(&output_of("spfinalize", &["--preserve", "--attributes", "a ", "-"], text.as_bytes()));
    let column = attributes.column("a ").unwrap();
    let found: Vec<(Point, f64)> = rows.iter().map(|(point, row)| (*point, column.of(row, 0))).collect();
    assert_eq!(found, [([0., 0., 1.], 7.), ([1., 0., 2.], 8.), ([0., 1., 3.], 9.)]);
}

#[test]
fn one_bad_name_costs_no_other_attribute() {
    let folder = Folder::new();
    let many: Vec<String> = (0..300).map(|number| format!("n{number}")).collect();
    let numbers = vec!["1"; 300].join(",");
    let files = [
        ("a.csv", "x,y,z,a,a,good\n0,0,0,1,2,5\n1,0,0,3,4,5\n".to_string()),
        ("b.csv", format!("x,y,z,{},good\n0,0,0,1,5\n1,0,0,3,5\n", "n".repeat(400))),
        ("c.csv", format!("x,y,z,{},good\n0,0,0,{numbers},5\n1,0,0,{numbers},5\n", many.join(","))),
        (
            "d.ply",
            "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n\
             property int a\nproperty int a\nproperty int good\nend_header\n0 0 0 1 2 5\n1 0 0 3 4 5\n"
                .to_string(),
        ),
    ];
    for (name, content) in files {
        let file = folder.write(name, content);
        let (attributes, rows) = rows_of(&output_of("spfinalize", &["--attributes", "good", &file], &[]));
        let column = attributes.column("good").unwrap();
        assert!(rows.len() == 2 && rows.iter().all(|(_, row)| column.of(row, 0) == 5.0), "{name}");
    }
    let all = output_of("spfinalize", &["--attributes", "all", &folder.path("a.csv")], &[]);
    assert_eq!(rows_of(&all).0.names(), "a, a_2, good");
    let many = folder.path("c.csv");
    assert_outcome("spfinalize", &["--attributes", "all", &many], &[], 2, "choose fewer attributes");
}

#[test]
fn contour_lines_are_those_of_elevations() {
    let arguments = ["--attribute", "a", "--contours", "4"];
    assert_outcome("spdem", &arguments, &[], 2, "cannot be used with");
}
