//! Pixels that triangles and points are painted on, in any number: what they show is known when all are there.

use resvg::tiny_skia::{ColorU8, Pixmap};

use super::ramp::{Colour, mix};
use spmesh_core::error::{Error, Result};
use spmesh_geometry::predicates::Point2;

/// Samples of a pixel along each side.
const SAMPLES: usize = 2;

/// How much of edges is seen.
const INK: f64 = 0.55;

/// An edge is seen if it is not farther behind what is seen there. Units: lengths of the picture.
const DEPTH_TOLERANCE: f32 = 1.0;

/// What is painted with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Paint {
    /// Numbers at the corners, to be shown as colours.
    pub(super) values: [f64; 3],
    /// How bright the triangle is, from 0 to 1.
    pub(super) shade: f32,
}

/// A picture as PNG.
#[derive(Debug)]
pub(super) struct Pixels {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) png: Vec<u8>,
}

/// Samples of the pixels of a rectangle: numbers, not colours, because how long a stream is and between which elevations it lies
/// may be known at its end only.
///
/// A sample has what the last triangle, or with depths the nearest one, has there. Triangles with a common edge compute where it
/// crosses a row of samples from the same numbers, so that no sample between them is left out.
///
/// Memory: 52 bytes for each pixel, 68 with depths.
#[derive(Debug)]
pub(super) struct Canvas {
    /// The place of the upper left corner in the picture.
    corner: Point2,
    /// Samples of a row, and of a column.
    columns: usize,
    rows: usize,
    /// NaN where nothing is.
    values: Vec<f64>,
    shades: Vec<f32>,
    inked: Vec<bool>,
    /// How far away what is seen is; empty if all is seen.
    depths: Vec<f32>,
}

impl Canvas {
    /// Nothing painted so far, on so many pixels.
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

    /// Paints a triangle, whose corners have a place in the picture and a depth.
    pub(super) fn triangle(&mut self, corners: [[f64; 3]; 3], paint: Paint) {
        let corners = corners.map(|corner| self.to_samples(corner));
        let [low, high] = range_of(corners.map(|corner| corner[1]));
        let value = Plane::of(corners, paint.values);
        let depth = Plane::of(corners, corners.map(|corner| corner[2]));
        for row in among(low, high, self.rows) {
            let y = row as f64 + 0.5;
            let Some([left, right]) = crossing(corners, y) else { continue };
            for column in among(left, right, self.columns) {
                let (at, x) = (row * self.columns + column, column as f64 + 0.5);
                if self.is_hidden(at, || depth.at([x, y])) {
                    continue;
                }
                (self.values[at], self.shades[at], self.inked[at]) = (value.at([x, y]), paint.shade, false);
            }
        }
    }

    /// Inks an edge, on samples that have been painted.
    pub(super) fn edge(&mut self, ends: [[f64; 3]; 2]) {
        let mut ends = ends.map(|end| self.to_samples(end));
        // The same samples for both triangles.
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
                // An edge is as far away as its triangles.
                self.inked[at] |= self.depths.is_empty() || depth as f32 <= self.depths[at] + DEPTH_TOLERANCE;
            }
        }
    }

    /// Paints a point: a square around it, two pixels wide, so that a single one is seen.
    pub(super) fn point(&mut self, at: Point2, value: f64) {
        let [x, y, _] = self.to_samples([at[0], at[1], 0.0]);
        let reach = SAMPLES as f64;
        for row in among(y - reach, y + reach, self.rows) {
            for column in among(x - reach, x + reach, self.columns) {
                self.values[row * self.columns + column] = value;
            }
        }
    }

    /// The picture: `colour` says what a number looks like on a surface of some shade.
    ///
    /// # Errors
    /// If the picture is too large.
    pub(super) fn pixels(&self, colour: impl Fn(f64, f64) -> Colour) -> Result<Pixels> {
        let (width, height) = (self.columns / SAMPLES, self.rows / SAMPLES);
        let mut pixmap = Pixmap::new(width as u32, height as u32).ok_or_else(too_large)?;
        for (at, pixel) in pixmap.pixels_mut().iter_mut().enumerate() {
            *pixel = self.pixel([at % width, at / width], &colour).premultiply();
        }
        let png = pixmap.encode_png().map_err(|_| too_large())?;
        Ok(Pixels { width, height, png })
    }

    /// The mean of the samples of a pixel; those where nothing is make it transparent.
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

    /// Whether something nearer is seen at a sample; if not, that has the new depth.
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

