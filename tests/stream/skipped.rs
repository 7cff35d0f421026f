//! Records and blocks that readers skip, and the records of headers in general.

use spmesh_base::error::ErrorKind;
use spmesh_base::limits::{BLOCK_PAYLOAD_MAX, HEADER_BODY_MAX, PRODUCER_LEN_MAX};
use spmesh_stream::{Coordinates, Crs, Event, Header, Kind, StreamReader, StreamWriter, Totals};

use super::{Random, assert_malformed, frames, random_stream, read_all, seal, write};
use crate::vectors::{load, run_python, verify};

/// Bytes of a header before its records.
const FIXED: usize = 32;
/// Tags that may be skipped; some are those of known records and blocks in small letters.
const SKIPPED: [&[u8; 4]; 6] = [b"note", b"z 9 ", b"grid", b"pnts", b"end ", b"cELL"];

fn record(tag: &[u8], payload: &[u8]) -> Vec<u8> {
    [tag, &(payload.len() as u32).to_le_bytes(), payload].concat()
}

/// The records of a header with a checksum, each with its tag and length; the last may be damaged.
fn records(header: &[u8]) -> Vec<Vec<u8>> {
    let mut rest = &header[FIXED..header.len() - 4];
    let mut records = Vec::new();
    while !rest.is_empty() {
        let len = rest.get(4..8).map_or(rest.len(), |len| {
            8usize.saturating_add(u32::from_le_bytes(len.try_into().unwrap()) as usize)
        });
        let (record, after) = rest.split_at(len.min(rest.len()));
        records.push(record.to_vec());
        rest = after;
    }
    records
}

/// A header with other records; `seal` corrects length and checksum.
fn with_records(header: &[u8], records: &[Vec<u8>]) -> Vec<u8> {
    [&header[..FIXED], &records.concat(), &[0; 4]].concat()
}

fn shuffle<T>(random: &mut Random, items: &mut [T]) {
    (1..items.len()).for_each(|last| items.swap(last, random.below(last + 1)));
}

fn bytes_of(random: &mut Random) -> Vec<u8> {
    (0..random.below(40)).map(|_| random.next() as u8).collect()
}

/// Damages the records of a header: their number, order, tags, lengths or payloads.
pub fn mutate_records(random: &mut Random, header: &mut Vec<u8>) {
    if header.len() < FIXED + 4 {
        return;
    }
    let mut records = records(header);
    let inserted = record(SKIPPED[random.below(SKIPPED.len())], &bytes_of(random));
    let count = records.len();
    if count == 0 {
        records.push(inserted);
    } else {
        let (at, other) = (random.below(count), random.below(count));
        match random.below(8) {
            0 => records.swap(at, other),
            1 => drop(records.remove(at)),
            2 => records.insert(at, records[other].clone()),
            3 => records.insert(at, inserted),
            4 => records[at][0] ^= 0x20,
            5 => {
                let tag =
                    [b"GRID", b"BBOX", b"TREE", b"REGN", b"cWKT", b"cGEO", b"prod", b"ABCD"][random.below(8)];
                let end = records[at].len().min(4);
                records[at][..end].copy_from_slice(&tag[..end]);
            }
            6 if records[at].len() >= 8 => {
                let len = [0, 1, 8, 47, 48, 49, u32::MAX, random.next() as u32][random.below(8)];
                records[at][4..8].copy_from_slice(&len.to_le_bytes());
            }
            _ => {
                let byte = random.below(records[at].len().max(1));
                if let Some(byte) = records[at].get_mut(byte) {
                    *byte = random.next() as u8;
                }
            }
        }
    }
    *header = with_records(header, &records);
}

/// A header of as many records as fit, all with tags of their own, and the last of them cut.
pub fn crowded_header() -> Vec<u8> {
    let digit =
        |number: usize| b"0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"[number % 62];
    let header =
        StreamWriter::new(Vec::new(), Header::new(Kind::Points, Coordinates::F64, 2, false)).unwrap();
    let header = write(header.header(), &[Event::End(Totals::default())]).unwrap();
    let header = &header[frames(&header)[0].clone()];
    let count = (HEADER_BODY_MAX - 16) / 8;
    let mut records: Vec<_> = (0..count)
        .map(|number| record(&[b'a', digit(number), digit(number / 62), digit(number / 62 / 62)], b""))
        .collect();
    records.last_mut().unwrap()[0] = b'b';
    records.push(vec![b'c'; 7]);
    seal(vec![with_records(header, &records)])
}

/// The same stream with skipped blocks before random blocks, and with skipped records among shuffled ones.
fn padded(random: &mut Random, bytes: &[u8]) -> Vec<u8> {
    let mut pieces: Vec<Vec<u8>> = Vec::new();
    for frame in frames(bytes) {
        while !pieces.is_empty() && random.below(3) == 0 {
            let tag = SKIPPED[random.below(SKIPPED.len())];
            pieces.push([&tag[..], &[0; 12], &bytes_of(random)].concat());
        }
        pieces.push(bytes[frame].to_vec());
    }
    let mut records = records(&pieces[0]);
    let count = random.below(4);
    let mut tags = SKIPPED.to_vec();
    tags.retain(|tag| !records.iter().any(|record| record[..4] == tag[..]));
    records.extend(tags.iter().take(count).map(|tag| record(&tag[..], &bytes_of(random))));
    shuffle(random, &mut records);
    pieces[0] = with_records(&pieces[0], &records);
    seal(pieces)
}

