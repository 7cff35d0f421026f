//! What the gradient of a surface says at a point: how steep it is, which way it faces, how bright it looks.

/// The angle with the horizontal, in degrees.
#[must_use]
pub fn slope([p, q]: [f64; 2]) -> f64 {
    p.hypot(q).atan().to_degrees()
}

/// The direction of steepest descent, in degrees clockwise from north, from 0 to below 360; NaN where the
/// surface is level.
#[must_use]
pub fn aspect([p, q]: [f64; 2]) -> f64 {
    if p == 0.0 && q == 0.0 {
        return f64::NAN;
    }
    let degrees = (-p).atan2(-q).to_degrees().rem_euclid(360.0);
    // 360 becomes 0, also where only rounding to f32 makes it 360.
    if degrees as f32 == 360.0 { 0.0 } else { degrees.abs() }
}

/// Parallel light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// The direction towards it, of length one: east, north, up.
    towards: [f64; 3],
}

impl Light {
    /// Light from an azimuth (clockwise from north) and an altitude above the horizon, both in degrees.
    #[must_use]
    pub fn from(azimuth: f64, altitude: f64) -> Light {
        let (azimuth, altitude) = (azimuth.to_radians(), altitude.to_radians());
        let along = altitude.cos();
        Light { towards: [azimuth.sin() * along, azimuth.cos() * along, altitude.sin()] }
    }

    /// Brightness of a matt (Lambertian) surface: from 0, where it faces away from the light, to 255, where
    /// it faces the light.
    #[must_use]
    pub fn shade(&self, [p, q]: [f64; 2]) -> f64 {
        let [east, north, up] = self.towards;
        let cosine = (up - p * east - q * north) / p.hypot(q).hypot(1.0);
        255.0 * cosine.max(0.0)
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
        assert!((light.shade([steep, -steep]) - 255.0).abs() < 1e-12);
        assert!((light.shade([0.0, 0.0]) - 255.0 * steep).abs() < 1e-12);
        assert_eq!(light.shade([-2.0, 2.0]), 0.0);
        assert!((Light::from(90.0, 0.0).shade([-1.0, 0.0]) - 255.0 * steep).abs() < 1e-12);
    }
}
