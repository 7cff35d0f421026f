//! Implements the rules. Each rule picks the apex of the triangle on an edge, which leaves a polygon on
//! either side.

use super::insertion::LARGE;
use super::polygon::Triangulator;
use super::rule::Rule;
use spmesh_base::error::Result;
use spmesh_base::random::Random;
use spmesh_delaunay::predicates::{Predicates2, Sign};

impl<P: Predicates2> Triangulator<'_, P> {
    /// Triangulates a simple polygon of at least four vertices.
    pub(super) fn by_rule(&mut self) -> Result<()> {
        match self.rule {
            Rule::Delaunay | Rule::Lifted(_) if self.is_regular && self.polygon.len() >= LARGE => {
                self.insert_vertices()
            }
            Rule::Delaunay | Rule::Lifted(_) if self.is_regular => self.split(Self::empty_apex),
            Rule::Delaunay | Rule::Lifted(_) => self.split(Self::constrained_apex),
            Rule::Random(seed) => {
                let mut random = Random::new(self.seed(*seed));
                self.split(|this, i, j| this.random_apex(&mut random, i, j))
            }
            Rule::Fan => self.split_fan(),
            Rule::Ear => self.cut_ears(),
            Rule::MinWeight | Rule::Aligned(_) | Rule::Data(_) | Rule::Gradients(_) => {
                let apexes = self.least_weight();
                let count = self.polygon.len();
                self.split(|_, i, j| apexes[i * count + j])
            }
        }
    }

    /// Splits the polygon recursively: `apex` gives the third corner of the triangle on an edge.
    pub(super) fn split(
        &mut self,
        mut apex: impl FnMut(&mut Self, usize, usize) -> Option<usize>,
    ) -> Result<()> {
        self.stack.clear();
        self.stack.push((0, self.polygon.len() - 1));
        while let Some((i, j)) = self.stack.pop() {
            let Some(k) = (if j == i + 2 { Some(i + 1) } else { apex(self, i, j) }) else {
                return Err(self.failure("no triangle fits an edge in it"));
            };
            self.emit(i, k, j)?;
            self.stack.extend([(i, k), (k, j)].into_iter().filter(|(i, j)| j - i > 1));
        }
        Ok(())
    }

    /// The place whose circle with the edge has no other vertex inside. Visibility is not tested: where all
    /// triangles are those of the lift, no edge is in the way.
    pub(super) fn empty_apex(&mut self, i: usize, j: usize) -> Option<usize> {
        self.best_apex(i, j, |_, _| true)
    }

    /// Like [`Triangulator::empty_apex`], among the places that both ends of the edge see: the constrained
    /// Delaunay triangulation. (A visible place is worse than any other visible place inside its circle, and
    /// the right one has none inside. So comparing places in turn finds it.)
    fn constrained_apex(&mut self, i: usize, j: usize) -> Option<usize> {
        self.best_apex(i, j, |this, k| this.sees(i, k) && this.sees(k, j))
    }

    fn best_apex(
        &mut self,
        i: usize,
        j: usize,
        mut fits: impl FnMut(&mut Self, usize) -> bool,
    ) -> Option<usize> {
        let (a, b) = (self.polygon[j], self.polygon[i]);
        let mut best: Option<usize> = None;
        for k in i + 1..j {
            let c = self.polygon[k];
            let is_better = match best {
                Some(best) => {
                    self.plane.is_left(a, b, c) && self.plane.is_inside([a, b, self.polygon[best]], c)
                }
                None => self.plane.is_left(a, b, c),
            };
            if is_better && fits(self, k) {
                best = Some(k);
            }
        }
        best
    }

    fn random_apex(&mut self, random: &mut Random, i: usize, j: usize) -> Option<usize> {
        let fitting: Vec<usize> = (i + 1..j).filter(|&k| self.fits(i, k, j)).collect();
        (!fitting.is_empty()).then(|| fitting[random.below(fitting.len() as u64) as usize])
    }

    /// Whether the triangle of three places is counterclockwise and lies in the polygon.
    fn fits(&mut self, i: usize, k: usize, j: usize) -> bool {
        let [a, b, c] = [i, k, j].map(|place| self.polygon[place]);
        self.plane.is_left(a, b, c) && self.sees(i, k) && self.sees(k, j)
    }

    /// A seed that depends on the seed of the rule and on the set.
    fn seed(&self, seed: u64) -> u64 {
        self.set.iter().fold(seed, |seed, &knot| Random::new(seed ^ u64::from(knot)).bits())
    }

    /// For each pair of places, the apex in the triangulation of least weight of the polygon between them
    /// (Klincsek, 1980); of equal weights, the first.
    fn least_weight(&mut self) -> Vec<Option<usize>> {
        let count = self.polygon.len();
        let mut apexes = vec![None; count * count];
        let mut sums = vec![f64::INFINITY; count * count];
        (1..count).for_each(|j| sums[(j - 1) * count + j] = 0.0);
        for length in 2..count {
            for i in 0..count - length {
                let j = i + length;
                if !self.sees(i, j) {
                    continue;
                }
                let weight = self.rule.weight(self.plane.knots, self.polygon[i], self.polygon[j]);
                for k in i + 1..j {
                    let sum = weight + sums[i * count + k] + sums[k * count + j];
                    if sum < sums[i * count + j] && self.fits(i, k, j) {
                        sums[i * count + j] = sum;
                        apexes[i * count + j] = Some(k);
                    }
                }
            }
        }
        apexes
    }

    /// Draws diagonals from the least knot to all vertices that it sees, and repeats in the remaining
    /// polygons.
    fn split_fan(&mut self) -> Result<()> {
        let mut pieces: Vec<Vec<usize>> = vec![(0..self.polygon.len()).collect()];
        while let Some(mut piece) = pieces.pop() {
            if let &[i, k, j] = &piece[..] {
                self.emit(i, k, j)?;
                continue;
            }
            let least = (0..piece.len()).min_by_key(|&at| self.polygon[piece[at]]).unwrap_or(0);
            piece.rotate_left(least);
            let seen: Vec<usize> = (1..piece.len()).filter(|&at| self.sees(piece[0], piece[at])).collect();
            if let &[first, last] = &seen[..] {
                // The least knot sees only its neighbours: it is the tip of an ear.
                let mut tip = [piece[last], piece[0], piece[first]];
                tip.sort_unstable();
                self.emit(tip[0], tip[1], tip[2])?;
                piece.remove(0);
                pieces.push(piece);
                continue;
            }
            for ends in seen.windows(2) {
                pieces.push([&piece[..1], &piece[ends[0]..=ends[1]]].concat());
            }
        }
        Ok(())
    }

    /// Cuts ears, starting from the first place.
    fn cut_ears(&mut self) -> Result<()> {
        let mut left: Vec<usize> = (0..self.polygon.len()).collect();
        while left.len() > 3 {
            let Some(at) = (0..left.len()).find(|&at| self.is_ear(&left, at)) else {
                return Err(self.failure("no ear can be cut from it"));
            };
            let [i, j, k] = around(&left, at);
            self.emit(i, j, k)?;
            left.remove(at);
        }
        self.emit(left[0], left[1], left[2])
    }

    /// Whether the triangle of a place and its neighbours has no other vertex inside or on it.
    fn is_ear(&mut self, left: &[usize], at: usize) -> bool {
        let corners = around(left, at);
        let [a, b, c] = corners.map(|place| self.polygon[place]);
        if !self.plane.is_left(a, b, c) {
            return false;
        }
        left.iter().filter(|place| !corners.contains(place)).all(|&place| {
            let v = self.polygon[place];
            [[a, b], [b, c], [c, a]].iter().any(|&[p, q]| self.plane.orient(p, q, v) == Sign::Negative)
        })
    }
}

/// A remaining place, between the remaining places before and after it.
fn around(left: &[usize], at: usize) -> [usize; 3] {
    let count = left.len();
    [left[(at + count - 1) % count], left[at], left[(at + 1) % count]]
}
