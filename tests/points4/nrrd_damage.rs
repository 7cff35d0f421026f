//! Damaged NRRD headers and data.

use spmesh_base::error::ErrorKind;
use spmesh_formats::volumes::{From4, read_points4};

use super::{all, assert_fails, gzip, read};
use crate::programs::Folder;
use spmesh_reference::sets::Random;

const GOOD: &str = "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 2 2 1 2\nencoding: raw\n\n12345678";

#[test]
fn the_header_that_is_damaged_below_is_good() {
    assert_eq!(read(GOOD).unwrap().points.len(), 8);
}

#[test]
fn damaged_headers_are_refused_with_line_and_field() {
    let cases: [(&str, &str, &[&str]); 26] = [
        ("NRRD0004", "NRRD00X4", &["line 1", "NRRD0001"]),
        ("type: uchar", "type: block", &["line 2, field type", "\"block\""]),
        ("type: uchar", "type: short", &["line 5, field encoding", "no field endian"]),
        ("type: uchar", "type: short\nendian: middle", &["field endian", "\"middle\""]),
        ("type: uchar\n", "", &["no field type"]),
        ("type: uchar", "type uchar", &["line 2", "name: description"]),
        ("dimension: 4", "dimension: 5", &["line 3, field dimension", "5 dimensions"]),
        ("dimension: 4", "dimension: -4", &["line 3", "\"-4\""]),
        ("dimension: 4", "dimension: 3", &["field sizes", "4 sizes for 3"]),
        ("dimension: 4\n", "", &["no field dimension"]),
        ("sizes: 2 2 1 2", "sizes: 2 2 1", &["line 4, field sizes", "3 sizes for 4"]),
        ("sizes: 2 2 1 2", "sizes: 2 2 0 2", &["field sizes", "no sites"]),
        ("sizes: 2 2 1 2", "sizes: 2 2 +1 2", &["field sizes", "\"+1\""]),
        ("sizes: 2 2 1 2", "sizes: 4294967296 4294967296 4294967296 2", &["field sizes", "more than"]),
        ("sizes: 2 2 1 2", "sizes: 18446744073709551616 1 1 1", &["field sizes", "a size"]),
        ("sizes: 2 2 1 2", "sizes: 2 2 1 2\nsizes: 2 2 1 2", &["line 5", "twice", "line 4"]),
        ("sizes: 2 2 1 2", "sizes: 2 2 1 2\nkinds: domain domain", &["field kinds", "2 kinds for 4"]),
        (
            "sizes: 2 2 1 2",
            "sizes: 2 2 1 2\nkinds: 3-vector domain domain time",
            &["field kinds", "one component"],
        ),
        ("sizes: 2 2 1 2", "sizes: 2 2 1 2\nkinds: time domain domain time", &["field kinds", "several"]),
        ("sizes: 2 2 1 2", "sizes: 100 100 10 10", &["found 8 of 1000000 values"]),
        ("encoding: raw", "encoding: bzip2", &["line 5, field encoding", "unu save"]),
        ("encoding: raw", "encoding: zip", &["line 5", "raw, gzip or text"]),
        ("encoding: raw", "encoding: gzip", &["gzip data"]),
        ("encoding: raw", "encoding: raw\nbyte skip: -2", &["line 6, field byte skip", "or -1"]),
        ("encoding: raw", "encoding: text\nbyte skip: -1", &["line 6, field byte skip", "raw"]),
        ("encoding: raw\n\n", "encoding: raw\n", &["line 6", "name: description"]),
    ];
    for (from, to, parts) in cases {
        assert_fails(read(GOOD.replacen(from, to, 1)), ErrorKind::Malformed, parts);
    }
    let header = GOOD.split("\n\n").next().unwrap();
    assert_fails(read(header), ErrorKind::Malformed, &["truncated", "data file"]);
    let binary = [header.as_bytes(), b"\n\xff\xfe\n\n12345678"].concat();
    assert_fails(read(binary), ErrorKind::Malformed, &["line 6", "a line of text"]);
}

