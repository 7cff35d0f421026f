//! Borders of finite sets of knots, and sharp places: knots that are repeated (thesis 8.3).
//!
//! Splines of the configurations of degree k sum to one where every closed half-plane through a point has at
//! least k + 1 knots. So knots are repeated on the border: as often as that takes at its corners
//! ([`Knots::clamped`]), or once everywhere ([`Knots::pulled_apart`]), which is right for degree 1, and so
//! for the quadratic splines of its links: they sum to one on the whole hull, and interpolate at its knots.
//! Copies come after all knots, which keep their ids, and are at the same places: the symbolic perturbation
//! of `knots` tells them apart as far as combinatorics go, and nothing has to be snapped back.

use super::knots::Knots;
use super::surface;
use crate::delaunay2::{MAX_POINTS, distinct};
use crate::predicates::{FiniteFloatPredicates, Predicates2, Sign, lexicographic};
use spmesh_core::error::{Error, Result};

impl Knots {
    /// The corners of the convex hull with multiplicity `degree` + 1; knots along its edges stay as they are.
    ///
    /// Splines of the degree then sum to one on the whole hull. Corners that are repeated already get what is
    /// missing.
    ///
    /// # Errors
    /// Knots on one line; more knots than can be handled.
    pub fn clamped(&self, degree: usize) -> Result<Knots> {
        let corners = self.border()?.corners;
        self.with_multiplicity(&corners, degree.saturating_add(1))
    }

    /// All knots on the border of the convex hull pulled apart: each place has two knots.
    ///
    /// # Errors
    /// Knots on one line; more knots than can be handled.
    pub fn pulled_apart(&self) -> Result<Knots> {
        let places = self.border()?.all;
        self.pull_apart(&places)
    }

    /// The listed knots pulled apart (thesis 8.3, figure 8.7): each place has two knots. The links of either
    /// are then triangulated from the other, whatever the rule is; Delaunay configurations do so by
    /// themselves, unless knots of the link are on one circle with the place: [`super::Start::generalised`]
    /// makes it sure.
    ///
    /// # Errors
    /// An unknown knot; more knots than can be handled.
    pub fn pull_apart(&self, knots: &[u32]) -> Result<Knots> {
        self.with_multiplicity(knots, 2)
    }

    /// Ids of all knots at the place of knot `id`, in order. Cost: O(n) if there are copies at all.
    #[must_use]
    pub fn copies_of(&self, id: u32) -> Vec<u32> {
        if !self.has_copies() {
            return vec![id];
        }
        (0..self.len() as u32).filter(|&other| self.at(other) == self.at(id)).collect()
    }

    /// The listed knots with copies, until there are `count` at each place.
    fn with_multiplicity(&self, ids: &[u32], count: usize) -> Result<Knots> {
        if let Some(unknown) = ids.iter().find(|&&id| id as usize >= self.len()) {
            return Err(Error::usage(format!("unknown knot {unknown}: there are {}", self.len())));
        }
        let mut places: Vec<u32> = ids.to_vec();
        places.sort_unstable_by(|&a, &b| lexicographic(self.at(a), self.at(b)));
        places.dedup_by(|a, b| self.at(*a) == self.at(*b));
        places.sort_unstable();
        let added = places.len().saturating_mul(count);
        if added.saturating_add(self.len()) > MAX_POINTS {
            let message = format!("{count} copies of {} knots are more than can be handled", places.len());
            return Err(Error::usage(message));
        }
        let mut points = self.points().to_vec();
        let firsts = distinct(&points);
        let mut present = vec![0; points.len()];
        firsts.iter().for_each(|&first| present[first as usize] += 1);
        for id in places {
            points.extend((present[firsts[id as usize] as usize]..count).map(|_| self.at(id)));
        }
        Knots::new(points)
    }

    /// The border of the convex hull, counterclockwise; of knots at one place the first.
    fn border(&self) -> Result<Border> {
        let all = surface::hull(self)?;
        let mut predicates = FiniteFloatPredicates::default();
        let count = all.len();
        let is_corner = |&place: &usize| {
            let [before, at, after] = [place + count - 1, place, place + 1].map(|i| self.at(all[i % count]));
            predicates.orient2d(before, at, after) != Sign::Zero
        };
        let corners = (0..count).filter(is_corner).map(|place| all[place]).collect();
        Ok(Border { corners, all })
    }
}

struct Border {
    corners: Vec<u32>,
    all: Vec<u32>,
}
