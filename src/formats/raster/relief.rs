//! What the gradient of a surface says at a point: how steep it is, which way it faces, how bright it looks.

/// The angle with the horizontal, in degrees.
pub fn slope([p, q]: [f64; 2]) -> f64 {
    p.hypot(q).atan().to_degrees()
}

/// The direction of steepest descent, in degrees clockwise from north, from 0 to below 360; NaN where the
/// surface is level.
pub fn aspect([p, q]: [f64; 2]) -> f64 {
    if p == 0.0 && q == 0.0 {
        return f64::NAN;
    }
    let degrees = (-p).atan2(-q).to_degrees().rem_euclid(360.0);
    // 360 becomes 0, also where only rounding to f32 makes it 360.
    if degrees as f32 == 360.0 { 0.0 } else { degrees.abs() }
}

/// [`aspect()`], rounded as `gdaldem` does it: to f32, before and after the change to clockwise angles.
pub fn rounded_aspect([p, q]: [f64; 2]) -> f32 {
    if p == 0.0 && q == 0.0 {
        return f32::NAN;
    }
    let anticlockwise = (-q).atan2(-p).to_degrees() as f32;
    let clockwise = if anticlockwise > 90.0 { 450.0 - anticlockwise } else { 90.0 - anticlockwise };
    if clockwise == 360.0 { 0.0 } else { clockwise }
}

/// Parallel light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// The direction towards it, of length one: east, north, up.
    towards: [f64; 3],
}

impl Light {
    /// Light from an azimuth (clockwise from north) and an altitude above the horizon, both in degrees.
    pub fn from(azimuth: f64, altitude: f64) -> Light {
        let (azimuth, altitude) = (azimuth.to_radians(), altitude.to_radians());
        let along = altitude.cos();
        Light { towards: [azimuth.sin() * along, azimuth.cos() * along, altitude.sin()] }
    }

    /// Brightness of a matt (Lambertian) surface: from 0, where it faces away from the light, to 1, where
    /// it faces the light.
    pub fn shade(&self, [p, q]: [f64; 2]) -> f64 {
        let [east, north, up] = self.towards;
        let cosine = (up - p * east - q * north) / p.hypot(q).hypot(1.0);
        cosine.max(0.0)
    }
}

/// The light of a hillshade.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shading {
    /// From one direction.
    One(Light),
    /// From south-west, west, north-west and north at this altitude in degrees, with the weights of `gdaldem`: the
    /// squared cosine of the angle between the aspect and each azimuth (after Mark, "Multidirectional,
    /// oblique-weighted, shaded-relief image of the Island of Hawaii", USGS OFR 92-422, 1992, who has sines).
    Many(f64),
}

impl Shading {
    /// Brightness of a surface, from 0 to 1.
    pub fn shade(&self, [p, q]: [f64; 2]) -> f64 {
        let altitude = match self {
            Shading::One(light) => return light.shade([p, q]),
            Shading::Many(altitude) => altitude,
        };
        let steepness = p * p + q * q;
        if steepness == 0.0 {
            return altitude.to_radians().sin().max(0.0);
        }
        // The squared cosines of the angles between the aspect and each azimuth, times the squared steepness.
        let south_west = 0.5 * steepness + p * q;
        let weights = [south_west, p * p, steepness - south_west, q * q];
        let shades =
            [225.0, 270.0, 315.0, 360.0].map(|azimuth| Light::from(azimuth, *altitude).shade([p, q]));
        // The weights sum up to twice the steepness.
        0.5 * weights.iter().zip(shades).map(|(weight, shade)| weight * shade).sum::<f64>() / steepness
    }

    /// Brightness as a byte: from 1 to 255, since 0 stands for no data.
    pub fn byte(&self, gradient: [f64; 2]) -> u8 {
        let shade = self.shade(gradient);
        // A vertical wall, whose gradient overflows.
        if shade.is_nan() { 1 } else { (1.0 + 254.0 * shade).round() as u8 }
    }
}

/// How the gradient at the centre of a cell follows from it and its eight neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Differences {
    /// Weighted differences of the three pairs of neighbours along an axis (Horn, "Hill shading and the reflectance
    /// map", 1981): for rough terrain.
    Horn,
    /// The difference of the nearest pair (Zevenbergen and Thorne, "Quantitative analysis of land surface
    /// topography", 1987): for smooth terrain.
    ZevenbergenThorne,
}

