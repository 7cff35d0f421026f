//! Repeats knots on the border and at sharp places (thesis 8.3).
//!
//! Splines of the configurations of degree k sum to one at a point if every closed half-plane that contains
//! the point contains at least k + 1 knots. So knots on the border are repeated: either corners, as often as
//! the degree needs ([`Knots::clamped`]), or all border knots, once ([`Knots::pulled_apart`]). The latter
//! suits degree 1, and so the quadratic splines of its links: they sum to one on the whole hull, and
//! interpolate at its knots. Copies have the coordinates of their knots, and are numbered after all given
//! knots, which keep their ids. The symbolic perturbation of `knots` tells copies apart combinatorially, so
//! no coordinates have to be moved and restored.

use super::knots::Knots;
use super::surface;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay2::{MAX_POINTS, distinct};
use spmesh_delaunay::predicates::{FiniteFloatPredicates, Predicates2, Sign, lexicographic};

impl Knots {
    /// The corners of the convex hull with multiplicity `degree` + 1; knots along its edges stay as they are.
    ///
    /// Splines of this degree then sum to one on the whole hull. Corners that are already repeated only get
    /// the missing copies.
    ///
    /// # Errors
    /// Knots on one line; too many knots.
    pub fn clamped(&self, degree: usize) -> Result<Knots> {
        let corners = self.border()?.corners;
        self.with_multiplicity(&corners, degree.saturating_add(1))
    }

    /// All knots on the border of the convex hull pulled apart: each place has two knots.
    ///
    /// # Errors
    /// Knots on one line; too many knots.
    pub fn pulled_apart(&self) -> Result<Knots> {
        let places = self.border()?.all;
        self.pull_apart(&places)
    }

    /// The listed knots pulled apart (thesis 8.3, figure 8.7): each of their places has two knots. The link
    /// of either knot is then triangulated by diagonals from the other, whatever the rule.
    /// [`super::Start::generalised`] guarantees this; Delaunay configurations have these diagonals anyway,
    /// unless knots of the link are on one circle with the place.
    ///
    /// # Errors
    /// An unknown knot; too many knots.
    pub fn pull_apart(&self, knots: &[u32]) -> Result<Knots> {
        self.with_multiplicity(knots, 2)
    }

    /// Ids of all knots at the place of knot `id`, in order.
    ///
    /// Cost: O(n) if there are copies at all.
    pub fn copies_of(&self, id: u32) -> Vec<u32> {
        if !self.has_copies() {
            return vec![id];
        }
        (0..self.len() as u32).filter(|&other| self.at(other) == self.at(id)).collect()
    }

    /// Adds copies of the listed knots until there are `count` knots at each of their places.
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
        Ok(Knots::new(points)?.displaced(self.displacement()))
    }

    /// The border of the convex hull, counterclockwise; of several knots at one place, only the first.
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
