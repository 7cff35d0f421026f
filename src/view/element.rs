//! Elements of SVG as a renderer sees them: each attribute must be taken, so that none is left out unseen.

use std::borrow::Cow;
use std::fmt::Display;
use std::str::FromStr;

use quick_xml::XmlVersion;
use quick_xml::events::BytesStart;

use spmesh_base::error::{Error, Result};

/// Attributes that change no pixel. Names and roles are for pages. Strokes keep their width with
/// `vector-effect`, but nothing is scaled here. All text is in the embedded font.
const SILENT: [&str; 6] = ["id", "class", "role", "xmlns", "font-family", "vector-effect"];

/// An element with the attributes that were not taken yet.
pub(super) struct Element<'a> {
    pub(super) name: &'a str,
    attributes: Vec<(&'a str, Cow<'a, str>)>,
}

impl<'a> Element<'a> {
    /// The element that a tag starts.
    pub(super) fn of(start: &'a BytesStart) -> Result<Element<'a>> {
        let mut attributes = Vec::new();
        for attribute in start.attributes() {
            let attribute = attribute.map_err(failed)?;
            let value = attribute.normalized_value(XmlVersion::Implicit1_0).map_err(failed)?;
            attributes.push((attribute.key.into_inner(), value));
        }
        Ok(Element { name: start.name().into_inner(), attributes })
    }

    /// The value of an attribute, if the element has it.
    pub(super) fn take(&mut self, name: &str) -> Option<Cow<'a, str>> {
        let at = self.attributes.iter().position(|(known, _)| *known == name)?;
        Some(self.attributes.swap_remove(at).1)
    }

    /// The value of an attribute that the element must have.
    pub(super) fn need(&mut self, name: &str) -> Result<Cow<'a, str>> {
        let value = self.take(name);
        value.ok_or_else(|| failed(format!("an element <{}> without {name}", self.name)))
    }

    /// The number that an attribute states, or a default.
    pub(super) fn number<T: FromStr>(&mut self, name: &str, default: T) -> Result<T> {
        let Some(value) = self.take(name) else { return Ok(default) };
        value.parse().map_err(|_| failed(format!("the attribute {name}=\"{value}\"")))
    }

    /// What an attribute means, if the element has it.
    pub(super) fn meaning<T>(&mut self, name: &str, of: impl FnOnce(&str) -> Option<T>) -> Result<Option<T>> {
        let Some(value) = self.take(name) else { return Ok(None) };
        of(&value).map(Some).ok_or_else(|| failed(format!("the attribute {name}=\"{value}\"")))
    }

    /// Checks that all attributes are taken.
    pub(super) fn finish(self) -> Result<()> {
        match self.attributes.iter().find(|(name, _)| !SILENT.contains(name)) {
            Some((name, _)) => Err(failed(format!("the attribute {name} of <{}>", self.name))),
            None => Ok(()),
        }
    }
}

/// The error of a picture that the renderer does not understand.
pub(super) fn failed(what: impl Display) -> Error {
    Error::usage(format!("the picture cannot be rendered: {what}"))
}
