//! Reads mmCIF: the atoms of the category `_atom_site`.

use std::io::Read;
use std::ops::Range;

use crate::molecules::builder::{Oddity, Record, StructureBuilder, printable};
use crate::molecules::cif::{Token, Tokens};
use crate::molecules::decimal::Number;
use crate::molecules::mmcif_tables::{Column, Tables, column};
use crate::text::lines::Lines;
use crate::twin::tokens::unexpected;
use spmesh_base::error::{Error, Result, counted};

/// The items of `_atom_site` that are used, in the order of [`ITEMS`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Item {
    X,
    Y,
    Z,
    Group,
    Id,
    Symbol,
    AuthAtom,
    LabelAtom,
    Altloc,
    AuthResidue,
    LabelResidue,
    AuthChain,
    LabelChain,
    Entity,
    AuthNumber,
    LabelNumber,
    Insertion,
    Occupancy,
    Model,
}

const ITEMS: [(Item, &str); 19] = [
    (Item::X, "Cartn_x"),
    (Item::Y, "Cartn_y"),
    (Item::Z, "Cartn_z"),
    (Item::Group, "group_PDB"),
    (Item::Id, "id"),
    (Item::Symbol, "type_symbol"),
    (Item::AuthAtom, "auth_atom_id"),
    (Item::LabelAtom, "label_atom_id"),
    (Item::Altloc, "label_alt_id"),
    (Item::AuthResidue, "auth_comp_id"),
    (Item::LabelResidue, "label_comp_id"),
    (Item::AuthChain, "auth_asym_id"),
    (Item::LabelChain, "label_asym_id"),
    (Item::Entity, "label_entity_id"),
    (Item::AuthNumber, "auth_seq_id"),
    (Item::LabelNumber, "label_seq_id"),
    (Item::Insertion, "pdbx_PDB_ins_code"),
    (Item::Occupancy, "occupancy"),
    (Item::Model, "pdbx_PDB_model_num"),
];

/// Start of the tags of the category.
pub(crate) const CATEGORY: &[u8] = b"_atom_site.";

/// Reads the atoms of the first data block that has any.
pub(crate) fn read<R: Read>(lines: Lines<R>, builder: &mut StructureBuilder) -> Result<()> {
    let tokens = Tokens::new(lines)?;
    let (row, tables) = (Row::default(), Tables::default());
    MmcifReader { tokens, builder, row, tables, blocks: 0, state: Block::Empty, is_core: false }.read()
}

struct MmcifReader<'b, R> {
    tokens: Tokens<R>,
    builder: &'b mut StructureBuilder,
    row: Row,
    /// What the current data block states of its molecules.
    tables: Tables,
    /// Number of data blocks with atoms so far; only the first of them is read.
    blocks: u64,
    state: Block,
    /// Whether there are atoms in the tags of the core dictionary.
    is_core: bool,
}

/// Warns of data blocks with atoms, of which there are so many, behind the first.
pub(crate) fn finish(blocks: u64, builder: &mut StructureBuilder) {
    if blocks > 1 {
        let others = counted(blocks - 1, "more data block has", "more data blocks have");
        builder.warn(format!("{others} atoms; only those of the first are read"));
    }
}

/// The item of a name in the category, if it is used.
pub(crate) fn item_of(name: &[u8]) -> Option<Item> {
    let item = ITEMS.iter().find(|(_, item)| name.eq_ignore_ascii_case(item.as_bytes()));
    item.map(|&(item, _)| item)
}

/// The form of the atoms in the current data block so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Block {
    Empty,
    /// Items of a single atom, without a loop.
    Items,
    Loop,
}

/// The values stated for an atom.
#[derive(Debug, Default)]
pub(crate) struct Row {
    values: Vec<u8>,
    ranges: [Option<Range<usize>>; ITEMS.len()],
    place: [Option<Number>; 3],
}

