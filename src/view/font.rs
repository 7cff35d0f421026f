//! The embedded font: the glyphs of characters, as contours.
//!
//! It is a file of OpenType, but always the same one. So this reads the tables that place and draw glyphs
//! (`cmap`, `hhea`, `hmtx`, `loca`, `glyf`), in the forms that they have there, and no other. The font has no
//! table for kerning.

/// The Latin letters of DejaVu Sans. An embedded font makes pictures look the same everywhere.
const FONT: &[u8] = include_bytes!("DejaVuSans-latin.ttf");

/// Glyphs are made of glyphs at most this deep.
const DEPTH_MAX: usize = 4;

/// The tables of the font.
pub(super) struct Font {
    segments: Vec<Segment>,
    /// Number of glyphs that have an advance of their own. Further ones have that of the last.
    advances: usize,
    hmtx: Bytes,
    loca: Bytes,
    glyf: Bytes,
    /// Units of the font in the size of text.
    pub(super) units: f32,
}

/// Successive characters with successive glyphs.
struct Segment {
    first: u16,
    last: u16,
    /// What is added to a character, modulo 65536.
    delta: u16,
}

/// A point of a contour. A point off the curve is the control point of a quadratic curve.
#[derive(Clone, Copy)]
pub(super) struct Dot {
    pub(super) x: f32,
    pub(super) y: f32,
    pub(super) is_on: bool,
}

impl Font {
    /// The embedded font; `None` if it has another form, as all results here.
    pub(super) fn embedded() -> Option<Font> {
        let file = Bytes(FONT);
        let count = usize::from(file.word(4)?);
        let table = |name: &[u8; 4]| {
            let entry =
                (0..count).map(|table| 12 + 16 * table).find(|&at| file.0.get(at..at + 4) == Some(name))?;
            file.part(file.long(entry + 8)?, file.long(entry + 12)?)
        };
        Some(Font {
            segments: segments(table(b"cmap")?)?,
            advances: usize::from(table(b"hhea")?.word(34)?),
            hmtx: table(b"hmtx")?,
            loca: table(b"loca")?,
            glyf: table(b"glyf")?,
            units: f32::from(table(b"head")?.word(18)?),
        })
    }

    /// The glyph of a character; the first one is that of characters which the font lacks.
    pub(super) fn glyph(&self, character: char) -> u16 {
        let Ok(code) = u16::try_from(u32::from(character)) else { return 0 };
        let segment = self.segments.iter().find(|segment| (segment.first..=segment.last).contains(&code));
        segment.map_or(0, |segment| code.wrapping_add(segment.delta))
    }

    /// How far the next glyph is from this one.
    pub(super) fn advance(&self, glyph: u16) -> Option<f32> {
        let row = usize::from(glyph).min(self.advances.checked_sub(1)?);
        self.hmtx.word(4 * row).map(f32::from)
    }

    /// The contours of a glyph, in units of the font.
    pub(super) fn contours(&self, glyph: u16) -> Option<Vec<Vec<Dot>>> {
        self.contours_within(glyph, DEPTH_MAX)
    }

    fn contours_within(&self, glyph: u16, depth: usize) -> Option<Vec<Vec<Dot>>> {
        let place = |glyph: usize| self.loca.word(2 * glyph).map(|half| 2 * usize::from(half));
        let (start, end) = (place(usize::from(glyph))?, place(usize::from(glyph) + 1)?);
        if start == end {
            return Some(Vec::new());
        }
        let data = self.glyf.part(start, end.checked_sub(start)?)?;
        match usize::try_from(data.signed(0)?) {
            Ok(count) => simple(data, count),
            Err(_) => self.composite(data, depth.checked_sub(1)?),
        }
    }

    /// The contours of a glyph that is made of others, such as a letter and an accent.
    fn composite(&self, data: Bytes, depth: usize) -> Option<Vec<Vec<Dot>>> {
        /// Offsets have 16 bits.
        const WORDS: u16 = 0x1;
        /// The part is moved by offsets, not so that points meet.
        const OFFSETS: u16 = 0x2;
        /// Another part follows.
        const MORE: u16 = 0x20;
        /// The part has another scale; none has.
        const SCALED: u16 = 0x8 | 0x40 | 0x80;
        let (mut contours, mut at) = (Vec::new(), 10);
        loop {
            let (flags, glyph) = (data.word(at)?, data.word(at + 2)?);
            if flags & SCALED != 0 || flags & OFFSETS == 0 {
                return None;
            }
            let [dx, dy] = if flags & WORDS != 0 {
                [data.signed(at + 4)?, data.signed(at + 6)?]
            } else {
                [data.byte(at + 4)?, data.byte(at + 5)?].map(|byte| i16::from(byte as i8))
            };
            at += if flags & WORDS != 0 { 8 } else { 6 };
            let [dx, dy] = [dx, dy].map(f32::from);
            let moved = |dot: Dot| Dot { x: dot.x + dx, y: dot.y + dy, is_on: dot.is_on };
            let part = self.contours_within(glyph, depth)?;
            contours
                .extend(part.into_iter().map(|contour| contour.into_iter().map(moved).collect::<Vec<Dot>>()));
            if flags & MORE == 0 {
                return Some(contours);
            }
        }
    }
}

