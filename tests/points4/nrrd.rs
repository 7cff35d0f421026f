//! NRRD volumes.

use spmesh_base::error::Result;
use spmesh_formats::volumes::{From4, Request, Selected4, Spacing, read_points4};

use super::{all, gzip, read, sample, value_at, with_condition};
use crate::programs::Folder;

/// A volume of 2 x 2 x 1 x 2 bytes from 1 to 8, with additional header fields.
fn small(fields: &str) -> Vec<u8> {
    let mut file = format!("NRRD0004\ntype: uchar\ndimension: 4\nsizes: 2 2 1 2\nencoding: raw\n{fields}\n");
    file.extend('\u{1}'..='\u{8}');
    file.into_bytes()
}

/// As `read`, with coordinates in world units.
fn read_world(content: &[u8]) -> Result<Selected4> {
    let folder = Folder::new();
    let from = From4::File(folder.file("input", content));
    read_points4(&Request { spacing: Spacing::World, ..all(from) })
}

fn values(points: Selected4) -> Vec<f64> {
    points.values.expect("a volume has values")
}

#[test]
fn a_volume_of_pynrrd_is_what_numpy_says() {
    let points = read_points4(&all(sample("functional_crop.nrrd"))).unwrap();
    assert_eq!((points.points.len(), points.warnings.len()), (360, 0));
    assert_eq!(points.values.as_ref().unwrap()[..2], [7598.0, 13637.0]);
    assert_eq!(value_at(&points, [5.0, 4.0, 2.0, 3.0]), -2635.0);
    assert_eq!(values(points).into_iter().sum::<f64>(), 3_649_376.0);
    let few = read_points4(&with_condition(sample("functional_crop.nrrd"), "value < 10000")).unwrap();
    assert_eq!(few.points.len(), 162);

    let world =
        read_points4(&Request { spacing: Spacing::World, ..all(sample("functional_crop.nrrd")) }).unwrap();
    assert_eq!(value_at(&world, [16.0 - 20.0, -28.0 + 16.0, 16.0, 3.0]), -2635.0);
    assert!(world.warnings.is_empty());
}

#[test]
fn the_first_axis_changes_fastest() {
    let points = read(small("")).unwrap();
    assert_eq!(points.points[..3], [[0.0; 4], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]]);
    assert_eq!(value_at(&points, [1.0, 1.0, 0.0, 1.0]), 8.0);
    assert_eq!(values(points), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
}

#[test]
fn time_is_the_axis_of_that_kind_or_the_list() {
    for kinds in ["time domain domain domain", "list space space space", "TIME list domain domain"] {
        let points = read(small(&format!("kinds: {kinds}\n"))).unwrap();
        assert_eq!(points.points[1], [0.0, 0.0, 0.0, 1.0], "{kinds}");
        assert_eq!(points.points[7], [1.0, 0.0, 1.0, 1.0], "{kinds}");
    }
    let points = read(small("kinds: space space space list\n")).unwrap();
    assert_eq!(points.points[1], [1.0, 0.0, 0.0, 0.0]);
}

#[test]
fn three_dimensions_leave_one_coordinate_at_zero() {
    let volume = |kinds: &str| {
        let header = format!("NRRD0001\ntype: uint8\ndimension: 3\nsizes: 1 2 2\nencoding: raw\n{kinds}\n");
        read([header.as_bytes(), &[1, 2, 3, 4]].concat()).unwrap()
    };
    let points = volume("");
    assert_eq!(points.points[3], [0.0, 1.0, 1.0, 0.0]);
    assert_eq!(points.warnings, ["the volume has three dimensions: all points have t = 0"]);
    let points = volume("kinds: domain domain time\n");
    assert_eq!(points.points[3], [0.0, 1.0, 0.0, 1.0]);
    assert_eq!(points.warnings, ["the volume has three dimensions: all points have z = 0"]);
}

#[test]
fn all_encodings_and_byte_orders_give_the_same_values() {
    let numbers = [-3i16, 0, 258, 32767];
    let volume = |fields: &str, data: &[u8]| {
        let header = format!(
            "NRRD0005\r\n# comment\r\ntype: signed short int\r\nDIMENSION: 4\r\nsizes: 4 1 1 1\r\n{fields}\r\nkey:=value: 3\r\n\r\n"
        );
        values(read([header.as_bytes(), data].concat()).unwrap())
    };
    let [le, be] = [numbers.map(i16::to_le_bytes).concat(), numbers.map(i16::to_be_bytes).concat()];
    let expected = [-3.0, 0.0, 258.0, 32767.0];
    assert_eq!(volume("encoding: raw\r\nendian: little", &le), expected);
    assert_eq!(volume("encoding: RAW\r\nendian: big", &be), expected);
    assert_eq!(volume("encoding: gzip\r\nendian: little", &gzip(&le)), expected);
    assert_eq!(volume("encoding: gz\r\nendian: Big", &gzip(&be)), expected);
    assert_eq!(volume("encoding: ascii", b"-3 0\n258,\t32767\n"), expected);
    assert_eq!(volume("encoding: text", b"\n\n -3 0 258 32767"), expected);
    assert_eq!(
        volume("encoding: raw\r\nendian: little\r\nbyte skip: 3", &[b"abc", &le[..]].concat()),
        expected
    );
    assert_eq!(
        volume("encoding: raw\r\nendian: little\r\nbyteskip: -1", &[b"abc\n", &le[..]].concat()),
        expected
    );
    assert_eq!(
        volume("encoding: raw\r\nendian: little\r\nline skip: 2", &[b"a\nb\n", &le[..]].concat()),
        expected
    );
    let skipped = [b"a\n", &gzip(&[b"abc", &be[..]].concat())[..]].concat();
    assert_eq!(volume("encoding: gz\r\nendian: big\r\nlineskip: 1\r\nbyte skip: 3", &skipped), expected);
    // Bytes after the values are ignored.
    assert_eq!(volume("encoding: raw\r\nendian: little", &[&le[..], b"more"].concat()), expected);
}

