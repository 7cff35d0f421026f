//! Reads files of Parquet, as apache/parquet-format specifies them, and refuses whatever `tess3` has no
//! reason to write. It shares no code with the writer, and knows field numbers only.

use std::collections::BTreeMap;

/// A field of a row; `None` if it has no value.
pub type Field = Option<Value>;

/// A value of one of the types that tables have.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    Text(String),
    Integer(i64),
    Number(f64),
}

/// The content of a file.
pub struct Table {
    /// Names and physical types.
    pub columns: Vec<(String, &'static str)>,
    pub rows: Vec<Vec<Field>>,
    /// Rows of each group.
    pub groups: Vec<usize>,
    /// Lengths of pages before compression.
    pub pages: Vec<usize>,
}

/// A value of Thrift.
#[derive(Debug)]
enum Node {
    Bool,
    Int(i64),
    Double,
    Bytes(Vec<u8>),
    List(Vec<Node>),
    Struct(BTreeMap<i64, Node>),
}

impl Node {
    /// A field of a structure, which must be there.
    fn field(&self, number: i64) -> &Node {
        self.optional(number).unwrap_or_else(|| panic!("no field {number} in {self:?}"))
    }

    fn optional(&self, number: i64) -> Option<&Node> {
        let Node::Struct(fields) = self else { panic!("{self:?} is no structure") };
        fields.get(&number)
    }

    fn int(&self, number: i64) -> i64 {
        let Node::Int(value) = self.field(number) else { panic!("field {number} of {self:?} is no integer") };
        *value
    }

    fn size(&self, number: i64) -> usize {
        usize::try_from(self.int(number)).unwrap()
    }

    fn list(&self, number: i64) -> &[Node] {
        let Node::List(items) = self.field(number) else { panic!("field {number} of {self:?} is no list") };
        items
    }

    fn text(&self) -> String {
        let Node::Bytes(bytes) = self else { panic!("{self:?} is no text") };
        String::from_utf8(bytes.clone()).unwrap()
    }

    fn assert_fields(&self, allowed: &[i64]) {
        let Node::Struct(fields) = self else { panic!("{self:?} is no structure") };
        assert!(fields.keys().all(|number| allowed.contains(number)), "fields of {self:?}");
    }
}

/// Bytes from their start on.
struct Bytes<'b>(&'b [u8]);

impl<'b> Bytes<'b> {
    fn take(&mut self, len: usize) -> &'b [u8] {
        let (taken, rest) = self.0.split_at_checked(len).expect("the bytes reach so far");
        self.0 = rest;
        taken
    }

    fn byte(&mut self) -> u8 {
        self.take(1)[0]
    }

    fn u32(&mut self) -> usize {
        u32::from_le_bytes(self.take(4).try_into().unwrap()) as usize
    }

    fn word(&mut self) -> [u8; 8] {
        self.take(8).try_into().unwrap()
    }

    fn varint(&mut self) -> u64 {
        let mut value = 0;
        for shift in (0..70).step_by(7) {
            let byte = self.byte();
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return value;
            }
        }
        panic!("an integer of more than 64 bits");
    }

    fn zigzag(&mut self) -> i64 {
        let value = self.varint();
        (value >> 1) as i64 ^ -((value & 1) as i64)
    }

    /// A value of a type of the compact protocol.
    fn node(&mut self, kind: u8) -> Node {
        match kind {
            1 | 2 => Node::Bool,
            3 => Node::Int((self.byte() as i8).into()),
            4..=6 => Node::Int(self.zigzag()),
            7 => {
                self.word();
                Node::Double
            }
            8 => {
                let len = self.varint() as usize;
                Node::Bytes(self.take(len).to_vec())
            }
            9 | 10 => self.list(),
            12 => self.structure(),
            _ => panic!("type {kind} of Thrift"),
        }
    }

    fn list(&mut self) -> Node {
        let head = self.byte();
        let len = if head >> 4 == 15 { self.varint() } else { (head >> 4).into() };
        Node::List((0..len).map(|_| self.node(head & 15)).collect())
    }

    fn structure(&mut self) -> Node {
        let mut fields = BTreeMap::new();
        let mut number = 0;
        loop {
            let head = self.byte();
            if head == 0 {
                return Node::Struct(fields);
            }
            number = if head >> 4 == 0 { self.zigzag() } else { number + i64::from(head >> 4) };
            assert!(fields.insert(number, self.node(head & 15)).is_none(), "field {number} twice");
        }
    }
}

