//! Streams of configurations.

use spmesh_base::error::ErrorKind;
use spmesh_configurations::special::{Function, FunctionKind};
use spmesh_configurations::{self as configurations, Claim, Configurations, FARAWAY, Knots, Rule, Start};
use spmesh_formats::drivers::Format;
use spmesh_stream::{ConfigurationBlock, Coordinates, Crs, Header, Kind, StreamReader, StreamWriter};
use spmesh_stream::{ConfigurationSet, Content, configurations_header, write_configurations, write_content};

use super::Random;
use crate::convert::{assert_cut_vectors_are_refused, assert_refused, converted, text_of};
use crate::programs::kind_of_damage;
use crate::vectors::{load, run_python, verify};

/// Knots on a small grid, so that some are collinear, cocircular or coincide.
pub fn random_knots(random: &mut Random, count: usize) -> Knots {
    let points = (0..count).map(|_| [random.below(7) as f64, random.below(6) as f64 - 2.0]);
    let corners = [[0.0, -2.0], [6.0, -2.0], [0.0, 3.0]];
    Knots::new(points.chain(corners).collect()).unwrap()
}

/// Configurations of one random rule, up to a degree.
pub fn random_configurations(random: &mut Random, knots: &Knots, degree: usize) -> Vec<Configurations> {
    let mut start = Start::delaunay(knots).unwrap();
    let rule = match random.below(3) {
        0 => Rule::Delaunay,
        1 => {
            start.flip_random(knots, 9, random.next());
            Rule::Random(random.next())
        }
        _ => Rule::Ear,
    };
    configurations::generate(knots, start.configurations(), &rule, degree).unwrap()
}

pub fn written(knots: &Knots, degrees: &[Configurations]) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_configurations(knots.points(), degrees, &mut bytes).unwrap();
    bytes
}

fn read(bytes: &[u8]) -> ConfigurationSet {
    ConfigurationSet::read(&mut StreamReader::new(bytes, "test").unwrap()).unwrap()
}

#[test]
fn configurations_come_back_as_they_were_written() {
    for seed in 0..300 {
        let mut random = Random(seed);
        let count = 4 + random.below(20);
        let knots = random_knots(&mut random, count);
        let mut degrees = random_configurations(&mut random, &knots, seed as usize % 5);
        if random.coin() {
            degrees.remove(random.below(degrees.len()));
        }
        let set = read(&written(&knots, &degrees));
        assert_eq!(set.degrees, degrees, "seed {seed}");
        assert_eq!(&set.points, knots.points(), "seed {seed}");
        assert_eq!(set.heights, None);
        for (before, after) in degrees.iter().zip(&set.degrees) {
            assert_eq!(
                configurations::links(&knots, after).ok(),
                configurations::links(&knots, before).ok(),
                "seed {seed}"
            );
        }
    }
}

#[test]
fn configurations_go_through_their_twins() {
    for seed in 0..60 {
        let mut random = Random(seed);
        let knots = random_knots(&mut random, 5 + seed as usize / 3);
        let bytes = written(&knots, &random_configurations(&mut random, &knots, seed as usize % 4));
        let text = text_of(&bytes);
        let back = converted(text.as_bytes(), Format::Twin, Format::Stream).unwrap();
        assert!(back == bytes, "seed {seed}");
        if seed < 8 {
            let Some(python) = run_python("scripts/spmesh_reader.py", &["-"], &bytes) else { return };
            assert_eq!(String::from_utf8(python.stdout).unwrap(), text, "seed {seed}");
        }
    }
}

/// 12,000 knots, so that groups and degrees are split between blocks.
fn large() -> (Knots, Vec<Configurations>) {
    let mut random = Random(5);
    let point = |_| [random.below(1 << 20) as f64, random.below(1 << 20) as f64];
    let knots = Knots::new((0..12_000).map(point).collect()).unwrap();
    let start = configurations::delaunay(&knots).unwrap();
    let degrees = configurations::generate(&knots, start, &Rule::Delaunay, 2).unwrap();
    (knots, degrees)
}

#[test]
fn degrees_longer_than_a_block_come_back_and_go_through_their_twins() {
    let (knots, degrees) = large();
    let bytes = written(&knots, &degrees);
    assert_eq!(read(&bytes).degrees, degrees);
    let text = text_of(&bytes);
    assert_eq!(text.lines().filter(|line| line.starts_with("degree ")).count(), 3);
    let groups: usize = degrees.iter().map(Configurations::group_count).sum();
    assert_eq!(text.lines().filter(|line| line.starts_with("in")).count(), groups);
    assert!(converted(text.as_bytes(), Format::Twin, Format::Stream).unwrap() == bytes);
}

