//! What the headers of many files state together, and which of the files are bad.

use std::io;
use std::path::PathBuf;

use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_formats::source::{Input, Survey};
use spmesh_stream::Coordinates;

use super::las_file::LasFile;
use super::{assert_fails, flat};
use crate::programs::Folder;

fn survey(paths: &[PathBuf], keep_going: bool) -> Result<Survey> {
    Survey::of(paths, &flat(), keep_going, |_| ())
}

#[test]
fn bad_files_are_left_out_if_wanted() {
    let folder = Folder::new();
    let tile = |at: i32| LasFile::of(&[[at, 0, 0], [at + 9, 9, 9]]).bytes();
    let cut = &tile(0)[..240];
    let files = [
        folder.file("damaged.las", "LASF, but not for long"),
        folder.file("first.las", tile(0)),
        folder.file("cut.las", cut),
        folder.root().join("gone.las"),
        folder.file("second.las", tile(100)),
        // Its header states no box; without it, all files have a grid.
        folder.file("infinite.xyz", "0 0 0\ninf 0 0\n"),
    ];
    let mut done = Vec::new();
    let found = Survey::of(&files, &flat(), true, |count| done.push(count)).unwrap();
    let bad: Vec<(usize, ErrorKind)> =
        found.bad.iter().map(|(index, error)| (*index, error.kind())).collect();
    let [malformed, gone] = [ErrorKind::Malformed, ErrorKind::Io];
    assert_eq!(bad, [(0, malformed), (2, malformed), (3, gone), (5, malformed)]);
    for (index, error) in &found.bad {
        assert!(error.to_string().starts_with(&files[*index].display().to_string()), "{error}");
    }
    assert_eq!(done, [1, 2, 3, 4, 5, 6]);
    let others = survey(&[files[1].clone(), files[4].clone()], true).unwrap();
    assert!(others.bad.is_empty());
    assert_eq!(found.extents, others.extents);
    assert_eq!(format!("{:?}", found.description), format!("{:?}", others.description));

    let named = ["damaged.las", "3 other files are bad, too", "cut.las", "gone.las"];
    assert_fails(
        survey(&files[..4], false),
        malformed,
        &[named[0], "2 other files are bad", named[2], named[3]],
    );
    assert_fails(survey(&files[4..], false), malformed, &["infinite.xyz"]);
    let no_good = [0, 2, 3, 5].map(|index| files[index].clone());
    assert_fails(survey(&no_good, true), malformed, &named);
}

/// A machine with too little of something may have read the file another time.
#[test]
fn shortages_are_not_those_of_a_file() {
    let of = |cause: io::Error| Error::io("reading", cause).is_shortage();
    assert!(Error::new(ErrorKind::Memory, "too little").is_shortage());
    assert!(of(io::ErrorKind::OutOfMemory.into()) && of(io::ErrorKind::StorageFull.into()));
    assert!(of(rustix::io::Errno::MFILE.into()) && of(rustix::io::Errno::NFILE.into()));
    assert!(!of(io::ErrorKind::NotFound.into()) && !Error::malformed("damaged").is_shortage());
}

/// The box of an empty tile is often that of nothing, far from all others.
#[test]
fn boxes_of_empty_files_count_for_no_grid() {
    let folder = Folder::new();
    let tile = |scale: f64| LasFile {
        scale: [scale; 3],
        offset: [400_000.0, 5_000_000.0, 0.0],
        ..LasFile::of(&[[1, 1, 1]])
    };
    let mut empty = LasFile { records: Vec::new(), ..tile(0.01) }.bytes();
    empty[179..227].fill(0);
    let files = [
        folder.file("empty.las", empty),
        folder.file("fine.las", tile(0.001).bytes()),
        folder.file("coarse.las", tile(0.01).bytes()),
    ];
    let fine = Coordinates::I32 { scale: [0.001; 3], offset: [400_000.0, 5_000_000.0, 0.0] };
    let found = survey(&files, false).unwrap();
    assert_eq!((found.description.coordinates, found.extents[0].bounds), (fine, None));
    let input = Input::open(&files, &flat()).unwrap();
    assert_eq!(input.description().coordinates, fine);
}
