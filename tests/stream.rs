//! The reader trusts no input, and the writer loses nothing.

mod attributes;
mod compressed;
mod compressed_tools;
mod configurations;
mod four;
mod newer;
mod random;
mod regions;
mod skipped;
mod tools4;

use spmesh_base::error::{ErrorKind, Result};
use spmesh_stream::model::bounds::Region;
use spmesh_stream::model::cells::{CellCode, CellTree};
use spmesh_stream::{Coordinates, Event, Header, Kind, Patch, StreamReader, StreamWriter};

use random::random_stream;

use crate::allocation::largest_during;
use crate::programs::kind_of_damage;
use crate::vectors::{is_refused, load, run_python, verify, verify_rows};

/// SplitMix64 (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound as u64) as usize
    }

    fn coin(&mut self) -> bool {
        self.next() & 1 == 1
    }
}

/// Writes events as a stream. Residual and points blocks may be cut differently.
fn write(header: &Header, events: &[Event]) -> Result<Vec<u8>> {
    write_rows(header, events, &vec![Vec::new(); events.len()])
}

/// As [`write`], with the attributes of the points of each event.
fn write_rows(header: &Header, events: &[Event], rows: &[Vec<u8>]) -> Result<Vec<u8>> {
    let mut writer = StreamWriter::new(Vec::new(), header.clone())?;
    for (event, rows) in events.iter().zip(rows) {
        match event {
            Event::Points(points) => writer.points_with_rows(points, rows)?,
            Event::Cells(cells) => writer.cells(cells)?,
            Event::Region(region) => writer.region(region)?,
            Event::Patch(patch) => writer.patch_with_rows(patch, rows)?,
            Event::Labels(labels) => writer.labels(labels)?,
            Event::ResidualPoints(points) => writer.residual_points_with_rows(points, rows)?,
            Event::Walls(walls) => writer.walls(walls)?,
            Event::Points4(points) => writer.points4(&points.points, points.values.as_deref())?,
            Event::Cells4(cells) => cells.iter().try_for_each(|cell| writer.cell4(cell))?,
            Event::Simplices4(simplices) => writer.simplices4(simplices)?,
            Event::Configurations(block) => writer.configurations(block)?,
            Event::Functions(functions) => writer.functions(functions)?,
            Event::Coefficients(coefficients) => writer.coefficients(coefficients)?,
            Event::Segments(segments) => writer.segments(segments)?,
            Event::OpenSegments(open) => writer.open_segments(open)?,
            Event::End(totals) => return writer.end(totals.points, totals.merged),
        }
    }
    panic!("events without END")
}

/// Joins adjacent events of a kind and drops empty ones: writing may change nothing else.
fn joined(events: Vec<Event>) -> Vec<Event> {
    let mut result: Vec<Event> = Vec::new();
    for event in events {
        match (result.last_mut(), event) {
            (Some(Event::Points(before)), Event::Points(points)) => before.extend(points),
            (Some(Event::Cells(before)), Event::Cells(cells)) => before.extend(cells),
            (Some(Event::Functions(before)), Event::Functions(functions)) => before.extend(functions),
            (Some(Event::Coefficients(before)), Event::Coefficients(numbers)) => before.extend(numbers),
            (Some(Event::Labels(before)), Event::Labels(labels)) => before.extend(labels),
            (Some(Event::ResidualPoints(before)), Event::ResidualPoints(points)) => before.extend(points),
            (Some(Event::Walls(before)), Event::Walls(walls)) => before.extend(walls),
            (Some(Event::Segments(before)), Event::Segments(segments)) => before.extend(segments),
            (Some(Event::OpenSegments(before)), Event::OpenSegments(open)) => before.extend(open),
            (Some(Event::Points4(before)), Event::Points4(points)) => four::extend(before, points),
            (Some(Event::Cells4(before)), Event::Cells4(cells)) => {
                cells.iter().for_each(|cell| before.push(cell))
            }
            (Some(Event::Simplices4(before)), Event::Simplices4(simplices)) => before.extend(simplices),
            (Some(Event::Configurations(before)), Event::Configurations(block))
                if before.degree == block.degree =>
            {
                block.groups().for_each(|(interior, boundaries)| before.push(interior, boundaries));
            }
            (_, Event::Points4(points)) if points.points.is_empty() => {}
            (_, Event::Cells4(cells)) if cells.is_empty() => {}
            (_, Event::Simplices4(simplices)) if simplices.is_empty() => {}
            (_, Event::Points(points)) if points.is_empty() => {}
            (_, Event::Cells(cells)) if cells.is_empty() => {}
            (_, Event::Labels(labels)) if labels.is_empty() => {}
            (_, Event::Functions(functions)) if functions.is_empty() => {}
            (_, Event::ResidualPoints(points)) if points.is_empty() => {}
            (_, Event::Walls(walls)) if walls.is_empty() => {}
            (_, Event::Segments(segments)) if segments.is_empty() => {}
            (_, Event::OpenSegments(open)) if open.is_empty() => {}
            (_, event) => result.push(event),
        }
    }
    result
}

