//! Recognizes text formats by a line that no other format has.

use crate::detect::Format;
use crate::molecules::pqr::is_pqr;

/// Record names of PDB except ATOM and HETATM: words that rarely start a line of another text.
const PDB_RECORDS: [&[u8]; 22] = [
    b"HEADER", b"OBSLTE", b"COMPND", b"SOURCE", b"KEYWDS", b"EXPDTA", b"NUMMDL", b"AUTHOR", b"REVDAT",
    b"SPRSDE", b"JRNL", b"REMARK", b"DBREF", b"SEQADV", b"SEQRES", b"MODRES", b"HETNAM", b"FORMUL",
    b"SSBOND", b"CRYST1", b"ORIGX1", b"MODEL",
];

/// First words of OFF files with one three-dimensional vertex per line, whatever follows it.
const OFF_KINDS: [&[u8]; 8] =
    [b"OFF", b"COFF", b"NOFF", b"CNOFF", b"STOFF", b"STCOFF", b"STNOFF", b"STCNOFF"];

/// Whether the word starts an OFF file.
pub(crate) fn is_off(word: &[u8]) -> bool {
    OFF_KINDS.contains(&word)
}

/// The format of a text.
pub(super) fn detect(head: &[u8]) -> Format {
    let mut lines = head.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii_end);
    if is_xyz(lines.clone()) {
        return Format::Xyz;
    }
    if is_pqr(lines.clone()) {
        return Format::Pqr;
    }
    let mut seen = Seen::default();
    lines.find_map(|line| seen.by_line(line)).unwrap_or_else(|| seen.without_proof())
}

/// Which lines that several formats share were seen.
#[derive(Default)]
struct Seen {
    vertex: bool,
    face: bool,
    /// Objects, groups or smoothing: OBJ if there are vertices too.
    group: bool,
    bounds: bool,
    number: bool,
}

impl Seen {
    /// Notes a line. Returns the format if the lines so far prove one.
    fn by_line(&mut self, line: &[u8]) -> Option<Format> {
        let mut fields = words(line);
        let word = fields.next()?;
        let second = fields.next().unwrap_or_default();
        if let Some(format) = of_molecule(line, word) {
            return Some(format);
        }
        if is_off(word) {
            return Some(Format::Off);
        }
        self.number |= !word.starts_with(b"#") && is_coordinate(line);
        match (word, second) {
            (b"#", b"nverts" | b"nfaces" | b"SMA") => return Some(Format::Sma),
            (b"#", b"npoints" | b"datatype" | b"finalizemethod" | b"SPA") => return Some(Format::Spa),
            (b"#", b"OBJ") => return Some(Format::Obj),
            (b"#", field) => self.bounds |= field.starts_with(b"bb_min") || field.starts_with(b"bb_max"),
            (b"x", b"cell") => return Some(Format::Spa),
            (b"x", _) if is_integer(second) && fields.next().is_none() => return Some(Format::Sma),
            (b"p", _) if !self.vertex && is_number(second) => return Some(Format::Spa),
            (b"v", _) => self.vertex |= is_number(second),
            (b"f", _) if second.contains(&b'/') => return Some(Format::Obj),
            (b"f", _) if is_integer(second) && !self.vertex => return Some(Format::Sma),
            (b"f", _) => self.face |= is_integer(second),
            (b"vn" | b"vt", _) if is_number(second) => return Some(Format::Obj),
            (b"mtllib" | b"usemtl", _) => return Some(Format::Obj),
            (b"o" | b"g" | b"s", _) => self.group = true,
            _ => {}
        }
        (self.vertex && self.group).then_some(Format::Obj)
    }

    /// The format if no line decided it.
    fn without_proof(&self) -> Format {
        match self {
            Seen { vertex: true, face: true, bounds: true, .. } => Format::Sma,
            Seen { bounds: true, number, .. } if self.vertex || !number => Format::Spa,
            Seen { vertex: true, .. } => Format::VertexLines,
            Seen { number: true, .. } => Format::Text,
            _ => Format::OtherText,
        }
    }
}

fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// Columns of a PDB line up to the last coordinate.
const PDB_PLACE_LEN: usize = 54;

/// PDB or mmCIF, if the line proves one of them. Names of columns in a text of points can be the same words.
fn of_molecule(line: &[u8], word: &[u8]) -> Option<Format> {
    let starts_with = |start: &[u8]| word.get(..start.len()).is_some_and(|w| w.eq_ignore_ascii_case(start));
    let second = words(line).nth(1).unwrap_or_default();
    let is_alone = second.is_empty() || second.starts_with(b"#");
    let is_list = word.iter().any(|byte| b",;".contains(byte));
    if starts_with(b"_atom_site.") || (starts_with(b"data_") || starts_with(b"loop_")) && is_alone && !is_list
    {
        return Some(Format::Mmcif);
    }
    // The serial number may touch the name of the record.
    let is_name = |name: &[u8]| starts_with(name) && word[name.len()..].iter().all(u8::is_ascii_digit);
    let is_numbered = line.len() >= PDB_PLACE_LEN || second.first().is_some_and(u8::is_ascii_digit);
    let is_atom = (is_name(b"ATOM") || is_name(b"HETATM")) && is_numbered;
    let is_record = PDB_RECORDS.contains(&word) && fills_columns(&line[word.len()..]);
    (line[0] == word[0] && (is_atom || is_record)).then_some(Format::Pdb)
}

/// Whether the rest of a line is what follows the name of a PDB record: blank columns or a number.
fn fills_columns(rest: &[u8]) -> bool {
    matches!(rest, [] | [b' '] | [b' ', b' ' | b'0'..=b'9', ..])
}

/// Whether the text starts with a count, a comment and an atom: `element x y z`, or as the comment states.
fn is_xyz<'a>(mut lines: impl Iterator<Item = &'a [u8]>) -> bool {
    let Some(first) = lines.find(|line| !line.is_empty()) else { return false };
    let is_count = first.trim_ascii().iter().all(u8::is_ascii_digit);
    let comment = lines.next().unwrap_or_default();
    let states_columns = words(comment).any(|word| word.starts_with(b"Properties="));
    let mut atom = words(lines.next().unwrap_or_default()).skip(1);
    is_count && (states_columns || atom.by_ref().take(3).filter(|field| is_number(field)).count() == 3)
}

/// Whether a field of the line is a number, whatever separates them.
fn is_coordinate(line: &[u8]) -> bool {
    let is_separator = |byte: &u8| byte.is_ascii_whitespace() || *byte == b',' || *byte == b';';
    line.split(is_separator).any(is_number)
}

fn is_number(word: &[u8]) -> bool {
    std::str::from_utf8(word).is_ok_and(|word| word.parse::<f64>().is_ok())
}

fn is_integer(word: &[u8]) -> bool {
    std::str::from_utf8(word).is_ok_and(|word| word.parse::<i64>().is_ok())
}
