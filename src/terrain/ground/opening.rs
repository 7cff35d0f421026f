//! Morphological openings of rasters with gaps, by disks of cells.
//!
//! The opening of a raster by a disk is the greatest function below it that disks can reach: at each cell,
//! the highest of the disks around it whose centre is a known cell, each pushed up until it meets the raster.
//! Cells without a value neither stop a disk nor are its centre. Source: Pingel, Clarke, McBride (2013), with
//! gaps instead of cells filled before.

/// The value of cells where nothing is known: above all others, so that it stops no disk.
pub(super) const GAP: f32 = f32::INFINITY;

/// A raster, row by row; [`GAP`] where nothing is known.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Raster {
    pub(super) columns: usize,
    pub(super) values: Vec<f32>,
}

/// How far a disk reaches to both sides in each of its rows.
pub(super) fn disk(radius: usize) -> Vec<usize> {
    let square = radius * radius;
    let reach = |row: usize| (square - row.abs_diff(radius).pow(2)).isqrt();
    (0..=2 * radius).map(reach).collect()
}

impl Raster {
    pub(super) fn rows(&self) -> usize {
        self.values.len() / self.columns
    }

    /// The opening by a disk, without the cells within twice its radius of the border, which may depend on
    /// cells beyond: both sides are shorter by four times the radius. Domain: they are longer.
    pub(super) fn opened(&self, radius: usize) -> Raster {
        let (spans, width) = (disk(radius), self.columns - 2 * radius);
        let mut centres = slid::<false>(&self.values, self.columns, &spans);
        self.where_unknown(radius, &mut centres, f32::NEG_INFINITY);
        let mut opened = slid::<true>(&centres, width, &spans);
        self.where_unknown(2 * radius, &mut opened, GAP);
        Raster { columns: width - 2 * radius, values: opened }
    }

    /// Sets the values of those cells of a part of the raster, without `border` cells at each side, that are
    /// not known.
    fn where_unknown(&self, border: usize, part: &mut [f32], value: f32) {
        let width = self.columns - 2 * border;
        for (row, part) in part.chunks_exact_mut(width).enumerate() {
            let here = &self.values[(row + border) * self.columns + border..];
            let unknown = part.iter_mut().zip(here).filter(|(_, z)| **z == GAP);
            unknown.for_each(|(part, _)| *part = value);
        }
    }

    /// The raster without so many cells at each side.
    pub(super) fn cropped(&self, border: usize) -> Raster {
        let columns = self.columns - 2 * border;
        let rows = border..self.rows() - border;
        let values =
            rows.flat_map(|row| &self.values[row * self.columns + border..][..columns]).copied().collect();
        Raster { columns, values }
    }
}

/// For each place of a disk inside of the raster, the least of the values that it covers; with `MAX`, the
/// greatest. Both sides are shorter by twice the radius.
fn slid<const MAX: bool>(values: &[f32], columns: usize, spans: &[usize]) -> Vec<f32> {
    let radius = spans.len() / 2;
    let (rows, width) = (values.len() / columns, columns - 2 * radius);
    let height = rows - 2 * radius;
    let mut slid = vec![if MAX { f32::NEG_INFINITY } else { f32::INFINITY }; width * height];
    let mut runs = Runs::new(columns);
    let mut row_of_span = vec![0.0; width];
    for (row, values) in values.chunks_exact(columns).enumerate() {
        runs.fill::<MAX>(values, 2 * radius + 1);
        // Rows of the disk with one reach come in pairs, and at its middle several follow each other.
        let mut reach = usize::MAX;
        for (below, above) in (0..=radius).map(|at| (at, spans.len() - 1 - at)) {
            let targets =
                [row.checked_sub(below), row.checked_sub(above)].map(|to| to.filter(|to| *to < height));
            if targets == [None, None] {
                continue;
            }
            if spans[below] != reach {
                reach = spans[below];
                runs.least::<MAX>(radius, reach, &mut row_of_span);
            }
            let [first, second] = targets;
            for to in first.into_iter().chain(second.filter(|_| below != above)) {
                let target = &mut slid[to * width..(to + 1) * width];
                target
                    .iter_mut()
                    .zip(&row_of_span)
                    .for_each(|(target, &run)| *target = best::<MAX>(*target, run));
            }
        }
    }
    slid
}

