//! Points where a level cuts the edges of simplices, and the products of simplices that result.

use foldhash::{HashMap, HashMapExt};

use spmesh_base::error::{Error, Result};

/// Numbers the points where edges are cut; each edge gets one point.
#[derive(Debug, Default)]
pub(super) struct Cuts(HashMap<(u32, u32), u32>);

impl Cuts {
    pub(super) fn new() -> Self {
        Cuts(HashMap::new())
    }

    /// The number of the point on an edge; `make` is called to add a new one.
    pub(super) fn number(&mut self, edge: (u32, u32), make: impl FnOnce()) -> Result<u32> {
        if let Some(&number) = self.0.get(&edge) {
            return Ok(number);
        }
        let number = u32::try_from(self.0.len());
        let number = number.map_err(|_| Error::usage("2^32 points or more in a section"))?;
        self.0.insert(edge, number);
        make();
        Ok(number)
    }
}

/// Simplices of the product of two simplices, whose vertices are pairs of theirs: one for each path from the
/// first pair to the last that advances in one list at a time (a staircase). With lists in increasing order,
/// both sides of a face that is a product of parts of the lists have the same simplices there.
pub(super) fn staircases(
    below: &[u32],
    above: &[u32],
    visit: &mut impl FnMut(&[(u32, u32)]) -> Result<()>,
) -> Result<()> {
    fn steps(
        path: &mut Vec<(u32, u32)>,
        below: &[u32],
        above: &[u32],
        visit: &mut impl FnMut(&[(u32, u32)]) -> Result<()>,
    ) -> Result<()> {
        let ([i, below_rest @ ..], [j, above_rest @ ..]) = (below, above) else { return Ok(()) };
        path.push((*i, *j));
        if below_rest.is_empty() && above_rest.is_empty() {
            visit(path)?;
        }
        if !below_rest.is_empty() {
            steps(path, below_rest, above, visit)?;
        }
        if !above_rest.is_empty() {
            steps(path, below, above_rest, visit)?;
        }
        path.pop();
        Ok(())
    }
    steps(&mut Vec::with_capacity(below.len() + above.len()), below, above, visit)
}

/// Interpolates linearly between two numbers; exact if they are equal.
pub(super) fn between(from: f64, to: f64, share: f64) -> f64 {
    if from == to { from } else { from * (1.0 - share) + to * share }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prisms_fall_into_simplices() {
        let count = |below: &[u32], above: &[u32]| {
            let mut count = 0;
            staircases(below, above, &mut |path| {
                assert_eq!(path.len(), below.len() + above.len() - 1);
                count += 1;
                Ok(())
            })
            .unwrap();
            count
        };
        assert_eq!(
            (count(&[1], &[2, 3, 4, 5]), count(&[1, 2], &[3, 4, 5]), count(&[], &[1, 2, 3, 4, 5])),
            (1, 3, 0)
        );
    }
}
