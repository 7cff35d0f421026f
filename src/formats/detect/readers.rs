//! Which formats each tool reads, and its message for any other.

use spmesh_base::error::{Error, Result};

use crate::detect::{HEAD_LEN, detect};
use crate::drivers::{Format, formats_with};

/// A tool that reads inputs of several formats.
#[derive(Debug)]
pub struct Reader {
    /// Name of the tool.
    pub tool: &'static str,
    /// The formats that it reads, in the order of its messages.
    formats: fn() -> Vec<Format>,
    /// Whether `--raw` makes it read numbers without a header.
    has_raw: bool,
    /// Axes of its points.
    axes: usize,
}

/// Formats of points in space. Every tool that takes points reads them.
fn points() -> Vec<Format> {
    formats_with(|row| row.points.is_some() && row.atoms.is_none())
}

/// Molecular structures, whose atoms are points in space.
fn structures() -> Vec<Format> {
    formats_with(|row| row.atoms.is_some())
}

/// The formats whose points are written again: see [`crate::source::PointFile`].
fn rewritten() -> Vec<Format> {
    vec![Format::Las, Format::Stream, Format::Text, Format::OtherText]
}

const fn reader(tool: &'static str, formats: fn() -> Vec<Format>) -> Reader {
    Reader { tool, formats, has_raw: false, axes: 3 }
}

/// `spfinalize`.
pub const SPFINALIZE: Reader =
    Reader { has_raw: true, ..reader("spfinalize", || [points(), structures()].concat()) };

/// `configgen`.
pub const CONFIGGEN: Reader = reader("configgen", points);

/// `splinefit`.
pub const SPLINEFIT: Reader = reader("splinefit", points);

/// `spinfo`, for the points that an audit compares with.
pub const SPINFO: Reader = reader("spinfo", || [points(), structures()].concat());

/// `spconvert`. It takes points of these formats as `spfinalize` does.
pub const SPCONVERT: Reader = reader("spconvert", || {
    let points = [Format::Las, Format::VtkLegacy, Format::VtkXml, Format::Text];
    Format::read().filter(|format| format.events().is_some()).chain(points).collect()
});

/// `tess3`.
pub const TESS3: Reader = reader("tess3", || [structures(), vec![Format::Off], points()].concat());

/// `spcanopy`.
pub const SPCANOPY: Reader = reader("spcanopy", || vec![Format::Las]);

/// `spground`, for the files whose points get classes.
pub const SPGROUND: Reader = reader("spground", rewritten);

/// `spground`, for points whose ground is triangulated.
pub const SPGROUND_MESH: Reader = reader("spground", points);

/// `spheight`, for the files whose points get heights.
pub const SPHEIGHT: Reader = reader("spheight", rewritten);

/// `spreport`.
pub const SPREPORT: Reader = reader("spreport", points);

/// `dd4`.
pub const DD4: Reader =
    Reader { has_raw: true, axes: 4, ..reader("dd4", || formats_with(|row| row.sites.is_some())) };

/// All of them.
pub const READERS: [&Reader; 11] = [
    &SPFINALIZE,
    &CONFIGGEN,
    &SPLINEFIT,
    &SPINFO,
    &SPCONVERT,
    &SPCANOPY,
    &SPGROUND,
    &SPHEIGHT,
    &SPREPORT,
    &TESS3,
    &DD4,
];

/// The reader of a caller that does not name its tool.
static ANY: Reader = Reader { has_raw: true, ..reader("this program", points) };

impl Default for &'static Reader {
    fn default() -> Self {
        &ANY
    }
}

impl Reader {
    /// The format of an input that starts with `head`, if the tool reads it.
    ///
    /// # Errors
    /// Malformed, if the input is empty, or of a format that the tool does not read.
    pub fn detect(&self, head: &[u8]) -> Result<Format> {
        let format = detect(head)?;
        if !self.reads(format) {
            return Err(Error::malformed(self.refusal(format, head)));
        }
        if format == Format::OtherText && head.len() as u64 == HEAD_LEN && !may_hold_points_later(head) {
            return Err(Error::malformed(format!(
                "no line of coordinates in the first {HEAD_LEN} bytes; {}",
                self.list()
            )));
        }
        Ok(format)
    }

    /// Whether the tool reads this format.
    pub fn reads(&self, format: Format) -> bool {
        (self.formats)().contains(&format)
    }

    /// The formats that the tool reads, for messages.
    fn list(&self) -> String {
        let mut listed: Vec<&str> = Vec::new();
        for format in (self.formats)() {
            let name = format.row().listed;
            if !listed.contains(&name) {
                listed.push(name);
            }
        }
        format!("{} reads {}", self.tool, listed.join(", "))
    }

    /// The tool's message for a file of this format, which starts with `head`.
    pub fn refusal(&self, format: Format, head: &[u8]) -> String {
        let reads = self.list();
        if format == Format::Binary {
            let at = head.iter().position(|&byte| byte == 0).unwrap_or_default();
            let raw = if self.has_raw { "; raw numbers need --raw" } else { "" };
            return format!("zero byte at byte {at}: not text, and of no known format; {reads}{raw}");
        }
        let holds_space = READERS.iter().any(|reader| reader.axes == 3 && reader.reads(format));
        let hint = match self.axes == 4 && holds_space {
            true => "it has no times: write points as lines of x y z t",
            false => format.row().hint,
        };
        let hint = if hint.is_empty() { String::new() } else { format!("; {hint}") };
        format!("this is {}; {reads}{hint}", format.name())
    }
}

/// Whether points may follow a head of text without coordinates: comments and at most one line of names come
/// before them.
fn may_hold_points_later(head: &[u8]) -> bool {
    let lines = head.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii).filter(|line| !line.is_empty());
    let (comments, others): (Vec<_>, Vec<_>) =
        lines.partition(|line| line.starts_with(b"#") || line.starts_with(b"//"));
    others.len() <= 2 && comments.len() + others.len() > 0
}
