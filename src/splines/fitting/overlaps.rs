//! All pairs of boxes that overlap.

use spmesh_delaunay::predicates::Point2;

/// Up to this number of boxes, all pairs are compared.
const FEW: usize = 16;
/// A cut is rejected if a half would keep more than this part of the boxes.
const SHARE_MAX: f64 = 0.8;

/// A box from lower left to upper right.
pub(super) type Rectangle = [Point2; 2];

/// Calls `visit` once for each pair of different boxes that have a point in common, with the lesser number
/// first.
///
/// The plane is halved at medians recursively. The part that contains the lower left corner of the
/// intersection reports the pair. Cost: O(n log n), plus the number of pairs.
pub(super) fn for_each_pair(boxes: &[Rectangle], visit: &mut impl FnMut(u32, u32)) {
    let all: Vec<u32> = (0..boxes.len() as u32).collect();
    Search { boxes, visit }.search(all, [[f64::NEG_INFINITY; 2], [f64::INFINITY; 2]]);
}

struct Search<'a, V> {
    boxes: &'a [Rectangle],
    visit: &'a mut V,
}

impl<V: FnMut(u32, u32)> Search<'_, V> {
    fn search(&mut self, some: Vec<u32>, part: Rectangle) {
        if some.len() > FEW
            && let Some((axis, cut, [below, above])) = self.halves(&some, part)
        {
            drop(some);
            let ([mut upper, mut lower], [from, to]) = ([part[1], part[0]], part);
            (upper[axis], lower[axis]) = (cut, cut);
            self.search(below, [from, upper]);
            self.search(above, [lower, to]);
            return;
        }
        for (place, &first) in some.iter().enumerate() {
            for &second in &some[place + 1..] {
                let (a, b) = (self.boxes[first as usize], self.boxes[second as usize]);
                let corner = [0, 1].map(|axis| a[0][axis].max(b[0][axis]));
                let is_common = (0..2).all(|axis| corner[axis] <= a[1][axis].min(b[1][axis]));
                let is_here =
                    (0..2).all(|axis| part[0][axis] <= corner[axis] && corner[axis] < part[1][axis]);
                if is_common && is_here {
                    (self.visit)(first, second);
                }
            }
        }
    }

    /// The better of two cuts; `None` if both are rejected.
    fn halves(&self, some: &[u32], part: Rectangle) -> Option<(usize, f64, [Vec<u32>; 2])> {
        let greatest = (SHARE_MAX * some.len() as f64) as usize;
        let halved = |axis: usize| {
            let mut middles: Vec<f64> = some
                .iter()
                .map(|&at| {
                    let [lower, upper] = self.boxes[at as usize];
                    lower[axis].max(part[0][axis]).midpoint(upper[axis].min(part[1][axis]))
                })
                .collect();
            let half = middles.len() / 2;
            let cut = *middles.select_nth_unstable_by(half, f64::total_cmp).1;
            let among = |is_in: &dyn Fn(Rectangle) -> bool| -> Vec<u32> {
                some.iter().copied().filter(|&at| is_in(self.boxes[at as usize])).collect()
            };
            (axis, cut, [among(&|[lower, _]| lower[axis] < cut), among(&|[_, upper]| upper[axis] >= cut)])
        };
        let is_useful =
            |(_, _, halves): &(usize, f64, [Vec<u32>; 2])| halves.iter().all(|half| half.len() <= greatest);
        let both = [0, 1].map(halved).into_iter().filter(is_useful);
        both.min_by_key(|(_, _, halves)| halves[0].len() + halves[1].len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_base::random::Random;

    #[test]
    fn every_pair_is_found_once() {
        let mut random = Random::new(3);
        let mut whole = |end| random.below(end) as f64;
        let mut boxes: Vec<Rectangle> = (0..400)
            .map(|_| {
                let corner = [whole(60), whole(60)];
                [corner, [corner[0] + whole(6), corner[1] + whole(6)]]
            })
            .collect();
        boxes.extend([[[0.0; 2], [60.0; 2]], [[5.0; 2], [5.0; 2]], [[5.0; 2], [5.0; 2]]]);
        let mut found = Vec::new();
        for_each_pair(&boxes, &mut |a, b| found.push((a, b)));
        found.sort_unstable();
        let overlap = |a: usize, b: usize| {
            (0..2).all(|axis| {
                boxes[a][0][axis].max(boxes[b][0][axis]) <= boxes[a][1][axis].min(boxes[b][1][axis])
            })
        };
        let all = (0..boxes.len()).flat_map(|a| (a + 1..boxes.len()).map(move |b| (a, b)));
        let expected: Vec<(u32, u32)> =
            all.filter(|&(a, b)| overlap(a, b)).map(|(a, b)| (a as u32, b as u32)).collect();
        assert_eq!(found, expected);
    }
}
