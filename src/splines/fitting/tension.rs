//! The choice of a tension, by restricted maximum likelihood.
//!
//! Thin plates are smooth; ground with steps and banks is less so. The energy of a spline in tension is the
//! thin-plate energy plus t^2 times the membrane energy. Waves longer than 2 pi / t are those of a membrane,
//! which bends at observations. Tensions are compared by their likelihood, which holds for observations,
//! whatever the energy is.

use super::choice::{Choice, Limits};
use super::likelihood::Likelihood;
use super::membrane::membrane;
use super::normal_equations::NormalEquations;
use super::solve::Equations;
use super::symmetric::Symmetric;
use crate::bases::Basis;
use spmesh_base::error::{Error, Result};

/// Tensions that suit terrain. Waves longer than six distances of observations have mainly the energy of a
/// membrane with the second, and waves longer than three with the third.
pub const TENSIONS: [f64; 3] = [0.0, 1.0, 2.0];

/// An energy with its tension.
#[derive(Debug)]
pub struct Tense {
    /// The tension, in units of one over the distance of observations.
    pub tension: f64,
    /// The matrix of the energy.
    pub energy: Symmetric,
    /// The choice of `lambda` for it.
    pub choice: Choice,
}

/// Chooses a tension and `lambda` by restricted maximum likelihood, for the energy `bending` of a thin plate.
/// Tensions are tried in the given order, while they become likelier. If there is one only, `lambda` alone is
/// chosen.
///
/// Cost: about seven factorisations for each tension that is tried.
///
/// # Errors
/// No tension, or one that is negative or not finite; those of
/// [`restricted_likelihood`](super::restricted_likelihood) and [`membrane`].
pub fn choose_tension(
    basis: &Basis,
    normal: &NormalEquations,
    bending: Symmetric,
    tensions: &[f64],
) -> Result<Tense> {
    let (mut likelihood, area) = (Likelihood::default(), normal.area_per_observation(basis));
    let plain = Limits::of(&Equations::new(basis, normal, Some(&bending))?);
    let (mut best, mut of_plate, mut slopes) = (None::<Tense>, plain.start, None);
    for &tension in tensions {
        check(tension)?;
        let energy = match (tension > 0.0, &mut slopes) {
            (false, _) => bending.clone(),
            (true, Some(slopes)) => tensed(&bending, slopes, tension, area),
            (true, none) => tensed(&bending, none.insert(membrane(basis)?), tension, area),
        };
        let equations = equations(basis, normal, &energy, tension)?;
        // The square of the wave number that a plate halves, times the area of an observation.
        let halved = (normal.weight * area / of_plate / normal.count as f64).sqrt();
        // This start halves the same waves.
        let start = (of_plate / (1.0 + tension * tension / halved)).max(plain.least);
        let limits = Limits { start, ..plain };
        let choice = match tensions.len() {
            1 => likelihood.of_one(&equations, limits)?,
            _ => likelihood.choose(&equations, limits)?,
        };
        if best.as_ref().is_some_and(|best| choice.best.score >= best.choice.best.score) {
            break;
        }
        if tension == 0.0 {
            of_plate = choice.best.lambda;
        }
        drop(equations);
        best = Some(Tense { tension, energy, choice });
    }
    best.ok_or_else(|| Error::usage("no tension to choose from"))
}

/// The energy `bending` with a tension, which is in units of one over the distance of observations.
///
/// # Errors
/// A tension that is negative or not finite; those of [`membrane`].
pub fn with_tension(
    basis: &Basis,
    normal: &NormalEquations,
    bending: Symmetric,
    tension: f64,
) -> Result<Symmetric> {
    check(tension)?;
    if tension == 0.0 {
        return Ok(bending);
    }
    Ok(tensed(&bending, &membrane(basis)?, tension, normal.area_per_observation(basis)))
}

/// The equations with an energy of this tension.
fn equations<'a>(
    basis: &'a Basis,
    normal: &'a NormalEquations,
    energy: &'a Symmetric,
    tension: f64,
) -> Result<Equations<'a>> {
    let equations = Equations::new(basis, normal, Some(energy))?;
    Ok(if tension > 0.0 { equations.in_tension() } else { equations })
}

fn tensed(bending: &Symmetric, membrane: &Symmetric, tension: f64, area: f64) -> Symmetric {
    bending.plus(tension * tension / area, membrane)
}

fn check(tension: f64) -> Result<()> {
    if tension >= 0.0 && tension.is_finite() {
        return Ok(());
    }
    Err(Error::usage(format!("tension {tension}: expected a finite number, not negative")))
}
