//! The canonical form of a line, which does not depend on the order of its pieces.

use spmesh_delaunay::predicates::Point2;

/// Merges successive equal points, and rotates a ring to its lexicographically least sequence, which starts
/// at the least point by x, then y. Returns whether more than one point is left.
pub(super) fn tidy(points: &mut Vec<Point2>, is_closed: bool) -> bool {
    points.dedup();
    if is_closed {
        while points.len() > 1 && points.first() == points.last() {
            points.pop();
        }
        let start = least_rotation(points);
        points.rotate_left(start);
    }
    points.len() > 1
}

/// The start at which a cyclic sequence is lexicographically least.
///
/// Two starts are compared point by point. If they agree in `equal` points and the next point of one is
/// greater, then neither that start nor any of the `equal` starts after it is the least. So the cost is
/// linear.
fn least_rotation(points: &[Point2]) -> usize {
    let count = points.len();
    let (mut a, mut b, mut equal) = (0, 1, 0);
    while a < count && b < count && equal < count {
        let [of_a, of_b] = [a, b].map(|start| points[(start + equal) % count]);
        if of_a == of_b {
            equal += 1;
            continue;
        }
        let passed = if of_a > of_b { &mut a } else { &mut b };
        *passed += equal + 1;
        if a == b {
            b += 1;
        }
        equal = 0;
    }
    a.min(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_start_at_the_least_of_all_rotations() {
        // All sequences of up to seven points among three.
        for count in 1..=7u32 {
            for code in 0..3usize.pow(count) {
                let points: Vec<Point2> =
                    (0..count).map(|i| [(code / 3usize.pow(i) % 3) as f64, -1.0]).collect();
                let rotation = |start: usize| [&points[start..], &points[..start]].concat();
                let least = (0..points.len()).map(rotation).min_by(|a, b| a.partial_cmp(b).unwrap()).unwrap();
                assert_eq!(rotation(least_rotation(&points)), least);
            }
        }
    }

    #[test]
    fn equal_neighbours_are_one_point() {
        let point = |x: u8| [f64::from(x), 0.0];
        let of = |text: &[u8], is_closed| {
            let mut points: Vec<Point2> = text.iter().map(|&x| point(x)).collect();
            let is_line = tidy(&mut points, is_closed);
            (points.into_iter().map(|[x, _]| x as u8).collect::<Vec<u8>>(), is_line)
        };
        assert_eq!(of(&[3, 3, 1, 1, 3], false), (vec![3, 1, 3], true));
        assert_eq!(of(&[3, 3, 2, 5, 2, 1, 3, 3], true), (vec![1, 3, 2, 5, 2], true));
        assert_eq!(of(&[3, 3, 3], true), (vec![3], false));
        assert_eq!(of(&[3, 3], false), (vec![3], false));
    }
}
