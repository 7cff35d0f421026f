//! Pixels that any number of triangles and points are painted on. Colours are chosen when all have come.

use tiny_skia::{ColorU8, Pixmap};

use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::Point2;
use spmesh_formats::raster::colour_map::{Colour, mix};

/// Samples of a pixel along each side.
const SAMPLES: usize = 2;

/// The opacity of edges.
const INK: f64 = 0.55;

/// An edge is visible if it is at most this far behind the nearest triangle. Units: lengths of the picture.
const DEPTH_TOLERANCE: f32 = 1.0;

/// The values and the brightness of a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Paint {
    /// Values at the corners, to be shown as colours.
    pub(super) values: [f64; 3],
    /// The brightness at the corners, from 0 to 1.
    pub(super) shades: [f64; 3],
}

/// A picture as PNG.
#[derive(Debug)]
pub(super) struct Pixels {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) png: Vec<u8>,
}

/// Samples of the pixels of a rectangle. They are values, not colours, because the length of a stream and its
/// range of elevations may be known only at its end.
///
/// A sample has the value of the last triangle there; with depths, the value of the nearest triangle. Two
/// triangles with a common edge compute from the same numbers where it crosses a row of samples, so no sample
/// between them is left out.
///
/// Memory: 52 bytes for each pixel, 68 with depths.
#[derive(Debug)]
pub(super) struct Canvas {
    /// The place of the upper left corner in the picture.
    corner: Point2,
    /// Samples of a row, and of a column.
    columns: usize,
    rows: usize,
    /// NaN where nothing was painted.
    values: Vec<f64>,
    shades: Vec<f32>,
    inked: Vec<bool>,
    /// The distances of the visible triangles; empty in a view from above.
    depths: Vec<f32>,
}

impl Canvas {
    /// A blank canvas of `width` times `height` pixels.
    pub(super) fn new(corner: Point2, [width, height]: [usize; 2], has_depths: bool) -> Canvas {
        let (columns, rows) = (SAMPLES * width, SAMPLES * height);
        let samples = columns * rows;
        Canvas {
            corner,
            columns,
            rows,
            values: vec![f64::NAN; samples],
            shades: vec![0.0; samples],
            inked: vec![false; samples],
            depths: vec![f32::INFINITY; if has_depths { samples } else { 0 }],
        }
    }

    /// Paints a triangle. Each corner is its place in the picture, and its depth.
    pub(super) fn triangle(&mut self, corners: [[f64; 3]; 3], paint: Paint) {
        let corners = corners.map(|corner| self.to_samples(corner));
        let [low, high] = range_of(corners.map(|corner| corner[1]));
        let value = Plane::of(corners, paint.values);
        let shade = Plane::of(corners, paint.shades);
        let depth = Plane::of(corners, corners.map(|corner| corner[2]));
        for row in among(low, high, self.rows) {
            let y = row as f64 + 0.5;
            let Some([left, right]) = crossing(corners, y) else { continue };
            for column in among(left, right, self.columns) {
                let (at, x) = (row * self.columns + column, column as f64 + 0.5);
                if self.is_hidden(at, || depth.at([x, y])) {
                    continue;
                }
                let shade = shade.at([x, y]) as f32;
                (self.values[at], self.shades[at], self.inked[at]) = (value.at([x, y]), shade, false);
            }
        }
    }

    /// Draws an edge on samples that have been painted.
    pub(super) fn edge(&mut self, ends: [[f64; 3]; 2]) {
        let mut ends = ends.map(|end| self.to_samples(end));
        // Both triangles of the edge must ink the same samples.
        if ends[1] < ends[0] {
            ends.swap(0, 1);
        }
        let [from, to] = ends;
        let span = (to[0] - from[0]).abs().max((to[1] - from[1]).abs());
        let Some(part) = inside(ends, [self.columns as f64, self.rows as f64]) else { return };
        let steps = (span * (part[1] - part[0])).ceil().max(1.0);
        for step in 0..=steps as u64 {
            let part = part[0] + (part[1] - part[0]) * step as f64 / steps;
            let [x, y, depth] = [0, 1, 2].map(|axis| from[axis] + part * (to[axis] - from[axis]));
            if x >= 0.0 && y >= 0.0 && x < self.columns as f64 && y < self.rows as f64 {
                let at = y as usize * self.columns + x as usize;
                // Rounding may put an edge behind its own triangles.
                self.inked[at] |= self.depths.is_empty() || depth as f32 <= self.depths[at] + DEPTH_TOLERANCE;
            }
        }
    }

    /// Draws the outlines of what is in front: samples next to others that are farther away by more than
    /// `least`, or blank.
    pub(super) fn outline(&mut self, least: f32) {
        let far = |canvas: &Canvas, at: usize| canvas.depths.get(at).copied().unwrap_or(f32::INFINITY);
        for row in 0..self.rows {
            for column in 0..self.columns {
                let at = row * self.columns + column;
                let depth = far(self, at);
                if depth.is_infinite() {
                    continue;
                }
                let below = if row + 1 < self.rows { far(self, at + self.columns) } else { f32::INFINITY };
                let above = if row > 0 { far(self, at - self.columns) } else { f32::INFINITY };
                let right = if column + 1 < self.columns { far(self, at + 1) } else { f32::INFINITY };
                let left = if column > 0 { far(self, at - 1) } else { f32::INFINITY };
                self.inked[at] |= [below, above, right, left].iter().any(|other| other - depth > least);
            }
        }
    }

