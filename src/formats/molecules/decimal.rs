//! Decimal numbers as written, and the quantum of which all coordinates of an input are multiples.

use crate::molecules::model::Model;
use spmesh_stream::Coordinates;
use spmesh_stream::model::points::Point3;

/// Greatest number of digits of a number kept as an integer: every integer of 15 digits is exact in f64.
const DIGITS_MAX: usize = 15;

/// The powers of ten needed here. All are exact in f64.
const POWERS: [f64; DIGITS_MAX + 1] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];

/// Greatest number of decimal places of a quantum; a finer quantum leaves no room for a molecule in 32 bits.
const PLACES_MAX: usize = 9;

/// Decimal places of coordinates in most structures: 0.001 Å.
const PLACES_USUAL: usize = 3;

/// The quanta by their decimal places.
const QUANTA: [f64; PLACES_MAX + 1] = [1e0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9];

/// A number in a text.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Number {
    /// `digits / 10^places`; `digits` is an integer of at most 15 digits.
    Decimal { digits: f64, places: usize },
    /// The f64 nearest to a number with an exponent or with more digits.
    Float(f64),
}

impl Number {
    /// The number that `field` denotes, without surrounding blanks; `None` if it is not a finite number.
    pub(crate) fn parse(field: &[u8]) -> Option<Number> {
        let digits = match field.split_first()? {
            (b'-' | b'+', rest) => rest,
            _ => field,
        };
        let (mut value, mut count, mut point) = (0u64, 0, None);
        for (at, &byte) in digits.iter().enumerate() {
            match byte {
                b'0'..=b'9' if count < DIGITS_MAX => {
                    value = value * 10 + u64::from(byte - b'0');
                    count += 1;
                }
                b'.' if point.is_none() => point = Some(at),
                _ => return Number::parse_float(field),
            }
        }
        if count == 0 {
            return None;
        }
        let places = point.map_or(0, |at| digits.len() - 1 - at);
        // An integer zero has no sign: -0.000 becomes 0.000.
        let digits = if field[0] == b'-' && value != 0 { -(value as f64) } else { value as f64 };
        Some(Number::Decimal { digits, places })
    }

    #[cold]
    fn parse_float(field: &[u8]) -> Option<Number> {
        let number: f64 = std::str::from_utf8(field).ok()?.parse().ok()?;
        number.is_finite().then_some(Number::Float(number))
    }

    /// Ten times the number, such as a length in Å that is stated in nm.
    pub(crate) fn tenfold(self) -> Number {
        match self {
            Number::Decimal { digits, places: places @ 1.. } => {
                Number::Decimal { digits, places: places - 1 }
            }
            whole => Number::Float(10.0 * whole.value()),
        }
    }

    /// The f64 nearest to the number: the quotient of two exact numbers is rounded once.
    pub(crate) fn value(self) -> f64 {
        match self {
            Number::Decimal { digits, places } => digits / POWERS[places],
            Number::Float(value) => value,
        }
    }
}

/// How coordinates are stored while an input is read: as multiples of a quantum as long as one fits all of
/// them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Quantum {
    /// Integer multiples of the power of ten with this number of decimal places.
    Places(usize),
    /// No quantum: the numbers themselves, as f64.
    None,
}

impl Default for Quantum {
    fn default() -> Self {
        Quantum::Places(PLACES_USUAL)
    }
}

impl Quantum {
    /// The stored form of a point. If the quantum has to change, converts all points in `models`.
    #[inline]
    pub(crate) fn store(&mut self, place: [Number; 3], models: &mut [Model]) -> Point3 {
        let Quantum::Places(places) = *self else { return place.map(Number::value) };
        let mut stored = [0.0; 3];
        for (stored, number) in stored.iter_mut().zip(place) {
            match number {
                Number::Decimal { digits, places: own } if own == places && fits(digits) => *stored = digits,
                _ => return self.store_unusual(places, place, models),
            }
        }
        stored
    }

    #[cold]
    fn store_unusual(&mut self, places: usize, place: [Number; 3], models: &mut [Model]) -> Point3 {
        *self = Quantum::for_all(places, place, models);
        match *self {
            Quantum::Places(finer) => {
                if finer > places {
                    change(models, |value| value * POWERS[finer - places]);
                }
                place.map(|number| multiple(number, finer).expect("the quantum serves the place"))
            }
            Quantum::None => {
                change(models, |value| value / POWERS[places]);
                place.map(Number::value)
            }
        }
    }

    /// The coarsest quantum, with at least `places` decimal places, that fits `place` and all points stored
    /// with `places`.
    fn for_all(places: usize, place: [Number; 3], models: &[Model]) -> Quantum {
        let Some(finer) = (places..=PLACES_MAX)
            .find(|&finer| place.iter().all(|&number| multiple(number, finer).is_some()))
        else {
            return Quantum::None;
        };
        let factor = POWERS[finer - places];
        let stored = models.iter().flat_map(|model| model.points.as_flattened());
        if finer == places || stored.into_iter().all(|value| fits(value * factor)) {
            Quantum::Places(finer)
        } else {
            Quantum::None
        }
    }

    /// The encoding of stored coordinates.
    pub(crate) fn coordinates(self) -> Coordinates {
        match self {
            Quantum::Places(places) => Coordinates::I32 { scale: [QUANTA[places]; 3], offset: [0.0; 3] },
            Quantum::None => Coordinates::F64,
        }
    }
}

/// The number in units of a quantum, if that is a 32-bit integer.
fn multiple(number: Number, places: usize) -> Option<f64> {
    let Number::Decimal { digits, places: own } = number else { return None };
    let multiple = if own <= places {
        digits * POWERS[places - own]
    } else {
        // Both are exact, so the quotient is an integer if and only if the remainder is 0.
        let divisor = POWERS[own - places];
        (digits % divisor == 0.0).then_some(digits / divisor)?
    };
    fits(multiple).then_some(multiple)
}

fn fits(value: f64) -> bool {
    value.abs() <= f64::from(i32::MAX)
}

fn change(models: &mut [Model], change: impl Fn(f64) -> f64) {
    let values = models.iter_mut().flat_map(|model| model.points.as_flattened_mut());
    values.for_each(|value| *value = change(*value));
}
