//! NIfTI-1 volumes.

use spmesh_base::error::{ErrorKind, Result};
use spmesh_formats::volumes::{From4, Request, Selected4, Spacing, read_points4};

use super::{all, assert_fails, gzip, read, sample, value_at, with_condition};
use crate::programs::Folder;

/// A NIfTI-1 header in one of the two byte orders.
struct Header {
    bytes: Vec<u8>,
    is_big: bool,
}

impl Header {
    /// The header of a volume of 2 x 1 x 1 x 2 values of 16 bits.
    fn new(is_big: bool) -> Header {
        let mut header = Header { bytes: vec![0; 352], is_big };
        header.bytes[344..348].copy_from_slice(b"n+1\0");
        header.put(0, 348i32.to_le_bytes());
        [4i16, 2, 1, 1, 2]
            .into_iter()
            .enumerate()
            .for_each(|(at, len)| header.put(40 + 2 * at, len.to_le_bytes()));
        header.put(70, 4i16.to_le_bytes());
        header.put(72, 16i16.to_le_bytes());
        (0..4).for_each(|axis| header.put(80 + 4 * axis, 1f32.to_le_bytes()));
        header.put(108, 352f32.to_le_bytes());
        header
    }

    fn put<const N: usize>(&mut self, at: usize, mut bytes: [u8; N]) {
        if self.is_big {
            bytes.reverse();
        }
        self.bytes[at..at + N].copy_from_slice(&bytes);
    }

    fn with<const N: usize>(mut self, at: usize, little: [u8; N]) -> Header {
        self.put(at, little);
        self
    }

    /// The file: the header and the values 1, 2, 3 and -4.
    fn file(mut self) -> Vec<u8> {
        for number in [1i16, 2, 3, -4] {
            self.bytes.extend(if self.is_big { number.to_be_bytes() } else { number.to_le_bytes() });
        }
        self.bytes
    }
}

fn read_world(content: &[u8]) -> Result<Selected4> {
    let folder = Folder::new();
    let from = From4::File(folder.file("input", content));
    read_points4(&Request { spacing: Spacing::World, ..all(from) })
}

#[test]
fn a_series_is_what_nibabel_says() {
    let points = read_points4(&all(sample("functional.nii"))).unwrap();
    assert_eq!((points.points.len(), points.warnings.len()), (21420, 0));
    assert_eq!(
        points.values.as_ref().unwrap()[..3],
        [4004.137202501297, 4143.715501368046, 3894.6462841033936]
    );
    assert_eq!(value_at(&points, [3.0, 5.0, 1.0, 7.0]), 3780.6309475898743);

    let bright = read_points4(&with_condition(sample("functional.nii"), "value > 4500")).unwrap();
    assert_eq!(bright.points.len(), 937);
    let sums = [0, 1, 2, 3].map(|axis| bright.points.iter().map(|point| point[axis]).sum::<f64>());
    assert_eq!(sums, [7484.0, 6472.0, 971.0, 8845.0]);

    let world = read_points4(&Request { spacing: Spacing::World, ..all(sample("functional.nii")) }).unwrap();
    assert_eq!(value_at(&world, [32.0 - 12.0, -40.0 + 20.0, 8.0, 14.0]), 3780.6309475898743);
    let units = "world coordinates are in the units of the header: lengths are in mm, times are in s";
    assert_eq!(world.warnings, [units]);
}

#[test]
fn both_byte_orders_are_read_plain_and_compressed() {
    for is_big in [false, true] {
        let file = Header::new(is_big).file();
        for content in [gzip(&file), file] {
            let points = read(content).unwrap();
            assert_eq!(points.points[2], [0.0, 0.0, 0.0, 1.0]);
            assert_eq!(points.values.unwrap(), [1.0, 2.0, 3.0, -4.0]);
        }
    }
}