fn assert_malformed(bytes: &[u8], case: &str) {
    let error = verify(bytes).map(|_| ()).expect_err(case);
    assert_eq!(error.kind(), ErrorKind::Malformed, "{case}: {error}");
    assert!(error.to_string().contains("byte "), "{case}: {error}");
}

#[test]
fn what_was_read_can_be_written() {
    for vector in load("pass", "txt") {
        let (header, events, rows) = verify_rows(&vector.bytes).unwrap();
        let (header_again, events_again, rows_again) =
            verify_rows(&write_rows(&header, &events, &rows).unwrap()).unwrap();
        assert_eq!(header_again, header, "{}", vector.name);
        assert_eq!(rows_again.concat(), rows.concat(), "{}", vector.name);
        assert_eq!(joined(events_again), joined(events), "{}", vector.name);
    }
}

#[test]
fn a_stream_cut_anywhere_is_malformed() {
    for vector in load("pass", "txt") {
        for len in 0..vector.bytes.len() {
            assert_malformed(&vector.bytes[..len], &format!("{} cut at {len}", vector.name));
        }
    }
}

#[test]
fn a_flipped_bit_changes_nothing_or_is_malformed() {
    for vector in load("pass", "txt") {
        let whole = verify(&vector.bytes).unwrap();
        for bit in 0..vector.bytes.len() * 8 {
            let mut bytes = vector.bytes.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            match verify(&bytes) {
                Ok(read) => assert_eq!(read, whole, "{} with bit {bit} flipped", vector.name),
                Err(error) => assert_eq!(error.kind(), kind_of_damage(bit / 8), "{}: {error}", vector.name),
            }
        }
    }
}

#[test]
fn every_changed_byte_of_a_tetrahedral_mesh_is_malformed() {
    let header = Header::new(Kind::TetrahedralMesh, Coordinates::F64, 3, false);
    let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
    let new = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let (simplices, finalized) = (vec![0, 1, 2, 3], vec![0, 1, 2, 3]);
    writer.patch(&Patch { new, simplices, finalized, ..Patch::default() }).unwrap();
    writer.labels(&[7, 1, 7, u64::MAX]).unwrap();
    let bytes = writer.end(5, 1).unwrap();
    assert_eq!(verify(&bytes).unwrap().1.len(), 3);
    for at in 0..bytes.len() {
        for change in 1..=255 {
            let mut changed = bytes.clone();
            changed[at] ^= change;
            let error = read_all(&changed).expect_err("one byte is another");
            assert_eq!(error.kind(), kind_of_damage(at), "byte {at} ^ {change}: {error}");
        }
    }
}

/// The bit of the length of a block that says that its payload is compressed.
const COMPRESSED: usize = 1 << 31;

/// Ranges of the header and of the blocks, checksums included.
fn frames(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
    let u32_at = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    let mut frames = Vec::new();
    let mut frame = 0..16 + u32_at(12) + 4;
    while frame.start < bytes.len() {
        let start = frame.end;
        frames.push(frame);
        frame =
            start..if start < bytes.len() { start + 16 + (u32_at(start + 8) & !COMPRESSED) } else { start };
    }
    frames
}

/// Corrects sequence numbers, lengths and checksums, so that damage reaches later checks.
fn seal(mut frames: Vec<Vec<u8>>) -> Vec<u8> {
    let header = &mut frames[0];
    let body_end = header.len() - 4;
    header[12..16].copy_from_slice(&(body_end as u32 - 16).to_le_bytes());
    let checksum = crc32c::crc32c(&header[..body_end]);
    header[body_end..].copy_from_slice(&checksum.to_le_bytes());
    for (sequence, block) in (0u32..).zip(&mut frames[1..]) {
        let len = (block.len() as u32 - 16) | (u32::from(block[11] & 0x80) << 24);
        block[4..8].copy_from_slice(&sequence.to_le_bytes());
        block[8..12].copy_from_slice(&len.to_le_bytes());
        let checksum = crc32c::crc32c_append(crc32c::crc32c(&block[..12]), &block[16..]);
        block[12..16].copy_from_slice(&checksum.to_le_bytes());
    }
    frames.concat()
}

