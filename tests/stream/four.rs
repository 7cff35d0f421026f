//! Streams of four dimensions.

use spmesh_base::error::{ErrorKind, Result};
use spmesh_base::limits::TEXT_NUMBERS_MAX;
use spmesh_formats::drivers::Format;
use spmesh_stream::model::cells4::{Cell4, Cells4, Point4};
use spmesh_stream::{
    Coordinates, Event, Header, Kind, Points4, StreamReader, StreamWriter, Totals, read_diagram4,
};

use super::{Random, joined, write};
use crate::convert::{assert_cut_vectors_are_refused, assert_refused, converted};
use crate::vectors::{load, run_python, verify};

/// A header without optional information.
pub fn header(kind: Kind, has_value: bool) -> Header {
    Header::new(kind, Coordinates::F64, 4, has_value)
}

/// A stream without content.
pub fn empty(kind: Kind) -> Vec<u8> {
    write(&header(kind, false), &[Event::End(Totals::default())]).unwrap()
}

/// Appends points to others.
pub fn extend(before: &mut Points4, points: Points4) {
    before.points.extend(points.points);
    if let (Some(before), Some(values)) = (&mut before.values, points.values) {
        before.extend(values);
    }
}

/// A random increasing subset of the numbers below `bound`; each is taken with probability 1 / `rarity`.
fn some(random: &mut Random, bound: usize, rarity: usize) -> Vec<u32> {
    (0..bound as u32).filter(|_| random.below(rarity) == 0).collect()
}

fn random_points(random: &mut Random, kind: Kind, has_values: bool) -> Points4 {
    let mut points: Vec<Point4> = (0..random.below(60))
        .map(|_| std::array::from_fn(|_| random.below(4) as f64 / 4.0 - random.below(3) as f64))
        .collect();
    if kind == Kind::Cells4 {
        points.sort_by(|a, b| a.partial_cmp(b).unwrap());
        points.dedup();
    }
    let value = |random: &mut Random| if random.coin() { f64::NAN } else { random.next() as f64 / 7.0 };
    let values = has_values.then(|| points.iter().map(|_| value(random)).collect());
    Points4 { points, values }
}

/// Cells with well-formed lists and random content.
fn random_cells(random: &mut Random, points: usize) -> Cells4 {
    let count = if points < 5 { 0 } else { random.below(40) };
    let mut cells = Cells4::default();
    for _ in 0..count {
        let is_infinite = random.coin();
        let rarity = 1 + random.below(9);
        let mut vertices = some(random, points, rarity);
        if vertices.len() < 5 {
            vertices = (0..if is_infinite { 4 } else { 5 }).collect();
        }
        let corners = vertices.len() + usize::from(is_infinite);
        let mut neighbours = some(random, count, 4);
        neighbours.truncate(corners * (corners - 3) / 2);
        cells.push(Cell4 { is_infinite, vertices: &vertices, neighbours: &neighbours });
    }
    cells
}

fn random_stream(seed: u64) -> (Header, Vec<Event>, Vec<u8>) {
    let mut random = Random(seed);
    let kind = [Kind::Points4, Kind::Cells4, Kind::Simplices4][random.below(3)];
    let mut header = header(kind, random.coin());
    let points = random_points(&mut random, kind, header.has_elevation);
    let count = points.points.len();
    let mut events = vec![Event::Points4(points)];
    match kind {
        Kind::Cells4 => events.push(Event::Cells4(random_cells(&mut random, count))),
        Kind::Simplices4 if count >= 5 => {
            let first = |random: &mut Random| random.below(count - 4) as u32;
            let simplex = |random: &mut Random| {
                let a = first(random);
                [a + 1, a, a + 2, a + 4, a + 3]
            };
            events.push(Event::Simplices4((0..random.below(20)).map(|_| simplex(&mut random)).collect()));
        }
        _ => {}
    }
    let merged = if kind == Kind::Points4 { 0 } else { random.below(3) as u64 };
    let points = count as u64 + merged;
    header.points = random.coin().then_some(points);
    events.push(Event::End(Totals { points, merged, ..Totals::default() }));
    let bytes = write(&header, &events).unwrap();
    (header, events, bytes)
}

fn text_of(stream: &[u8]) -> String {
    String::from_utf8(converted(stream, Format::Stream, Format::Twin).unwrap()).unwrap()
}

