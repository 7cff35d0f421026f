//! The parts of a file that are read: ranges of records, and the chunks that hold them.

use std::ops::Range;

use crate::las::index::wrong_index;
use crate::las::laz_chunks::Chunk;
use crate::source::records::raw_point;
use spmesh_base::error::Result;
use spmesh_stream::model::bounds::Bounds;

/// Records between two parts that are read too: they cost less than another read.
const GAP_MAX: u64 = 1000;

/// Consecutive records of a file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Part {
    /// Their numbers.
    pub(crate) records: Range<u64>,
    /// A box that the index promises for them, in stored coordinates.
    pub(crate) within: Option<Bounds>,
}

/// The chunks with records of `parts`, which are in the order of the file; all chunks for `None`.
pub(crate) fn chunks_of_parts(chunks: Vec<Chunk>, parts: Option<&[Part]>) -> Vec<Chunk> {
    let Some(mut parts) = parts else { return chunks };
    let mut wanted = Vec::new();
    for mut chunk in chunks {
        while let Some((_, rest)) = parts.split_first().filter(|(part, _)| part.records.end <= chunk.first) {
            parts = rest;
        }
        if let Some(part) = parts.first().filter(|part| part.records.start < chunk.after()) {
            chunk.within = part.within;
            wanted.push(chunk);
        }
    }
    wanted
}

/// The records of `parts` in ranges that are not close to each other; all of `points` records for `None`.
pub(crate) fn ranges_of_parts(points: u64, parts: Option<&[Part]>) -> Vec<Range<u64>> {
    let Some(parts) = parts else { return std::iter::once(0..points).collect() };
    let mut ranges: Vec<Range<u64>> = Vec::new();
    for Part { records, .. } in parts {
        match ranges.last_mut().filter(|last| records.start <= last.end.saturating_add(GAP_MAX)) {
            Some(last) => last.end = last.end.max(records.end),
            None => ranges.push(records.clone()),
        }
    }
    ranges
}

/// Checks that `records`, of which the first has the number `first` in the file, lie in the box that the index
/// promises. Cost: nothing without a box.
pub(crate) fn check_records(
    records: &[u8],
    record_len: usize,
    first: u64,
    within: Option<&Bounds>,
) -> Result<()> {
    let Some(within) = within else { return Ok(()) };
    let outside = records.chunks_exact(record_len).position(|record| !within.contains(raw_point(record)));
    match outside {
        Some(index) => {
            Err(wrong_index("a record lies outside of its node")
                .at(format!("record {}", first + index as u64)))
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(records: Range<u64>) -> Part {
        Part { records, within: None }
    }

    fn chunk(first: u64, points: u64) -> Chunk {
        Chunk { start: 100 + first, len: 9, points, first, within: None }
    }

    #[test]
    fn chunks_with_one_record_of_a_part_are_read() {
        let chunks = || vec![chunk(0, 10), chunk(10, 10), chunk(20, 5), chunk(25, 10)];
        let firsts = |parts: &[Part]| -> Vec<u64> {
            chunks_of_parts(chunks(), Some(parts)).iter().map(|chunk| chunk.first).collect()
        };
        assert_eq!(chunks_of_parts(chunks(), None).len(), 4);
        assert!(firsts(&[]).is_empty());
        assert_eq!(firsts(&[part(9..10)]), [0]);
        assert_eq!(firsts(&[part(9..11)]), [0, 10]);
        assert_eq!(firsts(&[part(0..1), part(2..3), part(20..21), part(34..35)]), [0, 20, 25]);
        assert_eq!(firsts(&[part(5..30)]), [0, 10, 20, 25]);
    }

    #[test]
    fn ranges_close_to_each_other_are_one() {
        assert!(matches!(&ranges_of_parts(7, None)[..], [all] if *all == (0..7)));
        assert!(ranges_of_parts(7, Some(&[])).is_empty());
        let parts = [part(0..1), part(1001..1010), part(2011..2012)];
        assert_eq!(ranges_of_parts(5000, Some(&parts)), [0..1010, 2011..2012]);
    }

    #[test]
    fn the_record_outside_of_its_box_is_named() {
        let bytes: Vec<u8> =
            [[1i32, 2, 3], [4, 5, 6]].iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let within = |max| Some(Bounds { min: [1.0, 2.0, 3.0], max });
        assert!(check_records(&bytes, 12, 7, None).is_ok());
        assert!(check_records(&bytes, 12, 7, within([4.0, 5.0, 6.0]).as_ref()).is_ok());
        let error = check_records(&bytes, 12, 7, within([4.0, 4.0, 6.0]).as_ref()).unwrap_err().to_string();
        assert!(error.contains("record 8") && error.contains("without the index"), "{error}");
    }
}