fn mutate(random: &mut Random, frames: &mut Vec<Vec<u8>>) {
    let at = random.below(frames.len());
    let other = random.below(frames.len());
    let fixed = if at == 0 { 32 } else { 16 };
    match random.below(9) {
        8 => skipped::mutate_records(random, &mut frames[0]),
        0 if at > 0 && other > 0 => frames.swap(at, other),
        1 if at > 0 => drop(frames.remove(at)),
        2 if at > 0 => frames.insert(at, frames[at].clone()),
        3 if at > 0 && other > 0 => {
            let tag = frames[other][..4].to_vec();
            frames[at][..4].copy_from_slice(&tag);
        }
        4 if frames[at].len() > fixed + 4 => {
            let len = 1 + random.below(frames[at].len() - fixed - 4);
            frames[at].drain(fixed..fixed + len);
        }
        _ => {
            let frame = &mut frames[at];
            let start = if at == 0 { 10 } else { 16 };
            if frame.len() > start {
                let byte = start + random.below(frame.len() - start);
                frame[byte] = [0, 1, 2, 0x7f, 0x80, 0xff, random.next() as u8][random.below(7)];
            }
        }
    }
}

#[test]
fn sealed_damage_never_panics_and_what_is_accepted_can_be_written() {
    let vectors = load("pass", "txt");
    let mut accepted = 0;
    for seed in 0..200_000 {
        let mut random = Random(seed);
        let bytes = &vectors[random.below(vectors.len())].bytes;
        let mut pieces: Vec<_> = frames(bytes).into_iter().map(|range| bytes[range].to_vec()).collect();
        for _ in 0..1 + random.below(3) {
            mutate(&mut random, &mut pieces);
        }
        match verify_rows(&seal(pieces)) {
            Ok((header, events, rows)) => {
                accepted += 1;
                let (header_again, events_again, rows_again) =
                    verify_rows(&write_rows(&header, &events, &rows).unwrap()).unwrap();
                assert_eq!(header_again, header, "seed {seed}");
                assert_eq!(rows_again.concat(), rows.concat(), "seed {seed}");
                assert_eq!(joined(events_again), joined(events), "seed {seed}");
            }
            Err(error) => assert!(is_refused(&error), "seed {seed}: {error}"),
        }
    }
    assert!(accepted > 3_000, "only {accepted} cases got through, the damage is too heavy to test anything");
}

fn read_all(bytes: &[u8]) -> Result<()> {
    let mut reader = StreamReader::new(bytes, "hostile")?;
    while reader.next_event()?.is_some() {}
    Ok(())
}