#[test]
fn text_may_hold_missing_values() {
    let header = "NRRD0004\ntype: float\ndimension: 4\nsizes: 4 1 1 1\nencoding: text\n\nnan 1e3 -.5 inf\n";
    let points = read(header).unwrap();
    assert_eq!(values(points), [1000.0, -0.5, f64::INFINITY]);
}

#[test]
fn a_volume_that_is_compressed_as_a_whole_is_read() {
    assert_eq!(values(read(gzip(&small(""))).unwrap())[7], 8.0);
}

/// Points of a detached header in a new folder, beside these data files.
fn detached(field: &str, files: &[(&str, &[u8])]) -> Result<Selected4> {
    let folder = Folder::new();
    files.iter().for_each(|(name, content)| drop(folder.file(name, content)));
    let header = format!("NRRD0005\ntype: uchar\ndimension: 4\nsizes: 2 1 1 2\nencoding: raw\n{field}");
    read_points4(&all(From4::File(folder.file("volume.nhdr", header))))
}

#[test]
fn values_may_be_in_other_files() {
    let whole: &[(&str, &[u8])] = &[("my values.raw", &[1, 2, 3, 4])];
    assert_eq!(values(detached("data file: my values.raw", whole).unwrap()), [1.0, 2.0, 3.0, 4.0]);
    assert_eq!(values(detached("datafile: ./my values.raw\n\n", whole).unwrap()), [1.0, 2.0, 3.0, 4.0]);
    let halves: &[(&str, &[u8])] = &[("at008.raw", &[1, 2]), ("at010.raw", &[3, 4])];
    for field in [
        "data file: at%03d.raw 8 10 2",
        "data file: LIST\nat008.raw\nat010.raw\n",
        "data file: LIST 3\r\nat008.raw\r\nat010.raw",
    ] {
        assert_eq!(values(detached(field, halves).unwrap()), [1.0, 2.0, 3.0, 4.0], "{field}");
    }
    let ends: &[(&str, &[u8])] = &[("a", &[9, 9, 1, 2]), ("b", &[9, 3, 4])];
    assert_eq!(
        values(detached("byte skip: -1\ndata file: LIST\na\nb\n", ends).unwrap()),
        [1.0, 2.0, 3.0, 4.0]
    );
}

#[test]
fn world_units_are_what_the_header_states() {
    let places = |fields: &str| {
        let points = read_world(&small(fields)).unwrap_or_else(|e| panic!("{fields}: {e}"));
        assert!(points.warnings.is_empty(), "{fields}: {:?}", points.warnings);
        [points.points[0], points.points[7]]
    };
    assert_eq!(places("spacings: 0.5 2 nan 10\n"), [[0.0; 4], [0.5, 2.0, 0.0, 10.0]]);
    assert_eq!(
        places("spacings: 1 1 1 1\naxis mins: 5 -3 nan nan\n"),
        [[5.0, -3.0, 0.0, 0.0], [6.0, -2.0, 0.0, 1.0]]
    );
    assert_eq!(
        places("axismins: 5 0 0 0\naxismaxs: 7 4 nan 0.5\n"),
        [[5.0, 0.0, 0.0, 0.0], [7.0, 4.0, 0.0, 0.5]]
    );
    assert_eq!(
        places("axis mins: 0 0 0 0\naxis maxs: 4 4 1 4\ncenterings: cell node ??? cell\n"),
        [[1.0, 0.0, 0.0, 1.0], [3.0, 4.0, 0.0, 3.0]]
    );
    let directions = "space: RAS\nspace directions: (2,0,0) (0,-4,0) (0,0,3) none\nspace origin: (1,8, -1)\n";
    assert_eq!(places(directions), [[1.0, 8.0, -1.0, 0.0], [3.0, 4.0, -1.0, 1.0]]);
    let time_first = "kinds: time space space space\nspace directions: none (2,0,0) (0,4,0) (0,0,3)\nspace origin: (1,8,-1)\n";
    assert_eq!(places(time_first), [[1.0, 8.0, -1.0, 0.0], [3.0, 8.0, 2.0, 1.0]]);
    let of_time = "space directions: (2,0,0,0) (0,4,0,0) (0,0,3,0) (0,0,0,5)\nspace origin: (0,0,0,100)\n";
    assert_eq!(places(of_time), [[0.0, 0.0, 0.0, 100.0], [2.0, 4.0, 0.0, 105.0]]);
}

