//! Attributes of points: what each point carries beside its coordinates, such as intensity or colour.
//!
//! The *row* of a point is the stored numbers of all its attributes, one after the other, little-endian and
//! without padding (`formats/spmesh.md`, section 2.7). Programs pass rows on byte by byte.

mod number;

use std::collections::HashSet;
use std::ops::Range;

pub use number::{Number, NumberType};

/// Greatest length of a row, in bytes.
pub const ROW_LEN_MAX: usize = 1024;

/// Greatest length of a name, in bytes.
pub const NAME_LEN_MAX: usize = 255;
/// Bytes that are left for the number behind a name that several attributes have.
const NUMBER_LEN_MAX: usize = 20;

/// One attribute of all points.
#[derive(Debug, Clone, PartialEq)]
pub struct Attribute {
    /// Its name, which no other attribute of the points has.
    pub name: String,
    /// Type of its stored numbers.
    pub number: NumberType,
    /// Numbers per point, at least 1.
    pub components: u8,
    /// Its unit; empty if there is none, or it is not known.
    pub unit: String,
    /// What the LAS specification calls it; empty if it has no such name.
    pub las_name: String,
    /// Scale and offset: a stored number stands for number * scale + offset.
    pub scale: Option<[f64; 2]>,
    /// The bytes of the stored number that says that the value is unknown.
    pub unknown: Option<Vec<u8>>,
}

impl Attribute {
    /// An attribute of one number per point, whose stored numbers are its values.
    pub fn new(name: impl Into<String>, number: NumberType) -> Self {
        Attribute {
            name: name.into(),
            number,
            components: 1,
            unit: String::new(),
            las_name: String::new(),
            scale: None,
            unknown: None,
        }
    }

    /// Bytes that it takes in a row.
    pub fn width(&self) -> usize {
        self.number.width() * usize::from(self.components)
    }

    /// The stored numbers in the bytes of this attribute.
    pub fn numbers<'a>(&self, bytes: &'a [u8]) -> impl Iterator<Item = Number> + use<'a> {
        let number = self.number;
        bytes.chunks_exact(number.width()).map(move |bytes| number.read(bytes))
    }

    /// The value that the bytes of a stored number stand for; `None` if it is unknown.
    pub fn value(&self, stored: &[u8]) -> Option<f64> {
        if self.unknown.as_deref() == Some(stored) {
            return None;
        }
        let number = self.number.read(stored).to_f64();
        Some(self.scale.map_or(number, |[scale, offset]| number * scale + offset))
    }

    /// Checks the rules of one attribute.
    ///
    /// # Errors
    /// A text about the rule that is broken.
    pub fn check(&self) -> Result<(), String> {
        let name = &self.name;
        if name.is_empty() || name.len() > NAME_LEN_MAX {
            return Err(format!(
                "an attribute whose name has {} bytes, expected 1 to {NAME_LEN_MAX}",
                name.len()
            ));
        }
        let texts = [name, &self.unit, &self.las_name];
        if texts.iter().any(|text| text.len() > NAME_LEN_MAX || text.chars().any(char::is_control)) {
            return Err(format!(
                "the name, unit or LAS name of attribute \"{}\" is too long or has control characters",
                name.escape_default()
            ));
        }
        if self.components == 0 {
            return Err(format!("attribute \"{name}\" has no components"));
        }
        if let Some([scale, offset]) = self.scale
            && !(scale.is_finite() && offset.is_finite() && scale != 0.0)
        {
            return Err(format!("attribute \"{name}\" has the scale {scale} and the offset {offset}"));
        }
        if let Some(unknown) = &self.unknown
            && unknown.len() != self.number.width()
        {
            return Err(format!("the unknown number of attribute \"{name}\" has another type"));
        }
        Ok(())
    }
}

