//! How the rows of an input's points are made of the records of a file.

use spmesh_base::error::{Error, Result};
use spmesh_stream::model::attributes::{Attribute, Attributes};

/// Where the numbers of an attribute are in a record of the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Field {
    /// These bytes, as they are.
    Bytes { at: usize, len: usize },
    /// Some bits of one byte: `byte >> shift & mask`.
    Bits { at: usize, shift: u8, mask: u8 },
}

/// An attribute that a file has.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Offer {
    pub(crate) attribute: Attribute,
    pub(crate) field: Field,
}

/// Attributes whose rows are records as they are.
pub(crate) fn offers_of<'a>(attributes: impl IntoIterator<Item = &'a Attribute>) -> Vec<Offer> {
    let mut at = 0;
    let offer = |attribute: &Attribute| {
        let len = attribute.width();
        at += len;
        Offer { attribute: attribute.clone(), field: Field::Bytes { at: at - len, len } }
    };
    attributes.into_iter().map(offer).collect()
}

/// The fields of a row, in their order.
#[derive(Debug, Clone, Default)]
pub(crate) struct RowPlan(Vec<Field>);

impl RowPlan {
    /// Whether points have no rows.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether a row has the field that starts at this byte of a record.
    pub(crate) fn uses(&self, start: usize) -> bool {
        self.0.iter().any(|field| matches!(*field, Field::Bytes { at, .. } if at == start))
    }

    /// Appends the row of a record.
    #[inline]
    pub(crate) fn append(&self, record: &[u8], rows: &mut Vec<u8>) {
        for field in &self.0 {
            match *field {
                Field::Bytes { at, len } => rows.extend_from_slice(&record[at..at + len]),
                Field::Bits { at, shift, mask } => rows.push(record[at] >> shift & mask),
            }
        }
    }
}

/// Which attributes of the files points carry.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum AttributeChoice {
    /// None.
    #[default]
    None,
    /// Those that all files have.
    All,
    /// Those of these names, in this order.
    Named(Vec<String>),
    /// Those of these names that all files have, with the same type.
    Offered(Vec<String>),
}

impl AttributeChoice {
    /// The choice that a list on the command line stands for: nothing, `all`, or names.
    pub fn of_names(names: &[String]) -> Self {
        match names {
            [] => AttributeChoice::None,
            [all] if all == "all" => AttributeChoice::All,
            names => AttributeChoice::Named(names.to_vec()),
        }
    }
}

/// The attributes that the points of all files have, and a plan for each file. A notice names what `All` leaves
/// out.
pub(crate) fn choose(
    choice: &AttributeChoice,
    files: &[(&str, &[Offer])],
    notices: &mut Vec<String>,
) -> Result<(Attributes, Vec<RowPlan>)> {
    let names = match choice {
        AttributeChoice::None => Vec::new(),
        AttributeChoice::Named(names) => names.clone(),
        AttributeChoice::All => common_names(files, notices),
        AttributeChoice::Offered(names) => {
            let is_offered = |name: &&String| {
                files.iter().all(|(_, offers)| find(offers, name).is_some())
                    && check_same(name, files).is_ok()
            };
            names.iter().filter(is_offered).cloned().collect()
        }
    };
    let mut attributes: Vec<Attribute> = Vec::with_capacity(names.len());
    let mut plans = vec![RowPlan::default(); files.len()];
    for name in &names {
        for (plan, &(file, offers)) in plans.iter_mut().zip(files) {
            let Some(offer) = find(offers, name) else { return Err(lacks(file, name, offers)) };
            plan.0.push(offer.field.clone());
        }
        attributes
            .extend(files.first().and_then(|(_, offers)| find(offers, name)).map(|o| o.attribute.clone()));
        check_same(name, files)?;
    }
    let attributes = Attributes::new(attributes).map_err(Error::usage)?;
    Ok((attributes, plans))
}

