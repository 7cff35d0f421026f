//! Attributes of points: written and read as they are, and every fault is found.

use spmesh_base::error::ErrorKind;
use spmesh_formats::drivers::Format;
use spmesh_stream::model::attributes::{Attribute, Attributes, NumberType};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, Event, Header, Kind, Patch, StreamReader, StreamWriter};

use super::{Random, frames, random_stream, seal, write_rows};
use crate::convert::{converted, text_of};
use crate::vectors::{repository, verify, verify_rows};

const NUMBERS: [NumberType; 10] = [
    NumberType::U8,
    NumberType::I8,
    NumberType::U16,
    NumberType::I16,
    NumberType::U32,
    NumberType::I32,
    NumberType::U64,
    NumberType::I64,
    NumberType::F32,
    NumberType::F64,
];

/// One to five attributes with all that an attribute may state.
pub fn random_attributes(random: &mut Random) -> Attributes {
    let count = 1 + random.below(5);
    let attribute = |number: usize| {
        let kind = NUMBERS[random.below(NUMBERS.len())];
        Attribute {
            name: format!("a{number} \u{e9}\""),
            number: kind,
            components: 1 + random.below(3) as u8,
            unit: if random.coin() { "m/s".into() } else { String::new() },
            las_name: if random.coin() { "Scan Angle".into() } else { String::new() },
            scale: random.coin().then(|| [0.006, -(random.below(9) as f64)]),
            unknown: random.coin().then(|| (0..kind.width()).map(|_| random.next() as u8).collect()),
        }
    };
    Attributes::new((0..count).map(attribute).collect()).unwrap()
}

/// Bytes that follow from a point, NaN of all kinds included.
fn row_of(header: &Header, point: Point) -> Vec<u8> {
    let bits = point.map(|value| (value + 0.0).to_bits()).into_iter().fold(7, u64::wrapping_add);
    let mut random = Random(bits);
    (0..header.attributes.row_len()).map(|_| if random.coin() { 0xff } else { random.next() as u8 }).collect()
}

/// The rows of each event.
pub fn rows_of(header: &Header, events: &[Event]) -> Vec<Vec<u8>> {
    let rows = |points: &mut dyn Iterator<Item = Point>| points.flat_map(|at| row_of(header, at)).collect();
    let of_event = |event: &Event| match event {
        Event::Points(points) => rows(&mut points.iter().copied()),
        Event::Patch(patch) => rows(&mut patch.new.iter().copied()),
        Event::ResidualPoints(points) => rows(&mut points.iter().map(|&(_, at)| at)),
        _ => Vec::new(),
    };
    events.iter().map(of_event).collect()
}

/// Random streams that have attributes.
fn streams() -> impl Iterator<Item = (Header, Vec<u8>)> {
    let all = (0..400).map(random_stream).map(|(header, _, bytes)| (header, bytes));
    all.filter(|(header, _)| !header.attributes.is_empty())
}

#[test]
fn twins_keep_every_bit() {
    for (header, bytes) in streams() {
        let text = text_of(&bytes);
        let again = converted(text.as_bytes(), Format::Twin, Format::Stream).unwrap();
        let ((read, _, rows), (read_again, _, rows_again)) =
            (verify_rows(&bytes).unwrap(), verify_rows(&again).unwrap());
        assert_eq!((&read, &read_again), (&header, &header));
        assert_eq!(rows_again.concat(), rows.concat());
        assert_eq!(text_of(&again), text);
    }
}

#[test]
fn a_line_of_a_row_must_be_there_and_fit() {
    let header = Header {
        attributes: Attributes::new(vec![Attribute::new("class", NumberType::U8)]).unwrap(),
        ..Header::new(Kind::Points, Coordinates::F64, 2, false)
    };
    let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
    writer.points_with_rows(&[[1.0, 2.0, 0.0], [3.0, 4.0, 0.0]], &[7, 8]).unwrap();
    let text = text_of(&writer.end(0, 0).unwrap());
    assert!(text.contains("v 1 2 0\na 7\nv 3 4 0\na 8\n"), "{text}");
    for (found, replaced, expected) in [
        ("a 7\n", "", "a line \"a\" with the attributes"),
        ("a 8\n", "", "a line \"a\" with the attributes"),
        ("a 8\n", "a 8\na 8\n", "attributes without a point"),
        ("a 7\n", "a 256\n", "a number of type u8"),
        ("a 7\n", "a 7 7\n", "the end of the line"),
        ("a 7\n", "a\n", "a field is missing"),
        ("u8", "u9", "a type such as u16"),
        ("u8 1 ", "u8 0 ", "no components"),
        ("#spmesh attribute \"class\" u8 1 \"\" \"\" - - -\n", "", "expected v, x or a comment"),
    ] {
        crate::convert::assert_refused(&text, found, replaced, expected);
    }
}