/// The only subtable of characters, of format 4 without an array of glyphs.
fn segments(cmap: Bytes) -> Option<Vec<Segment>> {
    let start = cmap.long(8)?;
    let column = usize::from(cmap.word(start + 6)?);
    let segment = |number: usize| {
        let at = start + 14 + 2 * number;
        let (last, first) = (cmap.word(at)?, cmap.word(at + column + 2)?);
        let (delta, array) = (cmap.word(at + 2 * column + 2)?, cmap.word(at + 3 * column + 2)?);
        (array == 0).then_some(Segment { first, last, delta })
    };
    if cmap.word(start)? != 4 {
        return None;
    }
    (0..column / 2).map(segment).collect()
}

/// The contours of a glyph with points of its own.
fn simple(data: Bytes, count: usize) -> Option<Vec<Vec<Dot>>> {
    /// The point is on the curve.
    const ON: u8 = 0x1;
    /// A number follows, of further points with the same flags.
    const REPEAT: u8 = 0x8;
    let ends: Option<Vec<usize>> =
        (0..count).map(|at| Some(usize::from(data.word(10 + 2 * at)?) + 1)).collect();
    let ends = ends?;
    let total = *ends.last()?;
    let mut at = 10 + 2 * count;
    at += 2 + usize::from(data.word(at)?);
    let mut flags = Vec::new();
    while flags.len() < total {
        let flag = data.byte(at)?;
        let times = if flag & REPEAT != 0 { usize::from(data.byte(at + 1)?) } else { 0 };
        at += if flag & REPEAT != 0 { 2 } else { 1 };
        flags.extend(std::iter::repeat_n(flag, times + 1));
    }
    flags.truncate(total);
    let xs = coordinates(data, &mut at, &flags, [0x2, 0x10])?;
    let ys = coordinates(data, &mut at, &flags, [0x4, 0x20])?;
    let dots = flags.iter().zip(xs.into_iter().zip(ys));
    let mut dots = dots.map(|(flag, (x, y))| Dot { x, y, is_on: flag & ON != 0 });
    let starts = std::iter::once(0).chain(ends.iter().copied());
    let lengths = starts.zip(&ends).map(|(start, end)| end.saturating_sub(start));
    Some(lengths.map(|length| dots.by_ref().take(length).collect()).collect())
}

/// The coordinates of points along an axis. With the first flag, a step has one byte, and with the second one
/// it is positive. Without the first, a step has two bytes, or with the second one none.
fn coordinates(data: Bytes, at: &mut usize, flags: &[u8], [short, same]: [u8; 2]) -> Option<Vec<f32>> {
    let mut number = 0i16;
    let mut next = |flag: &u8| {
        let (step, bytes) = match (flag & short != 0, flag & same != 0) {
            (true, true) => (i16::from(data.byte(*at)?), 1),
            (true, false) => (-i16::from(data.byte(*at)?), 1),
            (false, true) => (0, 0),
            (false, false) => (data.signed(*at)?, 2),
        };
        *at += bytes;
        number = number.checked_add(step)?;
        Some(f32::from(number))
    };
    flags.iter().map(&mut next).collect()
}

/// Bytes of the font; numbers have their most significant byte first.
#[derive(Clone, Copy)]
struct Bytes(&'static [u8]);

impl Bytes {
    fn part(self, at: usize, length: usize) -> Option<Bytes> {
        self.0.get(at..at.checked_add(length)?).map(Bytes)
    }

    fn byte(self, at: usize) -> Option<u8> {
        self.0.get(at).copied()
    }

    fn word(self, at: usize) -> Option<u16> {
        self.0.get(at..)?.first_chunk().copied().map(u16::from_be_bytes)
    }

    fn signed(self, at: usize) -> Option<i16> {
        self.word(at).map(u16::cast_signed)
    }

    fn long(self, at: usize) -> Option<usize> {
        let number = self.0.get(at..)?.first_chunk().copied().map(u32::from_be_bytes)?;
        usize::try_from(number).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The box of all glyphs.
    const WIDEST: [f32; 4] = [-2090.0, -948.0, 3673.0, 2524.0];

    #[test]
    fn each_latin_letter_has_a_glyph() {
        let font = Font::embedded().unwrap();
        let letters = ('\u{20}'..='\u{7e}').chain('\u{a0}'..='\u{ff}');
        for letter in letters {
            let glyph = font.glyph(letter);
            assert!(glyph != 0 && font.advance(glyph).unwrap() > 0.0, "{letter:?}");
            let contours = font.contours(glyph).unwrap();
            assert_eq!(contours.is_empty(), letter.is_whitespace(), "{letter:?}");
            for contour in contours {
                assert!(contour[0].is_on, "{letter:?}");
                let is_in = |dot: &Dot| {
                    (WIDEST[0]..=WIDEST[2]).contains(&dot.x) && (WIDEST[1]..=WIDEST[3]).contains(&dot.y)
                };
                assert!(contour.iter().all(is_in), "{letter:?}");
            }
        }
        assert_eq!(['\u{7f}', 'Ā', '漢', '😀'].map(|letter| font.glyph(letter)), [0; 4]);
        assert!(!font.contours(0).unwrap().is_empty());
    }

    #[test]
    fn an_accent_is_above_its_letter() {
        let font = Font::embedded().unwrap();
        let [plain, accented] = ['e', 'é'].map(|letter| font.contours(font.glyph(letter)).unwrap());
        let top = |contours: &[Vec<Dot>]| contours.iter().flatten().map(|dot| dot.y).fold(f32::MIN, f32::max);
        assert_eq!(accented.len(), plain.len() + 1);
        assert!(top(&accented) > top(&plain) + 300.0);
    }
}