#[test]
fn unknown_fields_are_told() {
    let points =
        read(GOOD.replacen("encoding", "colour: blue\nmin: 0\nmax: 3\nkey:=value\nencoding", 1)).unwrap();
    assert_eq!(points.warnings, ["line 5: unknown field colour is ignored"]);
}

#[test]
fn a_header_without_end_is_not_read_to_the_end() {
    let endless = format!("{}{}", GOOD.split("\n\n").next().unwrap(), "\n# comment".repeat(200_000));
    assert_fails(read(&endless), ErrorKind::Malformed, &["more than 1048576 bytes"]);
    assert_fails(read(gzip(endless.as_bytes())), ErrorKind::Malformed, &["more than 1048576 bytes"]);
}

#[test]
fn truncated_values_are_counted() {
    assert_fails(read(&GOOD[..GOOD.len() - 1]), ErrorKind::Malformed, &["truncated: found 7 of 8 values"]);
    let wide = GOOD.replacen("uchar", "double\nendian: big", 1);
    assert_fails(read(wide), ErrorKind::Malformed, &["found 1 of 8 values"]);
    let from_end =
        GOOD.replacen("encoding", "byte skip: -1\nencoding", 1).replacen("2 2 1 2", "900 2 1 2", 1);
    assert_fails(read(from_end), ErrorKind::Malformed, &["of 3600 values"]);
    let skipped = |field: &str| GOOD.replacen("encoding", &format!("{field}\nencoding"), 1);
    assert_fails(
        read(skipped("byte skip: 9")),
        ErrorKind::Malformed,
        &["9 bytes are to be skipped, found 8"],
    );
    assert_fails(
        read(skipped("line skip: 2")),
        ErrorKind::Malformed,
        &["2 lines are to be skipped, found 1"],
    );
    assert_fails(
        read(skipped("byte skip: 18446744073709551615")),
        ErrorKind::Malformed,
        &["are to be skipped"],
    );
}

#[test]
fn compressed_values_are_read_to_the_end_of_their_data() {
    let header = GOOD.split("raw\n\n").next().unwrap();
    let volume = |data: &[u8]| [header.as_bytes(), b"gzip\n\n", data].concat();
    // 64 MB of zeros in gzip, of which the volume needs 8 bytes.
    let bomb = gzip(&vec![0; 1 << 26]);
    let points = read(volume(&bomb)).unwrap();
    assert_eq!((points.points.len(), &points.warnings[..]), (8, &[SURPLUS.to_string()][..]));
    for cut in [1, 1000, bomb.len() - 15] {
        assert_fails(read(volume(&bomb[..bomb.len() - cut])), ErrorKind::Malformed, &["gzip data ends"]);
    }
    assert_fails(read(volume(&gzip(b"1234"))), ErrorKind::Malformed, &["found 4 of 8 values"]);
    assert_fails(read(volume(b"not gzip data at all")), ErrorKind::Malformed, &["gzip data"]);
}

const SURPLUS: &str =
    "the bytes that follow the 8 values are ignored: are the stated sizes and the type right?";

/// Values enough for several buffers, with the header before them.
fn large(encoding: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("NRRD0004\ntype: uchar\ndimension: 3\nsizes: 100 100 60\nencoding: {encoding}\n\n");
    [header.as_bytes(), data].concat()
}

#[test]
fn checksums_and_lengths_of_compressed_volumes_are_verified() {
    let mut random = Random::new(7);
    let values: Vec<u8> = (0..600_000).map(|_| random.integer(0, 255) as u8).collect();
    let text: String = values.iter().map(|value| format!("{value} ")).collect();
    for (whole, is_file) in [
        (gzip(&values), false),
        (gzip(&large("raw", &values)), true),
        (gzip(&large("text", text.as_bytes())), true),
    ] {
        let file = |data: &[u8]| if is_file { data.to_vec() } else { large("gzip", data) };
        let padded = [&whole[..], &[0; 700]].concat();
        for good in [&whole, &padded] {
            let points = read(file(good)).unwrap();
            assert_eq!((points.points.len(), points.warnings.len()), (600_000, 1), "{:?}", points.warnings);
        }
        // The trailer: the checksum in four bytes, and the length in four.
        for place in whole.len() - 8..whole.len() {
            let mut damaged = whole.clone();
            damaged[place] ^= 4;
            assert_fails(read(file(&damaged)), ErrorKind::Malformed, &["input: ", "gzip data is damaged"]);
            assert_fails(read(file(&whole[..place])), ErrorKind::Malformed, &["input: ", "gzip data ends"]);
        }
        let followed = [&padded[..], b"garbage"].concat();
        assert_fails(read(file(&followed)), ErrorKind::Malformed, &["input: ", "other bytes follow"]);
    }
}

