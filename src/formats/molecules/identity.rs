//! Which atoms make a residue, and which residues a chain: by their places in the file. Labels alone do not
//! tell, as files number on after 9999 from 0, leave out names of chains, or have several copies.

use std::collections::{HashMap, HashSet};

use foldhash::fast::FixedState;

use crate::molecules::model::Residue;
use crate::molecules::names::Name;
use crate::molecules::residue_names::Kind;

type Map<K, V> = HashMap<K, V, FixedState>;
type Set<K> = HashSet<K, FixedState>;

/// What the atoms of a residue have in common: its labels, segment and entity.
type Labels = (Residue, Name, Name);

/// Tells where residues begin, atom by atom in the order of the file.
#[derive(Debug, Default)]
pub(crate) struct Residues {
    /// The residue of the atom before; `None` after an end.
    last: Option<(Labels, u32)>,
    /// The last residue with alternate locations of these labels, since the last end.
    alternates: Map<Labels, u32>,
    /// Residue, name and alternate location of atoms so far, where they tell residues apart; and those
    /// without the location.
    sites: Set<(u32, Name, Option<Name>)>,
}

impl Residues {
    /// The next atom begins a residue.
    pub(crate) fn end(&mut self) {
        *self = Residues::default();
    }

    /// Index of the residue of an atom, whose name and alternate location are given: that of the atom before
    /// if it has these labels, and otherwise `next`.
    ///
    /// Without numbers, a residue ends where an atom comes again. Alternate locations may be apart from each
    /// other: they are of the last residue with their labels.
    pub(crate) fn place(&mut self, labels: Labels, [name, altloc]: [Name; 2], next: u32) -> u32 {
        let is_counted = labels.0.number.is_some() || labels.0.name.is_empty();
        // An atom with one location is at all of them.
        let has = |index: u32, at: Option<Name>| self.sites.contains(&(index, name, at));
        let lacks = |index: u32| match altloc.is_empty() {
            true => !has(index, None),
            false => !has(index, Some(altloc)) && !has(index, Some(Name::EMPTY)),
        };
        // Some files name the segments of some atoms only.
        let (residue, segment, entity) = labels;
        let has_same = |last: Labels| {
            (last.0, last.2) == (residue, entity)
                && (last.1 == segment || last.1.is_empty() || segment.is_empty())
        };
        let index = match self.last {
            Some((last, index)) if has_same(last) && (is_counted || lacks(index)) => index,
            _ if is_counted && !altloc.is_empty() => {
                self.alternates.get(&labels).copied().filter(|&index| lacks(index)).unwrap_or(next)
            }
            _ => next,
        };
        if index == next && self.alternates.is_empty() {
            self.sites.clear();
        }
        if is_counted && !altloc.is_empty() {
            self.alternates.insert(labels, index);
        }
        if !is_counted || !altloc.is_empty() {
            self.sites.extend([(index, name, Some(altloc)), (index, name, None)]);
        }
        self.last = Some((labels, index));
        index
    }
}

/// What tells of a residue whether it is one of a chain's sequence.
pub(crate) struct Link {
    pub(crate) kind: Kind,
    pub(crate) is_hetatm: bool,
}

/// Residues of one name of a chain (and of one part of it in mmCIF) up to a TER.
struct Part {
    chain: Name,
    residues: Vec<usize>,
}

/// A chain so far: its number, the numbers and insertion codes in its sequence, and whether that has residues
/// of polymers.
struct Chain {
    number: u32,
    sites: Set<(i32, Name)>,
    has_polymer: bool,
}

/// Numbers the chains, each model by itself. `starts` has the number of residues before each model, and
/// `ends` the residues before a TER.
///
/// A name stands for one chain, unless a part of it counts its residues again: it is a copy. Without names,
/// each part with a polymer is a chain.
pub(crate) fn number_chains(
    residues: &mut [Residue],
    starts: &[usize],
    ends: &Set<usize>,
    mut link: impl FnMut(usize, Name) -> Link,
) {
    let mut next = 0;
    let len = residues.len();
    for (&start, &end) in starts.iter().zip(starts.iter().skip(1).chain([&len])) {
        let mut chains: Map<Name, Chain> = Map::default();
        let parts = parts(residues, start..end, ends);
        let mut counts: Map<Name, usize> = Map::default();
        parts.iter().for_each(|part| *counts.entry(part.chain).or_default() += 1);
        for part in parts {
            let is_alone = counts[&part.chain] == 1;
            let (sites, has_polymer) =
                if is_alone { Default::default() } else { sequence(residues, &part, &mut link) };
            let is_same = |chain: &Chain| {
                let are_two = part.chain.is_empty() && chain.has_polymer && has_polymer;
                !are_two && chain.sites.is_disjoint(&sites)
            };
            let chain = match chains.remove(&part.chain).filter(is_same) {
                Some(mut chain) => {
                    chain.sites.extend(sites);
                    Chain { has_polymer: chain.has_polymer || has_polymer, ..chain }
                }
                None => {
                    next += 1;
                    Chain { number: next, sites, has_polymer }
                }
            };
            part.residues.iter().for_each(|&index| residues[index].chain_number = chain.number);
            chains.insert(part.chain, chain);
        }
    }
}

/// The parts of the chains of a model, in the order in which they begin.
fn parts(residues: &[Residue], range: std::ops::Range<usize>, ends: &Set<usize>) -> Vec<Part> {
    let mut parts: Vec<Part> = Vec::new();
    let mut open: Map<(Name, Name), usize> = Map::default();
    for index in range {
        let Residue { chain, subchain, .. } = residues[index];
        let part = *open.entry((chain, subchain)).or_insert(parts.len());
        if part == parts.len() {
            parts.push(Part { chain, residues: Vec::new() });
        }
        parts[part].residues.push(index);
        if ends.contains(&index) {
            open.remove(&(chain, subchain));
        }
    }
    parts
}

/// Numbers and insertion codes of the residues of a part that may be those of a sequence, and whether one of
/// them is of a polymer. Water and HETATM records of other residues are often counted from 1.
fn sequence(
    residues: &[Residue],
    part: &Part,
    link: &mut impl FnMut(usize, Name) -> Link,
) -> (Set<(i32, Name)>, bool) {
    let (mut sites, mut has_polymer) = (Set::default(), false);
    for &index in &part.residues {
        let residue = residues[index];
        let Link { kind, is_hetatm } = link(index, residue.name);
        has_polymer |= kind == Kind::Polymer && !is_hetatm;
        if kind == Kind::Polymer || kind == Kind::Other && !is_hetatm {
            sites.extend(residue.number.map(|number| (number, residue.insertion_code)));
        }
    }
    (sites, has_polymer)
}
