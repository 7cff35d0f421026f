//! Where the borders of boxes should be so that they cut few tiles: on the borders between columns of tiles,
//! if the tiles are a grid.

/// Tiles on one axis make a grid only if there are at least this many columns.
const COLUMNS_MIN: usize = 3;

/// Most significant digits of a pitch.
const DIGITS_MAX: i32 = 15;

/// Most decimals of a border.
const DECIMALS_MAX: i32 = 12;

/// Most columns whose gaps are compared with each other.
const COMPARED_MAX: usize = 500;

/// Equally spaced borders along one axis, in stored coordinates. They need not be whole numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Borders {
    /// The border before the first column of tiles. Tiles of this column may begin before it, as nothing is
    /// there that a border would divide them from.
    pub(super) origin: f64,
    pub(super) pitch: f64,
}

/// Where a border may be that cuts no tile: above `after`, and at most at `before`. All tiles of earlier
/// columns end at or before `after`, and all of later ones start at or behind `before`.
#[derive(Debug, Clone, Copy)]
struct Gap {
    after: f64,
    before: f64,
    /// Number of the column behind it, from 0 on.
    column: f64,
}

/// Borders that lie between most columns of the tiles, which reach from their least to their greatest
/// coordinate; `None` if the tiles make no grid along this axis.
pub(super) fn borders_between(tiles: &[(f64, f64)]) -> Option<Borders> {
    let mut sorted = tiles.to_vec();
    sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let width =
        median(tiles.iter().map(|(min, max)| max - min).collect()).filter(|width| width.is_finite())?;
    // The first column needs no border before it.
    let gaps = gaps_of(&sorted, width / 2.0);
    if gaps.len() + 1 < COLUMNS_MIN {
        return None;
    }
    // A border stays off the ends of gaps, so that rounding cannot move it out.
    let inner = |gap: &Gap| Gap { before: gap.before - 1e-3 * (gap.before - gap.after), ..*gap };
    let open: Vec<Gap> = gaps.iter().filter(|gap| gap.after < gap.before).map(inner).collect();
    let stride = open.len().div_ceil(COMPARED_MAX).max(1);
    let compared: Vec<Gap> = open.iter().step_by(stride).copied().collect();
    let slopes = compared.iter().flat_map(|a| compared.iter().map(move |b| (a, b)));
    let slopes = slopes.filter(|(a, b)| a.column < b.column);
    let slope = |(a, b): (&Gap, &Gap)| (b.before - a.before) / (b.column - a.column);
    let mean = median(slopes.clone().map(slope).collect())?;
    // The pitches for which some origin lies in all gaps.
    let low = slopes.clone().map(|(a, b)| (b.after - a.before) / (b.column - a.column));
    let high = slopes.map(|(a, b)| (b.before - a.after) / (b.column - a.column));
    let (low, high) = (low.fold(0.0, f64::max), high.fold(f64::INFINITY, f64::min));
    // That near the mean with the fewest digits: it stays the same when columns come and go.
    let near_mean = (1..=DIGITS_MAX).map(|digits| rounded(mean, digits));
    let exact = (low < high)
        .then(|| near_mean.into_iter().find(|&pitch| low < pitch && pitch <= high).unwrap_or(mean));
    // Otherwise some tile is none of the grid. Tiles have round widths, which their points do not quite fill.
    let candidates = exact.into_iter().chain((1..=6).map(|digits| rounded(mean, digits))).chain([mean]);
    let mut best: Option<(usize, f64, f64)> = None;
    for pitch in candidates.filter(|&pitch| pitch.is_finite() && pitch > 0.0) {
        let (count, origin) = origin_of(&open, pitch);
        if best.is_none_or(|(most, _, _)| count > most) {
            best = Some((count, origin, pitch));
        }
    }
    let (count, origin, pitch) = best?;
    (2 * count >= gaps.len()).then_some(Borders { origin, pitch })
}

