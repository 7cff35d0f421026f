//! Points in a tree, to find those in a box.

/// Points of D dimensions, sorted so that the median of each range along one axis after the other is in its
/// middle, behind the points below it and before those above.
pub(super) struct PointTree<const D: usize> {
    /// Positions, with the numbers of the points.
    points: Vec<([f64; D], u32)>,
}

/// Ranges of this many points are not divided.
const LEAF: usize = 8;

impl<const D: usize> PointTree<D> {
    /// Sorts points, which are numbered in their order.
    ///
    /// Domain: fewer than 2^32 points, with finite coordinates.
    pub(super) fn new(points: impl Iterator<Item = [f64; D]>) -> Self {
        let mut points: Vec<([f64; D], u32)> = points.zip(0..).collect();
        divide(&mut points, 0);
        PointTree { points }
    }

    /// Calls `visit` with position and number of each point in the closed box from `low` to `high`, until it
    /// fails.
    pub(super) fn in_box<E>(
        &self,
        low: [f64; D],
        high: [f64; D],
        mut visit: impl FnMut([f64; D], u32) -> Result<(), E>,
    ) -> Result<(), E> {
        search(&self.points, 0, &low, &high, &mut visit)
    }
}

fn divide<const D: usize>(points: &mut [([f64; D], u32)], axis: usize) {
    if points.len() <= LEAF {
        return;
    }
    let middle = points.len() / 2;
    points.select_nth_unstable_by(middle, |(p, _), (q, _)| p[axis].total_cmp(&q[axis]));
    divide(&mut points[..middle], (axis + 1) % D);
    divide(&mut points[middle + 1..], (axis + 1) % D);
}

fn search<const D: usize, E>(
    points: &[([f64; D], u32)],
    axis: usize,
    low: &[f64; D],
    high: &[f64; D],
    visit: &mut impl FnMut([f64; D], u32) -> Result<(), E>,
) -> Result<(), E> {
    let is_inside = |at: &[f64; D]| (0..D).all(|axis| low[axis] <= at[axis] && at[axis] <= high[axis]);
    let mut visit_inside = |points: &[([f64; D], u32)]| {
        points.iter().filter(|(at, _)| is_inside(at)).try_for_each(|&(at, number)| visit(at, number))
    };
    if points.len() <= LEAF {
        return visit_inside(points);
    }
    let middle = points.len() / 2;
    visit_inside(&points[middle..=middle])?;
    let border = points[middle].0[axis];
    if low[axis] <= border {
        search(&points[..middle], (axis + 1) % D, low, high, visit)?;
    }
    if border <= high[axis] {
        search(&points[middle + 1..], (axis + 1) % D, low, high, visit)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_find_the_points_on_their_sides_and_no_others() {
        let points: Vec<[f64; 2]> =
            (0..500).map(|i| [f64::from(i * 37 % 23), f64::from(i * i % 19)]).collect();
        let tree = PointTree::new(points.iter().copied());
        for case in 0..200 {
            let low = [f64::from(case % 23), f64::from(case % 7)];
            let high = [low[0] + f64::from(case % 5), low[1] + f64::from(case % 11)];
            let mut found = Vec::new();
            tree.in_box(low, high, |at, number| {
                assert_eq!(points[number as usize], at);
                found.push(number);
                Ok::<(), ()>(())
            })
            .unwrap();
            found.sort_unstable();
            let is_inside =
                |at: &[f64; 2]| (0..2).all(|axis| low[axis] <= at[axis] && at[axis] <= high[axis]);
            let expected: Vec<u32> =
                (0..).zip(&points).filter(|(_, at)| is_inside(at)).map(|(number, _)| number).collect();
            assert_eq!(found, expected, "{low:?} {high:?}");
        }
    }
}