/// The attributes with names that a list may have: control characters left out, long names cut, and a number
/// behind names that others have, as in `name_2`.
pub fn with_usable_names(attributes: Vec<Attribute>) -> Vec<Attribute> {
    let mut taken: HashSet<String> = HashSet::new();
    let renamed = attributes.into_iter().map(|attribute| {
        let plain: String = attribute.name.chars().filter(|char| !char.is_control()).collect();
        let ends = plain.char_indices().map(|(at, char)| at + char.len_utf8());
        let end = ends.take_while(|&end| end <= NAME_LEN_MAX - NUMBER_LEN_MAX).last().unwrap_or(0);
        let base = if end == 0 { "unnamed" } else { &plain[..end] };
        let numbered = (2..).map(|number| format!("{base}_{number}"));
        let mut names = std::iter::once(base.to_string()).chain(numbered);
        let name = names.find(|name| taken.insert(name.clone())).unwrap_or_default();
        Attribute { name, ..attribute }
    });
    renamed.collect()
}

/// The attributes of all points of a stream, in the order of their numbers in a row.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Attributes(Vec<Attribute>);

impl Attributes {
    /// A list of attributes.
    ///
    /// # Errors
    /// A text about the rule that is broken: those of [`Attribute::check`], different names, and rows of at
    /// most [`ROW_LEN_MAX`] bytes.
    pub fn new(attributes: Vec<Attribute>) -> Result<Self, String> {
        attributes.iter().try_for_each(Attribute::check)?;
        let mut names: Vec<&str> = attributes.iter().map(|attribute| attribute.name.as_str()).collect();
        names.sort_unstable();
        if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(format!("two attributes \"{}\"", pair[0]));
        }
        let len: usize = attributes.iter().map(Attribute::width).sum();
        if len > ROW_LEN_MAX {
            return Err(format!(
                "rows of {len} bytes, the maximum is {ROW_LEN_MAX}: choose fewer attributes"
            ));
        }
        Ok(Attributes(attributes))
    }

    /// The attributes in their order.
    pub fn iter(&self) -> std::slice::Iter<'_, Attribute> {
        self.0.iter()
    }

    /// Whether points carry nothing but coordinates.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Bytes of a row.
    pub fn row_len(&self) -> usize {
        self.0.iter().map(Attribute::width).sum()
    }

    /// A row in which all values are unknown; 0 where an attribute has no number for that.
    pub fn unknown_row(&self) -> Vec<u8> {
        let numbers = self.0.iter().flat_map(|attribute| {
            let zero = vec![0; attribute.number.width()];
            let number = attribute.unknown.clone().unwrap_or(zero);
            number.repeat(usize::from(attribute.components))
        });
        numbers.collect()
    }

    /// Each attribute with its place in a row.
    pub fn places(&self) -> impl Iterator<Item = (&Attribute, Range<usize>)> {
        self.0.iter().scan(0, |end, attribute| {
            let start = *end;
            *end += attribute.width();
            Some((attribute, start..*end))
        })
    }

    /// The attribute with this name and its place in a row, if there is one.
    pub fn find(&self, name: &str) -> Option<(&Attribute, Range<usize>)> {
        self.places().find(|(attribute, _)| attribute.name == name)
    }

    /// The column that `choice` names: the name of an attribute, with a colon and the number of a component
    /// from 1 if it has several; `red`, `green` and `blue` are components of `rgb`.
    ///
    /// # Errors
    /// A text about what there is instead.
    pub fn column(&self, choice: &str) -> Result<Column, String> {
        let (name, component) = self.component(choice);
        let Some((attribute, place)) = self.find(name) else {
            return Err(match self.names() {
                names if names.is_empty() => format!("points have no attribute \"{choice}\": they have none"),
                names => format!("points have no attribute \"{choice}\": they have {names}"),
            });
        };
        let count = usize::from(attribute.components);
        let component = match component {
            Some(component) if (1..=count).contains(&component) => component,
            None if count == 1 => 1,
            _ => {
                return Err(format!(
                    "\"{name}\" has {count} components: choose one of {name}:1 to {name}:{count}"
                ));
            }
        };
        let at = place.start + (component - 1) * attribute.number.width();
        Ok(Column { attribute: attribute.clone(), at, row_len: self.row_len() })
    }

    /// The name of an attribute and the number of a component in `choice`.
    fn component<'a>(&self, choice: &'a str) -> (&'a str, Option<usize>) {
        let colours = ["red", "green", "blue"];
        if self.find(choice).is_some() {
            return (choice, None);
        }
        if let Some(component) = colours.iter().position(|&colour| colour == choice) {
            return ("rgb", Some(component + 1));
        }
        match choice.rsplit_once(':').and_then(|(name, number)| Some((name, number.parse().ok()?))) {
            Some((name, component)) => (name, Some(component)),
            None => (choice, None),
        }
    }

    /// The names, for messages.
    pub fn names(&self) -> String {
        self.0.iter().map(|attribute| attribute.name.as_str()).collect::<Vec<_>>().join(", ")
    }
}

