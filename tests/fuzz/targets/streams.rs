//! Streams and their text twins.

use spmesh_audit::{Audit, Inventory, Standard, configurations, diagram};
use spmesh_base::error::Result;
use spmesh_formats::sink::{EventSink, SpmSink, TwinSink};
use spmesh_formats::source::{EventSource, TwinSource};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Event, FinalizedCells, Header, Kind, LiveVertices, MemoryRules, StreamReader, Totals};

/// The first byte of a stream.
const FIRST: u8 = 0x89;
/// Bytes of a header before its body, and of its parts.
const HEAD: usize = 16;
/// Bytes of a block before its payload.
const FRAME: usize = 16;
/// The bit of the length of a block that says that its payload is compressed.
const COMPRESSED: usize = 1 << 31;

/// Reads the bytes as they are, and again with corrected checksums.
pub fn stream(bytes: &[u8]) {
    read_stream(bytes);
    if let Some(sealed) = sealed(bytes).filter(|sealed| sealed != bytes) {
        read_stream(&sealed);
    }
}

/// The bytes with correct checksums, if they begin as a stream does.
pub fn sealed(bytes: &[u8]) -> Option<Vec<u8>> {
    let mut sealed = bytes.to_vec();
    (bytes.first() == Some(&FIRST)).then(|| seal(&mut sealed)).flatten().map(|()| sealed)
}

fn read_stream(bytes: &[u8]) {
    let Ok(mut reader) = StreamReader::new(bytes, "fuzz") else { return };
    let Ok(stream) = read(&mut reader) else { return };
    examine(&stream);
    expect_copies(&stream);
}

/// Panics unless the text twin and the binary form of a well-formed stream can be read, and say the same.
fn expect_copies(stream: &Stream) {
    let text = twin_of(stream);
    let mut twin = TwinSource::new(&text[..], "twin").expect("a twin that was just written");
    let again = read(&mut twin).expect("a twin that was just written");
    assert_eq!(end_of(&again.1), end_of(&stream.1));
    let mut binary = Vec::new();
    write(stream, SpmSink::new(&mut binary, &stream.0));
    let mut reader = StreamReader::new(&binary[..], "copy").expect("a stream that was just written");
    let copy = read(&mut reader).expect("a stream that was just written");
    for (name, other) in [("twin", again), ("copy", copy)] {
        let other = twin_of(&other);
        let differs = text.iter().zip(&other).position(|(a, b)| a != b);
        let text = String::from_utf8_lossy(&text);
        assert!(text.as_bytes() == other, "the twin of the {name} differs at {differs:?}: {text}");
    }
}

/// The text twin of a stream.
fn twin_of(stream: &Stream) -> Vec<u8> {
    let mut text = Vec::new();
    write(stream, TwinSink::new(&mut text, &stream.0));
    text
}

fn write((_, events, rows): &Stream, sink: Result<impl EventSink>) {
    let mut sink = sink.expect("memory takes the header");
    for (event, rows) in events.iter().zip(rows) {
        sink.event(event, rows).expect("memory takes the events");
    }
}

/// Reads a text twin and examines its events.
pub fn twin(bytes: &[u8]) {
    let Ok(mut twin) = TwinSource::new(bytes, "fuzz") else { return };
    if let Ok(stream) = read(&mut twin) {
        examine(&stream);
        expect_copies(&stream);
    }
}

/// Header and events of a well-formed input, and the attributes of the points of each event.
type Stream = (Header, Vec<Event>, Vec<Vec<u8>>);

fn read(source: &mut impl EventSource) -> Result<Stream> {
    let (mut events, mut rows) = (Vec::new(), Vec::new());
    while let Some(event) = source.next_event()? {
        events.push(event);
        rows.push(source.rows().to_vec());
    }
    Ok((source.header().clone(), events, rows))
}

/// Panics unless the bytes are a stream whose claims pass their audit.
pub fn prove(bytes: &[u8]) {
    let mut reader = StreamReader::new(bytes, "output").expect("a stream that was just written");
    let (header, events, rows) = read(&mut reader).expect("a stream that was just written");
    let mut rules = MemoryRules::new(&header);
    events.iter().try_for_each(|event| rules.check(event)).expect("a stream that keeps the rules");
    audit(&header, &events, &rows)
        .expect("points in their cells, a diagram, configurations, or a Delaunay mesh");
}

fn end_of(events: &[Event]) -> Option<Totals> {
    match events.last() {
        Some(&Event::End(totals)) => Some(totals),
        _ => None,
    }
}

/// Passes events to every consumer. A well-formed stream may make false claims, so errors are accepted.
fn examine((header, events, rows): &Stream) {
    let mut inventory = Inventory::new(header);
    let _ = events.iter().try_for_each(|event| inventory.event(event));
    let mut live = LiveVertices::<Point>::new();
    let mut cells = header.tree.map(FinalizedCells::new);
    let _ = events.iter().try_for_each(|event| match (event, &mut cells) {
        (Event::Patch(patch), _) => live.enter(patch, |_, at| at).map(drop),
        (Event::Points(points), Some(cells)) => cells.check_points(points),
        (Event::Cells(tags), Some(cells)) => tags.iter().try_for_each(|&tag| cells.finalize(tag)),
        _ => Ok(()),
    });
    let _ = audit(header, events, rows);
}

/// Audits the claims of a well-formed stream.
fn audit(header: &Header, events: &[Event], rows: &[Vec<u8>]) -> std::result::Result<(), String> {
    match header.kind {
        Kind::Cells4 | Kind::Simplices4 => {
            let mut audit = diagram::StreamAudit::new(header.kind).expect("a kind with an audit");
            events.iter().try_for_each(|event| audit.event(event)).map_err(said)?;
            audit.prove().map(drop).map_err(said)
        }
        Kind::Configurations => {
            let mut audit = configurations::StreamAudit::default();
            events.iter().try_for_each(|event| audit.event(event)).map_err(said)?;
            audit.prove().map(drop).map_err(said)
        }
        _ => {
            let mut audit = Audit::new(header, Standard::Canonical, None).map_err(said)?;
            let mut all = events.iter().zip(rows);
            let outcome = all.try_for_each(|(event, rows)| audit.event_with_rows(event, rows));
            let _ = audit.report();
            outcome.map_err(said)
        }
    }
}

fn said(error: impl std::fmt::Debug) -> String {
    format!("{error:?}")
}

/// Corrects the checksums of the header and of all complete blocks; `None` if there is no header.
fn seal(bytes: &mut [u8]) -> Option<()> {
    let length = |bytes: &[u8], at: usize| -> Option<usize> {
        let field = bytes.get(at..at + 4)?.try_into().expect("four bytes");
        usize::try_from(u32::from_le_bytes(field)).ok()
    };
    let mut at = HEAD.checked_add(length(bytes, HEAD - 4)?)?;
    let sum = crc32c::crc32c(bytes.get(..at)?);
    bytes.get_mut(at..at + 4)?.copy_from_slice(&sum.to_le_bytes());
    at += 4;
    while let Some(payload) = length(bytes, at + 8).map(|field| field & !COMPRESSED) {
        let Some(end) = (at + FRAME).checked_add(payload).filter(|&end| end <= bytes.len()) else { break };
        let sum = crc32c::crc32c_append(crc32c::crc32c(&bytes[at..at + 12]), &bytes[at + FRAME..end]);
        bytes[at + 12..at + FRAME].copy_from_slice(&sum.to_le_bytes());
        at = end;
    }
    Some(())
}
