//! Short texts stored once each: atoms are many, and their names are few.

use std::collections::HashMap;

use foldhash::fast::FixedState;

/// A text of a [`Names`] table. [`Name::EMPTY`] is the empty text in every table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Name(u32);

impl Name {
    /// The empty text.
    pub const EMPTY: Name = Name(0);

    /// Whether the text is empty: not stated by the input.
    pub fn is_empty(self) -> bool {
        self == Name::EMPTY
    }
}

/// Length in bytes up to which texts are looked up as integers.
const SHORT_MAX: usize = 7;

/// A table of texts, each stored once.
#[derive(Debug, Clone)]
pub struct Names {
    texts: Vec<Box<str>>,
    /// Nearly all texts have only a few bytes, and integers are compared faster than texts.
    by_number: HashMap<u64, Name, FixedState>,
    by_text: HashMap<Box<str>, Name, FixedState>,
}

impl Default for Names {
    fn default() -> Self {
        Names { texts: vec!["".into()], by_number: HashMap::default(), by_text: HashMap::default() }
    }
}

impl Names {
    /// The name of `text`, which is added to the table if necessary.
    pub fn intern(&mut self, text: &str) -> Name {
        if let Some(name) = self.find(text) {
            return name;
        }
        let name = Name(u32::try_from(self.texts.len()).expect("fewer than 2^32 different names"));
        self.texts.push(text.into());
        match short(text) {
            Some(number) => self.by_number.insert(number, name),
            None => self.by_text.insert(text.into(), name),
        };
        name
    }

    /// The name of `text`, if the table has it.
    pub fn find(&self, text: &str) -> Option<Name> {
        match short(text) {
            // Many fields are empty.
            _ if text.is_empty() => Some(Name::EMPTY),
            Some(number) => self.by_number.get(&number).copied(),
            None => self.by_text.get(text).copied(),
        }
    }

    /// The text of a name of this table.
    pub fn text(&self, name: Name) -> &str {
        &self.texts[name.0 as usize]
    }
}

/// The bytes of a short text as base-256 digits after a leading 1, which distinguishes texts of different
/// lengths.
fn short(text: &str) -> Option<u64> {
    (text.len() <= SHORT_MAX).then(|| text.bytes().fold(1, |number, byte| number << 8 | u64::from(byte)))
}