fn find<'a>(offers: &'a [Offer], name: &str) -> Option<&'a Offer> {
    offers.iter().find(|offer| offer.attribute.name == name)
}

/// The names that all files have, in the order of the first.
fn common_names(files: &[(&str, &[Offer])], notices: &mut Vec<String>) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for offer in files.iter().flat_map(|(_, offers)| *offers) {
        let name = &offer.attribute.name;
        if !names.contains(name) {
            names.push(name.clone());
        }
    }
    names.retain(|name| {
        let without = files.iter().find(|(_, offers)| find(offers, name).is_none());
        notices.extend(without.map(|(file, _)| format!("{file} has no attribute {name}, which is left out")));
        without.is_none()
    });
    names
}

/// Checks that all files state the same about an attribute that they have.
fn check_same(name: &str, files: &[(&str, &[Offer])]) -> Result<()> {
    let stated: Vec<_> =
        files.iter().filter_map(|(file, offers)| Some((file, find(offers, name)?))).collect();
    let Some((first, of_first)) = stated.first() else { return Ok(()) };
    match stated.iter().find(|(_, offer)| offer.attribute != of_first.attribute) {
        None => Ok(()),
        Some((file, _)) => Err(Error::usage(format!(
            "{first} and {file} state another type, scale or unit of the attribute {name}: leave it out, or \
             finalize them one by one"
        ))),
    }
}

fn lacks(file: &str, name: &str, offers: &[Offer]) -> Error {
    let names: Vec<&str> = offers.iter().map(|offer| offer.attribute.name.as_str()).collect();
    let has = if names.is_empty() { "no attributes".to_string() } else { names.join(", ") };
    Error::usage(format!("no attribute \"{name}\" (--attributes): the file has {has}")).of_input(file)
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_stream::model::attributes::NumberType;

    fn offer(name: &str, number: NumberType, at: usize) -> Offer {
        let attribute = Attribute::new(name, number);
        Offer { field: Field::Bytes { at, len: attribute.width() }, attribute }
    }

    #[test]
    fn rows_are_made_of_fields() {
        let flags = Offer {
            attribute: Attribute::new("flags", NumberType::U8),
            field: Field::Bits { at: 0, shift: 5, mask: 3 },
        };
        let (a, b) = ([offer("a", NumberType::U16, 1), flags], [offer("a", NumberType::U16, 0)]);
        let named =
            |names: &[&str]| AttributeChoice::Named(names.iter().map(|name| name.to_string()).collect());
        let (_, plans) = choose(&named(&["flags", "a"]), &[("x", &a)], &mut Vec::new()).expect("it has both");
        let mut rows = Vec::new();
        plans[0].append(&[0xdf, 1, 2], &mut rows);
        assert_eq!(rows, [2, 1, 2]);
        let mut notices = Vec::new();
        let (all, _) = choose(&AttributeChoice::All, &[("x", &a), ("y", &b)], &mut notices).expect("all");
        assert_eq!((all.names().as_str(), notices.len()), ("a", 1));
        let error =
            choose(&named(&["flags"]), &[("x", &a), ("y", &b)], &mut notices).expect_err("y lacks it");
        assert!(error.to_string().contains("y: no attribute \"flags\""), "{error}");
        let other = [offer("a", NumberType::I16, 0)];
        let error = choose(&named(&["a"]), &[("x", &a), ("z", &other)], &mut notices).expect_err("types");
        assert!(error.to_string().contains("another type"), "{error}");
        let offered = AttributeChoice::Offered(["flags", "a", "b"].map(str::to_string).to_vec());
        let of =
            |files: &[(&str, &[Offer])]| choose(&offered, files, &mut Vec::new()).expect("a plan").0.names();
        assert_eq!(of(&[("x", &a)]), "flags, a");
        assert_eq!(of(&[("x", &a), ("y", &b)]), "a");
        assert_eq!(of(&[("x", &a), ("z", &other)]), "");
    }
}