#[test]
fn grids_heights_and_systems_are_kept() {
    let knots = Knots::new(vec![[0.0, 0.0], [40.0, 0.0], [0.0, 30.0], [-7.0, 12.0]]).unwrap();
    let degrees =
        configurations::generate(&knots, configurations::delaunay(&knots).unwrap(), &Rule::Delaunay, 1)
            .unwrap();
    let grid = Coordinates::I32 { scale: [0.5; 3], offset: [1000.0, 0.0, 0.0] };
    let mut header = configurations_header(knots.points(), grid, Crs::Wkt("a system".into()));
    header.has_elevation = true;
    header.bounds = None;
    let heights = [4.0, 3.0, 2.0, 1.0];
    let mut bytes = Vec::new();
    let content = Content { heights: Some(&heights), ..Content::of(knots.points(), &degrees) };
    write_content(header.clone(), content, &mut bytes).unwrap();
    assert_eq!(verify(&bytes).unwrap().0, header);
    let set = read(&bytes);
    assert_eq!((set.heights.as_deref(), &set.degrees), (Some(&heights[..]), &degrees));
    assert!(text_of(&bytes).contains("\nv 1020 0 1.5\n"), "{}", text_of(&bytes));
    let refused =
        write_content(header, Content::of(knots.points(), &degrees), Vec::new()).expect_err("no heights");
    assert_eq!(refused.kind(), ErrorKind::Usage);
}

#[test]
fn the_writer_refuses_what_no_reader_accepts() {
    let knots = Knots::new(vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]).unwrap();
    let degrees =
        configurations::generate(&knots, configurations::delaunay(&knots).unwrap(), &Rule::Delaunay, 1)
            .unwrap();
    let reversed: Vec<Configurations> = degrees.iter().rev().cloned().collect();
    let error = write_configurations(knots.points(), &reversed, Vec::new()).expect_err("degrees 1, 0");
    assert!(
        error.kind() == ErrorKind::Usage && error.to_string().contains("degree 0 after degree 1"),
        "{error}"
    );
    let too_high = Configurations::new(4097, Claim::Any);
    let error = write_configurations(knots.points(), &[too_high], Vec::new()).expect_err("degree 4097");
    assert!(error.to_string().contains("cannot write degree 4097"), "{error}");
    let few = Knots::new(knots.points()[..3].to_vec()).unwrap();
    let error = write_configurations(few.points(), &degrees, Vec::new()).expect_err("a knot is missing");
    assert!(error.to_string().contains("numbers of 3 knots"), "{error}");

    let mut writer =
        StreamWriter::new(Vec::new(), Header::new(Kind::Configurations, Coordinates::F64, 2, false)).unwrap();
    writer.points(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).unwrap();
    let mut block = ConfigurationBlock::new(0, Claim::Any);
    block.push(&[], &[[0, 1, FARAWAY], [0, 1, 2]]);
    let error = writer.configurations(&block).expect_err("an infinite one first");
    assert!(error.to_string().contains("does not follow"), "{error}");
}

/// Functions over random knots: several of every kind, with random terms.
fn random_functions(random: &mut Random, knots: &Knots) -> Vec<Function> {
    let count = knots.len() as u32;
    let mut knot = || random.below(count as usize) as u32;
    let mut functions: Vec<Function> = Vec::new();
    for _ in 0..60 {
        let [a, b, c, d] = [knot(), knot(), knot(), knot()];
        if a == b || b == c || c == a || [a, b, c].contains(&d) {
            continue;
        }
        let kind = match functions.len() % 5 {
            0 => FunctionKind::Edge([a, b]),
            1 => FunctionKind::Vertex(a),
            2 => FunctionKind::Tent([a, b]),
            3 => FunctionKind::Crease([a, b, c]),
            _ => FunctionKind::Face([a, b, c, d]),
        };
        let mut sets = [[a.min(b), a.max(b)], [c.min(d), c.max(d)]].to_vec();
        sets.sort_unstable();
        let terms = sets.into_iter().zip([0.5, -1.0 / 3.0]).collect();
        functions.push(Function { kind, terms });
    }
    functions.sort_by_key(|function| function.kind);
    functions.dedup_by_key(|function| function.kind);
    functions
}