/// One number of each row.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    attribute: Attribute,
    at: usize,
    row_len: usize,
}

impl Column {
    /// Name and unit for a legend.
    pub fn label(&self) -> String {
        let Attribute { name, unit, .. } = &self.attribute;
        if unit.is_empty() { name.clone() } else { format!("{name} ({unit})") }
    }

    /// The value of the point with this number; NaN if it is unknown.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn of(&self, rows: &[u8], point: usize) -> f64 {
        let stored = &rows[point * self.row_len + self.at..][..self.attribute.number.width()];
        self.attribute.value(stored).unwrap_or(f64::NAN)
    }
}

impl<'a> IntoIterator for &'a Attributes {
    type Item = &'a Attribute;
    type IntoIter = std::slice::Iter<'a, Attribute>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_have_places() {
        let colour = Attribute { components: 3, ..Attribute::new("rgb", NumberType::U16) };
        let list = vec![Attribute::new("a", NumberType::U8), colour, Attribute::new("t", NumberType::F64)];
        let attributes = Attributes::new(list).expect("all rules hold");
        assert_eq!(attributes.row_len(), 15);
        assert_eq!(attributes.find("t").map(|(_, place)| place), Some(7..15));
        assert_eq!(attributes.names(), "a, rgb, t");
    }

    #[test]
    fn columns_are_chosen_by_name_and_component() {
        let colour = Attribute { components: 3, ..Attribute::new("rgb", NumberType::U16) };
        let list = vec![Attribute::new("a", NumberType::U8), colour];
        let attributes = Attributes::new(list).expect("all rules hold");
        let rows = [9, 1, 0, 2, 0, 3, 0, 8, 4, 0, 5, 0, 6, 0];
        let of = |choice: &str, point| attributes.column(choice).expect("a column").of(&rows, point);
        assert_eq!([of("a", 0), of("a", 1), of("a:1", 1)], [9.0, 8.0, 8.0]);
        assert_eq!([of("rgb:2", 0), of("green", 1), of("blue", 1)], [2.0, 5.0, 6.0]);
        let refused = |choice: &str| attributes.column(choice).expect_err("no column");
        assert!(refused("rgb").contains("choose one of rgb:1 to rgb:3"));
        assert!(refused("rgb:4").contains("3 components"));
        assert!(refused("b").contains("they have a, rgb"));
    }

    #[test]
    fn values_have_scales_and_may_be_unknown() {
        let angle = Attribute {
            scale: Some([0.5, 1.0]),
            unknown: Some(vec![0, 128]),
            ..Attribute::new("angle", NumberType::I16)
        };
        assert_eq!(angle.value(&[255, 255]), Some(0.5));
        assert_eq!(angle.value(&[0, 128]), None);
    }

    #[test]
    fn broken_rules_are_named() {
        let of = |attribute: Attribute| Attributes::new(vec![attribute]).expect_err("a broken rule");
        let plain = || Attribute::new("a", NumberType::U8);
        assert!(of(Attribute::new("", NumberType::U8)).contains("0 bytes"));
        assert!(of(Attribute::new("a\u{9b}", NumberType::U8)).contains("control characters"));
        assert!(of(Attribute { components: 0, ..plain() }).contains("no components"));
        assert!(of(Attribute { scale: Some([0.0, 1.0]), ..plain() }).contains("scale 0"));
        assert!(of(Attribute { unknown: Some(vec![0; 2]), ..plain() }).contains("another type"));
        let wide = |name: &str| Attribute { components: 255, ..Attribute::new(name, NumberType::F32) };
        assert!(Attributes::new(vec![wide("a"), wide("b")]).expect_err("too long").contains("2040 bytes"));
        assert!(Attributes::new(vec![plain(), plain()]).expect_err("one name").contains("two attributes"));
    }
}
