//! Snap rounding by definition: all pairs of segments, all segments and all pixels, with fractions of big
//! integers.

use num_bigint::BigInt;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

/// A place of the grid.
pub type Place = [i64; 2];

/// A rational number; its denominator is positive.
#[derive(Clone, Debug)]
struct Fraction(BigInt, BigInt);

impl Fraction {
    fn new(numerator: BigInt, denominator: BigInt) -> Fraction {
        if denominator < BigInt::ZERO {
            Fraction(-numerator, -denominator)
        } else {
            Fraction(numerator, denominator)
        }
    }

    fn less(&self, other: &Fraction) -> bool {
        &self.0 * &other.1 < &other.0 * &self.1
    }

    /// a + (b - a) * self
    fn along(&self, a: i64, b: i64) -> Fraction {
        Fraction::new(BigInt::from(a) * &self.1 + BigInt::from(b - a) * &self.0, self.1.clone())
    }

    /// The integer nearest to it, the greater one of two.
    fn rounded(&self) -> i64 {
        let (numerator, denominator) = (&self.0 * 2 + &self.1, &self.1 * 2);
        let mut quotient = &numerator / &denominator;
        if &quotient * &denominator > numerator {
            quotient -= 1;
        }
        i64::try_from(quotient).expect("a small number")
    }
}

fn cross(a: Place, b: Place) -> BigInt {
    BigInt::from(a[0]) * b[1] - BigInt::from(a[1]) * b[0]
}

fn minus(a: Place, b: Place) -> Place {
    [a[0] - b[0], a[1] - b[1]]
}

/// The places that two segments have in common: none, one, or infinitely many, which are not returned.
fn common([a, b]: [Place; 2], [c, d]: [Place; 2]) -> Option<[Fraction; 2]> {
    let whole = cross(minus(b, a), minus(d, c));
    if whole == BigInt::ZERO {
        return None;
    }
    let (t, u) = (cross(minus(c, a), minus(d, c)), cross(minus(c, a), minus(b, a)));
    let (t, u) = (Fraction::new(t, whole.clone()), Fraction::new(u, whole));
    let (zero, one) = (Fraction::new(0.into(), 1.into()), Fraction::new(1.into(), 1.into()));
    if [&t, &u].iter().any(|part| part.less(&zero) || one.less(part)) {
        return None;
    }
    Some([t.along(a[0], b[0]), t.along(a[1], b[1])])
}

/// The least parameter at which a segment is in the half-open pixel, and whether it is there only behind
/// that; `None` if it is never there.
fn entry([a, b]: [Place; 2], centre: Place) -> Option<(Fraction, bool)> {
    // Lower bounds of the parameter, upper bounds, and whether these are included.
    let mut low = Fraction::new(0.into(), 1.into());
    let mut is_low_open = false;
    let mut high = Fraction::new(1.into(), 1.into());
    let mut is_high_open = false;
    for axis in 0..2 {
        let step = b[axis] - a[axis];
        // 2 centre - 1 <= 2 (a + step t) < 2 centre + 1
        let (min, max) = (2 * (centre[axis] - a[axis]) - 1, 2 * (centre[axis] - a[axis]) + 1);
        if step == 0 {
            if !(min <= 0 && 0 < max) {
                return None;
            }
            continue;
        }
        let at = |value: i64| Fraction::new(value.into(), (2 * step).into());
        let (first, last) = if step > 0 { (min, max) } else { (max, min) };
        // Going down, the open side is entered and the closed side left.
        let (first_open, last_open) = (step < 0, step > 0);
        let (first, last) = (at(first), at(last));
        if low.less(&first) {
            (low, is_low_open) = (first, first_open);
        } else if !first.less(&low) {
            is_low_open |= first_open;
        }
        if last.less(&high) {
            (high, is_high_open) = (last, last_open);
        } else if !high.less(&last) {
            is_high_open |= last_open;
        }
    }
    let is_met = low.less(&high) || (!high.less(&low) && !is_low_open && !is_high_open);
    is_met.then_some((low, is_low_open))
}

/// The vertices and segments that snap rounding makes of polylines: segments with their lesser end first, and
/// the least number of a polyline that they are part of.
pub fn snap_round(lines: &[Vec<Place>]) -> (BTreeSet<Place>, BTreeMap<[Place; 2], usize>) {
    let parts: Vec<(usize, [Place; 2])> = lines
        .iter()
        .enumerate()
        .flat_map(|(number, line)| line.windows(2).map(move |part| (number, [part[0], part[1]])))
        .filter(|(_, part)| part[0] != part[1])
        .collect();
    let mut hot: BTreeSet<Place> = lines.iter().flatten().copied().collect();
    for (index, (_, part)) in parts.iter().enumerate() {
        for (_, other) in &parts[..index] {
            hot.extend(common(*part, *other).map(|place| place.map(|value| value.rounded())));
        }
    }
    let mut segments = BTreeMap::new();
    for &(number, part) in &parts {
        let mut passed: Vec<((Fraction, bool), Place)> =
            hot.iter().filter_map(|&pixel| Some((entry(part, pixel)?, pixel))).collect();
        passed.sort_by(|(a, _), (b, _)| match (a.0.less(&b.0), b.0.less(&a.0)) {
            (true, _) => Ordering::Less,
            (_, true) => Ordering::Greater,
            _ => a.1.cmp(&b.1),
        });
        assert_eq!([passed[0].1, passed[passed.len() - 1].1], part, "a part starts and ends at its vertices");
        for ends in passed.windows(2) {
            let (a, b) = (ends[0].1, ends[1].1);
            let least = segments.entry([a.min(b), a.max(b)]).or_insert(number);
            *least = number.min(*least);
        }
    }
    (hot, segments)
}

/// Whether two different segments have nothing in common but ends of both.
pub fn are_noded(one: [Place; 2], other: [Place; 2]) -> bool {
    let shared = one.iter().filter(|end| other.contains(end)).count();
    if cross(minus(one[1], one[0]), minus(other[1], other[0])) != BigInt::ZERO {
        return match common(one, other) {
            None => true,
            Some(place) => {
                let is = |end: &Place| (0..2).all(|axis| &place[axis].1 * end[axis] == place[axis].0);
                one.iter().any(is) && other.iter().any(is)
            }
        };
    }
    if cross(minus(one[1], one[0]), minus(other[0], one[0])) != BigInt::ZERO {
        return true;
    }
    // On one straight line: disjoint, or one after the other.
    let ([a, b], [c, d]) = (one.map(|e| e), other.map(|e| e));
    let ([a, b], [c, d]) = ([a.min(b), a.max(b)], [c.min(d), c.max(d)]);
    shared < 2 && (b <= c || d <= a)
}