    /// Paints a point as a square two pixels wide, so that a single one is visible.
    pub(super) fn point(&mut self, at: Point2, value: f64) {
        let [x, y, _] = self.to_samples([at[0], at[1], 0.0]);
        let reach = SAMPLES as f64;
        for row in among(y - reach, y + reach, self.rows) {
            for column in among(x - reach, x + reach, self.columns) {
                self.values[row * self.columns + column] = value;
            }
        }
    }

    /// The values of all samples, NaN where nothing was painted.
    pub(super) fn values(&self) -> &[f64] {
        &self.values
    }

    /// The picture; `colour` maps a value and a brightness to a colour.
    pub(super) fn pixels(&self, colour: impl Fn(f64, f64) -> Colour) -> Result<Pixels> {
        let (width, height) = (self.columns / SAMPLES, self.rows / SAMPLES);
        let mut pixmap = Pixmap::new(width as u32, height as u32).ok_or_else(too_large)?;
        for (at, pixel) in pixmap.pixels_mut().iter_mut().enumerate() {
            *pixel = self.pixel([at % width, at / width], &colour).premultiply();
        }
        let png = pixmap.encode_png().map_err(|_| too_large())?;
        Ok(Pixels { width, height, png })
    }

    /// The mean of the samples of a pixel. Blank samples make it transparent.
    fn pixel(&self, [column, row]: [usize; 2], colour: &impl Fn(f64, f64) -> Colour) -> ColorU8 {
        let (mut sums, mut found) = ([0u32; 3], 0);
        for at in (0..SAMPLES * SAMPLES).map(|sample| {
            (SAMPLES * row + sample / SAMPLES) * self.columns + SAMPLES * column + sample % SAMPLES
        }) {
            if self.values[at].is_nan() {
                continue;
            }
            let bare = colour(self.values[at], f64::from(self.shades[at]));
            let seen = if self.inked[at] { mix(bare, [0; 3], INK) } else { bare };
            (0..3).for_each(|channel| sums[channel] += u32::from(seen[channel]));
            found += 1;
        }
        let [r, g, b] = sums.map(|sum| ((sum + found / 2) / found.max(1)) as u8);
        ColorU8::from_rgba(r, g, b, (255 * found / (SAMPLES * SAMPLES) as u32) as u8)
    }

    /// Whether a nearer triangle hides a sample. If not, the sample gets the new depth.
    fn is_hidden(&mut self, at: usize, depth: impl Fn() -> f64) -> bool {
        let Some(nearest) = self.depths.get_mut(at) else { return false };
        let depth = depth() as f32;
        if depth > *nearest {
            return true;
        }
        *nearest = depth;
        false
    }

    fn to_samples(&self, [x, y, depth]: [f64; 3]) -> [f64; 3] {
        [(x - self.corner[0]) * SAMPLES as f64, (y - self.corner[1]) * SAMPLES as f64, depth]
    }
}

/// A linear function on a triangle.
struct Plane {
    corner: Point2,
    value: f64,
    gradient: Point2,
    range: [f64; 2],
}

impl Plane {
    fn of(corners: [[f64; 3]; 3], values: [f64; 3]) -> Plane {
        let [a, b, c] = corners;
        let [u, v] = [b, c].map(|corner| [corner[0] - a[0], corner[1] - a[1]]);
        let [s, t] = [values[1] - values[0], values[2] - values[0]];
        let determinant = u[0] * v[1] - u[1] * v[0];
        let gradient = [(s * v[1] - t * u[1]) / determinant, (t * u[0] - s * v[0]) / determinant];
        // A needle has the value of its first corner.
        let gradient = if gradient.iter().all(|part| part.is_finite()) { gradient } else { [0.0; 2] };
        Plane { corner: [a[0], a[1]], value: values[0], gradient, range: range_of(values) }
    }

    fn at(&self, [x, y]: Point2) -> f64 {
        let [p, q] = self.gradient;
        let value = self.value + p * (x - self.corner[0]) + q * (y - self.corner[1]);
        value.clamp(self.range[0], self.range[1])
    }
}

/// The least and the greatest of three numbers.
fn range_of([a, b, c]: [f64; 3]) -> [f64; 2] {
    [a.min(b).min(c), a.max(b).max(c)]
}

/// The indices below `count` whose centres are in the half-open interval from `low` to `high`.
fn among(low: f64, high: f64, count: usize) -> std::ops::Range<usize> {
    // Conversion saturates.
    let first = |bound: f64| ((bound - 0.5).ceil().max(0.0) as usize).min(count);
    first(low)..first(high)
}

