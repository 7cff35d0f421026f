//! Points in nested boxes, to find those that a circle may contain.

use super::disk::Disk;
use crate::exact::plane::Xy;

/// Most points of a box without boxes inside.
const LEAF: usize = 16;

/// A balanced tree of boxes. Each box is the bounding box of a range of points; its two children have the
/// halves of the range.
pub(super) struct Tree {
    ids: Vec<u32>,
    /// Least and greatest coordinates of each box. Box `i` has the children 2 i + 1 and 2 i + 2.
    boxes: Vec<[Xy; 2]>,
}

impl Tree {
    pub(super) fn of(points: &[Xy]) -> Tree {
        let mut ids: Vec<u32> = (0..points.len() as u32).collect();
        let mut boxes = Vec::new();
        build(points, &mut ids, 0, &mut boxes);
        Tree { ids, boxes }
    }

    /// Calls `take` with all points that a disk may contain, and possibly others, until it returns false.
    pub(super) fn for_each_in(&self, disk: &Disk, mut take: impl FnMut(u32) -> bool) {
        let mut waiting = vec![(0, 0..self.ids.len())];
        while let Some((node, range)) = waiting.pop() {
            if range.is_empty() || !disk.may_meet(self.boxes[node]) {
                continue;
            }
            if range.len() > LEAF {
                let middle = range.start.midpoint(range.end);
                waiting.extend([(2 * node + 1, range.start..middle), (2 * node + 2, middle..range.end)]);
            } else if !self.ids[range].iter().all(|&id| take(id)) {
                return;
            }
        }
    }
}

/// Sorts ids so that each range is split at its median along the longer side of its box, and finds the boxes.
fn build(points: &[Xy], ids: &mut [u32], node: usize, boxes: &mut Vec<[Xy; 2]>) {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for &id in ids.iter() {
        for axis in 0..2 {
            low[axis] = low[axis].min(points[id as usize][axis]);
            high[axis] = high[axis].max(points[id as usize][axis]);
        }
    }
    if boxes.len() <= node {
        boxes.resize(node + 1, [[0.0; 2]; 2]);
    }
    boxes[node] = [low, high];
    if ids.len() > LEAF {
        let axis = usize::from(high[1] - low[1] > high[0] - low[0]);
        let middle = ids.len() / 2;
        ids.select_nth_unstable_by(middle, |&a, &b| {
            points[a as usize][axis].total_cmp(&points[b as usize][axis]).then(a.cmp(&b))
        });
        let (left, right) = ids.split_at_mut(middle);
        build(points, left, 2 * node + 1, boxes);
        build(points, right, 2 * node + 2, boxes);
    }
}
