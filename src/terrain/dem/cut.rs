//! Cuts triangles at the sides of cells.

use spmesh_base::error::Result;
use spmesh_stream::model::bounds::Point;

/// Most corners of a triangle that is cut four times.
const CORNERS_MAX: usize = 7;

/// A convex polygon with elevations, in the coordinates of cells.
#[derive(Debug, Clone, Copy)]
pub(super) struct Polygon {
    corners: [Point; CORNERS_MAX],
    count: usize,
}

impl Polygon {
    #[cfg(test)]
    fn of([a, b, c]: [Point; 3]) -> Polygon {
        let none = [0.0; 3];
        Polygon { corners: [a, b, c, none, none, none, none], count: 3 }
    }

    /// Its corners.
    fn corners(&self) -> &[Point] {
        &self.corners[..self.count]
    }

    /// Its area, and the mean of its elevations.
    pub(super) fn integral(&self) -> (f64, f64) {
        let Some((first, others)) = self.corners().split_first() else { return (0.0, 0.0) };
        let (mut area, mut sum) = (0.0, 0.0);
        for pair in others.windows(2) {
            let [p, q] = [0, 1].map(|at| [0, 1, 2].map(|axis| pair[at][axis] - first[axis]));
            let twice = (p[0] * q[1] - p[1] * q[0]).abs();
            area += twice;
            sum += twice * (p[2] + q[2]);
        }
        (0.5 * area, if area > 0.0 { first[2] + sum / (3.0 * area) } else { first[2] })
    }

    /// Makes `parts` those below and above a place on an axis. A side that lies there belongs to both.
    #[inline]
    fn cut<const AXIS: usize>(&self, at: f64, [below, above]: [&mut Polygon; 2]) {
        below.count = 0;
        above.count = 0;
        let corners = self.corners();
        let Some(mut corner) = corners.last() else { return };
        for next in corners {
            let [here, there] = [corner[AXIS] - at, next[AXIS] - at];
            if here < 0.0 && there > 0.0 || here > 0.0 && there < 0.0 {
                let share = here / (here - there);
                let crossing = [0, 1, 2].map(|axis| {
                    if axis == AXIS { at } else { corner[axis] + share * (next[axis] - corner[axis]) }
                });
                below.push(crossing);
                above.push(crossing);
            }
            if there <= 0.0 {
                below.push(*next);
            }
            if there >= 0.0 {
                above.push(*next);
            }
            corner = next;
        }
    }

    #[inline]
    fn push(&mut self, corner: Point) {
        // Rounding may add corners that a convex polygon would not have: they are nearly on another one.
        if self.count < CORNERS_MAX {
            self.corners[self.count] = corner;
            self.count += 1;
        }
    }

    /// The least and the greatest coordinate along an axis.
    #[inline]
    pub(super) fn range<const AXIS: usize>(&self) -> [f64; 2] {
        self.corners().iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], corner| {
            let place = corner[AXIS];
            [if place < low { place } else { low }, if place > high { place } else { high }]
        })
    }
}

/// Cuts triangles at the sides of cells. It holds polygons, so that none is copied as a whole.
#[derive(Debug)]
pub(super) struct Cutter {
    triangle: Polygon,
    rows: Strips,
    columns: Strips,
}

/// The polygon that is cut into strips: two copies that take turns, and the strip that was cut off.
#[derive(Debug)]
struct Strips {
    rests: [Polygon; 2],
    strip: Polygon,
}

const NOTHING: Polygon = Polygon { corners: [[0.0; 3]; CORNERS_MAX], count: 0 };

impl Cutter {
    pub(super) fn new() -> Cutter {
        let strips = || Strips { rests: [NOTHING; 2], strip: NOTHING };
        Cutter { triangle: NOTHING, rows: strips(), columns: strips() }
    }

    /// Calls `part` with the part of a triangle in each cell that it meets, of a raster of `size` columns and
    /// rows.
    pub(super) fn cells_of(
        &mut self,
        corners: [Point; 3],
        size: [u32; 2],
        mut part: impl FnMut([usize; 2], &Polygon) -> Result<()>,
    ) -> Result<()> {
        let Cutter { triangle, rows, columns } = self;
        triangle.corners[..3].copy_from_slice(&corners);
        triangle.count = 3;
        rows.each::<1>(triangle, size[1], |row, strip| {
            columns.each::<0>(strip, size[0], |column, cell| part([column, row], cell))
        })
    }
}

impl Strips {
    /// Calls `part` with the part of a polygon between each pair of neighbouring integers on an axis, from 0
    /// to `end`.
    #[inline]
    fn each<const AXIS: usize>(
        &mut self,
        polygon: &Polygon,
        end: u32,
        mut part: impl FnMut(usize, &Polygon) -> Result<()>,
    ) -> Result<()> {
        let [low, high] = polygon.range::<AXIS>();
        if !(high > 0.0 && low < f64::from(end)) {
            return Ok(());
        }
        let first = low.max(0.0) as usize;
        // Where triangles are smaller than cells, most are in one row and one column.
        if low >= 0.0 && high <= (first + 1) as f64 {
            return part(first, polygon);
        }
        let [mut rest, mut beyond] = self.rests.each_mut();
        let strip = &mut self.strip;
        let next = if low < 0.0 {
            polygon.cut::<AXIS>(0.0, [strip, rest]);
            first
        } else {
            polygon.cut::<AXIS>((first + 1) as f64, [strip, rest]);
            part(first, strip)?;
            first + 1
        };
        for number in next..end as usize {
            let side = (number + 1) as f64;
            if high <= side {
                return part(number, rest);
            }
            rest.cut::<AXIS>(side, [strip, beyond]);
            part(number, strip)?;
            (rest, beyond) = (beyond, rest);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_add_up_to_the_triangle() {
        for corners in [
            [[0.5, 0.25, 1.0], [7.75, 2.5, 5.0], [3.0, 6.0, -2.0]],
            [[0.0, 0.0, 0.0], [4.0, 0.0, 1.0], [0.0, 4.0, 2.0]],
            [[1.25, 1.5, 3.0], [1.5, 1.25, 3.0], [1.75, 1.75, 3.0]],
            [[-3.0, 2.0, 1.0], [2.5, -4.0, 0.0], [9.5, 9.5, 7.0]],
        ] {
            let whole = Polygon::of(corners);
            let (mut area, mut sum) = (0.0, 0.0);
            Cutter::new()
                .cells_of(corners, [8, 8], |[column, row], part| {
                    let ((size, mean), place) = (part.integral(), [column as f64, row as f64]);
                    for (axis, side) in place.into_iter().enumerate() {
                        let [low, high] = if axis == 0 { part.range::<0>() } else { part.range::<1>() };
                        assert!(low >= side && high <= side + 1.0, "{column} {row}");
                    }
                    area += size;
                    sum += size * mean;
                    Ok(())
                })
                .unwrap();
            let [mut right, mut lower, mut left, mut inside, mut outside] = [NOTHING; 5];
            whole.cut::<0>(0.0, [&mut outside, &mut right]);
            right.cut::<1>(0.0, [&mut outside, &mut lower]);
            lower.cut::<0>(8.0, [&mut left, &mut outside]);
            left.cut::<1>(8.0, [&mut inside, &mut outside]);
            let (expected, mean) = inside.integral();
            assert!((area - expected).abs() < 1e-12 * expected, "{area} {expected}");
            assert!((sum - expected * mean).abs() < 1e-11 * expected, "{sum}");
        }
    }
}
