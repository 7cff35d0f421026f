//! Colour maps that are perceptually uniform and ordered by lightness.

use crate::raster::Light;

/// Red, green and blue.
pub type Colour = [u8; 3];

/// Colours at equal steps from the least value to the greatest.
#[derive(Debug, PartialEq)]
pub struct ColourMap(&'static [Colour]);

/// For time and order (viridis, CC0).
pub const VIRIDIS: ColourMap = ColourMap(&[
    [68, 1, 84],
    [71, 45, 123],
    [59, 82, 139],
    [44, 114, 142],
    [33, 145, 140],
    [40, 174, 128],
    [94, 201, 98],
    [173, 220, 48],
    [253, 231, 37],
]);

/// For elevations (batlow of Crameri, "Scientific colour maps", MIT).
pub const BATLOW: ColourMap = ColourMap(&[
    [1, 25, 89],
    [16, 63, 96],
    [28, 90, 98],
    [60, 109, 86],
    [104, 123, 62],
    [157, 137, 43],
    [210, 147, 67],
    [248, 161, 123],
    [253, 183, 188],
    [250, 204, 250],
]);

/// Diverging, for values below and above a middle (vik of Crameri, MIT).
pub const VIK: ColourMap = ColourMap(&[
    [0, 18, 97],
    [2, 63, 125],
    [30, 111, 157],
    [113, 168, 196],
    [201, 221, 231],
    [236, 229, 224],
    [234, 206, 189],
    [211, 151, 116],
    [190, 101, 51],
    [139, 39, 6],
    [89, 0, 8],
]);

impl ColourMap {
    /// The colour at a position from 0 to 1; positions beyond have the colours of the ends.
    pub fn at(&self, part: f64) -> Colour {
        let steps = self.0.len() - 1;
        // NaN has the first colour.
        let part = if part > 0.0 { part.min(1.0) } else { 0.0 };
        let place = part * steps as f64;
        let first = (place as usize).min(steps - 1);
        mix(self.0[first], self.0[first + 1], place - first as f64)
    }
}

/// The colour `part` of the way between two colours.
pub fn mix(from: Colour, to: Colour, part: f64) -> Colour {
    [0, 1, 2].map(|channel| {
        let [from, to] = [from, to].map(|colour| f64::from(colour[channel]));
        (from + part * (to - from)).round() as u8
    })
}

/// A colour as SVG writes it.
pub fn hex([r, g, b]: Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Grey of some brightness, from 0 to 1.
pub fn grey(shade: f64) -> Colour {
    [(255.0 * shade).round() as u8; 3]
}

/// A colour in light: level ground, of brightness `level`, keeps it; other surfaces darken or brighten it.
pub fn lit(colour: Colour, shade: f64, level: f64) -> Colour {
    /// The part of a colour that remains in the dark.
    const AMBIENT: f64 = 0.45;
    if shade <= level {
        mix([0; 3], colour, AMBIENT + (1.0 - AMBIENT) * shade / level)
    } else {
        mix(colour, [255; 3], 0.6 * (shade - level) / (1.0 - level))
    }
}

/// The brightness of a surface, from 0 to 1.
pub fn shade(light: &Light, gradient: [f64; 2]) -> f64 {
    let shade = light.shade(gradient);
    // A vertical wall, whose gradient overflows.
    if shade.is_nan() { 0.0 } else { shade }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// CIE lightness, from 0 to 100.
    fn lightness(colour: Colour) -> f64 {
        let linear = colour.map(|channel| {
            let part = f64::from(channel) / 255.0;
            if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
        });
        let luminance = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
        let cube = 216.0 / 24389.0;
        if luminance > cube { 116.0 * luminance.cbrt() - 16.0 } else { luminance * 24389.0 / 27.0 }
    }

    fn steps(colour_map: &ColourMap, from: f64, to: f64) -> Vec<f64> {
        let at = |step: u32| lightness(colour_map.at(from + (to - from) * f64::from(step) / 64.0));
        (0..64).map(|step| at(step + 1) - at(step)).collect()
    }

    #[test]
    fn lightness_tells_the_order() {
        for colour_map in [&VIRIDIS, &BATLOW] {
            // Channels are rounded to integers.
            assert!(
                steps(colour_map, 0.0, 1.0).iter().all(|&step| step > -0.15 && step < 3.0),
                "{colour_map:?}"
            );
            let [first, last] = [0.0, 1.0].map(|part| lightness(colour_map.at(part)));
            assert!(last - first > 65.0, "{colour_map:?}: {first} to {last}");
        }
    }

    #[test]
    fn lightness_rises_to_the_middle_and_falls_from_it() {
        assert!(steps(&VIK, 0.0, 0.5).iter().all(|&step| step > -0.15));
        assert!(steps(&VIK, 0.5, 1.0).iter().all(|&step| step < 0.15));
        let [low, high] = [0.0, 1.0].map(|part| lightness(VIK.at(part)));
        assert!((low - high).abs() < 8.0, "{low}, {high}");
    }

    #[test]
    fn ends_and_what_is_beyond_have_the_colours_of_the_ends() {
        assert_eq!([-1.0, 0.0, 1.0, 9.0].map(|part| VIRIDIS.at(part)[0]), [68, 68, 253, 253]);
        assert_eq!(VIRIDIS.at(f64::NAN), VIRIDIS.at(0.0));
        assert_eq!(hex(BATLOW.at(0.0)), "#011959");
    }

    #[test]
    fn level_ground_keeps_its_colour() {
        assert_eq!(lit([10, 100, 200], 0.5, 0.5), [10, 100, 200]);
        let channels = |shade| lit([90, 100, 110], shade, 0.5)[1];
        assert!(
            channels(0.0) < channels(0.4) && channels(0.4) < channels(0.7) && channels(0.7) < channels(1.0)
        );
        assert_eq!(grey(1.0), [255; 3]);
    }
}
