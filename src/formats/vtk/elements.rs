//! Reads the elements of an XML file one after the other. Texts stay in the file, so they may have any
//! length.

use std::io::{self, BufRead, BufReader, Read};
use std::ops::Range;

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use crate::detect::BYTE_ORDER_MARK;
use crate::source::origin::FileView;
use crate::text::numbers::fill;
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::{XML_DEPTH_MAX, XML_TAG_MAX};

/// Bytes read at once.
const BUFFER_LEN: usize = 1 << 17;

/// Reads elements. Memory: one tag.
pub(crate) struct Elements {
    reader: Reader<Bounded<BufReader<FileView>>>,
    /// Offset in the file at which the reader started.
    start: u64,
    /// Names of the open elements.
    path: Vec<String>,
    buffer: Vec<u8>,
}

/// The start of an element.
#[derive(Debug)]
pub(crate) struct Tag {
    pub(crate) name: String,
    attributes: Vec<(String, String)>,
    /// Offset in the file after the tag.
    pub(crate) end: u64,
}

/// What comes next, except texts.
enum Next {
    Open(Tag),
    Close,
    /// A comment or other content to ignore.
    Nothing,
}

impl Tag {
    /// The value of an attribute, if it is there.
    pub(crate) fn get(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.trim())
    }

    /// An error about the element.
    pub(crate) fn error(&self, what: &str) -> Error {
        Error::malformed(format!("element {}: {what}", self.name)).at(format!("byte {}", self.end))
    }
}

impl Elements {
    pub(crate) fn new(file: &FileView) -> Result<Self> {
        let mut mark = Vec::new();
        file.range(0, 3).read_to_end(&mut mark).map_err(|e| Error::io("reading", e))?;
        let start = if mark == BYTE_ORDER_MARK { BYTE_ORDER_MARK.len() as u64 } else { 0 };
        let input = BufReader::with_capacity(BUFFER_LEN, file.range(start, file.len()));
        let mut reader = Reader::from_reader(Bounded { input, left: 0 });
        reader.config_mut().expand_empty_elements = true;
        Ok(Elements { reader, start, path: Vec::new(), buffer: Vec::new() })
    }

    /// The next child of the innermost open element, or at first the root; `None` at the end of that element.
    /// Texts and comments are skipped. The caller must reach the end of a child before asking for the next.
    pub(crate) fn child(&mut self) -> Result<Option<Tag>> {
        loop {
            self.text()?;
            match self.next()? {
                Next::Open(tag) => return Ok(Some(tag)),
                Next::Close => return Ok(None),
                Next::Nothing => {}
            }
        }
    }

    /// Goes to the end of the innermost open element.
    pub(crate) fn skip(&mut self) -> Result<()> {
        let depth = self.path.len();
        while self.path.len() >= depth {
            self.child()?;
        }
        Ok(())
    }

    /// Goes to the end of the innermost open element, and returns the range of its only text, which may stand
    /// between child elements.
    pub(crate) fn only_text(&mut self) -> Result<Range<u64>> {
        let mut found = 0..0;
        loop {
            let text = self.text()?;
            if !text.is_empty() && !found.is_empty() {
                return Err(self.locate(Error::malformed("a second text in one element, expected its end")));
            }
            found = if text.is_empty() { found } else { text };
            match self.next()? {
                Next::Open(_) => self.skip()?,
                Next::Close => return Ok(found),
                Next::Nothing => {}
            }
        }
    }

    /// Offset of the bytes after an underscore, where appended data starts.
    pub(crate) fn behind_underscore(&mut self) -> Result<u64> {
        self.reader.get_mut().left = usize::MAX;
        let mut stream = self.reader.stream();
        loop {
            let bytes = fill(&mut stream)?;
            let blank = bytes.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
            let next = bytes.get(blank).copied();
            let is_end = bytes.is_empty();
            stream.consume(blank);
            match next {
                Some(b'_') => return Ok(self.position() + 1),
                None if !is_end => {}
                _ => {
                    return Err(self.locate(Error::malformed("found no underscore before the appended data")));
                }
            }
        }
    }

