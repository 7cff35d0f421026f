//! Segments bent to the centres of the hot pixels that they pass through, and elevations of their vertices.

use super::collinear::{Cover, Segments};
use super::exact::{Place, minus};
use super::nodes::{Nodes, Part, Places};
use super::search::Found;
use super::{LineVertex, Noded, NodingChange, NodingOptions};
use crate::network::NetworkSegment;

/// Bends all segments. Frees what it needs no longer, as the result takes as much memory.
pub(super) fn bend(
    places: Places,
    starts: &[u32],
    segments: Segments,
    found: Found,
    options: &NodingOptions,
    note: &mut dyn FnMut(NodingChange, u32, Place),
) -> Noded {
    let Places { places, elevations, conflicts, .. } = places;
    let nodes = Nodes::of(places, elevations, &found.crossings);
    let touches = nodes.sorted(&found.touches);
    drop(found);
    let mut amid: Vec<u32> = touches.iter().map(|&touch| touch as u32).collect();
    amid.sort_unstable();
    amid.dedup();
    let line = |vertex: u32| starts.partition_point(|&start| start <= vertex) as u32 - 1;
    let mut bends = Bends {
        interpolated: vec![f64::NAN; if nodes.has_elevations() { amid.len() } else { 0 }],
        bent: vec![u32::MAX; amid.len()],
        amid,
        conflicts: conflicts.iter().map(|&[place, vertex]| [nodes.of_place(place), line(vertex)]).collect(),
        pieces: Vec::with_capacity(segments.ends.len() + touches.len()),
        nodes,
        options: *options,
    };
    let mut rest = &touches[..];
    let (mut chain, mut cover) = (Vec::new(), Cover::default());
    for segment in 0..segments.ends.len() {
        let count = rest.iter().take_while(|&&touch| touch >> 32 == segment as u64).count();
        let (own, later) = rest.split_at(count);
        rest = later;
        bends.chain(segments.ends[segment], own, &mut chain);
        bends.follow(segments.parts(segment), &chain, &mut cover);
    }
    drop((touches, segments));
    bends.finish(note)
}

/// A straight piece of the result, once for each segment that was bent to it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Piece {
    ends: [u32; 2],
    line: u32,
    is_shared: bool,
    is_hard: bool,
}

struct Bends {
    nodes: Nodes,
    /// The nodes that segments are bent to, in increasing order.
    amid: Vec<u32>,
    /// Lowest elevation that was interpolated at each of them; NaN if none was. Empty if lines state none.
    interpolated: Vec<f64>,
    /// The least line that was bent to each of them; `u32::MAX` if none was.
    bent: Vec<u32>,
    /// Nodes with several elevations, and a line of each.
    conflicts: Vec<[u32; 2]>,
    pieces: Vec<Piece>,
    options: NodingOptions,
}

impl Bends {
    /// Replaces the content of `chain` by the nodes of a segment in their order along it: x does not
    /// decrease, and y does not turn back.
    fn chain(&self, ends: [u32; 2], touches: &[u64], chain: &mut Vec<u32>) {
        let [a, b] = ends.map(|end| self.nodes.of_place(end));
        chain.clear();
        chain.extend([a, b]);
        if !touches.is_empty() {
            chain.extend(touches.iter().map(|&touch| touch as u32));
            let is_falling = self.nodes.is_falling(a, b);
            chain.sort_unstable_by_key(|&node| self.nodes.key_along(node, is_falling));
        }
    }

    /// The place of a node among those that segments are bent to.
    fn place(&self, node: u32) -> usize {
        self.amid.binary_search(&node).expect("a segment is bent to the node")
    }

    /// Enters the pieces of a segment, and interpolates elevations.
    fn follow(&mut self, parts: &[Part], chain: &[u32], cover: &mut Cover) {
        cover.find(&self.nodes, chain, parts);
        for (ends, piece) in chain.windows(2).zip(&cover.pieces) {
            let ends = [ends[0].min(ends[1]), ends[0].max(ends[1])];
            let &super::collinear::Piece { line, is_shared, is_hard } = piece;
            self.pieces.push(Piece { ends, line, is_shared, is_hard });
        }
        let last = chain.len() - 1;
        for (index, &node) in chain[..last].iter().enumerate().skip(1) {
            if !cover.is_end[index] {
                let place = self.place(node);
                self.bent[place] = self.bent[place].min(cover.pieces[index].line);
            }
        }
        if chain.len() > 2 && !self.interpolated.is_empty() {
            self.interpolate(chain, cover);
        }
    }

