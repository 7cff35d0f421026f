//! SPA and SPB, from bytes assembled by hand according to `formats/historical.md`.

use spmesh_base::error::{ErrorKind, Result};
use spmesh_formats::source::{SpDatatype, SpEvent, SpFinalization, SpReader, SpaReader, SpbReader};

use super::{assert_fails, points_of};

/// Byte order of the data of an SPB file, and the byte order that the flag claims.
#[derive(Clone, Copy, Debug)]
struct Order {
    big: bool,
    flag: u8,
}

const ORDERS: [Order; 4] = [
    Order { big: false, flag: 0 },
    Order { big: false, flag: 1 },
    Order { big: true, flag: 0 },
    Order { big: true, flag: 1 },
];

#[derive(Clone, Copy)]
enum Element {
    Point([f64; 3]),
    Cell(i32),
}

struct Writer {
    order: Order,
    datatype: u8,
    bytes: Vec<u8>,
}

impl Writer {
    fn raw(&mut self, mut bytes: Vec<u8>) {
        if self.order.big {
            bytes.reverse();
        }
        self.bytes.extend(bytes);
    }

    fn int(&mut self, value: i32) {
        self.raw(value.to_le_bytes().to_vec());
    }

    fn point(&mut self, point: [f64; 3]) {
        for value in point {
            match self.datatype {
                0 => self.raw((value as f32).to_le_bytes().to_vec()),
                1 => self.int(value as i32),
                _ => self.raw(value.to_le_bytes().to_vec()),
            }
        }
    }
}

/// An SPB file with these elements; `stated` is the number of points in the header, -1 if unknown.
fn spb(
    order: Order,
    datatype: u8,
    stated: i32,
    bounds: Option<[[f64; 3]; 2]>,
    elements: &[Element],
) -> Vec<u8> {
    let mut file = Writer { order, datatype, bytes: vec![7, order.flag, datatype | 1 << 2] };
    file.int(1);
    file.int(5);
    file.bytes.extend(b"hello");
    file.int(stated);
    file.bytes.push(u8::from(bounds.is_some()));
    for corner in bounds.iter().flatten() {
        file.point(*corner);
    }
    let mut blocks: Vec<&[Element]> = elements.chunks(32).collect();
    if elements.len().is_multiple_of(32) {
        blocks.push(&[]);
    }
    for block in blocks {
        let bit = |(at, element): (usize, &Element)| u32::from(matches!(element, Element::Point(_))) << at;
        file.int(block.iter().enumerate().map(bit).sum::<u32>() as i32);
        for element in block {
            match element {
                Element::Point(point) => file.point(*point),
                Element::Cell(index) => {
                    file.int(*index);
                    let padding = if datatype == 2 { 20 } else { 8 };
                    file.bytes.resize(file.bytes.len() + padding, 0);
                }
            }
        }
    }
    file.bytes
}

/// `count` points on a parabola, and a tag after every third.
fn elements(count: usize) -> Vec<Element> {
    let pair = |i: usize| {
        let x = i as f64;
        let tag = (i % 3 == 2).then_some(Element::Cell(i as i32));
        std::iter::once(Element::Point([x, 1000.0 + x * x, -x])).chain(tag)
    };
    (0..count).flat_map(pair).collect()
}

fn events(reader: &mut impl SpReader) -> Result<Vec<SpEvent>> {
    std::iter::from_fn(|| reader.next_event().transpose()).collect()
}

fn expected(elements: &[Element]) -> Vec<SpEvent> {
    let event = |element: &Element| match element {
        Element::Point(point) => SpEvent::Point(*point),
        Element::Cell(index) => SpEvent::FinalizedCell(*index),
    };
    elements.iter().map(event).collect()
}

#[test]
fn binary_of_either_order_is_read_whatever_its_flag_says() {
    for order in ORDERS {
        for datatype in 0..3 {
            for count in [1, 5, 24, 25, 48, 200] {
                for has_bounds in [false, true] {
                    let elements = elements(count);
                    let last = count as f64 - 1.0;
                    let bounds =
                        has_bounds.then_some([[0.0, 1000.0, -last], [last, 1000.0 + last * last, 0.0]]);
                    let bytes = spb(order, datatype, count as i32, bounds, &elements);
                    let mut reader = SpbReader::new(&bytes[..]).unwrap();
                    let header = reader.header().clone();
                    assert_eq!(header.comments, ["hello"]);
                    assert_eq!(header.points, Some(count as u64), "{order:?}");
                    assert_eq!(header.finalization, SpFinalization::QuadTree);
                    assert_eq!(header.bounds.is_some(), has_bounds);
                    assert_eq!(
                        events(&mut reader).unwrap(),
                        expected(&elements),
                        "{order:?} {datatype} {count}"
                    );
                }
            }
        }
    }
}