impl<R: Read> MmcifReader<'_, R> {
    fn read(&mut self) -> Result<()> {
        loop {
            match self.tokens.token() {
                Token::Tag => self.read_item()?,
                Token::Loop => self.read_loop()?,
                Token::Save => {
                    self.tokens.advance()?;
                }
                Token::Data | Token::End => {
                    self.end_block()?;
                    if self.tokens.token() == Token::End {
                        break;
                    }
                    self.tokens.advance()?;
                }
                Token::Value | Token::Quoted => {
                    let error = unexpected(self.tokens.text(), "a tag: this value has none");
                    return Err(self.tokens.locate(error));
                }
            }
        }
        self.builder.end(self.tokens.unended());
        finish(self.blocks, self.builder);
        if self.blocks == 0 && self.is_core {
            return Err(Error::malformed(
                "found atoms in the words of the core dictionary (_atom_site_fract_x), expected mmCIF \
                 (_atom_site.Cartn_x): convert it first",
            ));
        }
        Ok(())
    }

    fn end_block(&mut self) -> Result<()> {
        let tables = std::mem::take(&mut self.tables);
        let state = std::mem::replace(&mut self.state, Block::Empty);
        if state == Block::Empty || self.blocks != 1 {
            return Ok(());
        }
        tables.give(self.builder);
        if state == Block::Items { self.finish_row() } else { Ok(()) }
    }

    /// Records that the block has atoms. Returns whether to read them.
    fn enter(&mut self, state: Block) -> Result<bool> {
        match self.state {
            Block::Empty => self.blocks += 1,
            Block::Items if state == Block::Items => {}
            _ => {
                let error = Error::malformed("the data block has _atom_site a second time");
                return Err(self.tokens.locate(error));
            }
        }
        self.state = state;
        Ok(self.blocks == 1)
    }

    /// Reads a tag and its value.
    fn read_item(&mut self) -> Result<()> {
        let item = self.item();
        let column = column(self.tokens.text());
        let is_wanted = item.is_some() && self.enter(Block::Items)?;
        if !matches!(self.tokens.advance()?, Token::Value | Token::Quoted) {
            return Err(self.tokens.locate(Error::malformed("the tag before has no value")));
        }
        if let Some(Some(item)) = item
            && is_wanted
        {
            self.take(item)?;
        }
        if let Some(column) = column {
            self.take_of_table(column);
        }
        self.tokens.advance().map(drop)
    }

    /// The item of the current tag: `None` if it is of another category, `Some(None)` if the item is not
    /// used.
    fn item(&mut self) -> Option<Option<Item>> {
        let tag = self.tokens.text();
        let (category, name) = tag.split_at_checked(CATEGORY.len())?;
        if !category.eq_ignore_ascii_case(CATEGORY) {
            self.is_core |= category.eq_ignore_ascii_case(b"_atom_site_");
            return None;
        }
        Some(item_of(name))
    }

    fn read_loop(&mut self) -> Result<()> {
        let (mut columns, mut table) = (Vec::new(), Vec::new());
        let mut is_wanted = false;
        while self.tokens.advance()? == Token::Tag {
            let item = self.item();
            if columns.is_empty() && item.is_some() {
                is_wanted = self.enter(Block::Loop)?;
            }
            if let Some(Some(item)) = item
                && columns.contains(&Some(item))
            {
                return Err(self.tokens.locate(Error::malformed("the loop has this tag a second time")));
            }
            columns.push(item.flatten());
            table.push(column(self.tokens.text()));
        }
        if columns.is_empty() {
            return Err(self.tokens.locate(Error::malformed("loop_ without tags")));
        }
        if is_wanted {
            for (item, name) in &ITEMS[..3] {
                if !columns.contains(&Some(*item)) {
                    let error = Error::malformed(format!("the loop of _atom_site has no tag {name}"));
                    return Err(self.tokens.locate(error));
                }
            }
            return self.read_rows(&columns);
        }
        if let Some(&first) = table.iter().flatten().next() {
            return self.read_table(&table, first);
        }
        while matches!(self.tokens.token(), Token::Value | Token::Quoted) {
            self.tokens.advance()?;
        }
        Ok(())
    }

    /// Reads the rows of a category of the tables.
    fn read_table(&mut self, columns: &[Option<Column>], first: Column) -> Result<()> {
        for index in (0..columns.len()).cycle() {
            if !matches!(self.tokens.token(), Token::Value | Token::Quoted) {
                break;
            }
            if index == 0 {
                self.tables.start_row(first);
            }
            if let Some(column) = columns[index] {
                self.take_of_table(column);
            }
            self.tokens.advance()?;
        }
        Ok(())
    }

    /// Stores the current value in the tables.
    fn take_of_table(&mut self, column: Column) {
        let value = self.tokens.text();
        if self.tokens.token() == Token::Quoted || !matches!(value, b"?" | b".") {
            self.tables.set(column, value);
        }
    }

    fn read_rows(&mut self, columns: &[Option<Item>]) -> Result<()> {
        while matches!(self.tokens.token(), Token::Value | Token::Quoted) {
            for (index, column) in columns.iter().enumerate() {
                if !matches!(self.tokens.token(), Token::Value | Token::Quoted) {
                    let error = format!("the row of an atom ends after {index} of {} values", columns.len());
                    return Err(self.tokens.locate(Error::malformed(error)));
                }
                if let Some(item) = *column {
                    self.take(item)?;
                }
                if index + 1 == columns.len() {
                    self.finish_row()?;
                }
                self.tokens.advance()?;
            }
        }
        Ok(())
    }

    /// Stores the current value in the row.
    fn take(&mut self, item: Item) -> Result<()> {
        let value = self.tokens.text();
        let is_stated = self.tokens.token() == Token::Quoted || !matches!(value, b"?" | b".");
        if let Item::X | Item::Y | Item::Z = item {
            let number = is_stated.then(|| Number::parse(without_uncertainty(value))).flatten();
            let Some(number) = number else {
                let expected = format!("a number for {}", ITEMS[item as usize].1);
                return Err(self.tokens.locate(unexpected(value, &expected)));
            };
            self.row.set_place(item, Some(number));
        } else if is_stated {
            self.row.set(item, value);
        }
        Ok(())
    }

    /// Makes an atom of the row, and clears the row.
    fn finish_row(&mut self) -> Result<()> {
        let result = self.row.push_to(self.builder, self.tokens.line());
        self.row.clear();
        result.map_err(|e| self.tokens.locate(e))
    }
}

