//! A partial mesh that passes the audit can be merged.

use spmesh_audit::{Audit, Standard};
use spmesh_base::error::{ErrorKind, Result};
use spmesh_pipeline::reduce::{Options, Part, merge_tetrahedra, merge_triangles};
use spmesh_stream::model::bounds::{Point, Region};
use spmesh_stream::{Event, Header, StreamReader, StreamWriter};

use super::solids::tetrahedralize;
use super::streams::{GRID, Tagging, stream_of, threads, triangulate};
use spmesh_reference::clouds::{Family, of};
use spmesh_reference::sets::Random;

/// The part of a cloud of integers at x < 0, or at x >= 0.
fn half_of(dims: u8, seed: u64, is_west: bool) -> Vec<u8> {
    let points = of(&mut Random::new(seed), Family::Integers, 300);
    let input = stream_of(dims, &points, GRID, Tagging::Chunked(1), &mut Random::new(2));
    let infinite = f64::INFINITY;
    let [low, high] = if is_west { [-infinite, 0.0] } else { [0.0, infinite] };
    if dims == 2 {
        let region = Region { min: [low, -infinite], max: [high, infinite] };
        let options = Options { part: Some(Part::Region(region)), every_node: true, ..threads(1) };
        triangulate(&input, &options).unwrap().0
    } else {
        let region = Region { min: [low, -infinite, -infinite], max: [high, infinite, infinite] };
        let part = Some(Part::Region(region));
        tetrahedralize(&input, &Options { part, threads: 1, every_node: true, ..Options::default() })
            .unwrap()
            .0
    }
}

fn events_of(bytes: &[u8]) -> (Header, Vec<Event>) {
    let mut reader = StreamReader::new(bytes, "part").unwrap();
    let mut events = Vec::new();
    while let Some(event) = reader.next_event().unwrap() {
        events.push(event);
    }
    (reader.header().clone(), events)
}

/// A stream of these events, with more points of the input than they have.
fn stream(header: &Header, events: &[Event], more: u64) -> Result<Vec<u8>> {
    let mut writer = StreamWriter::new(Vec::new(), header.clone())?;
    for event in events {
        match event {
            Event::Patch(patch) => writer.patch(patch)?,
            Event::ResidualPoints(points) => writer.residual_points(points)?,
            Event::Walls(walls) => writer.walls(walls)?,
            Event::End(totals) => return writer.end(totals.points + more, totals.merged),
            other => panic!("{other:?} in a partial mesh"),
        }
    }
    panic!("no END");
}

fn merged(bytes: &[u8], dims: u8) -> Result<Vec<u8>> {
    let readers = vec![StreamReader::new(bytes, "part")?];
    if dims == 2 {
        Ok(merge_triangles(readers, Vec::new(), &Default::default(), |_| ())?.0)
    } else {
        Ok(merge_tetrahedra(readers, Vec::new(), &Default::default(), |_| ())?.0)
    }
}

fn is_proven(bytes: &[u8]) -> bool {
    let mut reader = StreamReader::new(bytes, "part").unwrap();
    let mut audit = Audit::new(reader.header(), Standard::Canonical, None).unwrap();
    while let Some(event) = reader.next_event().unwrap() {
        if audit.event(&event).is_err() {
            return false;
        }
    }
    true
}

/// The block and the input are those of the fault, whatever comes before.
#[test]
fn what_does_not_fit_is_named_by_input_and_block() {
    let (mut header, mut events) = events_of(&half_of(2, 1, true));
    header.bounds = None;
    let number = events.iter().position(|event| matches!(event, Event::ResidualPoints(_))).unwrap();
    let Event::Patch(patch) = &events[0] else { panic!("no patch") };
    let inner = patch.new[patch.simplices[0] as usize];
    events.insert(number + 1, Event::ResidualPoints(vec![(None, inner)]));
    let damaged = stream(&header, &events, 1).unwrap();
    let east = half_of(2, 1, false);
    let readers = [(&east, "east.spm"), (&damaged, "west.spm")]
        .map(|(part, name)| StreamReader::new(&part[..], name).unwrap());
    let message = merge_triangles(readers.into(), Vec::new(), &Default::default(), |_| ())
        .map(drop)
        .unwrap_err()
        .to_string();
    assert!(message.starts_with(&format!("west.spm: block {} at byte ", number + 1)), "{message}");
}

/// Adds residual points in and around what is final: some lie in final simplices, some in balls, some
/// nowhere.
#[test]
fn what_the_audit_proves_can_be_merged() {
    for dims in [2, 3] {
        let mut random = Random::new(7);
        let (mut proven, mut refused) = (0, 0);
        for seed in 0..6 {
            let (mut header, events) = events_of(&half_of(dims, seed, true));
            header.bounds = None;
            let places: Vec<Point> = events.iter().filter_map(places).flatten().collect();
            for _ in 0..60 {
                let mut coordinate = || {
                    let place = places[random.integer(0, places.len() as i64 - 1) as usize];
                    let off = random.integer(-4, 4) as f64;
                    place.map(|x| x + off)
                };
                let (mut at, other) = (coordinate(), coordinate());
                at[1] = (at[1] + other[1]).div_euclid(2.0);
                at[2] = if dims == 2 { 0.0 } else { at[2] };
                if at[0] >= 0.0 {
                    continue;
                }
                let mut events = events.clone();
                let Some(Event::ResidualPoints(points)) =
                    events.iter_mut().find(|event| matches!(event, Event::ResidualPoints(_)))
                else {
                    panic!("no residual");
                };
                points.push((None, at));
                let bytes = stream(&header, &events, 1).unwrap();
                match (is_proven(&bytes), merged(&bytes, dims)) {
                    (true, Ok(mesh)) => {
                        assert!(is_proven(&mesh));
                        proven += 1;
                    }
                    (true, Err(error)) => panic!("{at:?} of set {seed} in {dims} dimensions: {error}"),
                    (false, Err(error)) => {
                        assert_eq!(error.kind(), ErrorKind::Malformed, "{error}");
                        let message = error.to_string();
                        assert!(message.starts_with("part: block "), "{message}");
                        refused += 1;
                    }
                    // Merging does not look into the balls of final simplices.
                    (false, Ok(mesh)) => {
                        assert!(!is_proven(&mesh), "{at:?} of set {seed}, {dims} dimensions")
                    }
                }
            }
        }
        assert!(proven > 20 && refused > 20, "{dims} dimensions: {proven} proven, {refused} refused");
    }
}

fn places(event: &Event) -> Option<Vec<Point>> {
    match event {
        Event::Patch(patch) => Some(patch.new.clone()),
        Event::ResidualPoints(points) => Some(points.iter().map(|&(_, at)| at).collect()),
        _ => None,
    }
}
