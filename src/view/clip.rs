//! Clips: what was drawn outside of a clip is taken back.

use tiny_skia::{FillRule, Mask, Path, Pixmap, PremultipliedColorU8, Transform};

/// Shapes, of which a clip shows what any of them covers.
pub(super) type Shapes = Vec<(Path, FillRule)>;

/// The pixels that a clip hides, in whole or in part, as they were before anything was drawn in it.
///
/// Shapes are drawn in a clip as if there were none; then these pixels come back. If each shape was drawn
/// through a mask instead, those that share a pixel at the border of the clip would cover more of it than the
/// clip leaves open. A clip within another one needs nothing more: each takes back what is outside of it.
///
/// Memory: a byte for each pixel of the picture, and 4 bytes for each that is hidden.
pub(super) struct Hidden {
    mask: Mask,
    /// The hidden pixels, in the order of the mask.
    before: Vec<PremultipliedColorU8>,
}

impl Hidden {
    /// The pixels that a clip hides; `None` if the picture is too large for a mask.
    pub(super) fn by(shapes: &Shapes, pixmap: &Pixmap) -> Option<Hidden> {
        let mut mask = Mask::new(pixmap.width(), pixmap.height())?;
        for (path, rule) in shapes {
            mask.fill_path(path, *rule, true, Transform::identity());
        }
        let is_hidden = |open: &u8| *open < u8::MAX;
        let mut before = Vec::with_capacity(mask.data().iter().filter(|open| is_hidden(open)).count());
        let pixels = mask.data().iter().zip(pixmap.pixels());
        before.extend(pixels.filter(|(open, _)| is_hidden(open)).map(|(_, pixel)| *pixel));
        Some(Hidden { mask, before })
    }

    /// Brings back the pixels.
    pub(super) fn restore(self, pixmap: &mut Pixmap) {
        let pixels = self.mask.data().iter().zip(pixmap.pixels_mut());
        let hidden = pixels.filter(|(open, _)| **open < u8::MAX);
        for ((open, pixel), before) in hidden.zip(self.before) {
            *pixel = mix(before, *pixel, *open);
        }
    }
}

/// A pixel of which a part shows what is drawn: `open` of 255.
fn mix(before: PremultipliedColorU8, drawn: PremultipliedColorU8, open: u8) -> PremultipliedColorU8 {
    let part = u32::from(open);
    let mixed = |a: u8, b: u8| ((u32::from(a) * (255 - part) + u32::from(b) * part + 127) / 255) as u8;
    let (red, green) = (mixed(before.red(), drawn.red()), mixed(before.green(), drawn.green()));
    let (blue, alpha) = (mixed(before.blue(), drawn.blue()), mixed(before.alpha(), drawn.alpha()));
    // No colour exceeds its opacity, because none did before.
    PremultipliedColorU8::from_rgba(red, green, blue, alpha).unwrap_or(before)
}
