//! Cuts triangles along the borders of tiles.
//!
//! A border point is computed from the ends of one edge, in an order that does not depend on the triangle,
//! and is exactly on the border: so all pieces around it have the same point. Columns are cut first. A border
//! between columns is then an edge of what is left and right of it, with the same ends, so rows cut it at the
//! same points, too. See `docs/theory/tiles.md`.

use super::scheme::{Place, Scheme, Tile};

/// The point of an edge where a coordinate has a value that is between those of its ends.
fn crossing(a: Place, b: Place, axis: usize, value: f64) -> Place {
    let is_ordered = (a[axis], a[1 - axis], a[2]) <= (b[axis], b[1 - axis], b[2]);
    let (a, b) = if is_ordered { (a, b) } else { (b, a) };
    let part = (value - a[axis]) / (b[axis] - a[axis]);
    let mut place = [0, 1, 2].map(|i| a[i] + part * (b[i] - a[i]));
    place[axis] = value;
    place
}

/// The corners of a convex polygon, with the points between them at which it crosses the given values.
fn with_crossings(polygon: &[Place], axis: usize, values: &[f64], cut: &mut Vec<Place>) {
    cut.clear();
    for (number, &a) in polygon.iter().enumerate() {
        let b = polygon[(number + 1) % polygon.len()];
        let (min, max) = (a[axis].min(b[axis]), a[axis].max(b[axis]));
        let between = values.iter().filter(|&&value| min < value && value < max);
        cut.push(a);
        let start = cut.len();
        cut.extend(between.map(|&value| crossing(a, b, axis, value)));
        if a[axis] > b[axis] {
            cut[start..].reverse();
        }
    }
}

/// Working memory for cutting.
#[derive(Debug, Default)]
pub(super) struct Knife {
    values: Vec<f64>,
    by_columns: Vec<Place>,
    strip: Vec<Place>,
    by_rows: Vec<Place>,
    cell: Vec<Place>,
}

impl Knife {
    /// Calls `take` with each tile that a triangle is in, and the corners of its part there, in the order of
    /// the triangle's.
    pub(super) fn cut(
        &mut self,
        (scheme, level): (Scheme, u32),
        triangle: [Place; 3],
        mut take: impl FnMut(Tile, &[Place]),
    ) {
        let Knife { values, by_columns, strip, by_rows, cell } = self;
        let [west, east] = range(&triangle, 0);
        let columns = scheme.columns_of(level, west, east);
        values.clear();
        values.extend((*columns.start()..=columns.end() + 1).map(|column| scheme.west(level, column)));
        with_crossings(&triangle, 0, values, by_columns);
        for x in columns {
            select(by_columns, 0, [scheme.west(level, x), scheme.west(level, x + 1)], strip);
            if strip.len() < 3 {
                continue;
            }
            let [south, north] = range(strip, 1);
            let rows = scheme.rows_of(level, south, north);
            values.clear();
            values.extend((*rows.start()..=rows.end() + 1).map(|row| scheme.south(level, row)));
            with_crossings(strip, 1, values, by_rows);
            for y in rows {
                select(by_rows, 1, [scheme.south(level, y), scheme.south(level, y + 1)], cell);
                if cell.len() >= 3 {
                    take(Tile { x, y }, cell);
                }
            }
        }
    }
}

fn range(places: &[Place], axis: usize) -> [f64; 2] {
    let along = || places.iter().map(|place| place[axis]);
    [along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max)]
}

/// The points between two values: those of a part of the polygon, as it has its crossings.
fn select(polygon: &[Place], axis: usize, [min, max]: [f64; 2], part: &mut Vec<Place>) {
    part.clear();
    part.extend(polygon.iter().filter(|place| (min..=max).contains(&place[axis])));
}
