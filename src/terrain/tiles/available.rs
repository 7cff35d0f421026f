//! Which tiles there are, as rectangles.

use serde_json::{Value, json};

use super::scheme::Tile;

/// A rectangle of tiles, all of which are there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Rectangle {
    pub(super) min: [u32; 2],
    pub(super) max: [u32; 2],
}

impl Rectangle {
    fn to_json(self) -> Value {
        let ([x0, y0], [x1, y1]) = (self.min, self.max);
        json!({"startX": x0, "startY": y0, "endX": x1, "endY": y1})
    }

    /// What is below a tile, which is `levels` levels higher.
    fn below(&self, tile: Tile, levels: u32) -> Option<Rectangle> {
        let side = 1u64 << levels;
        let [x, y] = [tile.x, tile.y].map(|at| [u64::from(at) * side, (u64::from(at) + 1) * side - 1]);
        let part = |axis: usize, [first, last]: [u64; 2]| {
            let (min, max) = (u64::from(self.min[axis]).max(first), u64::from(self.max[axis]).min(last));
            (min <= max).then_some([min as u32, max as u32])
        };
        let ([x0, x1], [y0, y1]) = (part(0, x)?, part(1, y)?);
        Some(Rectangle { min: [x0, y0], max: [x1, y1] })
    }
}

/// Rectangles that cover tiles, which are in the order of rows: runs in rows, joined where they are the same
/// in rows one above the other.
pub(super) fn rectangles(tiles: impl Iterator<Item = Tile>) -> Vec<Rectangle> {
    let mut done: Vec<Rectangle> = Vec::new();
    // Where the rectangles start that the row before, and this row, have grown.
    let (mut before, mut row) = (Vec::new(), Vec::<Rectangle>::new());
    let close = |before: &mut Vec<Rectangle>, row: &mut Vec<Rectangle>, done: &mut Vec<Rectangle>| {
        for run in row.iter_mut() {
            let same = |old: &Rectangle| {
                (old.min[0], old.max[0], old.max[1] + 1) == (run.min[0], run.max[0], run.max[1])
            };
            if let Some(number) = before.iter().position(same) {
                run.min[1] = before.swap_remove(number).min[1];
            }
        }
        done.append(before);
        before.append(row);
    };
    for Tile { x, y } in tiles {
        match row.last_mut() {
            Some(run) if run.max == [x.wrapping_sub(1), y] => run.max[0] = x,
            last => {
                if last.is_some_and(|run| run.max[1] != y) {
                    close(&mut before, &mut row, &mut done);
                }
                row.push(Rectangle { min: [x, y], max: [x, y] });
            }
        }
    }
    close(&mut before, &mut row, &mut done);
    done.append(&mut before);
    done.sort_unstable_by_key(|rectangle| [rectangle.min[1], rectangle.min[0]]);
    done
}

/// The rectangles of levels.
pub(super) fn of_levels(levels: &[Vec<Rectangle>]) -> Value {
    let of_level =
        |level: &Vec<Rectangle>| level.iter().map(|rectangle| rectangle.to_json()).collect::<Vec<_>>();
    json!(levels.iter().map(of_level).collect::<Vec<_>>())
}

/// The rectangles of `levels`, the first of which is that below a tile, as far as they are below it.
pub(super) fn below(tile: Tile, levels: &[Vec<Rectangle>]) -> Value {
    let of_level = |(number, level): (u32, &Vec<Rectangle>)| {
        level.iter().filter_map(|rectangle| rectangle.below(tile, number)).collect()
    };
    of_levels(&(1..).zip(levels).map(of_level).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangles_cover_each_tile_once() {
        let mut state = 5u64;
        for most in 0..40 {
            let mut tiles: Vec<Tile> = (0..most)
                .map(|_| {
                    state =
                        state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    Tile { x: (state >> 60) as u32 % 6, y: (state >> 50) as u32 % 6 }
                })
                .collect();
            tiles.sort_unstable();
            tiles.dedup();
            let mut found = Vec::new();
            for Rectangle { min, max } in rectangles(tiles.iter().copied()) {
                found.extend((min[1]..=max[1]).flat_map(|y| (min[0]..=max[0]).map(move |x| Tile { x, y })));
            }
            found.sort_unstable();
            assert_eq!(found, tiles);
        }
        let block = (0..4).flat_map(|y| (2..5).map(move |x| Tile { x, y }));
        assert_eq!(rectangles(block), [Rectangle { min: [2, 0], max: [4, 3] }]);
    }

    #[test]
    fn what_is_below_a_tile_is_clipped_to_it() {
        let all = vec![Rectangle { min: [0, 0], max: [9, 9] }];
        let clipped = Rectangle { min: [4, 8], max: [5, 9] };
        assert_eq!(below(Tile { x: 2, y: 4 }, &[all]), of_levels(&[vec![clipped]]));
    }
}
