//! Damaged files: whichever byte is wrong, reading ends with points or an error, within bounded memory.

use super::{flat, sample};
use crate::allocation::largest_during;
use crate::programs::Folder;
use spmesh_base::error::ErrorKind;
use spmesh_formats::source::Input;

/// Largest single allocation that a damaged small file may cause: a group of chunks.
const ALLOCATION_MAX: usize = 65 << 20;

/// Reads all points of `content`, and checks the memory that this takes and that an error is one of the
/// content.
fn try_read(folder: &Folder, content: &[u8]) {
    let path = folder.file("damaged", content);
    let read = || -> spmesh_base::error::Result<()> {
        let input = Input::open(&[path], &flat())?;
        let mut reader = input.read()?;
        let mut batch = Vec::new();
        let mut points = 0;
        while points < 10_000_000 {
            reader.next_batch(&mut batch)?;
            if batch.is_empty() {
                break;
            }
            points += batch.len();
        }
        Ok(())
    };
    let largest = largest_during(|| {
        if let Err(error) = read() {
            assert!(matches!(error.kind(), ErrorKind::Malformed | ErrorKind::Usage), "{error}");
        }
    });
    assert!(largest <= ALLOCATION_MAX, "a request of {largest} bytes");
}

/// Damages bytes of a sample one at a time: the first `until`, the last 64, and every 101st between.
fn damage(name: &str, until: usize) {
    let whole = std::fs::read(sample(name)).unwrap();
    let is_chosen = |&at: &usize| at < until || at + 64 > whole.len() || at % 101 == 0;
    damage_bytes(&whole, (0..whole.len()).filter(is_chosen));
}

/// Damages the bytes at `places` of a file one at a time, each in several ways.
pub fn damage_bytes(whole: &[u8], places: impl Iterator<Item = usize>) {
    let folder = Folder::new();
    for at in places {
        for change in [0x01, 0x80, 0xff] {
            let mut damaged = whole.to_vec();
            damaged[at] ^= change;
            try_read(&folder, &damaged);
        }
    }
}

#[test]
fn damage_to_las_is_survived() {
    damage("hextest.las", 387);
    damage("1_4_w_evlr.las", 400);
}

#[test]
fn damage_to_laz_is_survived() {
    damage("autzen.laz", 300);
    damage("pointwise.laz", 340);
}

#[test]
fn damage_to_layered_laz_is_survived() {
    damage("autzen.copc.laz", 400);
}

#[test]
fn files_cut_anywhere_are_errors() {
    let folder = Folder::new();
    for name in ["hextest.las", "autzen.laz", "autzen.copc.laz"] {
        let whole = std::fs::read(sample(name)).unwrap();
        for len in (0..whole.len()).step_by(3) {
            try_read(&folder, &whole[..len]);
        }
        let whole_points = super::points(&[sample(name)], &flat()).unwrap();
        for len in (0..whole.len()).step_by(7) {
            let path = folder.file("cut", &whole[..len]);
            // The end of the file after the points may be missing, but no point may.
            if let Ok(found) = super::points(&[path], &flat()) {
                assert_eq!(found, whole_points, "{name} cut at {len}");
            }
        }
    }
}

#[test]
fn points_in_the_header_are_refused() {
    let folder = Folder::new();
    let whole = std::fs::read(sample("hextest.las")).unwrap();
    // The offset of the point data is at byte 96, the length of the header at byte 94.
    for (at, value) in [(96, 0u32), (96, 100), (96, 226)] {
        let mut damaged = whole.clone();
        damaged[at..at + 4].copy_from_slice(&value.to_le_bytes());
        let path = folder.file("damaged", &damaged);
        super::assert_fails(Input::open(&[path], &flat()), ErrorKind::Malformed, &["they overlap"]);
    }
    let mut short = whole;
    short[94..96].copy_from_slice(&1u16.to_le_bytes());
    let path = folder.file("short", &short);
    super::assert_fails(Input::open(&[path], &flat()), ErrorKind::Malformed, &["header of 1 bytes"]);
}