    /// Interpolates between consecutive nodes for which lines state elevations, where a part with elevations
    /// at both ends runs along. The ends of such a part are nodes of this kind, so that it runs along all
    /// pieces between two of them or along none.
    fn interpolate(&mut self, chain: &[u32], cover: &Cover) {
        let along = {
            let [a, b] = [chain[0], chain[chain.len() - 1]].map(|node| self.nodes.places[node as usize]);
            minus(b, a)
        };
        // Positions along the segment, for the quotient only: exact, as differences of places are.
        let between = |a: Place, b: Place| {
            let [dx, dy] = minus(b, a);
            (i128::from(dx) * i128::from(along[0]) + i128::from(dy) * i128::from(along[1])) as f64
        };
        let is_stated = |node: &u32| !self.nodes.stated(*node).is_nan();
        let mut before: Option<usize> = None;
        for index in 0..chain.len() {
            if !is_stated(&chain[index]) {
                continue;
            }
            if let Some(before) = before.filter(|&before| cover.pieces[before].is_hard) {
                let ends: [u32; 2] = [chain[before], chain[index]];
                let [a, b] = ends.map(|node| self.nodes.places[node as usize]);
                let [from, to] = ends.map(|node| self.nodes.stated(node));
                for &node in &chain[before + 1..index] {
                    let part = between(a, self.nodes.places[node as usize]) / between(a, b);
                    let z = from + (to - from) * part;
                    let z = if self.options.round_elevations { z.round() } else { z };
                    let place = self.place(node);
                    let known = &mut self.interpolated[place];
                    if known.is_nan() {
                        *known = z;
                    } else if *known != z {
                        self.conflicts.push([node, cover.pieces[before].line]);
                        *known = known.min(z);
                    }
                }
            }
            before = Some(index);
        }
    }

    fn finish(mut self, note: &mut dyn FnMut(NodingChange, u32, Place)) -> Noded {
        let segments = self.segments(note);
        let nodes = &self.nodes;
        for (&node, &line) in self.amid.iter().zip(&self.bent) {
            if line != u32::MAX {
                let is_crossing = nodes.is_crossing(node);
                let change = if is_crossing { NodingChange::Crossing } else { NodingChange::Touch };
                note(change, line, nodes.places[node as usize]);
            }
        }
        self.conflicts.sort_unstable();
        self.conflicts.dedup_by_key(|conflict| conflict[0]);
        for &[node, line] in &self.conflicts {
            note(NodingChange::ConflictingElevation, line, nodes.places[node as usize]);
        }
        Noded { vertices: self.vertices(), segments }
    }

    /// The segments of the result. Frees the pieces.
    fn segments(&mut self, note: &mut dyn FnMut(NodingChange, u32, Place)) -> Vec<NetworkSegment> {
        let mut pieces = std::mem::take(&mut self.pieces);
        pieces.sort_unstable();
        let mut segments = Vec::with_capacity(pieces.len());
        for same in pieces.chunk_by(|a, b| a.ends == b.ends) {
            let Piece { ends, line, .. } = same[0];
            let is_hard = same.iter().any(|piece| piece.is_hard);
            segments.push(NetworkSegment { ends, line, is_hard });
            if same.len() > 1 || same[0].is_shared {
                note(NodingChange::Overlap, line, self.nodes.places[ends[0] as usize]);
            }
        }
        segments
    }

    /// The vertices of the result. Frees what they do not need before there is room for them.
    fn vertices(self) -> Vec<LineVertex> {
        let (places, mut elevations) = self.nodes.into_places();
        for (&node, &z) in self.amid.iter().zip(&self.interpolated) {
            let stated = &mut elevations[node as usize];
            *stated = if stated.is_nan() { z } else { *stated };
        }
        let z = |node: usize| elevations.get(node).copied().filter(|z| !z.is_nan());
        places.iter().enumerate().map(|(node, &place)| LineVertex { place, z: z(node) }).collect()
    }
}
