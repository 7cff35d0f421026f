//! Exact arithmetic of snap rounding, on coordinates of at most [`COORDINATE_MAX`].
//!
//! Differences of coordinates are below 2^44 when doubled, so cross products of two of them are below 2^89
//! and fit i128. The place of a crossing is a quotient of products below 2^132, which do not fit:
//! [`crossing_pixel`] divides in two steps of 22 bits.

use std::cmp::Ordering;

/// A place of the grid; also the centre of a pixel.
pub(super) type Place = [i64; 2];

/// Greatest magnitude of a coordinate.
pub const COORDINATE_MAX: i64 = 1 << 42;

/// The cross product of two vectors.
pub(super) fn cross(a: Place, b: Place) -> i128 {
    i128::from(a[0]) * i128::from(b[1]) - i128::from(a[1]) * i128::from(b[0])
}

pub(super) fn minus(a: Place, b: Place) -> Place {
    [a[0] - b[0], a[1] - b[1]]
}

/// On which side of the line from `a` to `b` the place `c` is: positive on the left.
fn side(a: Place, b: Place, c: Place) -> i128 {
    cross(minus(b, a), minus(c, a))
}

/// The pixel in which two segments cross, if a place inside of both is common to them and they are not
/// parallel.
///
/// The pixel of a real place is the one with the centre `floor(place + 1/2)`, per axis.
pub(super) fn crossing_pixel([a, b]: [Place; 2], [c, d]: [Place; 2]) -> Option<Place> {
    let (left, right) = (side(a, b, c), side(a, b, d));
    if left.signum() * right.signum() != -1 || side(c, d, a).signum() * side(c, d, b).signum() != -1 {
        return None;
    }
    // The place is c + (d - c) * part / whole.
    let (part, whole) = if left < 0 { (-left, right - left) } else { (left, left - right) };
    let along = minus(d, c);
    Some([0, 1].map(|axis| c[axis] + rounded(along[axis], part, whole)))
}

/// `floor(step * part / whole + 1/2)`, for 0 <= part <= whole < 2^88 and |step| < 2^44.
fn rounded(step: i64, part: i128, whole: i128) -> i64 {
    const LOW: u32 = 22;
    let (high, low) = (i128::from(step >> LOW), i128::from(step & ((1 << LOW) - 1)));
    let (twice, divisor) = (2 * part, 2 * whole);
    // step * twice = (high << LOW + low) * twice; each product below is less than 2^112.
    let (quotient, rest) = (high * twice).div_rem_floor(divisor);
    let low_quotient = ((rest << LOW) + low * twice + whole).div_euclid(divisor);
    ((quotient << LOW) + low_quotient) as i64
}

/// Division with a remainder that is not negative.
trait DivRemFloor: Sized {
    fn div_rem_floor(self, divisor: Self) -> (Self, Self);
}

impl DivRemFloor for i128 {
    fn div_rem_floor(self, divisor: i128) -> (i128, i128) {
        let quotient = self.div_euclid(divisor);
        (quotient, self - quotient * divisor)
    }
}

/// Whether a segment, ends included, has a place in the pixel with this centre: the half-open square from
/// centre - 1/2 to centre + 1/2 on both axes. `a` must be lexicographically below `b`.
pub(super) fn meets_pixel([a, b]: [Place; 2], centre: Place) -> bool {
    // Everything is doubled, which makes the sides of the pixel integers.
    let double = |place: Place| place.map(|value| 2 * value);
    let (a, b, centre) = (double(a), double(b), double(centre));
    let (min, max) = (centre.map(|value| value - 1), centre.map(|value| value + 1));
    let (low, high) = (a[1].min(b[1]), a[1].max(b[1]));
    if b[0] < min[0] || a[0] >= max[0] || high < min[1] || low >= max[1] {
        return false;
    }
    let along = minus(b, a);
    if along[0] == 0 || along[1] == 0 {
        return true;
    }
    // The part of the segment in the column of the pixel is from `first` to `last`, where it has left the
    // column if it does not end there. `height` compares the line with a place: above is greater.
    let (first, last) = (a[0].max(min[0]), b[0].min(max[0]));
    let height = |x: i64, y: i64| cross(along, [a[0] - x, a[1] - y]).signum().cmp(&0);
    if along[1] > 0 {
        let reached = height(last, min[1]);
        height(first, max[1]) == Ordering::Less
            && (reached == Ordering::Greater || (reached == Ordering::Equal && b[0] < max[0]))
    } else {
        height(first, min[1]) != Ordering::Less && height(last, max[1]) == Ordering::Less
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_divides_exactly_where_products_do_not_fit() {
        let most = 2 * COORDINATE_MAX;
        let whole = (i128::from(most) * i128::from(most)) * 2 - 1;
        assert_eq!(rounded(most, whole, whole), most);
        assert_eq!(rounded(-most, whole, whole), -most);
        assert_eq!(rounded(most, 0, whole), 0);
        // Just below and at one half.
        assert_eq!(rounded(1, whole / 2, whole), 0);
        assert_eq!(rounded(1, whole / 2 + 1, whole), 1);
        assert_eq!((rounded(1, 1, 2), rounded(-1, 1, 2), rounded(3, 1, 2), rounded(-3, 1, 2)), (1, 0, 2, -1));
    }

    #[test]
    fn pixels_are_half_open() {
        let meets = |a, b, centre| meets_pixel([a, b], centre);
        // The diagonal passes through the lower left corner of [1, 1] and the upper right one of [0, 0].
        assert!(meets([0, 0], [1, 1], [1, 1]) && meets([0, 0], [1, 1], [0, 0]));
        assert!(!meets([0, 0], [1, 1], [1, 0]) && !meets([0, 0], [1, 1], [0, 1]));
        // The falling one passes through the corner at 1/2, 1/2, which belongs to [1, 1] alone.
        assert!(meets([0, 1], [1, 0], [1, 1]) && !meets([0, 1], [1, 0], [0, 0]));
        // Sides: y = 1/2 belongs to the upper row, x = 1/2 to the right column.
        assert!(meets([0, 0], [4, 1], [2, 1]) && !meets([0, 0], [4, 1], [3, 0]));
        assert!(meets([0, 0], [4, 1], [2, 0]));
        assert!(meets([0, 0], [1, 4], [1, 2]) && meets([0, 0], [1, 4], [0, 2]));
        assert!(!meets([0, 4], [1, 0], [2, 2]));
    }
}
