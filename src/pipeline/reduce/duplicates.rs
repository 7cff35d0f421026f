//! Coinciding points are one vertex; in the plane, a policy chooses its elevation.

use super::residual::Residual;
use spmesh_base::error::{Error, Result};
use spmesh_stream::{Coordinates, Weights};

/// Which elevation survives where points coincide in x and y. The attributes are those of the point whose
/// elevation survives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "files", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[cfg_attr(feature = "flags", derive(clap::ValueEnum))]
pub enum Duplicates {
    /// The elevation of the point that comes first
    #[default]
    First,
    /// The lowest elevation
    Lowest,
    /// The highest elevation
    Highest,
    /// The mean elevation
    ///
    /// With integer coordinates it is rounded to the nearest, halves away from zero. The attributes are those
    /// of the first point.
    Mean,
    /// Coinciding points are an error
    Error,
}

/// Points that became part of the vertex of others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Merged {
    /// Their number.
    pub(super) points: u64,
    /// Those whose elevation is lost only because they are not the first, which depends on the order of
    /// points.
    pub(super) by_order: u64,
}

impl std::ops::AddAssign for Merged {
    fn add_assign(&mut self, other: Merged) {
        self.points += other.points;
        self.by_order += other.by_order;
    }
}

impl Duplicates {
    /// Sets the elevation of each vertex. `duplicates` are pairs of a point and the vertex that it coincides
    /// with. The vertex is the first of the coinciding points. With `weights`, it gets the row of the
    /// heaviest.
    ///
    /// # Errors
    /// [`spmesh_base::error::ErrorKind::Malformed`] if points coincide and the policy is
    /// [`Duplicates::Error`].
    pub(super) fn settle<const D: usize>(
        self,
        points: &mut Residual<D>,
        duplicates: &mut [[u32; 2]],
        coordinates: &Coordinates,
        weights: Option<Weights>,
    ) -> Result<Merged> {
        let merged = Merged { points: duplicates.len() as u64, by_order: 0 };
        if self == Duplicates::Error
            && let Some(&[_, vertex]) = duplicates.first()
        {
            let point = coordinates.to_decimal(points.point(vertex as usize));
            let place: Vec<String> =
                ["x", "y", "z"].iter().zip(point).take(D).map(|(axis, at)| format!("{axis} {at}")).collect();
            let policies = if D == 2 { "first, lowest, highest or mean" } else { "first" };
            let place = place.join(" ");
            return Err(Error::malformed(format!(
                "several points at {place}: choose --duplicates {policies}"
            )));
        }
        if let Some(weights) = weights {
            keep_heaviest(points, duplicates, weights);
            return Ok(merged);
        }
        if matches!(self, Duplicates::First | Duplicates::Error) {
            return Ok(Merged { by_order: unequal(points, duplicates), ..merged });
        }
        duplicates.sort_unstable_by_key(|&[point, vertex]| (vertex, point));
        let mut group = Vec::new();
        for same in duplicates.chunk_by(|a, b| a[1] == b[1]) {
            let vertex = same[0][1] as usize;
            group.clear();
            group.push(points.elevation[vertex]);
            group.extend(same.iter().map(|&[point, _]| points.elevation[point as usize]));
            let chosen = self.choose(&mut group, coordinates);
            let has = |point: usize| points.elevation[point].total_cmp(&chosen).is_eq();
            // The first of several that have the elevation; pairs of a vertex are in the order of the stream.
            if self != Duplicates::Mean
                && !has(vertex)
                && let Some(&[point, _]) = same.iter().find(|pair| has(pair[0] as usize))
            {
                points.copy_row(point as usize, vertex);
            }
            points.elevation[vertex] = chosen;
        }
        Ok(merged)
    }

    /// The elevation of a group, independent of the order of its points.
    fn choose(self, group: &mut [f64], coordinates: &Coordinates) -> f64 {
        group.sort_unstable_by(f64::total_cmp);
        match self {
            Duplicates::First | Duplicates::Error => unreachable!("these need no choice"),
            Duplicates::Lowest => group[0],
            Duplicates::Highest => group[group.len() - 1],
            Duplicates::Mean => mean(group, coordinates),
        }
    }
}