#[test]
fn what_is_skipped_changes_nothing() {
    let mut random = Random(7);
    let vectors = load("pass", "txt").into_iter().map(|vector| (vector.name, vector.bytes));
    let streams = (0..300).map(|seed| (format!("seed {seed}"), random_stream(seed).2));
    for (name, bytes) in vectors.chain(streams) {
        let expected = verify(&bytes).unwrap();
        for _ in 0..3 {
            let read = verify(&padded(&mut random, &bytes)).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!(read, expected, "{name}");
        }
    }
}

#[test]
fn the_python_reader_skips_the_same() {
    for seed in 0..6 {
        let bytes = padded(&mut Random(seed), &random_stream(seed).2);
        let Some(output) = run_python("scripts/spmesh_reader.py", &["-q", "-"], &bytes) else { return };
        assert!(output.status.success(), "seed {seed}: {}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn any_number_of_blocks_is_skipped() {
    let bytes =
        write(&Header::new(Kind::Points, Coordinates::F64, 2, false), &[Event::End(Totals::default())]);
    let bytes = bytes.unwrap();
    let [header, end] = &frames(&bytes)[..] else { panic!("a header and END") };
    let mut pieces = vec![bytes[header.clone()].to_vec()];
    pieces.extend(std::iter::repeat_n([&b"note"[..], &[0; 12]].concat(), 200_000));
    pieces.push(bytes[end.clone()].to_vec());
    let bytes = seal(pieces);
    let mut reader = StreamReader::new(&bytes[..], "stream").unwrap();
    assert!(matches!(reader.next_event().unwrap(), Some(Event::End(_))));
    assert_eq!(reader.place(), format!("block 200000 at byte {}", bytes.len() - 72));
    assert_eq!(reader.bytes_read(), bytes.len() as u64);
    assert!(reader.next_event().unwrap().is_none());
}

/// The places in messages count skipped blocks, as sequence numbers do.
#[test]
fn errors_after_skipped_blocks_name_the_block() {
    let stream =
        load("fail", "err").into_iter().find(|vector| vector.name == "tag-unknown-after-skipped").unwrap();
    let error = read_all(&stream.bytes).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Unsupported);
    assert!(error.to_string().contains("block 2 at byte "), "{error}");
}

#[test]
fn writers_write_records_in_the_order_of_the_text() {
    let mut orders = Vec::new();
    for seed in 0..200 {
        let (header, _, bytes) = random_stream(seed);
        let tags: Vec<_> =
            records(&bytes[frames(&bytes)[0].clone()]).iter().map(|record| record[..4].to_vec()).collect();
        let expected = [
            (&b"GRID"[..], header.coordinates != Coordinates::F64),
            (b"BBOX", header.bounds.is_some()),
            (b"TREE", header.tree.is_some()),
            (b"REGN", header.region.is_some()),
            (b"cWKT", matches!(header.crs, Crs::Wkt(_))),
            (b"cGEO", matches!(header.crs, Crs::GeoKeys { .. })),
            (b"attr", !header.attributes.is_empty()),
            (b"prod", !header.producer.is_empty()),
        ];
        let expected: Vec<_> =
            expected.iter().filter(|(_, is_there)| *is_there).map(|(tag, _)| tag.to_vec()).collect();
        assert_eq!(tags, expected, "seed {seed}");
        orders.push(tags);
    }
    let all: std::collections::BTreeSet<_> = orders.concat().into_iter().collect();
    assert_eq!(all.len(), 8);
}

#[test]
fn the_longest_producer_is_written_and_a_longer_one_is_refused() {
    let header = |len: usize| Header {
        producer: "p".repeat(len),
        ..Header::new(Kind::Points, Coordinates::F64, 2, false)
    };
    let end = [Event::End(Totals::default())];
    let longest = write(&header(PRODUCER_LEN_MAX), &end).unwrap();
    assert_eq!(verify(&longest).unwrap().0.producer.len(), PRODUCER_LEN_MAX);
    assert_eq!(write(&header(PRODUCER_LEN_MAX + 1), &end).unwrap_err().kind(), ErrorKind::Usage);
    let longer = record(b"prod", &vec![b'p'; PRODUCER_LEN_MAX + 1]);
    let mut pieces: Vec<_> = frames(&longest).into_iter().map(|range| longest[range].to_vec()).collect();
    pieces[0] = with_records(&pieces[0], &[longer]);
    let longer = seal(pieces);
    assert_malformed(&longer, "a long producer");
    let Some(output) = run_python("scripts/spmesh_reader.py", &["-q", "-"], &longer) else { return };
    assert_eq!(output.status.code(), Some(3));
}

#[test]
fn the_largest_block_is_skipped() {
    let bytes =
        write(&Header::new(Kind::Points, Coordinates::F64, 2, false), &[Event::End(Totals::default())]);
    let bytes = bytes.unwrap();
    let mut pieces: Vec<_> = frames(&bytes).into_iter().map(|range| bytes[range].to_vec()).collect();
    pieces.insert(1, [&b"note"[..], &[0; 12], &vec![1; BLOCK_PAYLOAD_MAX]].concat());
    assert_eq!(verify(&seal(pieces)).unwrap(), verify(&bytes).unwrap());
}
