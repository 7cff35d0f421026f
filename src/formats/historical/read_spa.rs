//! SPA: streaming points as text.

use std::io::Read;

use crate::historical::sp::{SpDatatype, SpEvent, SpFinalization, SpHeader, SpPass, SpReader};
use crate::source::pass::{Content, Opening};
use crate::text::lines::{Lines, number, quote};
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::SPA_COMMENTS_MAX;
use spmesh_stream::model::bounds::{Bounds, Point};

/// Reads an SPA file.
pub struct SpaReader<R> {
    lines: Lines<R>,
    header: SpHeader,
    /// The first event, which ends the header.
    first: Option<SpEvent>,
    points: u64,
    ended: bool,
}

impl<R: Read> SpaReader<R> {
    /// Reads the header: all comment lines before the first event.
    ///
    /// # Errors
    /// If reading fails or a line is not SPA.
    pub fn new(input: R) -> Result<Self> {
        let header = SpHeader {
            comments: Vec::new(),
            datatype: SpDatatype::Float,
            finalization: SpFinalization::None,
            points: None,
            bounds: None,
        };
        let lines = Lines::new(input, "");
        let mut reader = SpaReader { lines, header, first: None, points: 0, ended: false };
        let mut fields = HeaderFields::default();
        loop {
            let Some(line) = reader.lines.next_trimmed()? else {
                reader.ended = true;
                break;
            };
            if let Some(comment) = line.strip_prefix(b"#") {
                fields.read(comment.trim_ascii(), &mut reader.header);
            } else if let Some(event) = parse(line).map_err(|e| e.at(reader.lines.position()))? {
                reader.first = Some(event);
                break;
            }
        }
        reader.header.bounds = fields.bounds();
        Ok(reader)
    }
}

impl<R: Read> SpaReader<R> {
    /// Checks that the line of an event is whole.
    fn check_line(&self, event: Option<SpEvent>) -> Result<()> {
        if event.is_some() && !self.lines.is_ended() {
            return Err(Error::malformed("truncated: the last line has no end").at(self.lines.position()));
        }
        Ok(())
    }
}

impl<R: Read> SpReader for SpaReader<R> {
    fn header(&self) -> &SpHeader {
        &self.header
    }

    fn next_event(&mut self) -> Result<Option<SpEvent>> {
        let mut event = self.first.take();
        while event.is_none() && !self.ended {
            match self.lines.next_trimmed()? {
                Some(line) => {
                    event = parse(line).map_err(|e| e.at(self.lines.position()))?;
                    self.check_line(event)?;
                }
                None => self.ended = true,
            }
        }
        match event {
            Some(SpEvent::Point(_)) => self.points += 1,
            None => self.header.check_count(self.points).map_err(|e| e.at(self.position()))?,
            _ => {}
        }
        Ok(event)
    }

    fn position(&self) -> String {
        self.lines.position()
    }
}

/// The event of a line; `None` for comments and tags of vertices. Faces and tetrahedra are errors: they
/// belong to the related mesh formats.
fn parse(line: &[u8]) -> Result<Option<SpEvent>> {
    let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    let bad = || Error::malformed(format!("found {}, expected a line of SPA", quote(line)));
    match words.next() {
        Some(b"v" | b"p") => {
            let mut point = [0.0; 3];
            for value in &mut point {
                *value = words.next().and_then(number).ok_or_else(bad)?;
            }
            Ok(Some(SpEvent::Point(point)))
        }
        Some(b"x") if line[1..].trim_ascii_start().starts_with(b"cell") => {
            let index = words.nth(1).and_then(|word| std::str::from_utf8(word).ok()?.parse().ok());
            Ok(Some(SpEvent::FinalizedCell(index.ok_or_else(bad)?)))
        }
        None | Some(b"x") => Ok(None),
        Some(b"f" | b"c") => {
            Err(Error::malformed(format!("found {}: a mesh, expected points alone", quote(line))))
        }
        Some(word) if word.starts_with(b"#") => Ok(None),
        Some(_) => Err(bad()),
    }
}

#[derive(Default)]
struct HeaderFields {
    min: Option<Point>,
    max: Option<Point>,
    comments_len: usize,
}

impl HeaderFields {
    fn read(&mut self, comment: &[u8], header: &mut SpHeader) {
        let text = String::from_utf8_lossy(comment);
        let mut words = text.split_ascii_whitespace();
        let point = |into: &mut Option<Point>| {
            let values: Vec<f64> = words.clone().skip(1).filter_map(|word| word.parse().ok()).collect();
            *into = values.try_into().ok().or(*into);
        };
        match words.clone().next().unwrap_or_default() {
            "npoints" => header.points = words.nth(1).and_then(|word| word.parse().ok()),
            "bb_min" | "bb_min_f" | "bb_min_d" | "bb_min_i" => point(&mut self.min),
            "bb_max" | "bb_max_f" | "bb_max_d" | "bb_max_i" => point(&mut self.max),
            "datatype" => {
                header.datatype = match words.nth(1) {
                    Some("SP_DOUBLE") => SpDatatype::Double,
                    Some("SP_INT") => SpDatatype::Int,
                    _ => SpDatatype::Float,
                }
            }
            "finalizemethod" => {
                header.finalization = match words.nth(1) {
                    Some("SP_QUAD_TREE") => SpFinalization::QuadTree,
                    Some("SP_OCT_TREE") => SpFinalization::OctTree,
                    Some("SP_CLARKSON_2D") => SpFinalization::Clarkson2d,
                    Some("SP_CLARKSON_3D") => SpFinalization::Clarkson3d,
                    _ => SpFinalization::None,
                }
            }
            _ => {
                self.comments_len += text.len() + 1;
                if self.comments_len <= SPA_COMMENTS_MAX {
                    header.comments.push(text.into_owned());
                }
            }
        }
    }

    fn bounds(&self) -> Option<Bounds> {
        let (min, max) = (self.min?, self.max?);
        (0..3).all(|axis| min[axis] <= max[axis]).then_some(Bounds { min, max })
    }
}

/// Opens a file of points. Its bounding box is left out, because SPA rounds it.
pub(crate) fn open(file: &Opening) -> Result<Content> {
    let stated = SpaReader::new(file.origin.plain()?)?.header().state(None);
    let content =
        Content::new(stated, |file, _| Ok(Box::new(SpPass::new(SpaReader::new(file.origin.plain()?)?))));
    Ok(Content { is_costly: true, ..content })
}
