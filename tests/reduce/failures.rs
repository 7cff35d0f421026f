//! Runs that fail end with any number of threads, with a fitting error kind, and without an END block.

use std::io::{self, Cursor, Read, Write};
use std::sync::mpsc::{Receiver, channel};

use spmesh_base::error::{ErrorKind, Result};
use spmesh_pipeline::reduce::{Duplicates, Options, Stats};
use spmesh_stream::StreamReader;
use spmesh_stream::model::bounds::Point;

use super::streams::{GRID, Tagging, stream, threads, triangulate};
use spmesh_reference::sets::{Random, uniform};

const THREADS: [usize; 3] = [1, 2, 8];

/// A stream of many leaves.
fn points() -> Vec<u8> {
    let mut random = Random::new(11);
    let points: Vec<Point> =
        uniform(&mut random, 4000, 10_000).iter().map(|p| [p[0] as f64, p[1] as f64, 0.0]).collect();
    stream(&points, GRID, Tagging::Chunked(4), &mut random)
}

/// Accepts `room` bytes, then fails with `error`, or panics if there is none.
struct Failing {
    room: usize,
    error: Option<io::ErrorKind>,
}

impl Write for Failing {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.room < bytes.len() {
            return Err(self.error.expect("of the test, while writing").into());
        }
        self.room -= bytes.len();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// An input that blocks after its bytes, for as long as the test holds the other end of the channel.
struct Silent(Cursor<Vec<u8>>, Receiver<()>);

impl Read for Silent {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.0.read(buffer)?;
        if read == 0 {
            let _ = self.1.recv();
        }
        Ok(read)
    }
}

fn write_to(input: impl Read + Send + 'static, output: Failing, threads: usize) -> Result<Stats> {
    let options = Options { threads, ..Options::default() };
    spmesh_pipeline::reduce::triangulate(StreamReader::new(input, "points")?, output, &options, |_| ())
        .map(|(_, stats)| stats)
}

#[test]
fn an_output_that_fails_ends_the_run() {
    let input = points();
    let length = triangulate(&input, &threads(1)).unwrap().0.len();
    for threads in THREADS {
        for room in [0, 300, 1000, length / 3, length / 2, length - 1000, length - 1] {
            for (error, kind) in [
                (io::ErrorKind::StorageFull, ErrorKind::Io),
                (io::ErrorKind::BrokenPipe, ErrorKind::ClosedPipe),
            ] {
                let output = Failing { room, error: Some(error) };
                let failure = write_to(Cursor::new(input.clone()), output, threads).unwrap_err();
                assert_eq!(failure.kind(), kind, "{threads} threads, room for {room}: {failure}");
            }
        }
        let enough = Failing { room: length, error: None };
        assert_eq!(write_to(Cursor::new(input.clone()), enough, threads).unwrap().points, 4000);
    }
}

#[test]
fn a_failure_does_not_wait_for_a_silent_input() {
    let input = points();
    for threads in THREADS {
        let (held, silence) = channel();
        let silent = Silent(Cursor::new(input[..input.len() / 2].to_vec()), silence);
        let output = Failing { room: 1000, error: Some(io::ErrorKind::StorageFull) };
        assert_eq!(write_to(silent, output, threads).unwrap_err().kind(), ErrorKind::Io);
        drop(held);
    }
}

#[test]
fn a_panic_while_writing_is_an_error() {
    for threads in [2, 8] {
        let output = Failing { room: 1000, error: None };
        let failure = write_to(Cursor::new(points()), output, threads).unwrap_err();
        assert_eq!(failure.kind(), ErrorKind::Io);
        assert!(failure.to_string().contains("ended before its time"), "{failure}");
    }
}

#[test]
fn a_damaged_input_ends_the_run() {
    let input = points();
    for threads in THREADS {
        for part in 1..16 {
            let at = input.len() * part / 16;
            let cut = triangulate(&input[..at], &self::threads(threads)).unwrap_err();
            assert_eq!(cut.kind(), ErrorKind::Malformed, "{threads} threads, cut at {at}: {cut}");
            let mut damaged = input.clone();
            damaged[at] ^= 1;
            let flipped = triangulate(&damaged, &self::threads(threads)).unwrap_err();
            assert_eq!(flipped.kind(), ErrorKind::Malformed, "{threads} threads, bit at {at}: {flipped}");
            assert!(flipped.to_string().starts_with("points: "), "{flipped}");
        }
    }
}

#[test]
fn an_error_of_a_cell_names_it() {
    let mut random = Random::new(3);
    let mut points: Vec<Point> = (0..900).map(|i| [f64::from(i % 30), f64::from(i / 30), 0.0]).collect();
    points.push(points[400]);
    let input = stream(&points, GRID, Tagging::Chunked(3), &mut random);
    for threads in THREADS {
        let options = Options { duplicates: Duplicates::Error, ..self::threads(threads) };
        let failure = triangulate(&input, &options).unwrap_err();
        assert_eq!(failure.kind(), ErrorKind::Malformed);
        assert!(failure.to_string().starts_with("points: cell "), "{failure}");
    }
}
