//! Volumes of raw numbers without a header.

use spmesh_base::error::{ErrorKind, Result};
use spmesh_formats::volumes::{From4, RawLayout, Selected4, parse_sizes, read_points4};

use super::{all, assert_fails, gzip};
use crate::programs::Folder;

fn read(name: &str, content: &[u8], layout: &str) -> Result<Selected4> {
    let folder = Folder::new();
    read_points4(&all(From4::Raw(folder.file(name, content), layout.parse().expect("a layout"))))
}

#[test]
fn every_type_is_read_in_both_byte_orders() {
    macro_rules! check {
        ($type:ty, $numbers:expr) => {{
            let numbers: [$type; 2] = $numbers;
            for (order, bytes) in [
                ("le", numbers.map(<$type>::to_le_bytes).concat()),
                ("be", numbers.map(<$type>::to_be_bytes).concat()),
            ] {
                let points =
                    read("volume", &bytes, &format!("1x2x1x1:{}{order}", stringify!($type))).unwrap();
                assert_eq!(points.points, [[0.0; 4], [0.0, 1.0, 0.0, 0.0]]);
                assert_eq!(points.values.unwrap(), numbers.map(|number| number as f64));
            }
        }};
    }
    check!(i8, [-128, 5]);
    check!(u8, [200, 5]);
    check!(i16, [-30_000, 258]);
    check!(u16, [60_000, 258]);
    check!(i32, [-2_000_000_000, 66_051]);
    check!(u32, [4_000_000_000, 66_051]);
    check!(i64, [-9_007_199_254_740_991, 1 << 40]);
    check!(u64, [9_007_199_254_740_991, 1 << 40]);
    check!(f32, [-0.1, 3e38]);
    check!(f64, [-0.1, 1e300]);
}

#[test]
fn sizes_that_do_not_fit_the_file_are_refused() {
    let parts = ["truncated: found 7 of 8 values"];
    assert_fails(read("volume", &[0; 15], "2x2x2x1:u16le"), ErrorKind::Malformed, &parts);
    assert_fails(read("volume", &[0; 17], "2x2x2x1:u16le"), ErrorKind::Malformed, &["more than 16 bytes"]);
    assert_fails(
        read("volume", &[0; 16], "1024x1024x1024x1024:f64le"),
        ErrorKind::Malformed,
        &["found 2 of 1099511627776"],
    );
}

#[test]
fn a_compressed_volume_is_told_by_its_name() {
    let bytes = gzip(&[1, 2, 3, 4]);
    assert_eq!(read("volume.raw.gz", &bytes, "4x1x1x1:u8").unwrap().values.unwrap(), [1.0, 2.0, 3.0, 4.0]);
    // Raw data may start like gzip data.
    let plain = read("volume.raw", &bytes, &format!("{}x1x1x1:u8", bytes.len())).unwrap();
    assert_eq!(plain.values.unwrap()[..2], [31.0, 139.0]);
}

#[test]
fn a_compressed_volume_is_read_no_further_than_its_size() {
    // 64 MB of zeros in 64 KB.
    let bomb = gzip(&vec![0; 1 << 26]);
    assert_fails(read("bomb.gz", &bomb, "2x2x2x2:u8"), ErrorKind::Malformed, &["more than 16 bytes"]);
}

#[test]
fn layouts_are_read_and_written() {
    for layout in ["64x64x64x20:f32le", "1x2x3x4:u8", "5x6x7x8:i64be"] {
        assert_eq!(layout.parse::<RawLayout>().unwrap().to_string(), layout);
    }
    let cases = [
        ("64x64x64x20", "as in 64x64x64x20:f32le"),
        ("64x64x64:u8", "not four sizes"),
        ("64x64x64x20x3:u8", "not four sizes"),
        ("64x64x0x20:u8", "not four sizes"),
        ("64x-1x64x20:u8", "not four sizes"),
        ("64x64x99999999999999999999x20:u8", "not four sizes"),
        ("4294967296x4294967296x4294967296x20:u8", "more than"),
        ("64x64x64x20:f32", "f32le or f32be"),
        ("64x64x64x20:float", "unknown type"),
        ("64x64x64x20:", "unknown type"),
    ];
    for (layout, part) in cases {
        let error = layout.parse::<RawLayout>().unwrap_err();
        assert!(error.contains(part), "{layout}: {error}");
    }
    assert_eq!(parse_sizes("16x1x2x3"), Ok([16, 1, 2, 3]));
    assert!(parse_sizes("").is_err() && parse_sizes("+1x1x1x1").is_err() && parse_sizes("1x1x1x").is_err());
}