/// Gradients from cells of some size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gradient {
    differences: Differences,
    /// What differences are divided by.
    length: f64,
}

impl Gradient {
    /// Gradients from cells with sides of `step`, in the unit of the values.
    pub fn new(differences: Differences, step: f64) -> Gradient {
        let steps = match differences {
            Differences::Horn => 8.0,
            Differences::ZevenbergenThorne => 2.0,
        };
        Gradient { differences, length: steps * step }
    }

    /// The gradient as [`Gradient::at`] has it, but with the order of sums that `gdaldem` has for light from one
    /// direction: opposite cells first.
    #[inline]
    pub fn of_pairs(&self, cells: &[f32; 9]) -> [f64; 2] {
        let [a, b, c, d, _, f, g, h, i] = cells;
        if self.differences == Differences::ZevenbergenThorne {
            return self.at(cells);
        }
        let (falling, rising, across, along) = (a - i, g - c, d - f, b - h);
        let (west, north) = (falling + across + across + rising, falling + along + along - rising);
        [-f64::from(west) / self.length, f64::from(north) / self.length]
    }

    /// The gradient to the east and to the north of a cell in the middle of three rows, the northern one first.
    /// Sums are those of `gdaldem`: in f32, from left to right.
    #[inline]
    pub fn at(&self, [a, b, c, d, _, f, g, h, i]: &[f32; 9]) -> [f64; 2] {
        let (east, north) = match self.differences {
            Differences::Horn => {
                (((c + f) + f + i) - ((a + d) + d + g), ((a + b) + b + c) - ((g + h) + h + i))
            }
            Differences::ZevenbergenThorne => (f - d, b - h),
        };
        [f64::from(east) / self.length, f64::from(north) / self.length]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surfaces_that_face_the_light_are_bright() {
        let light = Light::from(315.0, 45.0);
        // Falling to the north-west with 45 degrees.
        let steep = 0.5f64.sqrt();
        assert!((light.shade([steep, -steep]) - 1.0).abs() < 1e-12);
        assert!((light.shade([0.0, 0.0]) - steep).abs() < 1e-12);
        assert_eq!(light.shade([-2.0, 2.0]), 0.0);
        assert!((Light::from(90.0, 0.0).shade([-1.0, 0.0]) - steep).abs() < 1e-12);
    }

    #[test]
    fn planes_have_one_gradient_in_all_methods() {
        // Rising by 3 to the east and 2 to the south, in cells of 4.
        let cells: [f32; 9] = std::array::from_fn(|cell| 4.0 * (3 * (cell % 3) + 2 * (cell / 3)) as f32);
        for differences in [Differences::Horn, Differences::ZevenbergenThorne] {
            assert_eq!(Gradient::new(differences, 4.0).at(&cells), [3.0, -2.0]);
        }
    }

    #[test]
    fn aspects_are_clockwise_from_north() {
        for (gradient, expected) in [
            ([0.0, -1.0], 0.0),
            ([-1.0, 0.0], 90.0),
            ([0.0, 1.0], 180.0),
            ([1.0, 0.0], 270.0),
            ([1.0, -1.0], 315.0),
        ] {
            assert_eq!(rounded_aspect(gradient), expected, "{gradient:?}");
            assert_eq!(aspect(gradient), f64::from(expected), "{gradient:?}");
        }
        assert!(rounded_aspect([0.0, 0.0]).is_nan() && aspect([0.0, 0.0]).is_nan());
        assert_eq!(rounded_aspect([1e-30, -1.0]), 0.0);
    }

    #[test]
    fn light_from_many_sides_is_that_of_one_where_it_is_sideways_to_the_others() {
        let level = 0.5f64.sqrt();
        let many = Shading::Many(45.0);
        assert!((many.shade([0.0, 0.0]) - level).abs() < 1e-15);
        assert_eq!((many.byte([0.0, 0.0]), many.byte([f64::INFINITY; 2])), (181, 1));
        // Steepest to the east: west counts once, the diagonals a half each, north nothing.
        let gradient = [0.3, 0.0];
        let shade = |azimuth| Light::from(azimuth, 45.0).shade(gradient);
        let expected = 0.5 * (shade(270.0) + 0.5 * shade(225.0) + 0.5 * shade(315.0));
        assert!((many.shade(gradient) - expected).abs() < 1e-12);
    }
}
