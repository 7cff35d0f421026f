//! Compressed streams hold what plain ones hold, and damage in them is found.

use spmesh_base::error::ErrorKind;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, Event, Header, Kind, write_triangles};

use super::{
    COMPRESSED, Random, assert_malformed, frames, joined, mutate, random_stream, read_all, seal, write,
    write_rows,
};
use crate::allocation::largest_during;
use crate::programs::kind_of_damage;
use crate::vectors::{is_refused, run_python, verify, verify_rows};

const GRID: Coordinates = Coordinates::I32 { scale: [0.01; 3], offset: [0.0; 3] };

fn header(kind: Kind, coordinates: Coordinates) -> Header {
    Header { compressed: true, ..Header::new(kind, coordinates, 2, true) }
}

/// Points along lines of flight.
fn points(count: usize, coordinates: Coordinates) -> Vec<u8> {
    let mut random = Random(1);
    let mut point = |i: usize| -> Point {
        [(i * 37 % 5000) as f64, (i / 135 * 40 + random.below(9)) as f64, (500 + random.below(60)) as f64]
    };
    let points = (0..count).map(&mut point).collect();
    write(&header(Kind::Points, coordinates), &[Event::Points(points), Event::End(Default::default())])
        .unwrap()
}

/// A mesh of squares, each of two triangles.
fn mesh(side: u32, coordinates: Coordinates) -> Vec<u8> {
    let mut triangles = Vec::new();
    for corner in (0..side * (side - 1)).filter(|corner| corner % side + 1 < side) {
        triangles.push([corner, corner + 1, corner + side]);
        triangles.push([corner + 1, corner + side + 1, corner + side]);
    }
    let at = |v: u32| [f64::from(v % side * 90), f64::from(v / side * 90), f64::from(v * v % 37)];
    let (header, mut bytes) = (header(Kind::TriangleMesh, coordinates), Vec::new());
    write_triangles(header, &triangles, (side * side) as usize, 0, at, &mut bytes).unwrap();
    bytes
}

fn samples() -> [Vec<u8>; 4] {
    [points(300, GRID), points(60, Coordinates::F64), mesh(12, GRID), mesh(7, Coordinates::F64)]
}

/// The number of blocks that are compressed.
fn compressed_blocks(stream: &[u8]) -> usize {
    let blocks = frames(stream).into_iter().skip(1);
    blocks.filter(|block| stream[block.start + 11] & 0x80 != 0).count()
}

#[test]
fn random_streams_come_back_and_are_not_longer() {
    let mut compressed = 0;
    for seed in 0..2_000 {
        let (header, _, plain) = random_stream(seed);
        let (_, events, rows) = verify_rows(&plain).unwrap();
        let header = Header { compressed: true, ..header };
        let bytes = write_rows(&header, &events, &rows).unwrap();
        assert!(bytes.len() <= plain.len(), "seed {seed}");
        let (header_again, events_again, rows_again) =
            verify_rows(&bytes).unwrap_or_else(|e| panic!("seed {seed}: {e}"));
        assert_eq!(header_again, header, "seed {seed}");
        assert_eq!(rows_again.concat(), rows.concat(), "seed {seed}");
        assert_eq!(joined(events_again), joined(events), "seed {seed}");
        compressed += compressed_blocks(&bytes);
    }
    assert!(compressed > 2_000, "{compressed}");
}

#[test]
fn samples_are_compressed_and_become_small() {
    for stream in samples() {
        assert!(compressed_blocks(&stream) > 0);
    }
    let plain = |stream: &[u8]| {
        let (header, events) = verify(stream).unwrap();
        write(&Header { compressed: false, ..header }, &events).unwrap().len()
    };
    for (stream, factor) in
        [(points(20_000, GRID), 4), (mesh(150, GRID), 6), (mesh(150, Coordinates::F64), 3)]
    {
        assert!(stream.len() * factor < plain(&stream), "{} of {} bytes", stream.len(), plain(&stream));
    }
}

#[test]
fn cuts_and_flips_are_found() {
    for stream in samples() {
        let whole = verify(&stream).unwrap();
        for len in 0..stream.len() {
            assert_malformed(&stream[..len], &format!("cut at {len}"));
        }
        for bit in 0..stream.len() * 8 {
            let mut bytes = stream.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            match verify(&bytes) {
                Ok(read) => assert_eq!(read, whole, "bit {bit} flipped"),
                Err(error) => assert_eq!(error.kind(), kind_of_damage(bit / 8), "bit {bit}: {error}"),
            }
        }
    }
}

