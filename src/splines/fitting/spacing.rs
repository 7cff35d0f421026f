//! The distance of observations, where there are some.

use super::knot_placement::bounds;
use super::observations::Observations;
use spmesh_base::error::Result;

/// Observations per cell of the box, on average.
const PER_CELL: f64 = 4.0;
/// The most cells along a side.
const CELLS_MAX: f64 = 4096.0;
/// Observations of a cell that count as different places, at most.
const PLACES_PER_CELL: f64 = 16.0;

/// How observations are spread.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spacing {
    /// Their typical distance. Units: those of coordinates.
    pub distance: f64,
    /// About the number of their places, but of those that are crowded only some.
    pub places: f64,
}

/// How observations are spread. Their distance is the root of the area per observation. The area is that of
/// the cells with observations, of a grid over the box with four of them per cell on average. So gaps do not
/// count.
///
/// Units: those of coordinates. Memory: at most 16 MB. Cost: two passes.
///
/// # Errors
/// Observations that span no area; those of the source.
pub fn spacing<O: Observations + ?Sized>(observations: &O) -> Result<Spacing> {
    let [lower, upper] = bounds(observations)?;
    let sides = [0, 1].map(|axis| upper[axis] - lower[axis]);
    let count = for_each(observations, |_| ())?;
    let side = (sides[0] * sides[1] * PER_CELL / count as f64).sqrt();
    let cells = sides.map(|length| (length / side).clamp(1.0, CELLS_MAX).round() as usize);
    let mut is_used = vec![false; cells[0] * cells[1]];
    for_each(observations, |point| {
        let cell = [0, 1].map(|axis| {
            let part = (point[axis] - lower[axis]) / sides[axis];
            ((part * cells[axis] as f64) as usize).min(cells[axis] - 1)
        });
        is_used[cell[1] * cells[0] + cell[0]] = true;
    })?;
    let used = is_used.iter().filter(|&&used| used).count() as f64;
    let part = used / is_used.len() as f64;
    let distance = (part * sides[0] * sides[1] / count as f64).sqrt();
    Ok(Spacing { distance, places: (PLACES_PER_CELL * used).min(count as f64) })
}

fn for_each<O: Observations + ?Sized>(observations: &O, mut visit: impl FnMut([f64; 2])) -> Result<u64> {
    let (mut reader, mut batch, mut count) = (observations.read()?, Vec::new(), 0);
    loop {
        batch.clear();
        reader.append(&mut batch)?;
        if batch.is_empty() {
            return Ok(count);
        }
        count += batch.len() as u64;
        batch.iter().for_each(|one| visit(one.point));
    }
}

#[cfg(test)]
mod tests {
    use super::super::observations::Observation;
    use super::*;

    #[test]
    fn gaps_do_not_count() {
        let all: Vec<Observation> = (0..10_000)
            .map(|i| [f64::from(i % 100), f64::from(i / 100)])
            .map(|point| Observation::new(point, 0.0))
            .collect();
        let found = spacing(&all).unwrap();
        assert!((found.distance - 1.0).abs() < 0.05 && found.places == 10_000.0, "{found:?}");
        // Half of the box is empty, except for its corner.
        let mut some: Vec<Observation> = all.iter().copied().filter(|one| one.point[0] < 50.0).collect();
        some.push(all[9_999]);
        let found = spacing(&some).unwrap();
        assert!((found.distance - 1.0).abs() < 0.1 && found.places == 5_001.0, "{found:?}");
        // Of a thousand observations at one place, a few count.
        let mut crowded = vec![all[0]; 1_000];
        crowded.push(all[9_999]);
        let found = spacing(&crowded).unwrap();
        assert!(found.distance < 0.3 && found.places == 32.0, "{found:?}");
        assert!(spacing(&all[..1]).is_err());
    }
}