#[test]
fn random_streams_come_back_as_they_were_written() {
    for seed in 0..2_000 {
        let (header, mut events, bytes) = random_stream(seed);
        let (header_again, mut again) = verify(&bytes).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        assert_eq!(header_again, header, "seed {seed}");
        assert!(matches!((again.pop(), events.pop()), (Some(Event::End(_)), Some(Event::End(_)))));
        assert_eq!(joined(again), joined(events), "seed {seed}");
    }
}

#[test]
fn random_streams_go_through_their_twins() {
    for seed in 0..200 {
        let (_, _, bytes) = random_stream(seed);
        let text = text_of(&bytes);
        let back = converted(text.as_bytes(), Format::Twin, Format::Stream).unwrap();
        assert!(back == bytes, "seed {seed}");
        if seed < 12 {
            let Some(python) = run_python("scripts/spmesh_reader.py", &["-"], &bytes) else { return };
            assert_eq!(String::from_utf8(python.stdout).unwrap(), text, "seed {seed}");
        }
    }
}

/// A stream of 300,000 points in one cell, so that the cell is longer than a block.
fn long_cell() -> (Vec<u32>, Vec<u8>) {
    let points: Vec<Point4> = (0..300_000).map(|i| [f64::from(i), 0.0, 0.0, 0.0]).collect();
    let all: Vec<u32> = (0..points.len() as u32).collect();
    let mut writer = StreamWriter::new(Vec::new(), header(Kind::Cells4, false)).unwrap();
    writer.points4(&points, None).unwrap();
    writer.cell4(Cell4 { is_infinite: false, vertices: &all, neighbours: &[1] }).unwrap();
    for len in [TEXT_NUMBERS_MAX + 1, TEXT_NUMBERS_MAX] {
        writer.cell4(Cell4 { is_infinite: true, vertices: &all[..len], neighbours: &[0, 1] }).unwrap();
    }
    (all, writer.end(300_000, 0).unwrap())
}

#[test]
fn cells_longer_than_a_block_or_a_line_come_back() {
    let (all, bytes) = long_cell();
    let diagram = read_diagram4(&mut StreamReader::new(&bytes[..], "long").unwrap()).unwrap();
    assert_eq!(diagram.cells.get(0), Cell4 { is_infinite: false, vertices: &all, neighbours: &[1] });
    assert_eq!(
        diagram.cells.get(1),
        Cell4 { is_infinite: true, vertices: &all[..=TEXT_NUMBERS_MAX], neighbours: &[0, 1] }
    );
    let text = text_of(&bytes);
    // The second cell needs one line more, the third one none.
    let further = text.lines().filter(|line| line.starts_with("+4 ")).count();
    assert_eq!(further, 299_999 / TEXT_NUMBERS_MAX + 1);
    assert!(converted(text.as_bytes(), Format::Twin, Format::Stream).unwrap() == bytes);
    if let Some(python) = run_python("scripts/spmesh_reader.py", &["-"], &bytes) {
        assert!(String::from_utf8(python.stdout).unwrap() == text);
    }
}

#[test]
fn a_whole_diagram_is_read_from_cells_and_from_points() {
    for vector in load("pass", "txt") {
        let mut reader = StreamReader::new(&vector.bytes[..], "whole").unwrap();
        let kind = reader.header().kind;
        let has_values = reader.header().has_elevation;
        let read = read_diagram4(&mut reader);
        if !matches!(kind, Kind::Points4 | Kind::Cells4) {
            let error = read.expect_err(&vector.name);
            assert_eq!(error.kind(), ErrorKind::Usage, "{}", vector.name);
            assert!(error.to_string().contains(kind.name()), "{error}");
            continue;
        }
        let (diagram, totals) = (read.unwrap(), reader.totals());
        assert_eq!(diagram.points.len() as u64, totals.points + totals.vertices, "{}", vector.name);
        assert_eq!(diagram.cells.len() as u64, totals.simplices, "{}", vector.name);
        assert_eq!(diagram.values.map(|values| values.len()), has_values.then_some(diagram.points.len()));
    }
    let split = load("pass", "txt").into_iter().find(|vector| vector.name == "cells4-split").unwrap();
    let diagram = read_diagram4(&mut StreamReader::new(&split.bytes[..], "split").unwrap()).unwrap();
    assert_eq!(diagram.merged, 1);
    assert_eq!(diagram.cells.get(0).neighbours, [1, 2, 3, 4, 5]);
    assert_eq!(diagram.cells.get(5).vertices, [1, 2, 3, 4]);
    assert!(diagram.values.unwrap()[4].is_nan());
}