/// A number that is linear on a triangle.
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
        // A needle has the number of its first corner.
        let gradient = if gradient.iter().all(|part| part.is_finite()) { gradient } else { [0.0; 2] };
        Plane { corner: [a[0], a[1]], value: values[0], gradient, range: range_of(values) }
    }

    fn at(&self, [x, y]: Point2) -> f64 {
        let [p, q] = self.gradient;
        let value = self.value + p * (x - self.corner[0]) + q * (y - self.corner[1]);
        value.clamp(self.range[0], self.range[1])
    }
}

/// Least and greatest of three numbers.
fn range_of([a, b, c]: [f64; 3]) -> [f64; 2] {
    [a.min(b).min(c), a.max(b).max(c)]
}

/// The numbers below `count` whose centres are from `low` on and before `high`.
fn among(low: f64, high: f64, count: usize) -> std::ops::Range<usize> {
    // What is beyond the range of integers becomes its end.
    let first = |bound: f64| ((bound - 0.5).ceil().max(0.0) as usize).min(count);
    first(low)..first(high)
}

/// Where a row enters and leaves a triangle. An edge has its lower end and not its upper one, so a row crosses none or two.
fn crossing([a, b, c]: [[f64; 3]; 3], y: f64) -> Option<[f64; 2]> {
    let mut found = [0.0; 2];
    let mut count = 0;
    for [from, to] in [[a, b], [b, c], [c, a]] {
        // From the least end, whichever triangle asks.
        let [low, high] = if (from[1], from[0]) < (to[1], to[0]) { [from, to] } else { [to, from] };
        if low[1] <= y && y < high[1] && count < 2 {
            found[count] = low[0] + (y - low[1]) * ((high[0] - low[0]) / (high[1] - low[1]));
            count += 1;
        }
    }
    let [p, q] = found;
    (count == 2).then(|| [p.min(q), p.max(q)])
}

/// The part of a line that is in a box from zero on: so the steps along it are as few as its sides allow.
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

/// What is wrong if there is no room for pixels.
pub(super) fn too_large() -> Error {
    Error::usage("the picture is too large: take less --width")
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: usize = 16;

    /// Least and greatest number.
    fn range(canvas: &Canvas) -> [f64; 2] {
        let known = canvas.values.iter().copied().filter(|value| !value.is_nan());
        known.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
    }

    fn counted(triangles: &[[[f64; 3]; 3]]) -> Vec<u32> {
        let mut counts = vec![0; 4 * SIZE * SIZE];
        for &corners in triangles {
            let mut canvas = Canvas::new([0.0; 2], [SIZE; 2], false);
            canvas.triangle(corners, Paint { values: [1.0; 3], shade: 0.0 });
            let hits = canvas.values.iter().map(|value| u32::from(!value.is_nan()));
            counts.iter_mut().zip(hits).for_each(|(count, hit)| *count += hit);
        }
        counts
    }

    #[test]
    fn fans_cover_each_sample_once() {
        // Around places that are samples, corners of samples, and others.
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
        canvas.triangle(corners(2.0), Paint { values: [0.0, 16.0, 0.0], shade: 0.5 });
        assert!((canvas.values[2 * SIZE * 2 + 6] - 3.25).abs() < 1e-12);
        canvas.triangle(corners(3.0), Paint { values: [9.0; 3], shade: 0.5 });
        assert!((canvas.values[2 * SIZE * 2 + 6] - 3.25).abs() < 1e-12);
        canvas.triangle(corners(1.0), Paint { values: [9.0; 3], shade: 0.5 });
        assert_eq!(range(&canvas), [9.0, 9.0]);
    }

    #[test]
    fn what_is_far_away_takes_no_time() {
        let mut canvas = Canvas::new([0.0; 2], [SIZE; 2], false);
        let far = [[-1e300, -1e300, 0.0], [1e300, -1e300, 0.0], [0.0, 1e300, 0.0]];
        canvas.triangle(far, Paint { values: [1.0; 3], shade: 0.0 });
        canvas.edge([[-1e12, 4.0, 0.0], [1e12, 4.0, 0.0]]);
        assert_eq!(canvas.inked.iter().filter(|&&is_inked| is_inked).count(), 2 * SIZE);
        canvas.edge([[-1e300, -1e300, 0.0], [1e300, -1e300, 0.0]]);
        canvas.point([-5.0, 1e300], 0.0);
        assert_eq!(range(&canvas), [1.0, 1.0]);
    }
}
