//! The header lines of a text twin.

use crate::twin::rows::parse_attribute;
use crate::twin::tokens::{expect_no_field, fields, next_field, parse_decimals, parse_integer, unexpected};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::attributes::{Attribute, Attributes};
use spmesh_stream::model::bounds::{Bounds, Region};
use spmesh_stream::model::cells::CellTree;
use spmesh_stream::{
    Constrained, Coordinates, Crs, Header, Kind, PartName, VERSION, Weighted, check_version,
};

/// The header as stated by the lines so far.
#[derive(Default)]
pub(crate) struct TwinHeader {
    seen: Vec<Vec<u8>>,
    kind: Option<Kind>,
    is_i32: bool,
    scale: Option<[f64; 3]>,
    offset: Option<[f64; 3]>,
    dims: Option<u8>,
    has_elevation: Option<bool>,
    bounds: Option<[f64; 6]>,
    points: Option<u64>,
    tree: Option<(u8, [f64; 4])>,
    region: Option<Vec<f64>>,
    chunked: bool,
    crs: Crs,
    attributes: Vec<Attribute>,
    constrained: Option<Constrained>,
    weighted: Option<Weighted>,
    part: Option<PartName>,
    producer: String,
}

impl TwinHeader {
    /// Takes the part of a header line after `#spmesh`.
    pub(crate) fn line(&mut self, line: &[u8]) -> Result<()> {
        let key = fields(line).next().unwrap_or_default().to_vec();
        let rest = line[line.windows(key.len().max(1)).position(|w| w == key).unwrap_or(0) + key.len()..]
            .trim_ascii();
        if self.seen.is_empty() != (key == b"version") {
            let message = format!("the header must start with one line \"#spmesh version {VERSION}\"");
            return Err(Error::malformed(message));
        }
        if key == b"attribute" {
            self.attributes.push(parse_attribute(rest)?);
            return Ok(());
        }
        if self.seen.contains(&key) {
            return Err(Error::malformed("the header says this twice"));
        }
        let mut values = fields(rest);
        match &key[..] {
            b"version" => check_version(only(parse_integer(next_field(&mut values)?)?, values)?)?,
            b"kind" => {
                let kind = std::str::from_utf8(rest).ok().and_then(Kind::from_name);
                self.kind = Some(kind.ok_or_else(|| unexpected(rest, "a kind of stream"))?);
            }
            b"coordinates" => self.is_i32 = expect_word(rest, &[("f64", false), ("i32", true)])?,
            b"scale" => self.scale = Some(only(parse_decimals(&mut values)?, values)?),
            b"offset" => self.offset = Some(only(parse_decimals(&mut values)?, values)?),
            b"dims" => self.dims = Some(expect_word(rest, &[("2", 2), ("3", 3), ("4", 4)])?),
            b"elevation" => self.has_elevation = Some(expect_word(rest, &YES_NO)?),
            b"bounds" => self.bounds = Some(only(parse_decimals(&mut values)?, values)?),
            b"points" => self.points = Some(only(parse_integer(next_field(&mut values)?)?, values)?),
            b"tree" => {
                let depth = parse_integer(next_field(&mut values)?)?;
                let depth = u8::try_from(depth).map_err(|_| Error::malformed("the tree is too deep"))?;
                self.tree = Some((depth, only(parse_decimals(&mut values)?, values)?));
            }
            b"region" => self.region = Some(parse_region(rest)?),
            b"chunked" => self.chunked = expect_word(rest, &YES_NO)?,
            b"wkt" => self.crs = Crs::Wkt(parse_string(rest)?),
            b"geokeys" => self.crs = only(parse_geo_keys(&mut values)?, values)?,
            b"constrained" => self.constrained = Some(parse_constrained(&mut values)?),
            b"weighted" => {
                let [greatest] = only(parse_decimals(&mut values)?, values)?;
                self.weighted = Some(Weighted { greatest });
            }
            b"part" => {
                let node = parse_integer(next_field(&mut values)?)?;
                let below = parse_integer(next_field(&mut values)?)?;
                let below = u32::try_from(below)
                    .map_err(|_| Error::malformed("the parts below have no number of 32 bits"))?;
                self.part = Some(only(PartName { node, below }, values)?);
            }
            b"producer" => self.producer = parse_string(rest)?,
            _ => return Err(unexpected(&key, "a statement of the header")),
        }
        self.seen.push(key);
        Ok(())
    }

