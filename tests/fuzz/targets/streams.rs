//! Streams and their text twins.

use spmesh_audit::{Audit, Inventory, Standard, configurations, diagram};
use spmesh_io::sink::{EventSink, TwinSink};
use spmesh_io::source::{EventSource, TwinSource};
use spmesh_model::bounds::Point;
use spmesh_stream::{Event, FinalizedCells, Header, Kind, LiveVertices, StreamReader, Totals};

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
    let Some((header, events, rows)) = read(&mut reader) else { return };
    examine(&header, &events);
    // The text twin of a valid stream can be read.
    let mut text = Vec::new();
    let mut sink = TwinSink::new(&mut text, &header).expect("memory takes the header");
    for (event, rows) in events.iter().zip(&rows) {
        sink.event(event, rows).expect("memory takes the events");
    }
    let mut twin = TwinSource::new(&text[..], "twin").expect("a twin that was just written");
    loop {
        match twin.next_event().expect("a twin that was just written") {
            Some(Event::End(totals)) => break assert_eq!(Some(totals), end_of(&events)),
            Some(_) => {}
            None => panic!("the twin has no end"),
        }
    }
}

/// Reads a text twin and examines its events.
pub fn twin(bytes: &[u8]) {
    let Ok(mut twin) = TwinSource::new(bytes, "fuzz") else { return };
    if let Some((header, events, _)) = read(&mut twin) {
        examine(&header, &events);
    }
}

/// Header and events, and the attributes of the points of each event, if the whole input is well-formed.
fn read(source: &mut impl EventSource) -> Option<(Header, Vec<Event>, Vec<Vec<u8>>)> {
    let (mut events, mut rows) = (Vec::new(), Vec::new());
    loop {
        match source.next_event() {
            Ok(Some(event)) => {
                events.push(event);
                rows.push(source.rows().to_vec());
            }
            Ok(None) => break,
            Err(_) => return None,
        }
    }
    Some((source.header().clone(), events, rows))
}

fn end_of(events: &[Event]) -> Option<Totals> {
    match events.last() {
        Some(&Event::End(totals)) => Some(totals),
        _ => None,
    }
}

/// Passes events to every consumer. A well-formed stream may make false claims, so errors are accepted.
fn examine(header: &Header, events: &[Event]) {
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
    match header.kind {
        Kind::Cells4 | Kind::Simplices4 => {
            let mut audit = diagram::StreamAudit::new(header.kind).expect("a kind with an audit");
            if events.iter().try_for_each(|event| audit.event(event)).is_ok() {
                let _ = audit.prove();
            }
        }
        Kind::Configurations => {
            let mut audit = configurations::StreamAudit::default();
            if events.iter().try_for_each(|event| audit.event(event)).is_ok() {
                let _ = audit.prove();
            }
        }
        _ => {
            if let Ok(mut audit) = Audit::new(header, Standard::Canonical, None) {
                let _ = events.iter().try_for_each(|event| audit.event(event));
                let _ = audit.report();
            }
        }
    }
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
