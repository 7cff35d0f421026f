//! The complex cut into parts, each a range of vertices along the curve: see [`super::parts`].

use super::complex::{DELETED, FROZEN};
use super::tetrahedralization::{NONE, Tetrahedron, WORDS};
use std::ops::Range;

/// Greatest number of parts.
pub(super) const PARTS_MAX: usize = 1024;

/// Parts are cut at borders of bins of vertices, at most 2^16.
const BITS_OF_BINS: u32 = 16;

/// A cut may be off the even place by 1/`SLACK` of the vertices of a part.
const SLACK: usize = 16;

/// Greatest number of places along the curve, in each part, where walks may start.
const STARTS_MAX: usize = 1 << 14;

/// A part of a complex.
#[derive(Debug)]
pub(super) struct Part {
    /// Its vertices.
    pub(super) own: Range<u32>,
    /// Number of its tetrahedra.
    pub(super) size: usize,
    /// Tetrahedra of the part along the curve. Walks that come to a frozen tetrahedron start again at them.
    pub(super) starts: Vec<u32>,
}

/// Cuts a complex with `finite` finite vertices into parts, at most as many as asked for, and freezes the
/// tetrahedra between them.
pub(super) fn cut(tetrahedra: &mut [Tetrahedron], finite: usize, parts: usize) -> Vec<Part> {
    let ends = ends(tetrahedra, finite, parts.min(PARTS_MAX));
    let mut first = 0;
    let part = |&end: &u32| {
        let own = std::mem::replace(&mut first, end)..end;
        let starts = vec![NONE; own.len().min(STARTS_MAX)];
        Part { own, size: 0, starts }
    };
    let mut parts: Vec<Part> = ends.iter().map(part).collect();
    for (number, tetrahedron) in tetrahedra.iter_mut().enumerate().filter(|(_, t)| t.vertices[0] < DELETED) {
        let (least, greatest) = range(tetrahedron, finite as u32);
        let part = &mut parts[ends.partition_point(|&end| end <= least)];
        if greatest >= part.own.end {
            tetrahedron.vertices = tetrahedron.vertices.map(|v| v | FROZEN);
            continue;
        }
        part.size += 1;
        let place = (least - part.own.start) as usize * part.starts.len() / part.own.len();
        part.starts[place] = (number * WORDS) as u32;
    }
    parts.iter_mut().for_each(|part| fill(&mut part.starts));
    parts
}

/// Undoes the freezing of tetrahedra.
pub(super) fn thaw(tetrahedra: &mut [Tetrahedron]) {
    for tetrahedron in tetrahedra {
        tetrahedron.vertices = tetrahedron.vertices.map(|v| v & !FROZEN);
    }
}

/// Fills gaps with the entry before, the first ones with the first entry. Clears a list without entries.
fn fill(starts: &mut Vec<u32>) {
    let Some(mut last) = starts.iter().copied().find(|&t| t != NONE) else {
        return starts.clear();
    };
    for start in starts {
        if *start == NONE {
            *start = last;
        }
        last = *start;
    }
}

/// The least and the greatest finite vertex.
fn range(tetrahedron: &Tetrahedron, infinite: u32) -> (u32, u32) {
    let [a, b, c, d] = tetrahedron.vertices;
    let finite = tetrahedron.vertices.map(|v| if v == infinite { 0 } else { v });
    (a.min(b).min(c.min(d)), finite.into_iter().fold(0, u32::max))
}

/// Where to cut `count` vertices into parts of almost the same size: where the fewest tetrahedra are cut.
fn ends(tetrahedra: &[Tetrahedron], count: usize, parts: usize) -> Vec<u32> {
    let shift = (usize::BITS - count.leading_zeros()).saturating_sub(BITS_OF_BINS);
    // For each bin, how many more tetrahedra a cut before it splits than a cut before the previous bin.
    let mut cuts = vec![0i64; (count >> shift) + 2];
    for tetrahedron in tetrahedra.iter().filter(|tetrahedron| tetrahedron.vertices[0] < DELETED) {
        let (least, greatest) = range(tetrahedron, count as u32);
        cuts[(least >> shift) as usize + 1] += 1;
        cuts[(greatest >> shift) as usize + 1] -= 1;
    }
    let mut sum = 0;
    for cut in &mut cuts {
        sum += *cut;
        *cut = sum;
    }
    let slack = count / parts / SLACK;
    let mut ends: Vec<u32> = (1..parts)
        .map(|part| {
            let even = (count as u64 * part as u64 / parts as u64) as usize;
            let bins = (even - slack) >> shift..=(even + slack) >> shift;
            let best = bins.min_by_key(|&bin| cuts[bin]).unwrap_or(even >> shift);
            (best << shift) as u32
        })
        .collect();
    ends.push(count as u32);
    ends
}