#[test]
fn splines_come_back_as_they_were_written() {
    for seed in 0..200 {
        let mut random = Random(seed);
        let knots = random_knots(&mut random, 12);
        let degrees = &random_configurations(&mut random, &knots, 1)[1..];
        let functions = random_functions(&mut random, &knots);
        let coefficients: Vec<f64> =
            functions.iter().map(|_| random.below(1000) as f64 / 7.0 - 50.0).collect();
        let content = Content {
            functions: &functions,
            coefficients: &coefficients,
            ..Content::of(knots.points(), degrees)
        };
        let mut header = configurations_header(knots.points(), Coordinates::F64, Crs::Unknown);
        header.kind = Kind::Splines;
        let mut bytes = Vec::new();
        write_content(header.clone(), content, &mut bytes).unwrap();
        let set = read(&bytes);
        assert_eq!((&set.functions, &set.coefficients), (&functions, &coefficients), "seed {seed}");
        assert_eq!(set.degrees, degrees);
        let text = text_of(&bytes);
        assert!(converted(text.as_bytes(), Format::Twin, Format::Stream).unwrap() == bytes, "seed {seed}");
        if seed < 20 {
            let twin = run_python("scripts/spmesh_reader.py", &["-"], &bytes);
            assert!(twin.is_none_or(|twin| twin.stdout == text.as_bytes()), "seed {seed}");
        }
        let few = Content { coefficients: &coefficients[1..], ..content };
        let error = write_content(header, few, Vec::new()).expect_err("a coefficient is missing");
        assert!(error.to_string().contains("one each is needed"), "{error}");
    }
}

#[test]
fn many_functions_come_in_many_blocks() {
    let knots = Knots::new((0..400).map(|id| [f64::from(id), f64::from(id * id)]).collect()).unwrap();
    let pairs = (0..400).flat_map(|p| (p + 1..400).map(move |q| [p, q])).collect::<Vec<[u32; 2]>>();
    let function = |pair: &[u32; 2]| Function { kind: FunctionKind::Edge(*pair), terms: vec![(*pair, 1.0)] };
    let functions: Vec<Function> = pairs.iter().map(function).collect();
    let mut bytes = Vec::new();
    let start = Start::delaunay(&knots).unwrap();
    let degrees = configurations::generate(&knots, start.configurations(), &Rule::Delaunay, 1).unwrap();
    let content = Content { functions: &functions, ..Content::of(knots.points(), &degrees[1..]) };
    write_content(configurations_header(knots.points(), Coordinates::F64, Crs::Unknown), content, &mut bytes)
        .unwrap();
    assert_eq!(read(&bytes).functions, functions);
    let mut reader = StreamReader::new(&bytes[..], "many").unwrap();
    let mut blocks = 0;
    while let Some(event) = reader.next_event().unwrap() {
        blocks += usize::from(matches!(event, spmesh_stream::Event::Functions(_)));
    }
    assert!(blocks > 10, "{blocks}");
}

#[test]
fn errors_in_twins_of_splines_name_the_line() {
    let text = load("pass", "txt").into_iter().find(|vector| vector.name == "splines").unwrap().expected;
    let cases = [
        ("function edge 1 2", "function side 1 2", "edge, vertex, tent, crease or face"),
        ("function edge 1 2", "function edge 1", "ends early"),
        ("function edge 1 2", "function edge 1 2 3", "the end of the line"),
        ("function edge 1 3", "function edge 1 5", "numbers of 4 knots"),
        ("function edge 1 3\n", "", "END states"),
        ("function edge 1 2\n", "", "cannot have this line here"),
        ("term 1 2 1", "term 1 2", "ends early"),
        ("term 1 2 1", "term 1 2 inf", "a finite number"),
        ("term 1 2 1", "term 2 1 1", "increasing numbers"),
        ("term 1 2 1", "coefficient 3", "has no term"),
        ("coefficient 0\n", "", "END states"),
        ("coefficient 0\n", "v 0 0 0\n", "cannot have this line here"),
        ("coefficient 0\n", "degree 2 any\n", "cannot have this line here"),
        ("coefficient 0\n", "function vertex 1\n", "cannot have this line here"),
        ("kind splines", "kind configurations", "term or a comment"),
    ];
    for (found, replaced, expected) in cases {
        assert_refused(&text, found, replaced, expected);
    }
    assert_cut_vectors_are_refused(|name| name.starts_with("splines"));
}