/// Where a row enters and leaves a triangle. An edge includes its lower end only, so a row crosses either two
/// edges or none.
fn crossing([a, b, c]: [[f64; 3]; 3], y: f64) -> Option<[f64; 2]> {
    let mut found = [0.0; 2];
    let mut count = 0;
    for [from, to] in [[a, b], [b, c], [c, a]] {
        // From the least end, so that both triangles of an edge compute the same place.
        let [low, high] = if (from[1], from[0]) < (to[1], to[0]) { [from, to] } else { [to, from] };
        if low[1] <= y && y < high[1] && count < 2 {
            found[count] = low[0] + (y - low[1]) * ((high[0] - low[0]) / (high[1] - low[1]));
            count += 1;
        }
    }
    let [p, q] = found;
    (count == 2).then(|| [p.min(q), p.max(q)])
}

/// The part of a line inside a box with its corner at zero; this bounds the number of steps along the line.
fn inside([from, to]: [[f64; 3]; 2], size: Point2) -> Option<[f64; 2]> {
    let mut part = [0.0f64, 1.0f64];
    for axis in 0..2 {
        let along = to[axis] - from[axis];
        let [enter, leave] = [0.0, size[axis]].map(|side| (side - from[axis]) / along);
        if along == 0.0 {
            if !(0.0..size[axis]).contains(&from[axis]) {
                return None;
            }
            continue;
        }
        part = [part[0].max(enter.min(leave)), part[1].min(enter.max(leave))];
    }
    (part[0] <= part[1]).then_some(part)
}

/// The error of a picture whose pixels do not fit in memory.
pub(super) fn too_large() -> Error {
    Error::usage("the picture is too large: take less --width")
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: usize = 16;

    /// The least and the greatest value.
    fn range(canvas: &Canvas) -> [f64; 2] {
        let known = canvas.values.iter().copied().filter(|value| !value.is_nan());
        known.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
    }

    fn counted(triangles: &[[[f64; 3]; 3]]) -> Vec<u32> {
        let mut counts = vec![0; 4 * SIZE * SIZE];
        for &corners in triangles {
            let mut canvas = Canvas::new([0.0; 2], [SIZE; 2], false);
            canvas.triangle(corners, Paint { values: [1.0; 3], shades: [0.0; 3] });
            let hits = canvas.values.iter().map(|value| u32::from(!value.is_nan()));
            counts.iter_mut().zip(hits).for_each(|(count, hit)| *count += hit);
        }
        counts
    }

    #[test]
    fn fans_cover_each_sample_once() {
        // Centres of samples, corners of samples, and other places.
        for centre in [[5.25, 5.25], [8.0, 8.0], [3.1, 12.7], [0.25, 0.25], [15.75, 0.25]] {
            let rim: Vec<[f64; 3]> =
                [[0.0, 0.0], [7.25, 0.0], [16.0, 0.0], [16.0, 16.0], [4.0, 16.0], [0.0, 16.0]]
                    .map(|[x, y]| [x, y, 0.0])
                    .to_vec();
            let next = rim.iter().cycle().skip(1);
            let fan: Vec<_> =
                rim.iter().zip(next).map(|(&a, &b)| [a, b, [centre[0], centre[1], 0.0]]).collect();
            assert!(counted(&fan).iter().all(|&count| count == 1), "{centre:?}");
        }
    }

    #[test]
    fn numbers_are_interpolated_and_nearer_triangles_hide_others() {
        let corners = |depth: f64| [[0.0, 0.0, depth], [16.0, 0.0, depth], [0.0, 16.0, depth]];
        let mut canvas = Canvas::new([0.0; 2], [SIZE; 2], true);
        canvas.triangle(corners(2.0), Paint { values: [0.0, 16.0, 0.0], shades: [0.5; 3] });
        assert!((canvas.values[2 * SIZE * 2 + 6] - 3.25).abs() < 1e-12);
        canvas.triangle(corners(3.0), Paint { values: [9.0; 3], shades: [0.5; 3] });
        assert!((canvas.values[2 * SIZE * 2 + 6] - 3.25).abs() < 1e-12);
        canvas.triangle(corners(1.0), Paint { values: [9.0; 3], shades: [0.5; 3] });
        assert_eq!(range(&canvas), [9.0, 9.0]);
    }

    #[test]
    fn what_is_far_away_takes_no_time() {
        let mut canvas = Canvas::new([0.0; 2], [SIZE; 2], false);
        let far = [[-1e300, -1e300, 0.0], [1e300, -1e300, 0.0], [0.0, 1e300, 0.0]];
        canvas.triangle(far, Paint { values: [1.0; 3], shades: [0.0; 3] });
        canvas.edge([[-1e12, 4.0, 0.0], [1e12, 4.0, 0.0]]);
        assert_eq!(canvas.inked.iter().filter(|&&is_inked| is_inked).count(), 2 * SIZE);
        canvas.edge([[-1e300, -1e300, 0.0], [1e300, -1e300, 0.0]]);
        canvas.point([-5.0, 1e300], 0.0);
        assert_eq!(range(&canvas), [1.0, 1.0]);
    }
}
