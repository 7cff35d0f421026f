//! Times compression: writes and reads a stream in memory, plain and compressed, on one thread.
//!
//! `compression_time STREAM...` reports bytes per point or simplex, and rates in MB of the plain stream per
//! second. The rate of the codec is what compression adds to the time of a plain stream.

use std::time::Instant;

use spmesh_formats::sink::{EventSink, SpmSink};
use spmesh_stream::{Event, Header, StreamReader};

/// Runs of which the fastest counts.
const RUNS: usize = 5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for path in std::env::args().skip(1) {
        let (header, events) = read(&std::fs::read(&path)?)?;
        let [plain, compressed] = [false, true].map(|compressed| Header { compressed, ..header.clone() });
        let (plain, plain_write) = fastest(|| write(&plain, &events))?;
        let (small, small_write) = fastest(|| write(&compressed, &events))?;
        let ((), plain_read) = fastest(|| skim(&plain))?;
        let ((), small_read) = fastest(|| skim(&small))?;
        assert!(read(&small)?.1 == events, "the compressed stream holds something else");
        let Some((Event::End(totals), _)) = events.last() else { return Err("no END".into()) };
        let records = if totals.simplices > 0 { totals.simplices } else { totals.points };
        let rate = |seconds: f64| plain.len() as f64 / 1e6 / seconds;
        println!(
            "{path}: {:.3} of {:.2} B; MB/s: write {:.0} of {:.0}, compress {:.0}, read {:.0} of {:.0}, expand {:.0}",
            small.len() as f64 / records as f64,
            plain.len() as f64 / records as f64,
            rate(small_write),
            rate(plain_write),
            rate(small_write - plain_write),
            rate(small_read),
            rate(plain_read),
            rate(small_read - plain_read),
        );
    }
    Ok(())
}

type Outcome<T> = spmesh_base::error::Result<T>;

/// The result of the last run, and the seconds of the fastest.
fn fastest<T>(run: impl Fn() -> Outcome<T>) -> Outcome<(T, f64)> {
    let mut best = f64::INFINITY;
    let mut last = None;
    for _ in 0..RUNS {
        let started = Instant::now();
        last = Some(run()?);
        best = best.min(started.elapsed().as_secs_f64());
    }
    Ok((last.expect("there is a run"), best))
}

/// Events with the attributes of their points.
type Events = Vec<(Event, Vec<u8>)>;

fn read(bytes: &[u8]) -> Outcome<(Header, Events)> {
    let mut reader = StreamReader::new(bytes, "stream")?;
    let mut events = Vec::new();
    while let Some(event) = reader.next_event()? {
        events.push((event, reader.rows().to_vec()));
    }
    Ok((reader.header().clone(), events))
}

/// Reads all events and drops them.
fn skim(bytes: &[u8]) -> Outcome<()> {
    let mut reader = StreamReader::new(bytes, "stream")?;
    while let Some(event) = reader.next_event()? {
        if let Event::Points(points) = event {
            reader.give_back(points);
        }
    }
    Ok(())
}

fn write(header: &Header, events: &[(Event, Vec<u8>)]) -> Outcome<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut sink = SpmSink::new(&mut bytes, header)?;
    events.iter().try_for_each(|(event, rows)| sink.event(event, rows))?;
    drop(sink);
    Ok(bytes)
}
