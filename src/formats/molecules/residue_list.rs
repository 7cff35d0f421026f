//! Lists of residues as users write them: `A:10-25,B/ATP`.

use std::fmt;
use std::str::FromStr;

use crate::molecules::model::{Residue, Structure};
use spmesh_base::error::Result;

/// Residues by chain, number and name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ResidueList {
    items: Vec<Item>,
}

/// One of the items between commas: `CHAIN:FROM-TO/NAME`, of which parts may be left out.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Item {
    text: String,
    chain: Option<String>,
    numbers: Option<Numbers>,
    name: Option<String>,
}

/// Numbers of residues, the last included. One number has the insertion code that is given, or any.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Numbers {
    first: i32,
    last: i32,
    code: Option<String>,
}

impl ResidueList {
    /// For each residue of a structure whether it is in the list.
    ///
    /// # Errors
    /// Usage, if an item names none.
    pub fn members(&self, structure: &Structure) -> Result<Vec<bool>> {
        let mut members = vec![false; structure.residues.len()];
        for item in &self.items {
            let mut is_found = false;
            for (member, residue) in members.iter_mut().zip(&structure.residues) {
                let is_named = item.names(residue, structure);
                *member |= is_named;
                is_found |= is_named;
            }
            if !is_found {
                let chains = structure.chains().into_iter().map(str::to_string);
                return Err(structure.lacks(
                    "residue",
                    &item.text,
                    chains.map(|chain| format!("chain {chain}")),
                ));
            }
        }
        Ok(members)
    }
}

impl Item {
    fn names(&self, residue: &Residue, structure: &Structure) -> bool {
        let text = |name| structure.names.text(name);
        let has_number = |numbers: &Numbers| {
            residue.number.is_some_and(|number| (numbers.first..=numbers.last).contains(&number))
                && numbers.code.as_ref().is_none_or(|code| text(residue.insertion_code) == code)
        };
        self.chain.as_ref().is_none_or(|chain| text(residue.chain) == chain)
            && self.numbers.as_ref().is_none_or(has_number)
            && self.name.as_ref().is_none_or(|name| text(residue.name).eq_ignore_ascii_case(name))
    }
}

impl FromStr for ResidueList {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<ResidueList, String> {
        let items = text.split(',').map(item).collect::<std::result::Result<_, _>>()?;
        Ok(ResidueList { items })
    }
}

impl fmt::Display for ResidueList {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let texts: Vec<&str> = self.items.iter().map(|item| &item.text[..]).collect();
        f.write_str(&texts.join(","))
    }
}

fn item(text: &str) -> std::result::Result<Item, String> {
    let error = || {
        format!(
            "{text:?} names no residues: expected CHAIN, CHAIN:NUMBER, CHAIN:FROM-TO, or /NAME behind one of these"
        )
    };
    let (place, name) = text.split_once('/').map_or((text, None), |(place, name)| (place, Some(name)));
    let (chain, range) = place.split_once(':').map_or((place, None), |(chain, range)| (chain, Some(range)));
    let is_empty = chain.is_empty() && range.is_none() && name.is_none();
    if is_empty || range == Some("") || name == Some("") {
        return Err(error());
    }
    Ok(Item {
        text: text.to_string(),
        chain: Some(chain).filter(|chain| !chain.is_empty()).map(str::to_string),
        numbers: range.map(|range| numbers(range).ok_or_else(error)).transpose()?,
        name: name.map(str::to_string),
    })
}

/// `10-25`, `-5--1`, `82` or `82A`.
fn numbers(text: &str) -> Option<Numbers> {
    // A minus at the start is that of the number.
    let middle = text.char_indices().skip(1).find(|&(_, letter)| letter == '-').map(|(at, _)| at);
    if let Some(at) = middle {
        let (first, last) = (text[..at].parse().ok()?, text[at + 1..].parse().ok()?);
        return (first <= last).then_some(Numbers { first, last, code: None });
    }
    let digits = text.trim_end_matches(|letter: char| letter.is_ascii_alphabetic());
    let first = digits.parse().ok()?;
    let code = Some(text[digits.len()..].to_string()).filter(|code| !code.is_empty());
    Some(Numbers { first, last: first, code })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_have_chains_numbers_and_names() {
        let numbers = |first, last, code: &str| {
            Some(Numbers { first, last, code: Some(code.to_string()).filter(|code| !code.is_empty()) })
        };
        for (text, chain, expected, name) in [
            ("A", "A", None, ""),
            ("A:10", "A", numbers(10, 10, ""), ""),
            ("A:10-25", "A", numbers(10, 25, ""), ""),
            ("A:-5--1", "A", numbers(-5, -1, ""), ""),
            (":-5", "", numbers(-5, -5, ""), ""),
            ("H:82A", "H", numbers(82, 82, "A"), ""),
            ("B/ATP", "B", None, "ATP"),
            ("/HEM", "", None, "HEM"),
            ("A-2:7/MG", "A-2", numbers(7, 7, ""), "MG"),
        ] {
            let item = item(text).unwrap();
            assert_eq!(item.chain.as_deref().unwrap_or(""), chain, "{text}");
            assert_eq!(item.numbers, expected, "{text}");
            assert_eq!(item.name.as_deref().unwrap_or(""), name, "{text}");
        }
        for wrong in ["", ":", "A:", "A/", "A:x", "A:5-", "A:9-5", "A:1-2B", ":99999999999"] {
            assert!(wrong.parse::<ResidueList>().is_err(), "{wrong}");
        }
        assert!("A,,B".parse::<ResidueList>().is_err());
    }
}