#[test]
fn axes_without_directions_have_spacings() {
    let places = |fields: &str| {
        let points = read_world(&small(fields)).unwrap_or_else(|e| panic!("{fields}: {e}"));
        [points.points[0], points.points[7]]
    };
    let space = "space directions: (2,0,0) (0,4,0) (0,0,3) none\nspace origin: (1,8,-1)\n";
    for (fields, [from, to]) in [
        ("spacings: nan nan nan 2\n", [0.0, 2.0]),
        ("axis mins: nan nan nan 5\naxis maxs: nan nan nan 8\n", [5.0, 8.0]),
        ("spacings: nan nan nan 2\naxis mins: nan nan nan 5\ncenters: ??? ??? ??? cell\n", [6.0, 8.0]),
        ("", [0.0, 1.0]),
    ] {
        let expected = [[1.0, 8.0, -1.0, from], [3.0, 12.0, -1.0, to]];
        assert_eq!(places(&format!("{space}{fields}")), expected, "{fields}");
    }
    let none = "space dimension: 3\nspace directions: none none none none\nspacings: 0.25 0.5 2 0.75\n";
    assert_eq!(places(none), [[0.0; 4], [0.25, 0.5, 0.0, 0.75]]);
    let first = "kinds: time space space space\nspace directions: none (0,2,0) (4,0,0) (0,0,3)\nspacings: 7 nan nan nan\n";
    assert_eq!(places(first)[1], [0.0, 2.0, 3.0, 7.0]);
    // Two axes of the plane, and one that has no direction.
    let plane = "space dimension: 2\nspace directions: (2,0) (0,4) none none\nspacings: nan nan 5 6\n";
    assert_eq!(places(plane)[1], [2.0, 4.0, 0.0, 6.0]);
}

#[test]
fn units_of_headers_are_told() {
    let warnings =
        |fields: &str| read_world(&small(&format!("spacings: 1 1 1 1\n{fields}"))).unwrap().warnings;
    let told = "world coordinates are in the units of the header:";
    assert_eq!(warnings("space units: \"mm\" \"mm\" \"mm\"\n"), [format!("{told} lengths are in mm")]);
    let units = "units: \"cm\" \"cm\" \"mm\" \"ms\"\n";
    assert_eq!(warnings(units), [format!("{told} lengths are in cm, mm, times are in ms")]);
    assert!(warnings("units: \"\" \"\" \"\" \"\"\n").is_empty());
}

#[test]
fn directions_may_be_oblique_or_in_another_order() {
    let turned = "space directions: (0,2,0) (4,0,0) (0,0,3) none\nspace origin: (1,8,-1)\n";
    let points = read_world(&small(turned)).unwrap();
    assert_eq!((points.points[7], points.orientation), ([5.0, 10.0, -1.0, 1.0], None));
    let oblique = "kinds: time space space space\nspace directions: none (3,4,0) (-8,6,0) (0,0,3)\n\
                   space origin: (1,8,-1)\n";
    let points = read_world(&small(oblique)).unwrap();
    // The axis of z has one more sample, that of y none.
    assert_eq!(points.points[7], [5.0, 0.0, 3.0, 1.0]);
    assert_eq!(points.orientation.unwrap().point_to_world(points.points[7]), [4.0, 12.0, 2.0, 1.0]);
}

#[test]
fn rounded_world_units_are_told() {
    let points = read_world(&small("spacings: 0.1 0.3 1 1\naxis mins: 0.7 0 0 0\n")).unwrap();
    assert_eq!(points.warnings.len(), 1);
    assert!(points.warnings[0].contains("rounded"), "{:?}", points.warnings);
}

#[test]
fn world_units_that_are_not_known_are_refused() {
    for (fields, part) in [
        ("", "states no spacing"),
        ("spacings: nan nan nan nan\n", "states no spacing"),
        ("spacings: 1 2 0 1\n", "0 apart"),
        ("spacings: 1 2 inf 1\n", "inf apart"),
        ("spacings: 1 2 1\n", "3 entries for 4"),
        ("spacings: 1 2 one 1\n", "\"one\""),
        ("space directions: (1,0.1,0) (0,1,0) (0,0,1) none\n", "not perpendicular"),
        ("space directions: (1,0.1,0,0) (0,1,0,0) (0,0,1,0) (0,0,0,1)\n", "along the axes"),
        ("space directions: (1,0,0) (0,1,0) (0,0,1)\n", "for each axis"),
        ("space directions: (1,0,0) (0,1) (0,0,1) none\n", "components"),
        ("space directions: (1,0,0) (0,1,0 none\n", "a vector"),
        ("space directions: (1,0,0) (0,1,0) (0,0,1) none\nspace origin: (1,2)\n", "components"),
    ] {
        let error = read_world(&small(fields)).expect_err(fields).to_string();
        assert!(error.contains(part) && error.contains("grid indices"), "{fields}: {error}");
        assert!(read(small(fields)).is_ok(), "{fields}");
    }
}