#[test]
fn binary_files_are_sources() {
    let found = points_of(spb(ORDERS[1], 2, -1, None, &elements(40))).unwrap();
    assert_eq!(found.len(), 40);
    assert_eq!(found[39], [39.0, 2521.0, -39.0]);
}

#[test]
fn damaged_binary_files_are_errors() {
    let bytes = spb(ORDERS[0], 2, 40, None, &elements(40));
    assert_fails(points_of(&bytes[..bytes.len() - 1]), ErrorKind::Malformed, &["truncated", "block at byte"]);
    assert_fails(points_of(&bytes[..bytes.len() - 24]), ErrorKind::Malformed, &["states 40 points"]);
    assert_fails(points_of(&bytes[..9]), ErrorKind::Malformed, &["header at byte 0"]);
    let nan = spb(ORDERS[0], 2, -1, None, &[Element::Point([0.0, f64::NAN, 1.0])]);
    assert_fails(points_of(nan), ErrorKind::Malformed, &["point 0", "not finite"]);
}

#[test]
fn text_has_header_points_and_tags() {
    let text = "# made by hand\n# npoints 2\n# bb_min_d 0 1 2\n# bb_max_d 3 4 5\n# datatype SP_DOUBLE\n\
                # finalizemethod SP_CLARKSON_2D\nv 0 1 2\nx cell 7\n# in between\nx 1\np 3 4 5\nx cell 12\n";
    let mut reader = SpaReader::new(text.as_bytes()).unwrap();
    assert_eq!(reader.header().comments, ["made by hand"]);
    assert_eq!(reader.header().points, Some(2));
    assert_eq!(reader.header().datatype, SpDatatype::Double);
    assert_eq!(reader.header().finalization, SpFinalization::Clarkson2d);
    assert_eq!(reader.header().bounds.unwrap().max, [3.0, 4.0, 5.0]);
    let expected = [
        SpEvent::Point([0.0, 1.0, 2.0]),
        SpEvent::FinalizedCell(7),
        SpEvent::Point([3.0, 4.0, 5.0]),
        SpEvent::FinalizedCell(12),
    ];
    assert_eq!(events(&mut reader).unwrap(), expected);
    assert_eq!(points_of(text).unwrap(), [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]);
}

#[test]
fn damaged_text_is_an_error() {
    assert_fails(points_of("# npoints 3\nv 1 2 3\n"), ErrorKind::Malformed, &["states 3 points", "has 1"]);
    assert_fails(points_of("v 1 2 3\nv 1 2\n"), ErrorKind::Malformed, &["line 2", "\"v 1 2\""]);
    assert_fails(points_of("v 1 2 3\nx cell\n"), ErrorKind::Malformed, &["line 2", "x cell"]);
    assert_fails(points_of("v 1 2 3\nv 1 inf 3\n"), ErrorKind::Malformed, &["line 2", "\"inf\"", "finite"]);
    let text = "# npoints 2\nv 1 2 3\nv 1 inf 3\n";
    assert_fails(points_of(text), ErrorKind::Malformed, &["line 3", "not finite"]);
    assert_fails(points_of("# npoints 1\nv 1 2\n"), ErrorKind::Malformed, &["line 2", "\"v 1 2\"", "SPA"]);
}

#[test]
fn points_of_a_cell_that_no_tag_finalizes_were_cut() {
    let head = "# finalizemethod SP_QUAD_TREE\n# bb_min 0 0 0\n# bb_max 4 4 0\n";
    let whole = format!("{head}v 1 1 0\nx cell 2\nv 3 3 0\nx cell 0\n");
    assert_eq!(points_of(&whole).unwrap().len(), 2);
    let cut = whole.strip_suffix("x cell 0\n").unwrap();
    assert_fails(points_of(cut), ErrorKind::Malformed, &["truncated", "never finalized"]);
    let unended = cut.strip_suffix(" 0\n").unwrap().to_string() + " 0";
    assert_fails(points_of(unended), ErrorKind::Malformed, &["line 6", "the last line has no end"]);
    // Without tags there is nothing to miss.
    assert_eq!(points_of(cut.replace("x cell 2\n", "")).unwrap().len(), 2);
}

#[test]
fn vertices_of_meshes_are_as_many_as_stated() {
    let mesh = "# nverts 4\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    assert_fails(points_of(mesh), ErrorKind::Malformed, &["states 4 vertices, the mesh has 3"]);
    assert_eq!(points_of(mesh.replace('4', "3")).unwrap().len(), 3);
}