/// The lesser, or with `MAX` the greater.
#[inline(always)]
fn best<const MAX: bool>(a: f32, b: f32) -> f32 {
    // The forms that processors have an instruction for.
    if MAX {
        if a > b { a } else { b }
    } else if a < b {
        a
    } else {
        b
    }
}

/// The least of the values of a row in each run of 1, 2, 4 and so on cells.
struct Runs {
    columns: usize,
    levels: Vec<Vec<f32>>,
}

impl Runs {
    fn new(columns: usize) -> Runs {
        Runs { columns, levels: Vec::new() }
    }

    /// Replaces the row. Runs of up to `longest` cells will be asked for.
    fn fill<const MAX: bool>(&mut self, values: &[f32], longest: usize) {
        let count = longest.ilog2() as usize + 1;
        self.levels.resize_with(count, || vec![0.0; self.columns]);
        self.levels[0].copy_from_slice(values);
        for level in 1..count {
            let (below, here) = self.levels.split_at_mut(level);
            let (below, here, half) = (&below[level - 1], &mut here[0], 1 << (level - 1));
            // The last runs are too short, and never asked for.
            let pairs = below.iter().zip(&below[half..]);
            here.iter_mut().zip(pairs).for_each(|(here, (&a, &b))| *here = best::<MAX>(a, b));
        }
    }

    /// For each place of a disk of a radius, the least of the cells up to `reach` from its middle.
    fn least<const MAX: bool>(&self, radius: usize, reach: usize, least: &mut [f32]) {
        let len = 2 * reach + 1;
        let level = len.ilog2() as usize;
        let (start, width) = (radius - reach, least.len());
        let left = &self.levels[level][start..][..width];
        let right = &self.levels[level][start + len - (1 << level)..][..width];
        least.iter_mut().zip(left.iter().zip(right)).for_each(|(least, (&a, &b))| *least = best::<MAX>(a, b));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_base::random::Random;

    /// The opening by its definition, at one cell.
    fn opened_at(raster: &Raster, radius: usize, [x, y]: [usize; 2]) -> f32 {
        let r = radius as i64;
        let around = |[x, y]: [i64; 2]| {
            let offsets = (-r..=r).flat_map(move |dy| (-r..=r).map(move |dx| [dx, dy]));
            offsets.filter(move |[dx, dy]| dx * dx + dy * dy <= r * r).map(move |[dx, dy]| [x + dx, y + dy])
        };
        let value = |[x, y]: [i64; 2]| raster.values[y as usize * raster.columns + x as usize];
        let centres = around([x as i64, y as i64]).filter(|&centre| value(centre) != GAP);
        let pushed = |centre| around(centre).map(value).filter(|z| *z != GAP).fold(f32::INFINITY, f32::min);
        centres.map(pushed).fold(f32::NEG_INFINITY, f32::max)
    }

    #[test]
    fn openings_are_those_of_the_definition() {
        let mut random = Random::new(11);
        for (radius, share) in [(1, 0.0), (1, 0.7), (2, 0.3), (3, 0.5), (5, 0.9), (6, 0.1)] {
            let [columns, rows] = [4 * radius + 9, 4 * radius + 7];
            let value = |_| if random.unit() < share { GAP } else { random.below(20) as f32 };
            let raster = Raster { columns, values: (0..columns * rows).map(value).collect() };
            let opened = raster.opened(radius);
            assert_eq!((opened.columns, opened.rows()), (9, 7));
            for (at, &found) in opened.values.iter().enumerate() {
                let [x, y] = [at % 9 + 2 * radius, at / 9 + 2 * radius];
                let is_gap = raster.values[y * columns + x] == GAP;
                assert_eq!(found, if is_gap { GAP } else { opened_at(&raster, radius, [x, y]) });
            }
        }
    }

    #[test]
    fn disks_are_round() {
        assert_eq!(disk(1), [0, 1, 0]);
        assert_eq!(disk(5), [0, 3, 4, 4, 4, 5, 4, 4, 4, 3, 0]);
    }
}