/// Reads a file.
///
/// # Panics
/// If a length, an offset or a count is wrong, or bytes belong to nothing.
pub fn read(content: &[u8]) -> Table {
    assert!(content.len() >= 12 && content.starts_with(b"PAR1") && content.ends_with(b"PAR1"), "magic");
    let (rest, mut tail) = (&content[..content.len() - 8], Bytes(&content[content.len() - 8..]));
    let data_len = rest.len().checked_sub(tail.u32()).expect("the footer fits");
    let mut footer = Bytes(&rest[data_len..]);
    let file = footer.structure();
    assert!(footer.0.is_empty(), "bytes behind the footer");
    file.assert_fields(&[1, 2, 3, 4, 6]);
    assert_eq!(file.int(1), 1, "version");
    assert_eq!(file.field(6).text(), concat!("spmesh ", env!("CARGO_PKG_VERSION")));
    let mut reader =
        Reader { data: &rest[..data_len], place: 4, columns: columns(file.list(2)), pages: Vec::new() };
    let mut rows = Vec::new();
    let groups: Vec<usize> = file.list(4).iter().map(|group| reader.group(group, &mut rows)).collect();
    assert_eq!(reader.place, data_len, "pages end where the footer starts");
    assert_eq!(rows.len(), file.size(3), "rows of the file");
    let named =
        reader.columns.into_iter().map(|(name, kind)| (name, ["INT64", "DOUBLE", "BYTE_ARRAY"][kind]));
    Table { columns: named.collect(), rows, groups, pages: reader.pages }
}

/// Types that columns may have, by their place in this list.
const KINDS: [i64; 3] = [2, 5, 6];
const TEXT: usize = 2;

/// Names and kinds of columns.
fn columns(schema: &[Node]) -> Vec<(String, usize)> {
    let (root, columns) = schema.split_first().unwrap();
    root.assert_fields(&[4, 5]);
    assert_eq!(root.size(5), columns.len(), "children of the root");
    let column = |element: &Node| {
        let kind = KINDS.iter().position(|&kind| kind == element.int(1)).expect("a known type");
        assert_eq!(element.int(3), 1, "optional");
        if kind == TEXT {
            element.assert_fields(&[1, 3, 4, 6, 10]);
            assert_eq!(element.int(6), 0, "converted type UTF8");
            element.field(10).assert_fields(&[1]);
            element.field(10).field(1).assert_fields(&[]);
        } else {
            element.assert_fields(&[1, 3, 4]);
        }
        (element.field(4).text(), kind)
    };
    columns.iter().map(column).collect()
}

/// Pages tile the data: each starts where the one before ends.
struct Reader<'b> {
    data: &'b [u8],
    place: usize,
    columns: Vec<(String, usize)>,
    pages: Vec<usize>,
}