    fn position(&self) -> u64 {
        self.start + self.reader.buffer_position()
    }

    fn locate(&self, error: Error) -> Error {
        error.at(format!("byte {}", self.position()))
    }

    /// Goes to the next tag, and returns the range of the text before it, without leading white space.
    fn text(&mut self) -> Result<Range<u64>> {
        self.reader.get_mut().left = usize::MAX;
        let (mut start, mut is_blank) = (self.position(), true);
        let mut stream = self.reader.stream();
        loop {
            let bytes = fill(&mut stream)?;
            if bytes.is_empty() {
                break;
            }
            let tag = memchr::memchr(b'<', bytes);
            let text = &bytes[..tag.unwrap_or(bytes.len())];
            if is_blank {
                let blank = text.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
                start += blank as u64;
                is_blank = blank == text.len();
            }
            let len = text.len();
            stream.consume(len);
            if tag.is_some() {
                break;
            }
        }
        Ok(start..self.position())
    }

    /// The next item after a text.
    fn next(&mut self) -> Result<Next> {
        self.buffer.clear();
        self.reader.get_mut().left = XML_TAG_MAX;
        let event = self.reader.read_event_into(&mut self.buffer);
        let end = self.start + self.reader.buffer_position();
        let found = event.map_err(damaged).and_then(|event| match event {
            Event::Start(start) => tag_of(&start, end).map(Next::Open),
            Event::End(_) => Ok(Next::Close),
            Event::Eof => Err(Error::malformed(match self.path.last() {
                Some(name) => format!("truncated: the file ends within the element {name}"),
                None => "truncated: the file has no element".to_string(),
            })),
            Event::CData(_) => Err(Error::malformed("found CDATA, expected an element")),
            _ => Ok(Next::Nothing),
        });
        let found = found.map_err(|e| e.at(format!("byte {end}")))?;
        match &found {
            Next::Open(tag) if self.path.len() == XML_DEPTH_MAX => {
                return Err(tag.error(&format!("more than {XML_DEPTH_MAX} elements in each other")));
            }
            Next::Open(tag) => self.path.push(tag.name.clone()),
            Next::Close => drop(self.path.pop()),
            Next::Nothing => {}
        }
        Ok(found)
    }
}

fn tag_of(start: &BytesStart, end: u64) -> Result<Tag> {
    let name = start.name().0.to_string();
    let mut attributes = Vec::new();
    for attribute in start.attributes() {
        let attribute =
            attribute.map_err(|e| Error::malformed(format!("attributes of element {name}: {e}")))?;
        attributes.push((attribute.key.0.to_string(), attribute.value.to_string()));
    }
    Ok(Tag { name, attributes, end })
}

fn damaged(error: quick_xml::Error) -> Error {
    match error {
        quick_xml::Error::Io(e) => Error::io("reading", io::Error::new(e.kind(), e.to_string())),
        e => Error::malformed(format!("damaged XML: {e}")),
    }
}

/// An input with a limit on the bytes that may be read, so that an endless tag is not held in memory.
struct Bounded<R> {
    input: R,
    left: usize,
}

impl<R: BufRead> Read for Bounded<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let bytes = self.fill_buf()?;
        let len = bytes.len().min(buffer.len());
        buffer[..len].copy_from_slice(&bytes[..len]);
        self.consume(len);
        Ok(len)
    }
}

impl<R: BufRead> BufRead for Bounded<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        let bytes = self.input.fill_buf()?;
        if self.left == 0 && !bytes.is_empty() {
            let message = format!("a tag or comment of more than {XML_TAG_MAX} bytes");
            return Err(io::Error::new(io::ErrorKind::InvalidData, message));
        }
        Ok(&bytes[..bytes.len().min(self.left)])
    }

    fn consume(&mut self, len: usize) {
        self.left = self.left.saturating_sub(len);
        self.input.consume(len);
    }
}