    /// The header made of the lines.
    pub(crate) fn finish(self) -> Result<Header> {
        let missing = |what: &str| Error::malformed(format!("the header does not say the {what}"));
        let kind = self.kind.ok_or_else(|| missing("kind"))?;
        if !self.seen.iter().any(|key| key == b"coordinates") {
            return Err(missing("coordinates"));
        }
        let coordinates = match (self.is_i32, self.scale, self.offset) {
            (false, None, None) => Coordinates::F64,
            (true, Some(scale), Some(offset)) => Coordinates::I32 { scale, offset },
            _ => {
                return Err(Error::malformed("scale and offset go with i32 coordinates, and only with them"));
            }
        };
        let dims = self.dims.ok_or_else(|| missing("dims"))?;
        let tree = self.tree.map(|(depth, [x, y, z, side])| {
            CellTree::new(dims, depth, [x, y, z], side)
                .ok_or_else(|| Error::malformed("the finalization tree is out of range or not exact"))
        });
        let header = Header {
            kind,
            coordinates,
            dims,
            has_elevation: self.has_elevation.ok_or_else(|| missing("elevation"))?,
            bounds: self.bounds.map(|[a, b, c, d, e, f]| Bounds { min: [a, b, c], max: [d, e, f] }),
            points: self.points,
            tree: tree.transpose()?,
            region: self.region.map(|sides| region_of(&sides, dims)).transpose()?,
            chunked: self.chunked,
            compressed: false,
            crs: self.crs,
            attributes: Attributes::new(self.attributes).map_err(Error::malformed)?,
            constrained: self.constrained,
            weighted: self.weighted,
            part: self.part,
            producer: self.producer,
        };
        header.check().map_err(Error::malformed)?;
        Ok(header)
    }
}

const YES_NO: [(&str, bool); 2] = [("yes", true), ("no", false)];

fn expect_word<T: Copy>(word: &[u8], words: &[(&str, T)]) -> Result<T> {
    let found = words.iter().find(|(name, _)| name.as_bytes() == word);
    found.map(|&(_, value)| value).ok_or_else(|| {
        let names: Vec<&str> = words.iter().map(|&(name, _)| name).collect();
        unexpected(word, &names.join(" or "))
    })
}

/// `value`, if the line has no field left.
fn only<'a, T>(value: T, mut rest: impl Iterator<Item = &'a [u8]>) -> Result<T> {
    expect_no_field(&mut rest)?;
    Ok(value)
}

/// Four or six numbers, possibly infinite.
fn parse_region(text: &[u8]) -> Result<Vec<f64>> {
    let numbers = fields(text).map(|field| std::str::from_utf8(field).ok()?.parse::<f64>().ok());
    let sides: Option<Vec<f64>> = numbers.collect();
    sides.filter(|sides| matches!(sides.len(), 4 | 6)).ok_or_else(|| unexpected(text, "four or six numbers"))
}

/// The region of these sides: first the lower sides, then the upper sides.
fn region_of(sides: &[f64], dims: u8) -> Result<Region<3>> {
    if sides.len() != 2 * usize::from(dims) {
        let message = format!("a region of {} numbers in {dims} dimensions", sides.len());
        return Err(Error::malformed(message));
    }
    let (lower, upper) = sides.split_at(sides.len() / 2);
    Ok(Region::of_sides(lower, upper))
}

/// Whether the border is cut, and the kill length.
fn parse_constrained<'a>(values: &mut impl Iterator<Item = &'a [u8]>) -> Result<Constrained> {
    let is_cut = expect_word(next_field(values)?, &YES_NO)?;
    let [kill] = parse_decimals(values)?;
    only(Constrained { is_cut, kill }, values)
}

fn parse_string(text: &[u8]) -> Result<String> {
    serde_json::from_slice(text).map_err(|_| unexpected(text, "a JSON string"))
}

fn parse_geo_keys<'a>(values: &mut impl Iterator<Item = &'a [u8]>) -> Result<Crs> {
    let mut record = || parse_hex(next_field(values)?);
    Ok(Crs::GeoKeys { directory: record()?, doubles: record()?, ascii: record()? })
}

fn parse_hex(field: &[u8]) -> Result<Vec<u8>> {
    let digit = |byte: u8| (byte as char).to_digit(16).map(|digit| digit as u8);
    let pairs = field.chunks(2).map(|pair| match *pair {
        [high, low] => Some(digit(high)? << 4 | digit(low)?),
        _ => None,
    });
    let bytes: Option<Vec<u8>> = if field == b"-" { Some(Vec::new()) } else { pairs.collect() };
    bytes.ok_or_else(|| unexpected(field, "pairs of hexadecimal digits, or -"))
}