/// A list that is broken over lines is refused when it gets too long, not when its cell ends.
#[test]
fn endless_lists_in_twins_are_refused_at_their_line() {
    let header = "#spmesh version 2\n#spmesh kind cells in 4 dimensions\n#spmesh coordinates f64\n\
                  #spmesh dims 4\n#spmesh elevation no\n#spmesh chunked no\n";
    let points: String = (0..6).map(|i| format!("v4 {i} 0 0 0\n")).collect();
    let start = [header, &points].concat();
    let cases = [
        ("c4 1 2 3 4 5\n+4 6\n+4 7\n", "line 15: a finite cell of 7 vertices, but 6 points"),
        ("c4 1 2 3 4 5\nn4 1 2 3 4 5\n+4 6\n", "line 15: cell of 5 vertices and 6 neighbours"),
        ("i4 1 2 3 4\nn4 1 2 3\n+4 4 5\n+4 6\n", "line 16: cell of 4 vertices and 6 neighbours"),
    ];
    for (lines, expected) in cases {
        let error = converted([&start, lines].concat().as_bytes(), Format::Twin, Format::Stream).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    }
}

/// The message with which a fresh writer refuses what `write` does.
fn refusal(
    kind: Kind,
    has_value: bool,
    write: impl FnOnce(&mut StreamWriter<Vec<u8>>) -> Result<()>,
) -> String {
    let mut writer = StreamWriter::new(Vec::new(), header(kind, has_value)).unwrap();
    write(&mut writer).expect_err("must be refused").to_string()
}

#[test]
fn the_writer_refuses_what_no_reader_accepts() {
    let points = [[0.0; 4], [0.0, 0.0, 0.0, 1.0]];
    let cell = |vertices, neighbours| Cell4 { is_infinite: true, vertices, neighbours };
    let cases = [
        (refusal(Kind::Points4, false, |w| w.points4(&[[f64::INFINITY; 4]], None)), "not finite"),
        (refusal(Kind::Points4, true, |w| w.points4(&points, None)), "a value for each"),
        (refusal(Kind::Points4, false, |w| w.points4(&points, Some(&[1.0, 2.0]))), "for none"),
        (refusal(Kind::Points4, true, |w| w.points4(&points, Some(&[1.0]))), "a value for each"),
        (refusal(Kind::Points4, true, |w| w.points4(&points, Some(&[1.0, f64::INFINITY]))), "neither finite"),
        (refusal(Kind::Cells4, false, |w| w.points4(&[points[1], points[0]], None)), "does not follow"),
        (
            refusal(Kind::Cells4, false, |w| w.cell4(cell(&[0, 1, 2, 3], &[]))),
            "an infinite cell of 4 vertices, but 0 points",
        ),
        (refusal(Kind::Cells4, false, |w| w.cell4(cell(&[0, 1, 2], &[]))), "an infinite cell of 3"),
        (
            refusal(Kind::Simplices4, false, |w| w.simplices4(&[[0, 1, 2, 3, 4]])),
            "simplex uses vertex 0 of 0",
        ),
    ];
    for (message, expected) in cases {
        assert!(message.contains(expected), "{message}");
    }
    let mut writer = StreamWriter::new(Vec::new(), header(Kind::Cells4, false)).unwrap();
    let line: Vec<Point4> = (0..4).map(|i| [f64::from(i), 0.0, 0.0, 0.0]).collect();
    writer.points4(&line, None).unwrap();
    writer.cell4(cell(&[0, 1, 2, 3], &[1])).unwrap();
    assert!(writer.end(4, 0).expect_err("no cell 1").to_string().contains("neighbour 1 of 1 cells"));
}

#[test]
fn every_nan_is_written_as_what_is_not_known() {
    let mut writer = StreamWriter::new(Vec::new(), header(Kind::Points4, true)).unwrap();
    let nan = f64::from_bits(0xfff8_0000_0000_0001);
    writer.points4(&[[0.0; 4]], Some(&[nan])).unwrap();
    let text = text_of(&writer.end(0, 0).unwrap());
    assert!(text.contains("\nv4 0 0 0 0 nan\n"), "{text}");
}

