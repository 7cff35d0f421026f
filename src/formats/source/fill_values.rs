//! Fill values: numbers that many programs write where an elevation is not known.
//!
//! A point may well be at -9999. So such a number counts only if it is far from all other elevations: farther
//! than half of their spread, and than a tenth of itself. Of a survey between 0 and 3,000 m, -9999 does.

use std::fmt;

use spmesh_stream::Coordinates;

/// Whole numbers that stand for no data: of rasters, and the least ones of 16 bits.
const WHOLE: [f64; 5] = [-9999.0, -99999.0, -999999.0, -32767.0, -32768.0];

/// Great ones, of either sign, which files write with few digits: round ones, those of netCDF and Surfer, and
/// the greatest f32 and f64.
const GREAT: [f64; 6] = [1e20, 1e30, 9.969_21e36, 1.701_41e38, 3.402_82e38, 1.797_69e308];

/// Elevations between these are no fill values.
const ORDINARY: [f64; 2] = [-9998.9, 0.99e20];

/// How far from others a fill value is, as a part of itself.
const PART: f64 = 0.1;

/// How many numbers are known: great ones have two signs.
const KNOWN: usize = WHOLE.len() + 2 * GREAT.len();

/// Counts the fill values among elevations, which come in any order.
#[derive(Debug, Clone, Default)]
pub struct FillValues {
    /// Of each known number: as it was found first, and how often.
    found: [(f64, u64); KNOWN],
    /// The range of all other elevations.
    others: Option<[f64; 2]>,
}

impl FillValues {
    /// Counts elevations, in world units, of which `range` is the range.
    pub fn add(&mut self, range: [f64; 2], elevations: impl Iterator<Item = f64>) {
        if range[0] > ORDINARY[0] && range[1] < ORDINARY[1] {
            return self.widen(range);
        }
        for z in elevations {
            match known(z) {
                Some(known) => {
                    let (value, count) = &mut self.found[known];
                    *value = if *count == 0 { z } else { *value };
                    *count += 1;
                }
                None => self.widen([z, z]),
            }
        }
    }

    /// Counts the stored elevations of points, of which `min` and `max` are the bounds.
    pub fn add_stored(
        &mut self,
        coordinates: &Coordinates,
        bounds: [f64; 2],
        stored: impl Iterator<Item = f64>,
    ) {
        let world = |z: f64| coordinates.to_world([0.0, 0.0, z])[2];
        self.add(bounds.map(world), stored.map(world));
    }

    fn widen(&mut self, [min, max]: [f64; 2]) {
        self.others = Some(self.others.map_or([min, max], |[low, high]| [low.min(min), high.max(max)]));
    }

    /// The fill values, and how often each was found.
    fn far(&self) -> impl Iterator<Item = (f64, u64)> {
        self.found.iter().copied().filter(|&(value, count)| count > 0 && self.is_far(value))
    }

    fn is_far(&self, value: f64) -> bool {
        let Some([min, max]) = self.others else { return true };
        let gap = (min - value).max(value - max);
        gap > (max - min) / 2.0 && gap > PART * value.abs()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.far().next().is_none()
    }
}

impl FillValues {
    /// The fill values.
    pub fn values(&self) -> Vec<f64> {
        self.far().map(|(value, _)| value).collect()
    }

    /// How many points have each of them, and how far they are from others.
    pub fn finding(&self) -> String {
        let counts = self.far().map(|(value, count)| {
            let points = if count == 1 { "point has" } else { "points have" };
            // Debug writes great numbers with an exponent.
            format!("{count} {points} z = {}", format!("{value:?}").trim_end_matches(".0"))
        });
        let counts = counts.collect::<Vec<String>>().join(", ");
        match self.others {
            Some([min, max]) => format!("{counts}, far from all others ({min} to {max})"),
            None => format!("{counts}, and none another one"),
        }
    }
}

/// Says how many there are, and how to drop them.
impl fmt::Display for FillValues {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let finding = self.finding();
        match self.others {
            Some([min, max]) => write!(
                f,
                "{finding}: if that stands for no value, drop them, as with spfinalize --keep-z {min},{max}"
            ),
            None => write!(f, "{finding}: that often stands for no value"),
        }
    }
}

/// Which of the known numbers it is, wherever others are.
fn known(z: f64) -> Option<usize> {
    if z > ORDINARY[0] && z < ORDINARY[1] {
        return None;
    }
    let near = |known: f64, part: f64| (z - known).abs() <= part * known.abs();
    // Stored in steps, whole numbers are rounded.
    let whole = WHOLE.iter().position(|&known| near(known, 1e-9));
    let great = || GREAT.iter().flat_map(|&known| [known, -known]).position(|known| near(known, 1e-3));
    whole.or_else(|| Some(WHOLE.len() + great()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(elevations: &[f64]) -> Option<String> {
        let mut values = FillValues::default();
        for part in elevations.chunks(3) {
            let of = |pick: fn(f64, f64) -> f64| part.iter().copied().reduce(pick).unwrap();
            values.add([of(f64::min), of(f64::max)], part.iter().copied());
        }
        (!values.is_empty()).then(|| values.to_string())
    }

    #[test]
    fn fill_values_are_far_from_others() {
        for value in [-9999.0, -32768.0, -32767.0, 1e30, -1e30, 9.97e36, 9.969_209_968_386_869e36, 1.7e38] {
            for value in [value, if value > 1e37 { 3.402_823_5e38 } else { value }] {
                let message = found(&[100.5, value, 3000.0, value, 12.0]).unwrap();
                assert!(
                    message.starts_with("2 points have z = ") && message.contains("--keep-z 12,3000"),
                    "{message}"
                );
            }
        }
        assert!(found(&[1.0, -9999.0]).unwrap().starts_with("1 point has z = -9999, far"));
        assert!(
            found(&[1.0, 2.0, -9999.0, 1e30])
                .unwrap()
                .starts_with("1 point has z = -9999, 1 point has z = 1e30,")
        );
        assert!(found(&[-9999.0, -9999.0]).is_some());
    }

    #[test]
    fn ordinary_elevations_are_none() {
        for elevations in [
            &[-9999.0, -9998.0, -9990.0][..],
            &[-9999.0, -10500.0, 8000.0],
            &[-9999.0, -6000.0, 4000.0],
            &[-9998.0, 1.0, 2.0],
            &[1e30, 1.5e30, 0.7e30],
            &[1e29, 1.0, 2.0],
            &[0.0, 1.0, 9999.5],
            &[],
        ] {
            assert_eq!(found(elevations), None, "{elevations:?}");
        }
    }
}
