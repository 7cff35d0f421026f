//! Units of lengths and angles.

use std::fmt;

use crate::crs::names::letters;

/// Two sizes of units are the same if they differ by less than this part. The closest kinds of feet differ by
/// eight parts in ten million; files state at least eight digits.
const TOLERANCE: f64 = 1e-7;

/// A unit of lengths, whose size is in metres, or of angles, whose size is in radians.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// Its name, as the EPSG dataset has it where the size is known.
    pub name: String,
    /// A short form for labels: m, ft, ftUS, °.
    pub symbol: String,
    /// Metres or radians.
    pub size: f64,
    /// Its EPSG code.
    pub code: Option<u16>,
}

/// EPSG code, name, symbol, size.
type Known = (u16, &'static str, &'static str, f64);

/// Units of lengths, in metres.
const LENGTHS: [Known; 10] = [
    (9001, "metre", "m", 1.),
    (9002, "foot", "ft", 0.3048),
    (9003, "US survey foot", "ftUS", 1200. / 3937.),
    (9036, "kilometre", "km", 1000.),
    (9005, "Clarke's foot", "ftCla", 0.304_797_265_4),
    (9094, "Gold Coast foot", "ftGC", 6_378_300. / 20_926_201.),
    (9084, "Indian yard", "ydInd", 0.914_398_553_970_127),
    (9040, "British yard (Sears 1922)", "ydSe", 36. / 39.370_147),
    (9041, "British foot (Sears 1922)", "ftSe", 12. / 39.370_147),
    (9042, "British chain (Sears 1922)", "chSe", 792. / 39.370_147),
];

/// Units of angles, in radians.
const ANGLES: [Known; 3] = [
    (9102, "degree", "°", std::f64::consts::PI / 180.),
    (9105, "grad", "gon", std::f64::consts::PI / 200.),
    (9101, "radian", "rad", 1.),
];

impl Unit {
    /// The metre.
    pub fn metre() -> Unit {
        Unit::known(&LENGTHS[0])
    }

    /// The degree.
    pub fn degree() -> Unit {
        Unit::known(&ANGLES[0])
    }

    /// The unit of lengths of `size` metres; `name` if it is none of the known ones.
    pub(crate) fn length(name: &str, size: f64) -> Unit {
        Unit::of_size(&LENGTHS, name, size)
    }

    /// The unit of angles of `size` radians.
    pub(crate) fn angle(name: &str, size: f64) -> Unit {
        Unit::of_size(&ANGLES, name, size)
    }

    /// The unit of an EPSG code.
    pub(crate) fn of_code(code: u16) -> Option<Unit> {
        // 9122 is a degree in any notation.
        let code = if code == 9122 { 9102 } else { code };
        LENGTHS.iter().chain(&ANGLES).find(|known| known.0 == code).map(Unit::known)
    }

    /// The unit of lengths of a name.
    pub(crate) fn of_name(name: &str) -> Option<Unit> {
        LENGTHS.iter().find(|known| letters(known.1) == letters(name)).map(Unit::known)
    }

    /// An angle in this unit, in degrees; degrees stay as they are.
    pub(crate) fn degrees(&self, angle: f64) -> f64 {
        if self.code == Some(9102) { angle } else { angle * self.size.to_degrees() }
    }

    /// The opposite of [`Unit::degrees`].
    pub(crate) fn of_degrees(&self, angle: f64) -> f64 {
        if self.code == Some(9102) { angle } else { angle / self.size.to_degrees() }
    }

    /// Whether both have the same size.
    pub fn is_same(&self, other: &Unit) -> bool {
        is_close(self.size, other.size)
    }

    fn of_size(known: &[Known], name: &str, size: f64) -> Unit {
        match known.iter().find(|known| is_close(known.3, size)) {
            Some(known) => Unit::known(known),
            None => Unit { name: name.to_string(), symbol: name.to_string(), size, code: None },
        }
    }

    fn known(&(code, name, symbol, size): &Known) -> Unit {
        Unit { name: name.to_string(), symbol: symbol.to_string(), size, code: Some(code) }
    }
}

fn is_close(a: f64, b: f64) -> bool {
    (a - b).abs() <= TOLERANCE * b.abs()
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn feet_are_told_apart() {
        let code = |size| Unit::length("foot", size).code;
        assert_eq!(code(0.3048), Some(9002));
        for survey in [0.304_800_609_601_219, 0.304_800_609_601_219_24, 0.304_800_609_6] {
            assert_eq!(code(survey), Some(9003));
        }
        assert_eq!((Unit::length("cubit", 0.45).name, code(0.45)), ("cubit".into(), None));
        assert_eq!(Unit::angle("Degree", 0.017_453_292_519_943_3), Unit::degree());
    }
}