#[test]
fn sealed_damage_of_compressed_blocks_never_panics() {
    let samples = samples();
    let mut accepted = 0;
    for seed in 0..40_000 {
        let mut random = Random(seed);
        let bytes = &samples[random.below(samples.len())];
        let mut pieces: Vec<_> = frames(bytes).into_iter().map(|range| bytes[range].to_vec()).collect();
        for _ in 0..1 + random.below(3) {
            mutate(&mut random, &mut pieces);
        }
        match verify(&seal(pieces)) {
            Ok((header, events)) => {
                accepted += 1;
                let (header_again, events_again) = verify(&write(&header, &events).unwrap()).unwrap();
                assert_eq!(header_again, header, "seed {seed}");
                assert_eq!(joined(events_again), joined(events), "seed {seed}");
            }
            Err(error) => assert!(is_refused(&error), "seed {seed}: {error}"),
        }
    }
    assert!(accepted > 500, "only {accepted} cases got through");
}

/// A zstd frame of zeros: runs of 2^17 of them.
fn zeros(runs: usize) -> Vec<u8> {
    let run = |last: bool| [&((1u32 << 20) | 2 | u32::from(last)).to_le_bytes()[..3], &[0]].concat();
    let runs = (1..=runs).flat_map(|number| run(number == runs));
    [0x28, 0xb5, 0x2f, 0xfd, 0, 0x50].into_iter().chain(runs).collect()
}

#[test]
fn no_compressed_block_makes_the_reader_allocate_beyond_the_stated_maximum() {
    let empty = |kind| write(&header(kind, GRID), &[Event::End(Default::default())]).unwrap();
    let block = |kind, tag: &[u8; 4], body: Vec<u8>| {
        let stream = empty(kind);
        let block = [tag, &[0, 0, 0, 0, 0, 0, 0, 0x80, 0, 0, 0, 0][..], &body].concat();
        seal(vec![stream[frames(&stream)[0].clone()].to_vec(), block])
    };
    let words = |words: &[u32]| -> Vec<u8> { words.iter().flat_map(|word| word.to_le_bytes()).collect() };
    let framed = |head: Vec<u8>, runs| {
        let frame = zeros(runs);
        [&head, &words(&[frame.len() as u32])[..], &frame].concat()
    };
    let axes = [0, 2, 0, 0, 0, 0].repeat(3);
    let patch = |counts: [u32; 4]| [&[2; 9][..], &words(&counts), &[0; 8]].concat();
    let records = |len: u32, runs| [&[3, 12, 0, 0][..], &words(&[len]), &zeros(runs)].concat();
    let cases = [
        block(Kind::Points, b"PNTS", records(1 << 20, 8)),
        block(Kind::Points, b"PNTS", records(1 << 20, 80_000)),
        block(Kind::Points, b"PNTS", records(u32::MAX, 8)),
        block(Kind::Points, b"PNTS", framed([&[1][..], &words(&[87_381]), &axes].concat(), 2)),
        block(Kind::Points, b"PNTS", framed([&[1][..], &words(&[u32::MAX]), &axes].concat(), 80_000)),
        block(Kind::TriangleMesh, b"PTCH", framed(patch([87_000, 0, 0, 0]), 3)),
        block(Kind::TriangleMesh, b"PTCH", framed(patch([0, 131_000, 0, 0]), 3)),
        block(Kind::TriangleMesh, b"PTCH", framed(patch([0, 0, 87_000, 0]), 3)),
        block(Kind::TriangleMesh, b"PTCH", framed(patch([u32::MAX; 4]), 3)),
    ];
    for (case, bytes) in cases.iter().enumerate() {
        let largest = largest_during(|| {
            let error = read_all(bytes).expect_err("nothing here is whole");
            assert_eq!(error.kind(), ErrorKind::Malformed, "case {case}: {error}");
        });
        assert!(largest <= 4 << 20, "case {case}: {largest} bytes at once");
    }
}

#[test]
fn the_bit_of_compression_needs_the_feature() {
    let plain = write(
        &Header { compressed: false, ..header(Kind::Points, GRID) },
        &[Event::Points(vec![[1.0, 2.0, 3.0]]), Event::End(Default::default())],
    );
    let plain = plain.unwrap();
    let mut pieces: Vec<_> = frames(&plain).into_iter().map(|range| plain[range].to_vec()).collect();
    pieces[1][8..12].copy_from_slice(&(COMPRESSED as u32 | 12).to_le_bytes());
    let error = read_all(&seal(pieces)).unwrap_err();
    assert!(error.to_string().contains("without feature bit 0"), "{error}");
}

/// Without a module for zstd, the reader says which one it needs.
#[test]
fn the_python_reader_decompresses_or_says_what_it_lacks() {
    for stream in [points(6000, GRID), mesh(60, GRID), mesh(20, Coordinates::F64)] {
        let Some(output) = run_python("scripts/spmesh_reader.py", &["-q", "-"], &stream) else { return };
        let message = String::from_utf8_lossy(&output.stderr);
        let is_lacking = output.status.code() == Some(1) && message.contains("install zstandard");
        assert!(output.status.success() || is_lacking, "{message}");
    }
}