#[test]
fn no_length_makes_the_reader_allocate_beyond_the_stated_maximum() {
    const BLOCK_MAX: usize = 1 << 20;
    let grid = Coordinates::I32 { scale: [1.0; 3], offset: [0.0; 3] };
    let points =
        write(&Header::new(Kind::Points, grid, 2, false), &[Event::End(Default::default())]).unwrap();
    let region = Some(Region::EVERYTHING);
    let partial = Header { region, ..Header::new(Kind::PartialTriangleMesh, grid, 2, false) };
    let partial = write(&partial, &[Event::End(Default::default())]).unwrap();
    let tetrahedral = Header::new(Kind::TetrahedralMesh, grid, 3, false);
    let tetrahedral = write(&tetrahedral, &[Event::End(Default::default())]).unwrap();
    let with_block = |stream: &[u8], tag: &[u8; 4], payload: Vec<u8>| {
        let block = [tag, &[0; 12][..], &payload].concat();
        seal(vec![stream[frames(stream)[0].clone()].to_vec(), block])
    };
    let counts = |counts: [u32; 4]| {
        let counts = counts.iter().flat_map(|count| count.to_le_bytes());
        let mut payload: Vec<u8> = [0; 8].into_iter().chain(counts).collect();
        payload.resize(BLOCK_MAX, 0);
        payload
    };
    let mut cases = vec![
        with_block(&points, b"PNTS", vec![0; BLOCK_MAX]),
        with_block(&partial, b"RPNT", vec![0xff; BLOCK_MAX]),
        with_block(&partial, b"PTCH", counts([(BLOCK_MAX as u32 - 24) / 8, 0, 0, 0])),
        with_block(&partial, b"PTCH", counts([u32::MAX; 4])),
        with_block(&partial, b"PTCH", counts([0, u32::MAX, 0, 0])),
        with_block(&tetrahedral, b"PTCH", counts([0, 0, 1 << 30, 0])),
        with_block(&tetrahedral, b"PTCH", counts([0, 0, (BLOCK_MAX as u32 - 24) / 16, 0])),
        with_block(&tetrahedral, b"LABL", vec![0; BLOCK_MAX]),
        with_block(&points, b"END ", vec![0; BLOCK_MAX]),
        with_block(&four::empty(Kind::Points4), b"PNT4", vec![0; BLOCK_MAX]),
        with_block(&four::empty(Kind::Simplices4), b"SIM4", vec![0; BLOCK_MAX]),
        with_block(&four::empty(Kind::Cells4), b"CEL4", [0xff; 8].to_vec()),
        with_block(&four::empty(Kind::Cells4), b"CEL4", 0x7fff_0000u64.to_le_bytes().to_vec()),
        with_block(&four::empty(Kind::Cells4), b"CEL4", [0, 0, 0, 0, 0, 0, 0, 1].repeat(BLOCK_MAX / 8)),
    ];
    // The lengths of the header, of its first record, and of the first block.
    for at in [12, 36, frames(&points)[1].start + 8] {
        for value in [u32::MAX, 1 << 31, 1 << 20] {
            let mut bytes = points.clone();
            bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
            cases.push(bytes.clone());
            if at == 36 {
                cases.push(seal(frames(&points).into_iter().map(|range| bytes[range].to_vec()).collect()));
            }
        }
    }
    cases.push(skipped::crowded_header());
    for (case, bytes) in cases.iter().enumerate() {
        let largest = largest_during(|| {
            let error = read_all(bytes).expect_err("nothing here is whole");
            assert_eq!(error.kind(), ErrorKind::Malformed, "case {case}: {error}");
        });
        assert!(largest <= 4 * BLOCK_MAX, "case {case}: {largest} bytes at once");
    }
}

#[test]
fn random_streams_come_back_as_they_were_written() {
    for seed in 0..2_000 {
        let (header, events, bytes) = random_stream(seed);
        let (header_again, mut events_again, rows) =
            verify_rows(&bytes).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        assert_eq!(header_again, header, "seed {seed}");
        assert_eq!(rows.concat(), attributes::rows_of(&header, &events).concat(), "seed {seed}");
        assert!(matches!(events_again.pop(), Some(Event::End(_))));
        assert_eq!(joined(events_again), joined(events), "seed {seed}");
    }
}

#[test]
fn the_python_reader_accepts_random_streams() {
    for seed in 0..12 {
        let (_, _, bytes) = random_stream(seed);
        let Some(output) = run_python("scripts/spmesh_reader.py", &["-q", "-"], &bytes) else { return };
        assert!(output.status.success(), "seed {seed}: {}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn a_writer_that_is_dropped_leaves_no_whole_stream() {
    let header = Header::new(Kind::Points, Coordinates::F64, 2, false);
    let mut bytes = Vec::new();
    let mut writer = StreamWriter::new(&mut bytes, header).unwrap();
    writer.points(&[[1.0, 2.0, 0.0]]).unwrap();
    drop(writer);
    assert_malformed(&bytes, "dropped");
}

#[test]
fn long_blocks_are_cut_below_the_maximum() {
    let tree = CellTree::new(2, 10, [0.0; 3], 1024.0).unwrap();
    let header = Header { tree: Some(tree), ..Header::new(Kind::Points, Coordinates::F64, 2, true) };
    let cells: Vec<CellCode> = tree.deepest_range(CellCode::ROOT).map(CellCode).collect();
    let points = vec![[1.0, 2.0, 3.0]; 100_000];
    let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
    writer.points(&points).unwrap();
    writer.cells(&cells).unwrap();
    let (_, events) = verify(&writer.end(0, 0).unwrap()).unwrap();
    assert!(events.len() > 10);
    assert_eq!(joined(events)[..2], [Event::Points(points), Event::Cells(cells)]);
}