/// How many points have another elevation than the vertex that they coincide with.
fn unequal<const D: usize>(points: &Residual<D>, duplicates: &[[u32; 2]]) -> u64 {
    let elevation = |index: u32| points.elevation.get(index as usize);
    duplicates.iter().filter(|&&[point, vertex]| elevation(point) != elevation(vertex)).count() as u64
}

/// Gives each vertex the row of the first of the heaviest points at its place.
fn keep_heaviest<const D: usize>(points: &mut Residual<D>, duplicates: &mut [[u32; 2]], weights: Weights) {
    duplicates.sort_unstable_by_key(|&[point, vertex]| (vertex, point));
    for &[point, vertex] in &*duplicates {
        let (point, vertex) = (point as usize, vertex as usize);
        let weight_of = |index: usize| weights.read(points.row(index)).next();
        if weight_of(point) > weight_of(vertex) {
            points.copy_row(point, vertex);
        }
    }
}

/// Mean of a sorted group.
fn mean(group: &[f64], coordinates: &Coordinates) -> f64 {
    let n = group.len() as f64;
    let mean = match coordinates {
        Coordinates::I32 { .. } => (group.iter().sum::<f64>() / n).round(),
        // Divided before the sum, which could overflow otherwise.
        Coordinates::F64 => group.iter().map(|z| z / n).sum(),
    };
    // Rounding must not carry the mean out of its group: it could leave the bounding box.
    mean.clamp(group[0], group[group.len() - 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settled(policy: Duplicates, elevations: &[f64]) -> Result<f64> {
        let mut points = Residual::<2>::default();
        elevations.iter().for_each(|&z| points.extend_raw(&[[3.0, 4.0, z]], &[]));
        let mut pairs: Vec<_> = (1..elevations.len() as u32).rev().map(|i| [i, 0]).collect();
        let grid = Coordinates::I32 { scale: [1.0; 3], offset: [0.0; 3] };
        let merged = policy.settle(&mut points, &mut pairs, &grid, None)?;
        assert_eq!(merged.points, pairs.len() as u64);
        let differ = elevations.iter().filter(|&&z| z != elevations[0]).count();
        assert_eq!(merged.by_order, if policy == Duplicates::First { differ as u64 } else { 0 });
        Ok(points.elevation[0])
    }

    #[test]
    fn rows_are_those_of_the_point_with_the_elevation() {
        let row_of = |policy: Duplicates| {
            let mut points = Residual::<2>::default();
            let elevations = [5.0, 9.0, 2.0, 2.0, 9.0];
            (0..).zip(elevations).for_each(|(row, z)| points.extend_raw(&[[3.0, 4.0, z]], &[row, 7]));
            let mut pairs = [[3, 0], [1, 0], [4, 0], [2, 0]];
            policy
                .settle(&mut points, &mut pairs, &Coordinates::F64, None)
                .expect("a policy that allows them");
            points.row(0).to_vec()
        };
        assert_eq!(row_of(Duplicates::First), [0, 7]);
        assert_eq!(row_of(Duplicates::Lowest), [2, 7]);
        assert_eq!(row_of(Duplicates::Highest), [1, 7]);
        assert_eq!(row_of(Duplicates::Mean), [0, 7]);
    }

    #[test]
    fn each_policy_chooses_its_elevation() {
        let elevations = [5.0, 9.0, 2.0, 2.0];
        assert_eq!(settled(Duplicates::First, &elevations).unwrap(), 5.0);
        assert_eq!(settled(Duplicates::Lowest, &elevations).unwrap(), 2.0);
        assert_eq!(settled(Duplicates::Highest, &elevations).unwrap(), 9.0);
        assert_eq!(settled(Duplicates::Mean, &elevations).unwrap(), 5.0);
        let message = settled(Duplicates::Error, &elevations).unwrap_err().to_string();
        assert!(message.contains("several points at x 3 y 4"), "{message}");
    }

    #[test]
    fn the_mean_stays_within_its_group() {
        for count in 1..50 {
            let group = vec![858.59; count];
            assert_eq!(mean(&group, &Coordinates::F64), 858.59);
        }
        let huge = mean(&[f64::MAX; 3], &Coordinates::F64);
        assert_eq!(huge, f64::MAX);
    }

    #[test]
    fn a_point_alone_keeps_its_elevation() {
        assert_eq!(settled(Duplicates::Error, &[7.0]).unwrap(), 7.0);
        assert_eq!(settled(Duplicates::Mean, &[7.0]).unwrap(), 7.0);
    }
}
