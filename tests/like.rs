//! Grids of existing rasters: TIFF files of every form, and damaged ones.

use std::fs;

use spmesh_base::limits::TIFF_TAG_BYTES_MAX;
use spmesh_formats::raster::Grid;

/// How a TIFF file is written.
#[derive(Debug, Clone, Copy)]
struct Form {
    is_big: bool,
    is_big_endian: bool,
}

const FORMS: [Form; 4] = [
    Form { is_big: false, is_big_endian: false },
    Form { is_big: false, is_big_endian: true },
    Form { is_big: true, is_big_endian: false },
    Form { is_big: true, is_big_endian: true },
];

impl Form {
    /// A number of `width` bytes.
    fn number(self, number: u64, width: usize) -> Vec<u8> {
        match self.is_big_endian {
            true => number.to_be_bytes()[8 - width..].to_vec(),
            false => number.to_le_bytes()[..width].to_vec(),
        }
    }

    /// A file of one directory, and the values that it points at. Tags have a type, its width, and values.
    fn file(self, tags: &[(u16, u16, usize, Vec<u64>)]) -> Vec<u8> {
        let (head, count_len, entry_len, place_len) =
            if self.is_big { (16, 8, 20, 8) } else { (8, 2, 12, 4) };
        let mut bytes = if self.is_big_endian { b"MM".to_vec() } else { b"II".to_vec() };
        match self.is_big {
            true => bytes.extend(
                [self.number(43, 2), self.number(8, 2), self.number(0, 2), self.number(16, 8)].concat(),
            ),
            false => bytes.extend([self.number(42, 2), self.number(8, 4)].concat()),
        }
        let mut later = Vec::new();
        let start = head + count_len + tags.len() * entry_len + place_len;
        bytes.extend(self.number(tags.len() as u64, count_len));
        for (tag, kind, width, values) in tags {
            let mut value: Vec<u8> = values.iter().flat_map(|&value| self.number(value, *width)).collect();
            bytes.extend([self.number((*tag).into(), 2), self.number((*kind).into(), 2)].concat());
            bytes.extend(self.number(values.len() as u64, place_len));
            if value.len() > place_len {
                bytes.extend(self.number((start + later.len()) as u64, place_len));
                later.append(&mut value);
            } else {
                value.resize(place_len, 0);
                bytes.append(&mut value);
            }
        }
        bytes.extend(self.number(0, place_len));
        [bytes, later].concat()
    }
}

fn doubles(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

/// Cells of 0.5, with a tie point at the second column and the third row.
fn tags() -> Vec<(u16, u16, usize, Vec<u64>)> {
    vec![
        (256, 3, 2, vec![700]),
        (257, 4, 4, vec![300]),
        (305, 2, 1, b"a program\0".iter().map(|&byte| byte.into()).collect()),
        (33550, 12, 8, doubles(&[0.5, 0.5, 0.0])),
        (33922, 12, 8, doubles(&[2.0, 3.0, 0.0, 11.0, 248.5, 0.0])),
        // Cells are points: the tie is the centre of its cell.
        (34735, 3, 2, vec![1, 1, 0, 1, 1025, 0, 1, 2]),
    ]
}

fn grid_of(bytes: &[u8]) -> Result<Grid, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("like.tif");
    fs::write(&path, bytes).unwrap();
    Grid::of_file(&path).map_err(|error| error.to_string())
}

#[test]
fn every_form_of_a_file_states_its_cells() {
    let expected = Grid { left: 9.75, top: 250.25, step: 0.5, columns: 700, rows: 300 };
    for form in FORMS {
        assert_eq!(grid_of(&form.file(&tags())), Ok(expected), "{form:?}");
    }
}

#[test]
fn a_file_that_is_cut_off_or_damaged_is_refused_or_read_as_it_is() {
    for form in FORMS {
        let whole = form.file(&tags());
        for len in 0..whole.len() {
            let message = grid_of(&whole[..len]).expect_err("a part");
            assert!(message.contains("cannot be read as TIFF"), "{form:?} {len}: {message}");
        }
        for at in 0..whole.len() {
            for bit in 0..8 {
                let mut damaged = whole.clone();
                damaged[at] ^= 1 << bit;
                let _no_panic = grid_of(&damaged);
            }
        }
    }
}

#[test]
fn long_values_are_not_read() {
    let mut of_texts = tags();
    of_texts.push((34737, 2, 1, vec![u64::from(b'x'); TIFF_TAG_BYTES_MAX + 1]));
    for form in FORMS {
        assert!(grid_of(&form.file(&of_texts)).is_ok(), "{form:?}");
        // What is needed must be short enough.
        let mut of_scale = tags();
        of_scale[3].3 = doubles(&vec![0.5; TIFF_TAG_BYTES_MAX / 8 + 1]);
        assert!(grid_of(&form.file(&of_scale)).unwrap_err().contains("where its cells are"), "{form:?}");
    }
}
