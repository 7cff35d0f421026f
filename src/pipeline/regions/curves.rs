//! Points on curves, whose tetrahedra grow with the square of their number.

use std::borrow::Cow;

use super::diagram::PER_POINT_MAX;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay3::{Kernel, Tetrahedralization};
use spmesh_delaunay::predicates::Point3;

/// Points of the sample whose tetrahedra are counted, at most and at least.
const COUNTED_MAX: usize = 1_000;
const COUNTED_MIN: usize = 250;

/// More tetrahedra for each point than surfaces and volumes have by far, and so many that it is worth a
/// message.
const MANY: f64 = 64.0;
const NOTABLE: f64 = 1e7;

/// Tetrahedra that grow by a smaller power of the number of points are of a thin tube, and need not go on so.
const POWER_MIN: f64 = 1.6;

/// About how many tetrahedra so many points have, of which this is a random sample; `None` if they are not
/// many for each point, or the sample is too small to tell.
///
/// # Errors
/// Those of the kernel.
pub(crate) fn tetrahedra_on_curves(sample: &[Point3], points: u64) -> Result<Option<f64>> {
    let counted = &sample[..sample.len().min(COUNTED_MAX)];
    if counted.len() < COUNTED_MIN {
        return Ok(None);
    }
    let all = count(counted)?;
    if all < (PER_POINT_MAX * counted.len()) as f64 {
        return Ok(None);
    }
    let growth = (all / count(&counted[..counted.len() / 2])?.max(1.0)).log2().min(2.0);
    let expected = all * (points as f64 / counted.len() as f64).powf(growth);
    let are_many = growth > POWER_MIN && expected > NOTABLE.max(MANY * points as f64);
    Ok(are_many.then_some(expected))
}

fn count(points: &[Point3]) -> Result<f64> {
    let mut mesh = Tetrahedralization::default();
    Kernel::new().triangulate(Cow::Borrowed(points), &mut mesh).map_err(Error::of_computation)?;
    Ok(mesh.tetrahedra().len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_base::random::Random;

    fn helix(random: &mut Random) -> Point3 {
        let turn = 18.0 * random.unit();
        [turn.cos(), turn.sin(), 0.1 * turn]
    }

    fn ball(random: &mut Random) -> Point3 {
        [0; 3].map(|_| random.unit())
    }

    fn sheet(random: &mut Random) -> Point3 {
        let [x, y] = [0; 2].map(|_| random.unit());
        [x, y, (7.0 * x).sin() * (5.0 * y).cos()]
    }

    #[test]
    fn tetrahedra_on_a_helix_are_foreseen() {
        let mut random = Random::new(3);
        let points: Vec<_> = (0..3_000).map(|_| helix(&mut random)).collect();
        let expected = tetrahedra_on_curves(&points, 60_000).unwrap().expect("many");
        let exact = 400.0 * count(&points).unwrap();
        assert!((0.9..1.1).contains(&(expected / exact)), "{expected} of {exact}");
        assert_eq!(tetrahedra_on_curves(&points, 3_000).unwrap(), None);
        assert_eq!(tetrahedra_on_curves(&points[..200], 200).unwrap(), None);
    }

    #[test]
    fn other_points_have_few() {
        for place in [ball, sheet] {
            let mut random = Random::new(4);
            let points: Vec<_> = (0..1_000).map(|_| place(&mut random)).collect();
            assert_eq!(tetrahedra_on_curves(&points, 1_000_000).unwrap(), None);
        }
        let line: Vec<_> = (0..1_000).map(|i| [f64::from(i), 0.0, 0.0]).collect();
        assert_eq!(tetrahedra_on_curves(&line, 1_000).unwrap(), None);
    }
}