#[test]
fn checksums_of_compressed_volumes_are_verified_and_surplus_is_told() {
    let file = |values: &[u8]| {
        let large = Header::new(false).with(42, 300i16.to_le_bytes()).with(44, 300i16.to_le_bytes());
        [&large.bytes, values].concat()
    };
    let values: Vec<u8> = (0..360_000u32).map(|i| (i % 9973 * 31 / 7) as u8).collect();
    let whole = gzip(&file(&values));
    assert!(read(&whole).unwrap().warnings.is_empty());
    for place in whole.len() - 8..whole.len() {
        let mut damaged = whole.clone();
        damaged[place] ^= 1;
        assert_fails(read(damaged), ErrorKind::Malformed, &["input: ", "gzip data is damaged"]);
    }
    let surplus = file(&[&values[..], &[0]].concat());
    for content in [gzip(&surplus), surplus] {
        let warnings = read(content).unwrap().warnings;
        assert!(
            warnings[0].starts_with("the bytes that follow the 180000 values are ignored"),
            "{warnings:?}"
        );
    }
}

#[test]
fn values_are_scaled_if_a_slope_is_stated() {
    let scaled = |slope: f32, intercept: f32| {
        Header::new(false).with(112, slope.to_le_bytes()).with(116, intercept.to_le_bytes()).file()
    };
    assert_eq!(read(scaled(0.5, 10.0)).unwrap().values.unwrap(), [10.5, 11.0, 11.5, 8.0]);
    assert_eq!(read(scaled(0.0, 10.0)).unwrap().values.unwrap()[0], 1.0);
    assert_fails(read(scaled(f32::INFINITY, 0.0)), ErrorKind::Malformed, &["scl_slope"]);
}

#[test]
fn extensions_lie_between_header_and_values() {
    let mut header = Header::new(false).with(108, 368f32.to_le_bytes());
    header.bytes.extend([7; 16]);
    assert_eq!(read(header.file()).unwrap().values.unwrap(), [1.0, 2.0, 3.0, -4.0]);
}

#[test]
fn world_units_follow_sform_then_qform_then_the_distances() {
    let steps = |header: Header| -> Header {
        let header = header.with(80, 2f32.to_le_bytes()).with(92, 0.5f32.to_le_bytes());
        header.with(136, 100f32.to_le_bytes())
    };
    let last = |header: Header| read_world(&header.file()).map(|points| points.points[3]);
    assert_eq!(last(steps(Header::new(false))).unwrap(), [2.0, 0.0, 0.0, 100.5]);
    // Half a turn around z, and an offset.
    let turned = |header: Header| {
        header.with(252, 1i16.to_le_bytes()).with(264, 1f32.to_le_bytes()).with(268, 7f32.to_le_bytes())
    };
    assert_eq!(last(turned(steps(Header::new(true)))).unwrap(), [5.0, 0.0, 0.0, 100.5]);
    let mapped = |header: Header, off: f32| {
        let header =
            header.with(254, 1i16.to_le_bytes()).with(280, 3f32.to_le_bytes()).with(284, off.to_le_bytes());
        header.with(300, 1f32.to_le_bytes()).with(320, 1f32.to_le_bytes()).with(292, (-1f32).to_le_bytes())
    };
    assert_eq!(last(mapped(turned(steps(Header::new(false))), 0.0)).unwrap(), [2.0, 0.0, 0.0, 100.5]);
    assert_fails(
        read_world(&mapped(Header::new(false), 0.25).file()),
        ErrorKind::Usage,
        &["not perpendicular", "grid indices"],
    );
    // A quarter turn around z: the axes of the grid are those of the world in another order.
    let half = std::f32::consts::FRAC_1_SQRT_2.to_le_bytes();
    let quarter = steps(Header::new(false)).with(252, 1i16.to_le_bytes()).with(264, half);
    let points = read_world(&quarter.file()).unwrap();
    assert_eq!((points.points[1], points.orientation), ([0.0, 2.0, 0.0, 100.0], None));
    let sixth = steps(Header::new(false)).with(252, 1i16.to_le_bytes()).with(264, 0.5f32.to_le_bytes());
    let points = read_world(&sixth.file()).unwrap();
    assert_eq!(points.points[3], [2.0, 0.0, 0.0, 100.5]);
    let [x, y, z] = points.orientation.unwrap().to_world([2.0, 0.0, 0.0]);
    assert!((x - 1.0).abs() + (y - 3f64.sqrt()).abs() + z.abs() < 1e-15, "{x} {y} {z}");
    let flat = Header::new(false).with(80, 0f32.to_le_bytes());
    assert_fails(read_world(&flat.file()), ErrorKind::Usage, &["apart"]);
}