impl Row {
    /// Sets a coordinate.
    pub(crate) fn set_place(&mut self, item: Item, number: Option<Number>) {
        self.place[item as usize] = number;
    }

    /// Sets an item that is no coordinate.
    pub(crate) fn set(&mut self, item: Item, value: &[u8]) {
        let start = self.values.len();
        self.values.extend_from_slice(value);
        self.ranges[item as usize] = Some(start..self.values.len());
    }

    pub(crate) fn clear(&mut self) {
        self.values.clear();
        self.ranges = Default::default();
        self.place = [None; 3];
    }

    fn value(&self, item: Item) -> Option<&[u8]> {
        self.ranges[item as usize].clone().map(|range| &self.values[range])
    }

    /// The text of the first of these items that is stated.
    fn text(&self, items: [Item; 2]) -> Result<&str> {
        match items.into_iter().find_map(|item| Some((item, self.value(item)?))) {
            Some((item, value)) => printable(value, ITEMS[item as usize].1),
            None => Ok(""),
        }
    }

    /// Makes an atom of the row, which is in this line of the file.
    pub(crate) fn push_to(&self, builder: &mut StructureBuilder, line: u64) -> Result<()> {
        let [Some(x), Some(y), Some(z)] = self.place else {
            return Err(Error::malformed("the atom has no Cartn_x, Cartn_y or Cartn_z"));
        };
        let model = self.value(Item::Model).map(parse::<i64>);
        match model {
            Some(Some(number)) => builder.resume_model(number),
            Some(None) => builder.note(Oddity::Model, line),
            None => {}
        }
        let serial = self.value(Item::Id).and_then(parse::<u64>);
        if serial.is_none() {
            builder.note(Oddity::Serial, line);
        }
        let number = self.value(Item::AuthNumber).or(self.value(Item::LabelNumber));
        let residue_number = number.and_then(parse::<i32>);
        if residue_number.is_none() && number.is_some() {
            builder.note(Oddity::ResidueNumber, line);
        }
        let occupancy = self.value(Item::Occupancy).map(|value| parse::<f32>(without_uncertainty(value)));
        let share = occupancy.flatten().filter(|share| share.is_finite());
        if share.is_none() && occupancy.is_some() {
            builder.note(Oddity::Occupancy, line);
        }
        builder.push(&Record {
            line,
            serial,
            name: self.text([Item::AuthAtom, Item::LabelAtom])?,
            element: self.text([Item::Symbol; 2])?,
            altloc: self.text([Item::Altloc; 2])?,
            chain: self.text([Item::AuthChain, Item::LabelChain])?,
            subchain: self.text([Item::LabelChain, Item::AuthChain])?,
            entity: self.text([Item::Entity; 2])?,
            segment: "",
            residue_name: self.text([Item::AuthResidue, Item::LabelResidue])?,
            residue_number,
            insertion_code: self.text([Item::Insertion; 2])?,
            occupancy: share.unwrap_or(1.0),
            is_hetatm: self.value(Item::Group).is_some_and(|group| group.eq_ignore_ascii_case(b"HETATM")),
            symbol_len: 0,
            place: [x, y, z],
            radius: None,
        })
    }
}

pub(crate) fn parse<T: std::str::FromStr>(value: &[u8]) -> Option<T> {
    std::str::from_utf8(value).ok()?.parse().ok()
}

/// A number without its standard uncertainty: `12.34` of `12.34(5)`.
pub(crate) fn without_uncertainty(value: &[u8]) -> &[u8] {
    let Some(inner) = value.strip_suffix(b")") else { return value };
    let digits = inner.iter().rev().take_while(|byte| byte.is_ascii_digit()).count();
    match &inner[..inner.len() - digits] {
        [number @ .., b'('] if digits > 0 => number,
        _ => value,
    }
}
