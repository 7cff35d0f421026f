//! Points streams: tags, chunks and boxes.

use spmesh_audit::{Audit, Check, Report, Standard, Violation};
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::model::cells::{CellCode, CellTree};
use spmesh_stream::{Coordinates, Event, Header, Kind, StreamWriter, Totals};

use super::{Verdict, assert_violates, audit};

/// Points, and the cells that are tagged after them.
type Chunk<'a> = (&'a [Point], &'a [u64]);

fn audit_chunks(header: &Header, chunks: &[Chunk]) -> Result<Report, Verdict> {
    let mut writer = StreamWriter::new(Vec::new(), header.clone()).unwrap();
    for (points, cells) in chunks {
        writer.points(points).unwrap();
        if !cells.is_empty() {
            writer.cells(&cells.iter().map(|&cell| CellCode(cell)).collect::<Vec<_>>()).unwrap();
        }
    }
    audit(&writer.end(0, 0).unwrap(), Standard::Canonical, None)
}

/// Passes the chunks directly to the audit, because the reader refuses some faults itself.
fn audit_events(header: &Header, chunks: &[Chunk]) -> Result<(), Violation> {
    let mut audit = Audit::new(header, Standard::Canonical, None).unwrap();
    for (points, cells) in chunks {
        audit.event(&Event::Points(points.to_vec()))?;
        for &cell in *cells {
            audit.event(&Event::Cells(vec![CellCode(cell)]))?;
        }
    }
    let points = chunks.iter().map(|(points, _)| points.len() as u64).sum();
    audit.event(&Event::End(Totals { points, ..Totals::default() }))
}

#[track_caller]
fn assert_no_chunk(chunks: &[Chunk]) {
    assert_eq!(audit_events(&header(true), chunks).unwrap_err().check, Check::Chunks);
    assert!(matches!(audit_chunks(&header(true), chunks), Err(Verdict::Malformed(_))));
    assert!(audit_events(&Header { bounds: None, ..header(false) }, chunks).is_ok());
}

/// A quadtree of two levels over [0, 4) x [0, 4); cells 4 to 7 are its quadrants.
fn header(chunked: bool) -> Header {
    let tree = CellTree::new(2, 2, [0.0; 3], 4.0);
    let bounds = Some(Bounds { min: [0.0, 0.0, 1.0], max: [3.5, 3.0, 9.0] });
    Header { tree, bounds, chunked, ..Header::new(Kind::Points, Coordinates::F64, 2, true) }
}

const LOWER_LEFT: [Point; 2] = [[0.0, 1.5, 1.0], [1.9, 0.0, 2.0]];
const LOWER_RIGHT: [Point; 1] = [[3.5, 0.0, 3.0]];
const UPPER_RIGHT: [Point; 2] = [[2.0, 2.0, 9.0], [3.0, 3.0, 4.0]];

#[test]
fn finalized_points_pass() {
    let chunks: [Chunk; 4] = [(&[], &[6]), (&LOWER_LEFT, &[4]), (&UPPER_RIGHT, &[7]), (&LOWER_RIGHT, &[5])];
    for chunked in [false, true] {
        let report = audit_chunks(&header(chunked), &chunks).unwrap();
        assert_eq!(report.lines.iter().any(|line| line.check == Check::Chunks), chunked);
    }
}

#[test]
fn points_without_tags_pass() {
    audit_chunks(&header(false), &[(&LOWER_LEFT, &[]), (&UPPER_RIGHT, &[]), (&LOWER_RIGHT, &[])]).unwrap();
}

#[test]
fn point_after_the_tag_of_its_cell() {
    let chunks: [Chunk; 3] =
        [(&LOWER_LEFT, &[4]), (&UPPER_RIGHT, &[7]), (&[LOWER_LEFT[1], LOWER_RIGHT[0]], &[])];
    let violation = assert_violates(audit_chunks(&header(false), &chunks), Check::Cells, &[]);
    assert_eq!(violation.vertices, [(None, LOWER_LEFT[1])]);
}

#[test]
fn point_after_the_tag_of_an_ancestor_or_of_all_children() {
    let chunks: [Chunk; 2] = [(&LOWER_LEFT, &[1]), (&LOWER_RIGHT, &[])];
    assert_violates(audit_chunks(&header(false), &chunks), Check::Cells, &[]);
    let chunks: [Chunk; 2] = [(&UPPER_RIGHT, &[19, 16, 18, 17]), (&LOWER_LEFT, &[])];
    assert_violates(audit_chunks(&header(false), &chunks), Check::Cells, &[]);
}

#[test]
fn points_of_two_cells_are_no_chunk() {
    assert_no_chunk(&[(&[LOWER_LEFT[0], UPPER_RIGHT[0]], &[4, 7])]);
}

#[test]
fn chunk_without_its_tag() {
    assert_no_chunk(&[(&UPPER_RIGHT, &[5]), (&LOWER_LEFT, &[4])]);
    assert_no_chunk(&[(&LOWER_LEFT, &[4]), (&UPPER_RIGHT, &[])]);
}

/// The tags after a chunk may span several blocks, and part of a tagged cell may be final already.
#[test]
fn chunk_before_a_run_of_tags() {
    let header = Header { bounds: None, ..header(true) };
    audit_events(&header, &[(&[], &[19]), (&LOWER_LEFT, &[5, 6, 4]), (&UPPER_RIGHT, &[7])]).unwrap();
}

#[test]
fn tags_must_be_news() {
    for tags in [&[4, 4][..], &[1, 16], &[16, 17, 18, 19, 4]] {
        let violation = audit_events(&header(false), &[(&[], tags)]).unwrap_err();
        assert_eq!(violation.check, Check::Cells, "{tags:?}");
    }
}

#[test]
fn bounds_must_hold_the_points() {
    audit_chunks(&header(false), &[(&LOWER_LEFT, &[])]).unwrap();
    let outside = [[3.75, 0.0, 5.0]];
    assert_eq!(audit_events(&header(false), &[(&outside, &[])]).unwrap_err().check, Check::Bounds);
}

#[test]
fn point_outside_of_the_tree() {
    let header = Header { bounds: None, ..header(false) };
    let violation = audit_events(&header, &[(&[[4.0, 0.0, 0.0]], &[])]).unwrap_err();
    assert_eq!((violation.check, &violation.vertices[..]), (Check::Region, &[(None, [4.0, 0.0, 0.0])][..]));
}

#[test]
fn octrees_pass_too() {
    let tree = CellTree::new(3, 5, [-8.0; 3], 16.0);
    let header = Header { tree, ..Header::new(Kind::Points, Coordinates::F64, 3, false) };
    let points = [[-1.0, 3.0, 7.0], [-1.5, 3.0, 7.5]];
    let cell = tree.unwrap().cell_of(points[0], 2).0;
    audit_chunks(&header, &[(&points, &[cell]), (&[[0.0; 3]], &[])]).unwrap();
    assert_violates(audit_chunks(&header, &[(&points, &[cell]), (&points, &[])]), Check::Cells, &[]);
}