#[test]
fn units_are_told_with_world_coordinates() {
    let warnings = |units: u8| read_world(&Header::new(false).with(123, [units]).file()).unwrap().warnings;
    let told = "world coordinates are in the units of the header:";
    assert_eq!(warnings(3 | 16), [format!("{told} lengths are in micrometres, times are in ms")]);
    assert_eq!(warnings(32), [format!("{told} times are in Hz")]);
    assert!(warnings(0).is_empty());
    assert!(read(Header::new(false).with(123, [10]).file()).unwrap().warnings.is_empty());
}

#[test]
fn single_volumes_are_at_time_zero() {
    let points =
        read(Header::new(false).with(40, 3i16.to_le_bytes()).with(42, 4i16.to_le_bytes()).file()).unwrap();
    assert_eq!(points.points[3], [3.0, 0.0, 0.0, 0.0]);
    assert_eq!(points.warnings, ["the volume has one time step: all points have t = 0"]);
}

#[test]
fn damaged_headers_are_refused_by_field() {
    let number = |number: i16| number.to_le_bytes();
    let cases: [(Header, &[&str]); 11] = [
        (Header::new(false).with(40, number(0)), &["dim[0]", "found 0"]),
        (Header::new(true).with(40, number(8)), &["dim[0]", "found 8"]),
        (Header::new(false).with(44, number(-1)), &["dim[2]", "size -1"]),
        (Header::new(false).with(40, number(5)).with(50, number(3)), &["dim[5]", "fifth dimension"]),
        (Header::new(false).with(70, number(128)), &["datatype", "type 128"]),
        (Header::new(false).with(72, number(8)), &["bitpix", "states 8 bits"]),
        (Header::new(false).with(108, 0f32.to_le_bytes()), &["vox_offset", "byte 0"]),
        (Header::new(false).with(108, f32::NAN.to_le_bytes()), &["vox_offset", "NaN"]),
        (Header::new(false).with(108, 1e30f32.to_le_bytes()), &["vox_offset"]),
        (Header::new(false).with(48, number(3)), &["truncated: found 4 of 6 values"]),
        (Header::new(false).with(108, 4096f32.to_le_bytes()), &["4096 bytes are to be skipped, found 360"]),
    ];
    for (header, parts) in cases {
        assert_fails(read(header.file()), ErrorKind::Malformed, parts);
    }
    let largest =
        (0..4).fold(Header::new(false), |header, axis| header.with(42 + 2 * axis, number(i16::MAX)));
    assert_fails(read(largest.file()), ErrorKind::Usage, &["more than"]);
}

#[test]
fn kin_of_the_format_are_told_apart() {
    let mut pair = Header::new(false);
    pair.bytes[344..348].copy_from_slice(b"ni1\0");
    assert_fails(read(pair.file()), ErrorKind::Malformed, &["pair of files"]);
    let mut second = Header::new(false).with(0, 540i32.to_le_bytes());
    second.bytes[4..8].copy_from_slice(b"n+2\0");
    assert_fails(read(second.file()), ErrorKind::Malformed, &["NIfTI-2"]);
    for len in [346, 347, 350] {
        let file = Header::new(false).file();
        assert_fails(read(&file[..len]), ErrorKind::Malformed, &[]);
    }
}