impl Reader<'_> {
    /// Adds the rows of a group; returns how many.
    fn group(&mut self, group: &Node, rows: &mut Vec<Vec<Field>>) -> usize {
        group.assert_fields(&[1, 2, 3]);
        let count = group.size(3);
        assert!(count > 0, "a group without rows");
        let chunks = group.list(1);
        assert_eq!(chunks.len(), self.columns.len(), "columns of a group");
        let mut found = vec![Vec::new(); count];
        let mut plain_len = 0;
        for (column, chunk) in chunks.iter().enumerate() {
            chunk.assert_fields(&[2, 3]);
            assert_eq!(chunk.int(2), 0, "no metadata elsewhere");
            plain_len += chunk.field(3).size(6);
            let fields = self.chunk(chunk.field(3), column, count);
            found.iter_mut().zip(fields).for_each(|(row, field)| row.push(field));
        }
        assert_eq!(plain_len, group.size(2), "bytes of the group");
        rows.extend(found);
        count
    }

    /// The fields of a column in a group of `count` rows.
    fn chunk(&mut self, metadata: &Node, column: usize, count: usize) -> Vec<Field> {
        metadata.assert_fields(&[1, 2, 3, 4, 5, 6, 7, 9, 12]);
        let (name, kind) = self.columns[column].clone();
        assert_eq!(metadata.int(1), KINDS[kind]);
        let encodings = metadata.list(2).iter().map(|node| matches!(node, Node::Int(0 | 3)));
        assert_eq!(encodings.collect::<Vec<_>>(), [true; 2], "PLAIN and RLE");
        assert_eq!(metadata.list(3).iter().map(Node::text).collect::<Vec<_>>(), [name]);
        assert_eq!((metadata.int(4), metadata.size(5)), (6, count), "zstd; number of values");
        let start = self.place;
        assert_eq!(metadata.size(9), start, "offset of the first page");
        let mut fields = Vec::new();
        let mut plain_len = 0;
        while fields.len() < count {
            plain_len += self.page(kind, &mut fields);
        }
        assert_eq!(fields.len(), count, "values of all pages");
        assert_eq!((metadata.size(6), metadata.size(7)), (plain_len, self.place - start), "bytes of pages");
        metadata.field(12).assert_fields(&[3]);
        let nulls = fields.iter().filter(|field| field.is_none()).count();
        assert_eq!(metadata.field(12).size(3), nulls, "rows without a value");
        fields
    }

    /// Adds the fields of the next page; returns its length before compression.
    fn page(&mut self, kind: usize, fields: &mut Vec<Field>) -> usize {
        let mut bytes = Bytes(&self.data[self.place..]);
        let before = bytes.0.len();
        let header = bytes.structure();
        let header_len = before - bytes.0.len();
        header.assert_fields(&[1, 2, 3, 5]);
        assert_eq!(header.int(1), 0, "a page of data");
        let data = header.field(5);
        data.assert_fields(&[1, 2, 3, 4]);
        assert_eq!([2, 3, 4].map(|number| data.int(number)), [0, 3, 3], "PLAIN, and RLE for levels");
        let (len, frame_len, count) = (header.size(2), header.size(3), data.size(1));
        let frame = bytes.take(frame_len);
        let content = zstd::bulk::decompress(frame, len).unwrap();
        assert_eq!(
            (content.len(), &frame[..4]),
            (len, &[0x28, 0xb5, 0x2f, 0xfd][..]),
            "the content of a page"
        );
        self.place += header_len + frame_len;
        self.pages.push(len);
        decode(&content, kind, count, fields);
        header_len + len
    }
}

/// Adds the fields of the content of a page of `count` rows.
fn decode(content: &[u8], kind: usize, count: usize, fields: &mut Vec<Field>) {
    let mut content = Bytes(content);
    let levels_len = content.u32();
    for is_present in levels(content.take(levels_len), count) {
        fields.push(is_present.then(|| match kind {
            0 => Value::Integer(i64::from_le_bytes(content.word())),
            1 => Value::Number(f64::from_le_bytes(content.word())),
            _ => {
                let len = content.u32();
                Value::Text(String::from_utf8(content.take(len).to_vec()).unwrap())
            }
        }));
    }
    assert!(content.0.is_empty(), "bytes behind the values");
}

/// Levels of one bit: runs of equal ones, and packed ones, eight to a byte.
fn levels(bytes: &[u8], count: usize) -> Vec<bool> {
    let mut bytes = Bytes(bytes);
    let mut found = Vec::new();
    while !bytes.0.is_empty() {
        let head = bytes.varint() as usize;
        assert!(head > 1 && head >> 1 <= count, "a run of {} among {count} levels", head >> 1);
        if head & 1 == 0 {
            let level = bytes.byte();
            assert!(level < 2, "level {level}");
            found.extend(std::iter::repeat_n(level == 1, head >> 1));
        } else {
            let packed = bytes.take(head >> 1);
            found.extend(packed.iter().flat_map(|byte| (0..8).map(move |bit| byte >> bit & 1 == 1)));
        }
    }
    assert_eq!(found.len(), count, "levels of a page");
    found
}
