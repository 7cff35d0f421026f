//! Lines before noding: without repeated vertices and gaps of elevations, and with long parts divided.

use super::Options;
use super::changes::{ChangeKind, Changes};
use spmesh_base::error::Result;
use spmesh_base::limits::check_line_vertices;
use spmesh_formats::source::Breakline;
use spmesh_stream::model::points::Point2;

/// A vertex in world coordinates, with its elevation.
type Vertex = (Point2, Option<f64>);

/// Prepares a line: leaves out vertices that repeat the one before, interpolates elevations between known
/// ones, and divides parts longer than `options` say evenly.
pub(crate) fn prepare(
    line: Breakline,
    number: u32,
    options: &Options,
    changes: &mut Changes,
) -> Result<Vec<Vertex>> {
    let mut vertices: Vec<Vertex> = line.vertices.into_iter().zip(line.elevations).collect();
    let mut kept = 0;
    for index in 0..vertices.len() {
        let vertex = vertices[index];
        // Vertices at one place that state different elevations are in conflict, which noding counts.
        if kept > 0 && vertices[kept - 1].0 == vertex.0 {
            let known = &mut vertices[kept - 1].1;
            if known.is_none() || vertex.1.is_none() || *known == vertex.1 {
                *known = known.or(vertex.1);
                changes.note(ChangeKind::RepeatedVertex, number, || vertex.0);
                continue;
            }
        }
        vertices[kept] = vertex;
        kept += 1;
    }
    vertices.truncate(kept);
    fill(&mut vertices, number, changes);
    match options.densify {
        Some(longest) => divide(&vertices, longest, options.vertices_max, number, changes),
        None => Ok(vertices),
    }
}

/// Interpolates elevations linearly along the line, between the next vertices before and behind that have
/// one.
fn fill(vertices: &mut [Vertex], number: u32, changes: &mut Changes) {
    let mut before: Option<usize> = None;
    for index in 0..vertices.len() {
        if vertices[index].1.is_none() {
            continue;
        }
        if let Some(first) = before.filter(|&first| first + 1 < index) {
            fill_gap(&mut vertices[first..=index], number, changes);
        }
        before = Some(index);
    }
}

/// Fills the gap between the first and the last vertex. The end that is lexicographically lesser comes first
/// in sums, so that the direction of the line does not matter.
fn fill_gap(gap: &mut [Vertex], number: u32, changes: &mut Changes) {
    let (first, last) = (gap[0], gap[gap.len() - 1]);
    let is_reversed = (last.0, last.1) < (first.0, first.1);
    if is_reversed {
        gap.reverse();
    }
    let lengths: Vec<f64> = gap.windows(2).map(|part| length(part[0].0, part[1].0)).collect();
    let whole: f64 = lengths.iter().sum();
    let (from, to) = (gap[0].1.unwrap_or(0.0), gap[gap.len() - 1].1.unwrap_or(0.0));
    let mut along = 0.0;
    for (index, length) in lengths[..lengths.len() - 1].iter().enumerate() {
        along += length;
        let part = if whole > 0.0 { along / whole } else { 0.0 };
        gap[index + 1].1 = Some(from + (to - from) * part);
        changes.note(ChangeKind::FilledElevation, number, || gap[index + 1].0);
    }
    if is_reversed {
        gap.reverse();
    }
}

fn length(a: Point2, b: Point2) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

/// Divides parts that are longer than `longest` evenly, with elevations where both ends have one.
fn divide(
    vertices: &[Vertex],
    longest: f64,
    most: usize,
    number: u32,
    changes: &mut Changes,
) -> Result<Vec<Vertex>> {
    let mut divided = Vec::with_capacity(vertices.len());
    for (index, &vertex) in vertices.iter().enumerate() {
        if let Some(&before) = index.checked_sub(1).and_then(|before| vertices.get(before)) {
            let count = (length(before.0, vertex.0) / longest).ceil();
            // A count beyond the numbers of `usize` becomes the greatest of them.
            check_line_vertices((count as usize).saturating_add(divided.len()), most)
                .map_err(|error| error.noting(&format!("parts of at most {longest:?}: divide lines less")))?;
            let is_reversed = vertex.0 < before.0;
            let (a, b) = if is_reversed { (vertex, before) } else { (before, vertex) };
            for step in 1..count as u32 {
                let step = if is_reversed { count - f64::from(step) } else { f64::from(step) };
                let part = step / count;
                let between = |a: f64, b: f64| a + (b - a) * part;
                let place = [between(a.0[0], b.0[0]), between(a.0[1], b.0[1])];
                divided.push((place, a.1.zip(b.1).map(|(a, b)| between(a, b))));
                changes.note(ChangeKind::Densified, number, || place);
            }
        }
        divided.push(vertex);
    }
    Ok(divided)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    fn prepared(vertices: &[(Point2, Option<f64>)], densify: Option<f64>) -> (Vec<Vertex>, Changes) {
        let (vertices, elevations) = vertices.iter().copied().unzip();
        let line = Breakline {
            vertices,
            elevations,
            is_point: false,
            polygon: None,
            properties: Arc::default(),
            position: "".into(),
        };
        let mut changes = Changes::new(false);
        (prepare(line, 0, &Options { densify, ..Options::default() }, &mut changes).unwrap(), changes)
    }

    #[test]
    fn gaps_are_filled_along_the_line() {
        let line = [
            ([0.0, 0.0], None),
            ([1.0, 0.0], Some(10.0)),
            ([1.0, 3.0], None),
            ([1.0, 3.0], None),
            ([2.0, 3.0], Some(14.0)),
            ([2.0, 4.0], None),
        ];
        let (mut filled, changes) = prepared(&line, None);
        let elevations: Vec<_> = filled.iter().map(|vertex| vertex.1).collect();
        assert_eq!(elevations, [None, Some(10.0), Some(13.0), Some(14.0), None]);
        assert_eq!(changes.count(ChangeKind::FilledElevation), 1);
        assert_eq!(changes.count(ChangeKind::RepeatedVertex), 1);
        let mut reversed = line;
        reversed.reverse();
        filled.reverse();
        assert_eq!(prepared(&reversed, None).0, filled);
    }

    #[test]
    fn long_parts_are_divided_evenly() {
        let line = [([0.0, 0.0], Some(0.0)), ([10.0, 0.0], Some(1.0)), ([10.0, 2.0], None)];
        let (divided, changes) = prepared(&line, Some(4.0));
        let x: Vec<f64> = divided.iter().map(|vertex| vertex.0[0]).collect();
        assert_eq!(x, [0.0, 10.0 * (1.0 / 3.0), 10.0 * (2.0 / 3.0), 10.0, 10.0]);
        assert_eq!(divided[1].1, Some(1.0 / 3.0));
        assert_eq!(changes.count(ChangeKind::Densified), 2);
        let mut reversed = line;
        reversed.reverse();
        let mut again = prepared(&reversed, Some(4.0)).0;
        again.reverse();
        assert_eq!(again, divided);
        assert!(
            prepare(
                Breakline {
                    vertices: vec![[0.0, 0.0], [1.0, 0.0]],
                    elevations: vec![None; 2],
                    is_point: false,
                    polygon: None,
                    properties: Arc::default(),
                    position: "".into()
                },
                0,
                &Options { densify: Some(1e-300), ..Options::default() },
                &mut Changes::new(false)
            )
            .is_err()
        );
    }
}
