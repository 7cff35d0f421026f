//! A random sample of points that depends on the set of them alone.

use spmesh_base::random::Random;
use spmesh_stream::model::bounds::Point;

/// The points whose hashes are least.
///
/// Memory: 32 bytes for each of `most` points, twice while they come.
#[derive(Debug)]
pub(crate) struct Sample {
    /// Points that are kept at least, if there are so many.
    most: usize,
    /// Hashes from here on are too great.
    end: u64,
    kept: Vec<(u64, Point)>,
}

impl Sample {
    /// An empty sample that will have at least `most` points, if there are so many different ones.
    pub(crate) fn new(most: usize) -> Sample {
        Sample { most, end: u64::MAX, kept: Vec::new() }
    }

    /// Takes points of the set.
    pub(crate) fn add(&mut self, points: &[Point]) {
        for &point in points {
            // Adding zero turns -0.0 into 0.0, so that equal points have one hash.
            let point = point.map(|coordinate| coordinate + 0.0);
            let hash = hash(point);
            if hash < self.end {
                self.kept.push((hash, point));
                if self.kept.len() >= 2 * self.most.max(1) {
                    self.shrink();
                }
            }
        }
    }

    /// Leaves out equal points, and those of greater hashes.
    fn shrink(&mut self) {
        self.kept.sort_unstable_by(|(a, p), (b, q)| a.cmp(b).then_with(|| p.partial_cmp(q).expect("finite")));
        self.kept.dedup();
        if self.kept.len() > self.most {
            self.end = self.kept[self.most].0;
            self.kept.truncate(self.most);
        }
    }

    /// The `count` points of least hash, in the order of their hashes; all if there are fewer.
    pub(crate) fn take(mut self, count: usize) -> Vec<Point> {
        self.shrink();
        self.kept.truncate(count);
        self.kept.into_iter().map(|(_, point)| point).collect()
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
            sample.take(200)
        };
        let first = sampled(&points, 7);
        assert_eq!(first.len(), 200);
        let mut shuffled = [points.clone(), points.clone()].concat();
        random.shuffle(&mut shuffled);
        assert_eq!(sampled(&shuffled, 1_000), first);
        assert_eq!(sampled(&points[..10], 3).len(), 10);
    }
}