#[test]
fn errors_in_twins_name_the_line() {
    let text =
        |name: &str| load("pass", "txt").into_iter().find(|vector| vector.name == name).unwrap().expected;
    let cases = [
        ("cells4-simplex", "c4 1 2", "c4 2 1", "not increasing numbers"),
        ("cells4-simplex", "c4 1 2", "c4 0 2", "from 1 to 2^32"),
        ("cells4-simplex", "c4 1 2", "c4 1.5 2", "an integer"),
        ("cells4-simplex", "c4 1 2 3 4 5", "c4 1 2 3 4 6", "not increasing numbers of 5 points"),
        ("cells4-simplex", "c4 1 2 3 4 5", "c4 1 2 3 4 4294967297", "from 1 to 2^32"),
        ("cells4-simplex", "c4 1 2 3 4 5", "c4 1 2 3 4", "a finite cell of 4 vertices"),
        ("cells4-simplex", "i4 1 2 3 4\n", "i4 1 2 3\n", "an infinite cell of 3 vertices"),
        ("cells4-simplex", "n4 2 3 4 5 6\n", "", "not followed by its line n4"),
        ("cells4-simplex", "n4 2 3 4 5 6\n", "n4\nn4\n", "one line c4 or i4, and then one line n4"),
        ("cells4-simplex", "n4 2 3 4 5 6\n", "n4 2 3 4 5 7\n", "neighbour 6 of 6 cells"),
        ("cells4-simplex", "c4 1 2 3 4 5\n", "", "cannot have this line here"),
        ("cells4-simplex", "c4 1 2 3 4 5\n", "+4 1\n", "cannot have this line here"),
        ("cells4-simplex", "c4 1 2 3 4 5\n", "s4 1 2 3 4 5\n", "expected v4, c4, i4, n4, +4"),
        ("cells4-simplex", "v4 0 0 0 0\n", "v4 0 0 0 2\n", "does not follow"),
        ("cells4-simplex", "v4 0 0 0 0\n", "v4 0 0 0 0 1\n", "end of the line"),
        ("cells4-simplex", "v4 0 0 0 0\n", "v4 0 0 0\n", "a field is missing"),
        ("cells4-simplex", "v4 0 0 0 0\n", "v 0 0 0\n", "expected v4"),
        ("cells4-simplex", "# end", "v4 2 0 0 0\n# end", "cannot have this line here"),
        ("cells4-simplex", "# end", "# patch\n# end", "cannot have this line here"),
        ("cells4-simplex", "dims 4", "dims 3", "expected 4"),
        ("cells4-simplex", "kind cells in 4 dimensions", "kind points", "a points in 4 dimensions"),
        ("points4-values", "280.15", "nan ", "\0"),
        ("points4-values", "280.15", "NaN", "a finite number"),
        ("points4-values", "280.15", "inf", "a finite number"),
        ("points4-values", "v4 0 1 2 3 280.15", "v4 0 1 nan 3 280.15", "a finite number"),
        ("simplices4", "s4 5 1 2 3 4", "s4 5 1 2 3 5", "uses a vertex twice"),
        ("simplices4", "s4 5 1 2 3 4", "s4 5 1 2 3 7", "simplex uses vertex 6 of 6"),
        ("simplices4", "s4 5 1 2 3 4", "s4 5 1 2 3", "a field is missing"),
        ("simplices4", "s4 5 1 2 3 4", "c4 5 1 2 3 4", "expected v4, s4"),
        ("simplices4", "v4 1 1 1 1\n", "s4 1 2 3 4 5\nv4 1 1 1 1\n", "cannot have this line here"),
    ];
    for (name, found, replaced, expected) in cases {
        let text = text(name);
        if expected == "\0" {
            assert!(text.contains(found), "{found} in {text}");
            let read = converted(text.replacen(found, replaced, 1).as_bytes(), Format::Twin, Format::Stream);
            assert!(read.is_ok(), "{replaced}: free spacing is accepted");
            continue;
        }
        assert_refused(&text, found, replaced, expected);
    }
}

#[test]
fn every_truncation_of_a_twin_is_refused() {
    assert_cut_vectors_are_refused(|name| name.contains('4'));
}

#[test]
fn formats_of_fewer_dimensions_refuse_them() {
    for kind in [Kind::Points4, Kind::Cells4, Kind::Simplices4] {
        for to in Format::written().filter(|format| !matches!(format, Format::Stream | Format::Twin)) {
            let error = converted(&empty(kind), Format::Stream, to).expect_err(to.value());
            assert_eq!(error.kind(), ErrorKind::Usage, "{to:?}: {error}");
            let expected = format!("a stream of kind {} cannot be written as", kind.name());
            assert!(error.to_string().contains(&expected), "{to:?}: {error}");
        }
    }
}
