//! A random sample of points that depends on the set of them alone, and when they come.

use spmesh_base::random::Random;
use spmesh_stream::model::bounds::Point;

/// The points whose hashes are least.
///
/// Memory: 40 bytes for each of `most` points, twice while they come.
#[derive(Debug)]
pub(crate) struct Sample {
    /// Points that are kept at least, if there are so many.
    most: usize,
    /// Hashes from here on are too great.
    end: u64,
    kept: Vec<Kept>,
    /// Points that have come.
    points: u64,
}

#[derive(Debug)]
struct Kept {
    hash: u64,
    point: Point,
    /// Points that have come before it; before the last of those that are equal.
    before: u64,
}

impl Sample {
    /// An empty sample that will have at least `most` points, if there are so many different ones.
    pub(crate) fn new(most: usize) -> Sample {
        Sample { most, end: u64::MAX, kept: Vec::new(), points: 0 }
    }

    /// An empty sample of the same size.
    pub(crate) fn again(self) -> Sample {
        Sample::new(self.most)
    }

    /// The number of different points, if the sample has all of them.
    pub(crate) fn distinct(&mut self) -> Option<u64> {
        self.shrink();
        (self.kept.len() < self.most).then_some(self.kept.len() as u64)
    }

    /// Takes points of the set.
    pub(crate) fn add(&mut self, points: &[Point]) {
        for (&point, before) in points.iter().zip(self.points..) {
            // Adding zero turns -0.0 into 0.0, so that equal points have one hash.
            let point = point.map(|coordinate| coordinate + 0.0);
            let hash = hash(point);
            if hash < self.end {
                self.kept.push(Kept { hash, point, before });
                if self.kept.len() >= 2 * self.most.max(1) {
                    self.shrink();
                }
            }
        }
        self.points += points.len() as u64;
    }

    /// Leaves out equal points, and those of greater hashes.
    fn shrink(&mut self) {
        self.kept.sort_unstable_by(|p, q| {
            let by_point = || p.point.partial_cmp(&q.point).expect("finite");
            p.hash.cmp(&q.hash).then_with(by_point).then(q.before.cmp(&p.before))
        });
        self.kept.dedup_by(|next, last| next.point == last.point);
        if self.kept.len() > self.most {
            self.end = self.kept[self.most].hash;
            self.kept.truncate(self.most);
        }
    }

    /// The `count` points of least hash, in the order of their hashes; all if there are fewer. Beside each,
    /// the part of all points that came before it.
    pub(crate) fn take(mut self, count: usize) -> (Vec<Point>, Vec<f64>) {
        self.shrink();
        self.kept.truncate(count);
        let (points, all) = (self.kept.iter().map(|kept| kept.point), self.points as f64);
        (points.collect(), self.kept.iter().map(|kept| kept.before as f64 / all).collect())
    }
}

fn hash(point: Point) -> u64 {
    point.iter().fold(0, |hash, coordinate| Random::new(hash ^ coordinate.to_bits()).bits())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_depend_on_the_set_alone() {
        let mut random = Random::new(3);
        let points: Vec<Point> = (0..5_000).map(|_| [0; 3].map(|_| random.below(40) as f64 - 20.0)).collect();
        let sampled = |points: &[Point], piece: usize| {
            let mut sample = Sample::new(300);
            points.chunks(piece).for_each(|points| sample.add(points));
            sample.take(200).0
        };
        let first = sampled(&points, 7);
        assert_eq!(first.len(), 200);
        let mut shuffled = [points.clone(), points.clone()].concat();
        random.shuffle(&mut shuffled);
        assert_eq!(sampled(&shuffled, 1_000), first);
        assert_eq!(sampled(&points[..10], 3).len(), 10);
    }

    #[test]
    fn the_last_of_equal_points_counts() {
        let points: Vec<Point> = [3.0, 1.0, 2.0, 1.0, 3.0].map(|x| [x, 0.0, 0.0]).to_vec();
        let mut sample = Sample::new(10);
        points.chunks(2).for_each(|points| sample.add(points));
        let (points, before) = sample.take(10);
        for (point, before) in points.iter().zip(before) {
            assert_eq!(before, [0.6, 0.4, 0.8][point[0] as usize - 1]);
        }
    }
}
