//! Sites of a grid, and their coordinates.

use crate::volumes::too_many;
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::SITES4_MAX;
use spmesh_stream::model::cells4::Point4;

/// The sites of a grid, numbered as in volume files: the index of the first axis changes fastest.
#[derive(Debug, Clone)]
pub(crate) struct Lattice {
    lens: [u64; 4],
    /// For each axis, the coordinate (x, y, z or t) that changes along it.
    coordinates: [usize; 4],
    frame: Frame,
}

/// Coordinates of indices: `mins + index * steps`, for x, y, z and t.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Frame {
    pub mins: [f64; 4],
    pub steps: [f64; 4],
}

impl Default for Frame {
    fn default() -> Self {
        Frame { mins: [0.0; 4], steps: [1.0; 4] }
    }
}

impl Lattice {
    /// A grid with `lens` sites along x, y, z and t.
    pub(crate) fn new(lens: [u64; 4]) -> Result<Lattice> {
        Lattice::along(lens, [0, 1, 2, 3])
    }

    /// As [`Lattice::new`], but `coordinates` names the coordinate that changes along each axis.
    pub(crate) fn along(lens: [u64; 4], coordinates: [usize; 4]) -> Result<Lattice> {
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
    pub(crate) fn sites(&self) -> u64 {
        self.lens.iter().product()
    }

    /// Sets the coordinates of the sites. Those that change along the axes of x, y and z become `spatial`.
    pub(crate) fn place(&mut self, spatial: [usize; 3], frame: Frame) -> Result<()> {
        self.frame = frame;
        self.coordinates = self.coordinates.map(|at| spatial.get(at).copied().unwrap_or(at));
        if self.largest().iter().all(|largest| largest.is_finite()) {
            return Ok(());
        }
        let Frame { mins, steps } = frame;
        Err(Error::usage(format!("sites {steps:?} apart, starting at {mins:?}, go beyond all numbers")))
    }

    /// The coordinates of the site with this number.
    pub(crate) fn site(&self, mut number: u64) -> Point4 {
        let mut index = [0; 4];
        for (index, len) in index.iter_mut().zip(self.lens) {
            *index = number % len;
            number /= len;
        }
        self.point(index)
    }

    /// All sites in the order of their numbers.
    pub(crate) fn iter(&self) -> impl Iterator<Item = Point4> {
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
            // Adding 0.0 turns -0.0 into 0.0.
            point[coordinate] = mins[coordinate] + index as f64 * steps[coordinate] + 0.0;
        }
        point
    }

    /// The greatest magnitude of each coordinate.
    fn largest(&self) -> [f64; 4] {
        let Frame { mins, steps } = &self.frame;
        let mut largest = [0.0; 4];
        for (len, at) in self.lens.into_iter().zip(self.coordinates) {
            largest[at] = mins[at].abs() + (len - 1) as f64 * steps[at].abs();
        }
        largest
    }

    /// Whether every coordinate is exactly `min + index * step`: both are multiples of a power of two, and no
    /// coordinate exceeds 2^53 times that power.
    pub(crate) fn is_exact(&self) -> bool {
        let Frame { mins, steps } = &self.frame;
        let largest = self.largest();
        (0..4).all(|at| largest[at] < lowest_bit(mins[at]).min(lowest_bit(steps[at])) * (1u64 << 53) as f64)
    }
}

/// The value of the lowest bit of a number; infinite for 0.
fn lowest_bit(number: f64) -> f64 {
    const FRACTION: u64 = (1 << 52) - 1;
    let bits = number.abs().to_bits();
    match (bits, bits & FRACTION) {
        (0, _) => f64::INFINITY,
        (_, 0) => number.abs(),
        _ => number.abs() - f64::from_bits(bits & (bits - 1)),
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
        let mut lattice = Lattice::along([2, 5, 1, 1], [3, 0, 1, 2]).unwrap();
        for (min, step, is_exact) in [
            (32.0, -4.0, true),
            (0.5, 0.25, true),
            (0.0, 0.1, false),
            (1e15, 1.0, true),
            (1e17, 1.0, false),
            (-2.0, 1.0 / 3.0, false),
            (0.0, f64::from_bits(1), true),
            (1.0, f64::from_bits(1), false),
        ] {
            let frame = Frame { mins: [min, 0.0, 0.0, 0.0], steps: [step, 1.0, 1.0, 1.0] };
            lattice.place([0, 1, 2], frame).unwrap();
            assert_eq!(lattice.is_exact(), is_exact, "{min} {step}");
        }
        let far = Frame { mins: [0.0; 4], steps: [1e308, 1.0, 1.0, 1.0] };
        assert!(lattice.place([0, 1, 2], far).unwrap_err().to_string().contains("beyond all numbers"));
    }
}