/// A border between two columns of tiles, if there are any.
pub(super) fn border_near(tiles: &[(f64, f64)]) -> Option<f64> {
    let mut sorted = tiles.to_vec();
    sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let width = median(tiles.iter().map(|(min, max)| max - min).collect())?;
    let gaps = gaps_of(&sorted, width / 2.0);
    gaps.iter().find(|gap| gap.after < gap.before).map(|gap| roundest_in(gap.after, gap.before))
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// The gaps between the columns of tiles. A column starts where a tile starts further than `apart` behind the
/// start of the column before.
fn gaps_of(sorted: &[(f64, f64)], apart: f64) -> Vec<Gap> {
    let mut gaps: Vec<Gap> = Vec::new();
    let (mut start, mut end) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
    for &(min, max) in sorted {
        if min > start + apart {
            gaps.push(Gap { after: end, before: min, column: 0.0 });
            start = min;
        }
        end = end.max(max);
    }
    // What is called the first column begins nowhere in particular.
    let mut gaps = gaps.split_off(gaps.len().min(1));
    let steps = gaps.windows(2).map(|pair| pair[1].before - pair[0].before).collect();
    let step = median(steps).unwrap_or(1.0);
    // From column to column, so that errors of the step do not add up.
    let (mut column, mut start) = (0.0, f64::NEG_INFINITY);
    for gap in &mut gaps {
        column +=
            ((gap.before - start) / step).round().clamp(1.0, if column == 0.0 { 1.0 } else { f64::MAX });
        start = gap.before;
        gap.column = column;
    }
    gaps
}

/// `value` with so many significant decimal digits.
fn rounded(value: f64, digits: i32) -> f64 {
    let unit = 10f64.powi(value.abs().log10().floor() as i32 + 1 - digits);
    (value / unit).round() * unit
}

/// The origin of borders with the given pitch that lie in the most gaps, and the number of these gaps.
fn origin_of(gaps: &[Gap], pitch: f64) -> (usize, f64) {
    // The gaps, moved to the origin by whole pitches. A gap opens behind its lower end.
    let moved = gaps.iter().map(|gap| (gap.after - gap.column * pitch, gap.before - gap.column * pitch));
    let moved: Vec<(f64, f64)> = moved.filter(|(after, before)| after < before).collect();
    let inside =
        |origin: f64| moved.iter().filter(|&&(after, before)| after < origin && origin <= before).count();
    let compared = moved.iter().step_by(moved.len().div_ceil(COMPARED_MAX).max(1));
    let most = compared.map(|&(_, before)| (inside(before), before));
    let Some((count, top)) = most.max_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1))) else {
        return (0, 0.0);
    };
    let holding = moved.iter().filter(|&&(after, before)| after < top && top <= before);
    let bottom = holding.map(|&(after, _)| after).fold(f64::NEG_INFINITY, f64::max);
    // Counted from the multiple of the pitch before it, so that the first column does not matter.
    let base = (top / pitch).floor() * pitch;
    (count, base + roundest_in(bottom.max(top - pitch) - base, top - base))
}

/// The number with the fewest digits that is above `low` and at most `high`.
pub(super) fn roundest_in(low: f64, high: f64) -> f64 {
    let start = high.abs().max((high - low).abs()).max(1.0).log10().ceil() as i32;
    // Powers of ten below one are divided by, as they are no binary numbers.
    let candidates = (-DECIMALS_MAX..=start).rev().map(|power| match power {
        0.. => (high / 10f64.powi(power)).floor() * 10f64.powi(power),
        _ => (high * 10f64.powi(-power)).floor() / 10f64.powi(-power),
    });
    candidates.into_iter().find(|&candidate| low < candidate && candidate <= high).unwrap_or(high)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tiles of the given pitch whose points do not reach their borders.
    fn grid(count: usize, origin: f64, pitch: f64) -> Vec<(f64, f64)> {
        let border = |i: usize| origin + i as f64 * pitch;
        (0..count)
            .map(|i| (border(i) + (i * 7 % 5) as f64, border(i + 1) - 1.0 - (i * 3 % 4) as f64))
            .collect()
    }

    fn cut(tiles: &[(f64, f64)], borders: Borders, columns: usize) -> usize {
        let column =
            |at: f64| ((at - borders.origin) / borders.pitch).floor().clamp(0.0, columns as f64 - 1.0);
        tiles.iter().filter(|(min, max)| column(*min) != column(*max)).count()
    }

    #[test]
    fn borders_are_those_between_tiles() {
        for (origin, pitch) in [(0.0, 1000.0), (-400_000.0, 100_000.0), (123_456.0, 7_531.0), (5.0, 50.0)] {
            for count in [3, 4, 9, 100] {
                let tiles = grid(count, origin, pitch);
                let borders = borders_between(&tiles).unwrap_or_else(|| panic!("{origin} {pitch} {count}"));
                assert_eq!(cut(&tiles, borders, count), 0, "{borders:?} of {origin} {pitch} {count}");
            }
        }
    }

    #[test]
    fn a_grid_may_have_holes_and_a_tile_that_is_none_of_it() {
        let mut tiles = grid(50, 2000.0, 1000.0);
        tiles.retain(|tile| !(7000.0..12000.0).contains(&tile.0) && tile.0 as i64 % 3 != 0);
        tiles.push((30_400.0, 30_700.0));
        let borders = borders_between(&tiles).unwrap();
        assert!(cut(&tiles, borders, 50) <= 1, "{borders:?}");
    }

    /// Tiles of a survey whose outline is ragged, with borders that are no whole numbers.
    #[test]
    fn first_and_last_columns_may_be_ragged() {
        let border = |i: usize| (50_000_000.0 + i as f64 * 18_487.812_5_f64).ceil();
        let mut tiles: Vec<(f64, f64)> = (0..16).map(|i| (border(i), border(i + 1) - 1.0)).collect();
        tiles.extend([
            (49_998_996.0, border(1) - 1.0),
            (border(15), 50_296_003.0),
            (50_000_900.0, border(1) - 1.0),
        ]);
        let borders = borders_between(&tiles).unwrap();
        assert_eq!(cut(&tiles, borders, 16), 0, "{borders:?}");
    }

    #[test]
    fn tiles_that_overlap_or_are_few_make_no_grid() {
        let strips: Vec<(f64, f64)> =
            (0..20).map(|i| (f64::from(i) * 300.0, f64::from(i) * 300.0 + 1000.0)).collect();
        assert_eq!(borders_between(&strips), None);
        assert_eq!(borders_between(&grid(2, 0.0, 10.0)), None);
        assert_eq!(borders_between(&[]), None);
        assert_eq!(borders_between(&[(5.0, 5.0); 9]), None);
    }
}
