//! Sections of a river by two banks: pairs of opposite vertices.
//!
//! Sections follow each other downstream without crossing: from one to the next, one bank advances by one
//! vertex. It is the bank for which the next section is shorter. So a bay of one bank shifts sections up to
//! about twice its depth below it. If places at the same share of both lengths were opposite, it would shift
//! all of them.

use std::ops::Range;

use super::stations::{Station, Stations};
use spmesh_stream::model::points::Point2;

/// Sections from the first vertices of both banks to the last ones, as numbers of vertices of the left and
/// the right bank.
pub(crate) struct Sections(Vec<[usize; 2]>);

impl Sections {
    /// The left bank comes first if both next sections have the same length.
    pub(crate) fn new([left, right]: [&[Point2]; 2]) -> Sections {
        let square = |[a, b]: [usize; 2]| {
            let [u, v] = [0, 1].map(|axis| left[a][axis] - right[b][axis]);
            u * u + v * v
        };
        let mut sections = vec![[0, 0]];
        let mut last = [0, 0];
        while last != [left.len() - 1, right.len() - 1] {
            let next = [[last[0] + 1, last[1]], [last[0], last[1] + 1]];
            let by_left =
                last[1] + 1 == right.len() || last[0] + 1 < left.len() && square(next[0]) <= square(next[1]);
            last = if by_left { next[0] } else { next[1] };
            sections.push(last);
        }
        Sections(sections)
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        self.0.iter().copied()
    }

    /// The sections of a vertex of a bank: 0 is left.
    fn of(&self, bank: usize, vertex: usize) -> Range<usize> {
        let first = self.0.partition_point(|section| section[bank] < vertex);
        first..first + self.0[first..].partition_point(|section| section[bank] == vertex)
    }

    /// The stations of the vertices of a bank, where the middles of all sections are the line of `stations`:
    /// the nearest place on it among the sections of the vertices opposite, and one more at each side; never
    /// above that of the vertex before. The ends of a bank are at the ends of the line.
    pub(crate) fn stations(&self, bank: usize, places: &[Point2], stations: &Stations) -> Vec<Station> {
        let last = self.0.len() - 1;
        let mut found = vec![Station::START];
        for (vertex, &place) in places.iter().enumerate().skip(1) {
            let own = self.of(bank, vertex);
            let opposite = [own.start, own.end - 1].map(|section| self.0[section][1 - bank]);
            let [first, end] = opposite.map(|vertex| self.of(1 - bank, vertex));
            let parts = first.start.saturating_sub(1)..end.end.min(last);
            found.push(stations.nearest_of(parts, place).max(found[vertex - 1]));
        }
        found[places.len() - 1] = Station::end(last - 1);
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn along(x: &[f64], y: f64) -> Vec<Point2> {
        x.iter().map(|&x| [x, y]).collect()
    }

    #[test]
    fn vertices_of_parallel_banks_are_level_across() {
        let dense: Vec<f64> = (0..=40).map(|x| f64::from(x) * 2.5).collect();
        for sparse in [&[0.0, 100.0][..], &[0.0, 10.0, 55.0, 60.0, 100.0], &dense] {
            let banks = [along(&dense, 7.0), along(sparse, 3.0)];
            let sections = Sections::new([&banks[0], &banks[1]]);
            let middles = sections.iter().map(|[a, b]| {
                let ([x, y], [u, v]) = (banks[0][a], banks[1][b]);
                [(x + u) / 2.0, (y + v) / 2.0]
            });
            let middles: Vec<Point2> = middles.collect();
            assert!(middles.is_sorted(), "{sparse:?}");
            let mut stations = Stations::new(middles);
            // Elevations fall as x grows.
            let known: Vec<_> = stations.places().iter().map(|[x, _]| Some(-x)).collect();
            assert_eq!(stations.settle(&known), Some(0));
            for (number, bank) in banks.iter().enumerate() {
                for (station, [x, _]) in sections.stations(number, bank, &stations).into_iter().zip(bank) {
                    let z = stations.elevation(station);
                    assert!((z + x).abs() < 1e-12, "{sparse:?}: {z} at {x}");
                }
            }
        }
    }

    #[test]
    fn a_bay_shifts_sections_near_it_alone() {
        let depth = 50.0;
        let all: Vec<f64> = (0..=60).map(|x| f64::from(x) * 5.0).collect();
        let mut left = along(&all[..=20], 5.0);
        left.extend((1..=10).map(|y| [100.0, 5.0 + 5.0 * f64::from(y)]));
        left.extend((0..=10).rev().map(|y| [110.0, 5.0 + 5.0 * f64::from(y)]));
        left.extend(along(&all[23..], 5.0));
        let right = along(&all, 0.0);
        let sections = Sections::new([&left, &right]);
        let far = sections.iter().filter(|&[a, b]| (left[a][0] - right[b][0]).abs() > 5.0);
        let far: Vec<f64> = far.map(|[a, _]| left[a][0]).collect();
        assert!(far.iter().all(|x| (100.0..=110.0 + 2.0 * depth).contains(x)), "{far:?}");
    }
}
