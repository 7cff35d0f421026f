//! The elements of a picture, as an XML parser sees them.

use std::collections::HashMap;

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

/// An element with its attributes, and the identifiers of its ancestors.
#[derive(Debug)]
pub struct Element {
    pub name: String,
    pub attributes: HashMap<String, String>,
    pub within: Vec<String>,
    pub text: String,
}

impl Element {
    pub fn number(&self, name: &str) -> f64 {
        self.attributes[name].parse().unwrap()
    }

    pub fn is_in(&self, id: &str) -> bool {
        self.within.iter().any(|within| within == id)
    }

    /// The polygons or polylines of a path, as corner positions.
    pub fn rings(&self) -> Vec<Vec<[f64; 2]>> {
        let pieces = self.attributes["d"].split('M').skip(1);
        let place = |text: &str| {
            let mut numbers = text.split(' ').map(|number| number.parse().unwrap());
            [numbers.next().unwrap(), numbers.next().unwrap()]
        };
        pieces.map(|piece| piece.trim_end_matches('Z').split('L').map(place).collect()).collect()
    }

    /// The approximate perceived lightness of its colour, from 0 to 255.
    pub fn lightness(&self, attribute: &str) -> f64 {
        let colour = u32::from_str_radix(self.attributes[attribute].trim_start_matches('#'), 16).unwrap();
        lightness([16, 8, 0].map(|shift| (colour >> shift) as u8))
    }
}

/// The lightness of a colour, from 0 to 255.
pub fn lightness(colour: [u8; 3]) -> f64 {
    let [r, g, b] = colour.map(f64::from);
    (0.2126 * r.powf(2.2) + 0.7152 * g.powf(2.2) + 0.0722 * b.powf(2.2)).powf(1.0 / 2.2)
}

/// All elements of a picture, in order.
pub fn parse(text: &str) -> Vec<Element> {
    let (mut reader, mut found, mut open) = (Reader::from_str(text), Vec::<Element>::new(), Vec::new());
    let mut open_elements = Vec::new();
    loop {
        match reader.read_event().unwrap() {
            Event::Start(start) => {
                found.push(element(&start, &open));
                open_elements.push(found.len() - 1);
                open.push(found[found.len() - 1].attributes.get("id").cloned().unwrap_or_default());
            }
            Event::Empty(start) => found.push(element(&start, &open)),
            Event::Text(words) => {
                if let Some(&last) = open_elements.last() {
                    found[last].text += &words;
                }
            }
            Event::End(_) => {
                open.pop();
                open_elements.pop();
            }
            Event::Eof => break,
            _ => {}
        }
    }
    assert!(open.is_empty());
    found
}

fn element(start: &BytesStart, open: &[String]) -> Element {
    let attributes = start.attributes().map(|attribute| {
        let attribute = attribute.unwrap();
        (attribute.key.as_ref().to_string(), attribute.value.to_string())
    });
    Element {
        name: start.name().as_ref().to_string(),
        attributes: attributes.collect(),
        within: open.to_vec(),
        text: String::new(),
    }
}

/// Elements of one name in a group.
pub fn within<'a>(elements: &'a [Element], id: &str, name: &str) -> Vec<&'a Element> {
    elements.iter().filter(|element| element.name == name && element.is_in(id)).collect()
}

/// The element with an identifier.
pub fn named<'a>(elements: &'a [Element], id: &str) -> Option<&'a Element> {
    elements.iter().find(|element| element.attributes.get("id").is_some_and(|found| found == id))
}