#[test]
fn other_kinds_are_refused_by_name() {
    for vector in load("pass", "txt") {
        let mut reader = StreamReader::new(&vector.bytes[..], "whole").unwrap();
        let kind = reader.header().kind;
        let read = ConfigurationSet::read(&mut reader);
        if kind.has_knots() {
            assert_eq!(read.unwrap().points.len() as u64, reader.totals().points, "{}", vector.name);
            continue;
        }
        let error = read.expect_err(&vector.name);
        assert_eq!(error.kind(), ErrorKind::Usage, "{error}");
        assert!(error.to_string().contains(kind.name()), "{error}");
    }
}

#[test]
fn errors_in_twins_name_the_line() {
    let text =
        load("pass", "txt").into_iter().find(|vector| vector.name == "configurations").unwrap().expected;
    let cases = [
        ("degree 0 delaunay", "degree 0 round", "any, delaunay or lifted"),
        ("degree 0 delaunay", "degree 4097 delaunay", "the maximum is 4096"),
        ("degree 0 delaunay", "degree 4294967296 delaunay", "a degree"),
        ("degree 0 delaunay", "degree 2 delaunay", "interior set of 0 knots, expected 2"),
        ("degree 0 delaunay\n", "", "a degree starts with"),
        ("degree 1 delaunay", "degree 0 delaunay", "degree 0 after those of 0"),
        ("in\n", "", "after the line \"in\""),
        ("in\n", "in\nin\n", "has no configuration"),
        ("in 2\n", "in 1\n", "does not follow"),
        ("in 4\n", "in 5\n", "not of increasing numbers of 4 knots"),
        ("in 4\n", "in 3 4\n", "interior set of 2 knots, expected 1"),
        ("in 4\non 1 2 3\n", "in 4\n", "has no configuration"),
        ("on 1 2 4", "on 0 2 4", "from 1 to 2^32 - 1"),
        ("on 1 2 4", "on 1 2 4294967296", "from 1 to 2^32 - 1"),
        ("on 1 2 4", "on 1 2 5", "is not of numbers of 4 knots"),
        ("on 1 2 4", "on 2 4 1", "least knot first"),
        ("on 1 2 4", "on 1 2 4 3", "end of the line"),
        ("on 1 2 4", "on 1 2", "a field is missing"),
        ("on 1 2 4", "f 1 2 4", "expected v, degree, in, on, line"),
        ("line 2 1", "line 2 2", "repeats a knot"),
        ("# end", "v 0 0 0\n# end", "cannot have this line here"),
        ("# end", "x cell 1\n# end", "expected v, degree, in, on, line"),
        ("# end", "# patch\n# end", "cannot have this line here"),
        ("simplices 13", "simplices 12", "END states"),
    ];
    for (found, replaced, expected) in cases {
        assert_refused(&text, found, replaced, expected);
    }
}

#[test]
fn every_truncation_of_a_twin_is_refused() {
    assert_cut_vectors_are_refused(|name| name.starts_with("configurations"));
}

#[test]
fn every_changed_byte_and_every_cut_is_malformed() {
    let vector = load("pass", "txt").into_iter().find(|vector| vector.name == "configurations").unwrap();
    for at in 0..vector.bytes.len() {
        assert_eq!(verify(&vector.bytes[..at]).expect_err("cut").kind(), ErrorKind::Malformed, "cut at {at}");
        for bit in 0..8 {
            let mut bytes = vector.bytes.clone();
            bytes[at] ^= 1 << bit;
            let error = verify(&bytes).expect_err("a bit");
            assert_eq!(error.kind(), kind_of_damage(at), "bit {bit} of byte {at}");
        }
    }
}

#[test]
fn formats_that_hold_none_refuse_them() {
    let vector = load("pass", "txt").into_iter().find(|vector| vector.name == "configurations").unwrap();
    for to in Format::written().filter(|format| !matches!(format, Format::Stream | Format::Twin)) {
        let error = converted(&vector.bytes, Format::Stream, to).expect_err(to.value());
        assert_eq!(error.kind(), ErrorKind::Usage, "{to:?}: {error}");
        let expected = "a stream of kind configurations cannot be written as";
        assert!(error.to_string().contains(expected), "{to:?}: {error}");
    }
}