#[test]
fn a_weight_in_a_line_is_up_to_that_of_the_header() {
    let text = std::fs::read_to_string(repository("formats/vectors/pass/weights-points.txt")).unwrap();
    let most = "a finite number up to 2.25";
    for (weight, part) in [("2.375", most), ("inf", most), ("nan", "expected a number of type f64")] {
        crate::convert::assert_refused(&text, "a 1 2.125", &format!("a 1 {weight}"), part);
    }
}

/// Rows as long as they can be, and more points than one block of rows holds.
#[test]
fn long_rows_are_cut_with_their_points() {
    let wide = Attribute { components: 128, ..Attribute::new("wide", NumberType::F64) };
    let header = Header {
        attributes: Attributes::new(vec![wide]).unwrap(),
        ..Header::new(Kind::Points, Coordinates::F64, 2, false)
    };
    let points: Vec<Point> = (0..5_000).map(|i| [f64::from(i), 0.5, 0.0]).collect();
    let events = [Event::Points(points), Event::End(Default::default())];
    let rows = rows_of(&header, &events);
    let bytes = write_rows(&header, &events, &rows).unwrap();
    let (_, events_again, rows_again) = verify_rows(&bytes).unwrap();
    assert!(events_again.len() > 5, "several blocks");
    assert_eq!(rows_again.concat(), rows.concat());
}

/// Leaves out, repeats, moves and cuts the blocks of rows.
#[test]
fn rows_stand_directly_behind_their_points() {
    let is_rows = |piece: &[u8]| piece.starts_with(b"attp");
    let mut cases = 0;
    for (_, bytes) in streams() {
        let pieces: Vec<Vec<u8>> = frames(&bytes).into_iter().map(|range| bytes[range].to_vec()).collect();
        let Some(at) = pieces.iter().position(|piece| is_rows(piece)) else { continue };
        let refused = |pieces: Vec<Vec<u8>>, expected: &str| {
            let error = verify(&seal(pieces)).expect_err(expected);
            assert_eq!(error.kind(), ErrorKind::Malformed);
            assert!(error.to_string().contains(expected), "{expected}: {error}");
        };
        let changed = |change: &dyn Fn(&mut Vec<Vec<u8>>)| {
            let mut pieces = pieces.clone();
            change(&mut pieces);
            pieces
        };
        refused(
            changed(&|pieces| drop(pieces.remove(at))),
            "expected the attributes of the points before it",
        );
        refused(changed(&|pieces| pieces.insert(at, pieces[at].clone())), "no points precede");
        refused(changed(&|pieces| pieces.swap(at - 1, at)), "no points precede");
        refused(
            changed(&|pieces| {
                pieces[at].pop();
            }),
            "bytes of attributes, expected",
        );
        cases += 1;
    }
    assert!(cases > 100, "only {cases} streams have rows");
}

#[test]
fn other_kinds_have_no_attributes() {
    let attributes = Attributes::new(vec![Attribute::new("a", NumberType::U8)]).unwrap();
    for kind in [Kind::Configurations, Kind::Splines] {
        let header =
            Header { attributes: attributes.clone(), ..Header::new(kind, Coordinates::F64, 2, false) };
        assert!(
            StreamWriter::new(Vec::new(), header).is_err_and(|e| e.to_string().contains("no attributes"))
        );
    }
}

#[test]
fn a_reader_without_attributes_gives_no_rows() {
    let header = Header::new(Kind::TriangleMesh, Coordinates::F64, 2, false);
    let new = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let patch = Patch { new, simplices: vec![0, 1, 2], finalized: vec![0, 1, 2], ..Patch::default() };
    let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
    writer.patch(&patch).unwrap();
    let bytes = writer.end(3, 0).unwrap();
    let mut reader = StreamReader::new(&bytes[..], "plain").unwrap();
    while reader.next_event().unwrap().is_some() {
        assert!(reader.rows().is_empty());
    }
}
