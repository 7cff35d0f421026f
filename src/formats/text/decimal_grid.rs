//! The coarsest grid that holds several grids, exactly: scales and offsets stand for their shortest decimals.

use spmesh_stream::model::bounds::Point;

/// A decimal: digits * 10^exponent.
#[derive(Debug, Clone, Copy)]
struct Exact {
    digits: i128,
    exponent: i32,
}

impl Exact {
    /// The shortest decimal that reads back as `value`, which is finite.
    fn of(value: f64) -> Option<Exact> {
        let text = format!("{value:e}");
        let (mantissa, exponent) = text.split_once('e')?;
        let decimals = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        let digits = mantissa.replace('.', "").parse().ok()?;
        let exponent = exponent.parse::<i32>().ok()? - i32::try_from(decimals).ok()?;
        Some(Exact { digits, exponent })
    }

    /// The number of units of 10^exponent; `None` if they are too many.
    fn units(self, exponent: i32) -> Option<i128> {
        let power = u32::try_from(self.exponent - exponent).ok()?;
        10i128.checked_pow(power)?.checked_mul(self.digits)
    }

    /// The nearest f64.
    fn value(self) -> Option<f64> {
        format!("{}e{}", self.digits, self.exponent).parse().ok()
    }
}

/// The scales of the coarsest grid that holds all points of `grids` (scales and offsets) and whose first `dims`
/// axes have one scale; `None` if numbers are of too different sizes.
pub(crate) fn common_scales(grids: &[(Point, Point)], dims: u8) -> Option<Point> {
    let geometry = usize::from(dims).min(3);
    let mut scales = [common_scale(grids, 0..geometry)?; 3];
    for (axis, scale) in scales.iter_mut().enumerate().skip(geometry) {
        *scale = common_scale(grids, axis..axis + 1)?;
    }
    Some(scales)
}

/// The greatest length of which all scales on these axes are multiples, and all differences of offsets on each.
fn common_scale(grids: &[(Point, Point)], axes: std::ops::Range<usize>) -> Option<f64> {
    let decimals = |numbers: fn(&(Point, Point)) -> &Point| -> Option<Vec<Exact>> {
        let numbers = grids.iter().flat_map(|grid| numbers(grid)[axes.clone()].iter());
        numbers.map(|&number| Exact::of(number)).collect()
    };
    let (scales, offsets) = (decimals(|grid| &grid.0)?, decimals(|grid| &grid.1)?);
    // A zero has no least digit.
    let exponents = scales.iter().chain(&offsets).filter(|number| number.digits != 0);
    let exponent = exponents.map(|number| number.exponent).min()?;
    let units = |number: &Exact| if number.digits == 0 { Some(0) } else { number.units(exponent) };
    let mut common = 0;
    for scale in &scales {
        common = greatest_divisor(common, units(scale)?);
    }
    for (number, offset) in offsets.iter().enumerate() {
        let first = &offsets[number % axes.len()];
        common = greatest_divisor(common, units(offset)?.checked_sub(units(first)?)?);
    }
    Exact { digits: common, exponent }.value()
}

fn greatest_divisor(mut a: i128, mut b: i128) -> i128 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a.abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grids_meet_exactly() {
        let grid = |scale, offset| ([scale; 3], [offset; 3]);
        let common = |grids: &[_]| common_scales(grids, 2).map(|scales| scales[0]);
        assert_eq!(common(&[grid(0.01, 0.0), grid(0.01, 0.005)]), Some(0.005));
        assert_eq!(common(&[grid(0.01, -3.3), grid(0.025, 4_000_000.0)]), Some(0.005));
        assert_eq!(common(&[grid(1e-7, 0.1), grid(1.0, 0.1)]), Some(1e-7));
        assert_eq!(common(&[grid(100.0, 0.0), grid(250.0, 1e6)]), Some(50.0));
        assert_eq!(common(&[grid(1e-200, 0.0), grid(1.0, 1.0)]), None);
        let uneven = [([0.01, 0.02, 0.5], [0.0, 0.005, 0.0]), ([0.01, 0.02, 0.2], [0.0, 0.015, 0.0])];
        assert_eq!(common_scales(&uneven, 2), Some([0.01, 0.01, 0.1]));
        assert_eq!(common_scales(&uneven, 3), Some([0.01; 3]));
    }
}
