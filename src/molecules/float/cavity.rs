//! The cavity of a new point: what is known of it while it is searched for.

use super::mesh::tetrahedron_of;
use super::star::Wall;

/// Searches that are told apart.
const SEARCH_MAX: u32 = u32::MAX / 2;

/// Decisions against the values of spheres that are made for one cavity.
const DECIDED_MAX: usize = 1000;

/// The cavity of one point at a time.
#[derive(Debug, Default)]
pub(super) struct Cavity {
    /// Tetrahedra to be replaced.
    pub(super) tetrahedra: Vec<u32>,
    pub(super) walls: Vec<Wall>,
    /// Tetrahedra that are in the cavity, or not, whatever the values of their spheres; the last entry of one
    /// counts.
    pub(super) decided: Vec<(u32, bool)>,
    /// No others are in the cavity.
    pub(super) is_narrow: bool,
    /// For each tetrahedron, the last search that met it, times two, plus one if it is in the cavity.
    met: Vec<u32>,
    search: u32,
}

impl Cavity {
    /// Begins a search: nothing but `seed` is in the cavity.
    pub(super) fn begin(&mut self, seed: u32, tetrahedra: usize) {
        if self.search == SEARCH_MAX {
            self.met.fill(0);
            self.search = 0;
        }
        self.search += 1;
        self.met.resize(tetrahedra, 0);
        self.tetrahedra.clear();
        self.walls.clear();
        self.add(seed, true);
    }

    /// Whether a tetrahedron is in the cavity, if the search has met it.
    #[inline(always)]
    pub(super) fn known(&self, t: u32) -> Option<bool> {
        let met = self.met[t as usize];
        (met / 2 == self.search).then_some(met & 1 == 1)
    }

    /// Records whether a tetrahedron is in the cavity.
    #[inline(always)]
    pub(super) fn add(&mut self, t: u32, is_inside: bool) {
        self.met[t as usize] = self.search * 2 + u32::from(is_inside);
        if is_inside {
            self.tetrahedra.push(t);
        }
    }

    pub(super) fn decision(&self, t: u32) -> Option<bool> {
        self.decided.iter().rev().find(|decided| decided.0 == t).map(|decided| decided.1)
    }

    /// Decides what to change where the point does not see a facet: the tetrahedron behind it is left out,
    /// but if that is the seed, or the cavity is narrow, the one in front of it is taken in. False if nothing
    /// is left to be changed.
    pub(super) fn decide(&mut self, seed: u32) -> bool {
        let before = self.decided.len();
        for i in 0..self.walls.len() {
            let wall = self.walls[i];
            if wall.is_seen() {
                continue;
            }
            let in_front = tetrahedron_of(wall.outside);
            let is_kept = self.is_narrow || wall.inside == seed;
            if is_kept && self.decision(in_front) == Some(false) || self.decided.len() == DECIDED_MAX {
                return false;
            }
            self.decided.push(if is_kept { (in_front, true) } else { (wall.inside, false) });
        }
        self.decided.len() > before
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<u32>() * (self.met.capacity() + self.tetrahedra.capacity())
            + size_of::<Wall>() * self.walls.capacity()
    }
}
