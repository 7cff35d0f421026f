//! Damaged inputs of every format: an error or an equal mesh, never a panic.

use spmesh_formats::drivers::Format;

use super::samples::{self, Random};
use super::{converted, text_of};
use crate::vectors::is_refused;

fn files() -> Vec<(Format, Vec<u8>)> {
    let mesh = samples::mesh(samples::grids()[1]);
    let points = samples::points(2, true, false);
    let mut files = vec![];
    for format in [Format::Stream, Format::Twin, Format::Obj, Format::Ply, Format::Sma, Format::Smb] {
        files.push((format, converted(&mesh, Format::Stream, format).unwrap()));
    }
    for format in [Format::Stream, Format::Twin, Format::Ply, Format::Spa, Format::Spb] {
        files.push((format, converted(&points, Format::Stream, format).unwrap()));
    }
    let tetrahedra = samples::tetrahedra(samples::grids()[1], true);
    files.push((Format::Twin, text_of(&tetrahedra).into_bytes()));
    files.push((Format::Stream, tetrahedra));
    for partial in [samples::partial(), samples::partial_space()] {
        files.push((Format::Twin, text_of(&partial).into_bytes()));
        files.push((Format::Stream, partial));
    }
    files
}

fn accepts(input: &[u8], format: Format) -> bool {
    match converted(input, format, Format::Stream) {
        Ok(stream) => {
            text_of(&stream);
            true
        }
        Err(error) => {
            assert!(is_refused(&error), "{error}");
            false
        }
    }
}

#[test]
fn changed_bytes_are_an_error_or_a_mesh() {
    let mut random = Random(11);
    for (format, file) in files() {
        for _ in 0..400 {
            let mut damaged = file.clone();
            for _ in 0..=random.below(3) {
                let at = random.below(file.len() as u64) as usize;
                damaged[at] = match random.below(3) {
                    0 => damaged[at] ^ 1 << random.below(8),
                    1 => random.below(256) as u8,
                    _ => b"-0129 x#\nvfe.\xff"[random.below(14) as usize],
                };
            }
            accepts(&damaged, format);
        }
    }
}

#[test]
fn cut_files_are_an_error_or_a_mesh() {
    let mut random = Random(12);
    for (format, file) in files() {
        for _ in 0..200 {
            let end = random.below(file.len() as u64 - 1) as usize;
            let is_accepted = accepts(&file[..end], format);
            let must_be_whole = matches!(format, Format::Stream | Format::Twin | Format::Ply | Format::Smb);
            assert!(!is_accepted || !must_be_whole, "{format:?} cut at {end}");
        }
    }
}

#[test]
fn moved_pieces_are_an_error_or_a_mesh() {
    let mut random = Random(13);
    for (format, file) in files() {
        for _ in 0..100 {
            let mut cut = || random.below(file.len() as u64) as usize;
            let (a, b, c) = (cut(), cut(), cut());
            let piece = &file[a.min(b)..a.max(b)];
            accepts(&[&file[..c], piece, &file[c..]].concat(), format);
        }
    }
}