#[test]
fn bytes_after_the_values_are_told() {
    let folder = Folder::new();
    let read_file =
        |content: String| read_points4(&all(From4::File(folder.file("v.nhdr", content)))).unwrap();
    let header = GOOD.strip_suffix("\n12345678").unwrap();
    let detached = folder.file("surplus", b"123456789");
    let named = format!("{}: {SURPLUS}", detached.display());
    assert_eq!(read_file(format!("{header}data file: surplus\n")).warnings, [named]);
    let halves = read_file(format!("{header}byte skip: -1\ndata file: LIST\nsurplus\nsurplus\n"));
    assert!(halves.warnings.is_empty());
    assert_eq!(read(format!("{GOOD}9")).unwrap().warnings, [SURPLUS]);
    let text = |data: &str| read(format!("{}{data}", GOOD.replace("raw\n\n12345678", "text\n\n")));
    assert_eq!(text("1 2 3 4 5 6 7 8 9").unwrap().warnings, [SURPLUS]);
    assert!(text("1 2 3 4 5 6 7 8\n\n \n").unwrap().warnings.is_empty());
}

#[test]
fn text_that_is_no_value_is_counted() {
    let volume = |kind: &str, text: &str| {
        read(format!("NRRD0004\ntype: {kind}\ndimension: 3\nsizes: 2 1 1\nencoding: text\n\n{text}"))
    };
    assert_fails(volume("float", "1 two"), ErrorKind::Malformed, &["value 2", "\"two\""]);
    assert_fails(volume("uchar", "1 256"), ErrorKind::Malformed, &["value 2", "\"256\""]);
    assert_fails(volume("uchar", "1.5 2"), ErrorKind::Malformed, &["value 1", "\"1.5\""]);
    assert_fails(volume("uchar", "1 \n"), ErrorKind::Malformed, &["found 1 of 2"]);
    assert_fails(
        volume("double", &"9".repeat(1 << 20)),
        ErrorKind::Malformed,
        &["value 1", "at most 128 bytes"],
    );
}

#[test]
fn data_files_that_are_not_there_are_named() {
    let header = |field: &str| GOOD.split("\n\n").next().unwrap().to_string() + "\n" + field + "\n";
    let folder = Folder::new();
    let read = |field: &str| read_points4(&all(From4::File(folder.file("volume.nhdr", header(field)))));
    assert_fails(read("data file: no.raw"), ErrorKind::Io, &["no.raw", "opening"]);
    folder.file("three", [1, 2, 3]);
    assert_fails(
        read("data file: LIST\nthree\nthree"),
        ErrorKind::Malformed,
        &["three", "found 3 of 4 values"],
    );
    assert_fails(read("data file: ."), ErrorKind::Malformed, &["not a file"]);
    assert_fails(read("data file:"), ErrorKind::Malformed, &["line 6, field data file", "name of a file"]);
    assert_fails(read("data file: LIST"), ErrorKind::Malformed, &["0 files"]);
    assert_fails(read("data file: LIST\na\nb\nc"), ErrorKind::Malformed, &["8 values cannot be in 3 files"]);
    assert_fails(read("data file: a%s 1 2 1"), ErrorKind::Malformed, &["%03d"]);
    assert_fails(read("data file: a%d 1 2 0"), ErrorKind::Malformed, &["increasing"]);
    assert_fails(read("data file: a%d 1 99999999999 1"), ErrorKind::Malformed, &["65536 increasing"]);
    assert_fails(read("data file: a%99999d 1 2 1"), ErrorKind::Malformed, &["%03d"]);
}
