//! Sites of a grid, and where they are.

use super::too_many;
use crate::cells4::Point4;
use crate::error::{Error, Result};
use crate::limits::SITES4_MAX;

/// The sites of a grid, numbered as in volume files: along the first axis fastest.
#[derive(Debug, Clone)]
pub(super) struct Lattice {
    lens: [u64; 4],
    /// For each axis: which of x, y, z and t changes along it.
    coordinates: [usize; 4],
    frame: Frame,
}

/// Where indices are: at `mins + index * steps`, for x, y, z and t.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Frame {
    pub mins: [f64; 4],
    pub steps: [f64; 4],
}

impl Default for Frame {
    fn default() -> Self {
        Frame { mins: [0.0; 4], steps: [1.0; 4] }
    }
}

impl Lattice {
    /// A grid of so many sites along x, y, z and t.
    ///
    /// # Errors
    /// Usage, if there is none along an axis, or there are more than [`SITES4_MAX`].
    pub(super) fn new(lens: [u64; 4]) -> Result<Lattice> {
        Lattice::along(lens, [0, 1, 2, 3])
    }

    /// As [`Lattice::new`], where other coordinates change along the axes.
    pub(super) fn along(lens: [u64; 4], coordinates: [usize; 4]) -> Result<Lattice> {
        let [a, b, c, d] = lens;
        if lens.contains(&0) {
            return Err(Error::usage(format!("a grid of {a} x {b} x {c} x {d} has no sites")));
        }
        let sites = lens.iter().try_fold(1u64, |product, &len| product.checked_mul(len));
        match sites {
            Some(sites) if sites <= SITES4_MAX => {}
            Some(sites) => {
                return Err(too_many("sites", sites, SITES4_MAX, "take a part of the grid"));
            }
            None => {
                let message = format!("a grid of {a} x {b} x {c} x {d} has more than {SITES4_MAX} sites");
                return Err(Error::usage(message));
            }
        }
        Ok(Lattice { lens, coordinates, frame: Frame::default() })
    }

    /// Number of sites.
    pub(super) fn sites(&self) -> u64 {
        self.lens.iter().product()
    }

    /// Puts the sites elsewhere.
    pub(super) fn place(&mut self, frame: Frame) {
        self.frame = frame;
    }

    /// Where the site of this number is.
    pub(super) fn site(&self, mut number: u64) -> Point4 {
        let mut index = [0; 4];
        for (index, len) in index.iter_mut().zip(self.lens) {
            *index = number % len;
            number /= len;
        }
        self.point(index)
    }

    /// All sites in the order of their numbers.
    pub(super) fn iter(&self) -> impl Iterator<Item = Point4> {
        let mut index = [0; 4];
        (0..self.sites()).map(move |_| {
            let point = self.point(index);
            for (index, len) in index.iter_mut().zip(self.lens) {
                *index += 1;
                if *index < len {
                    break;
                }
                *index = 0;
            }
            point
        })
    }

    fn point(&self, index: [u64; 4]) -> Point4 {
        let Frame { mins, steps } = &self.frame;
        let mut point = [0.0; 4];
        for (index, coordinate) in index.into_iter().zip(self.coordinates) {
            // Adding 0 makes 0 of -0.
            point[coordinate] = mins[coordinate] + index as f64 * steps[coordinate] + 0.0;
        }
        point
    }

    /// Whether the coordinates of one of `points`, which are sites, are not exactly where its indices are.
    pub(super) fn rounds(&self, points: &[Point4]) -> bool {
        let Frame { mins, steps } = &self.frame;
        let is_rounded = |axis: usize, coordinate: f64| {
            let [min, step] = [mins[axis], steps[axis]];
            let index = ((coordinate - min) / step).round();
            let offset = index * step;
            // What is lost by the product, and by the sum (Knuth's two-sum).
            let sum = min + offset;
            let min_part = sum - offset;
            index.mul_add(step, -offset) != 0.0 || (min - min_part) + (offset - (sum - min_part)) != 0.0
        };
        points.iter().any(|point| (0..4).any(|axis| is_rounded(axis, point[axis])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sites_are_numbered_along_the_first_axis_fastest() {
        let lattice = Lattice::along([2, 3, 1, 2], [3, 0, 1, 2]).unwrap();
        let all: Vec<Point4> = lattice.iter().collect();
        assert_eq!(all.len(), 12);
        assert_eq!(all[..3], [[0.0; 4], [0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.0]]);
        assert_eq!(all[11], [2.0, 0.0, 1.0, 1.0]);
        assert!(all.iter().enumerate().all(|(number, &site)| lattice.site(number as u64) == site));
    }

    #[test]
    fn products_do_not_wrap() {
        assert_eq!(Lattice::new([1 << 10; 4]).unwrap().sites(), SITES4_MAX);
        for lens in
            [[1 << 32; 4], [u64::MAX, 1, 1, 1], [(1 << 40) + 1, 1, 1, 1], [0, 1, 1, 1], [u64::MAX, 0, 2, 2]]
        {
            assert!(Lattice::new(lens).is_err(), "{lens:?}");
        }
    }

    #[test]
    fn rounding_of_world_units_is_noticed() {
        let mut lattice = Lattice::new([5, 1, 1, 2]).unwrap();
        for (min, step, is_rounded) in [
            (32.0, -4.0, false),
            (0.5, 0.25, false),
            (0.0, 0.1, true),
            (1e17, 1.0, true),
            (-2.0, 1.0 / 3.0, true),
        ] {
            lattice.place(Frame { mins: [min, 0.0, 0.0, 0.0], steps: [step, 1.0, 1.0, 1.0] });
            let points: Vec<Point4> = lattice.iter().collect();
            assert_eq!(lattice.rounds(&points), is_rounded, "{min} {step}");
        }
    }
}
