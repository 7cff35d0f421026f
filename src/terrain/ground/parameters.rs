//! What the search for the ground depends on.

use super::noise::COLUMN;
use super::rounds::Rules;
use spmesh_base::error::{Error, Result};
use spmesh_formats::crs::System;

/// Lengths in metres; slopes are rises over runs. What each is for: `docs/theory/ground.md`.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    /// Side of a cell.
    pub cell: f64,
    /// Radius of the largest object that is taken away.
    pub window: f64,
    /// Rise over the radius of a disk above which something is an object.
    pub slope: f64,
    /// The same for heights above the first surface, where [`Parameters::step`] is allowed beside it.
    pub residual_slope: f64,
    /// How far the ground may rise above the first surface at once.
    pub step: f64,
    /// Radius of the largest circle of a triangle of a surface, and how far from its triangles a surface is
    /// known.
    pub reach: f64,
    /// How far points of the ground lie from the surface where it is level.
    pub threshold: f64,
    /// How much further for each unit of slope: a length.
    pub scaling: f64,
    /// Depth of a pit that is no ground.
    pub pit: f64,
    /// Height above the ground from which points are noise.
    pub highest: f64,
    /// Vertical gap below points that are noise.
    pub gap: f64,
}

impl Default for Parameters {
    fn default() -> Self {
        Parameters {
            cell: 1.0,
            window: 18.0,
            slope: 0.2,
            residual_slope: 0.12,
            step: 0.4,
            reach: 100.0,
            threshold: 0.3,
            scaling: 1.25,
            pit: 2.0,
            highest: 500.0,
            gap: 15.0,
        }
    }
}

/// The least and the greatest side of a cell, in metres: pits of a few metres have at most as many cells as
/// windows.
const CELL_RANGE: [f64; 2] = [0.02, 1000.0];

/// The most cells of a window: disks of it take seconds for each million cells.
const WINDOW_CELLS_MAX: f64 = 256.0;

impl Parameters {
    /// The same in units of x and y and of z, whose lengths in metres are given.
    pub(super) fn in_units(&self, [run, rise]: [f64; 2]) -> Parameters {
        let slope = run / rise;
        Parameters {
            cell: self.cell / run,
            window: self.window / run,
            slope: self.slope * slope,
            residual_slope: self.residual_slope * slope,
            step: self.step / rise,
            reach: self.reach / run,
            threshold: self.threshold / rise,
            // A length for each unit of slope.
            scaling: self.scaling / run,
            pit: self.pit / rise,
            highest: self.highest / rise,
            gap: self.gap / rise,
        }
    }

    /// Refuses parameters out of their ranges.
    ///
    /// # Errors
    /// Usage, with the name of the flag.
    pub fn check(&self) -> Result<()> {
        let positive = [
            ("--cell", self.cell),
            ("--window", self.window),
            ("--reach", self.reach),
            ("--noise-gap", self.gap),
        ];
        if let Some((flag, value)) = positive.iter().find(|(_, value)| !(value.is_finite() && *value > 0.0)) {
            return Err(Error::usage(format!("{flag} takes a length above 0, not {value}")));
        }
        let others = [
            ("--slope", self.slope),
            ("--rise", self.step),
            ("--threshold", self.threshold),
            ("--scaling", self.scaling),
            ("--pit", self.pit),
            ("--max-height", self.highest),
        ];
        if let Some((flag, value)) = others.iter().find(|(_, value)| !(value.is_finite() && *value >= 0.0)) {
            return Err(Error::usage(format!("{flag} takes a number from 0 on, not {value}")));
        }
        let [least, most] = CELL_RANGE;
        if self.cell < least || self.cell > most {
            return Err(Error::usage(format!("--cell takes {least} to {most} metres, not {}", self.cell)));
        }
        if self.window > WINDOW_CELLS_MAX * self.cell {
            let most = WINDOW_CELLS_MAX * self.cell;
            return Err(Error::usage(format!(
                "--window {} is more than {WINDOW_CELLS_MAX} cells: with cells of {} it may be {most}; take larger ones",
                self.window, self.cell
            )));
        }
        Ok(())
    }

    /// How far around a place points can change its class, in units of x and y of a system: what
    /// `docs/theory/ground.md` proves.
    ///
    /// # Errors
    /// Usage, if x and y are angles.
    pub fn halo(&self, system: &System) -> Result<f64> {
        let units = units(system)?;
        let (in_units, metre) = (self.in_units(units), units.map(f64::recip));
        Ok(in_units.halo_of(&Rules::new(&in_units, metre), metre))
    }

    /// [`Parameters::halo`] of parameters in units.
    pub(super) fn halo_of(&self, rules: &Rules, metre: [f64; 2]) -> f64 {
        // A place depends on triangles within the reach, which depend on vertices two reaches further.
        let surfaces = 2.0 * 3.0 * self.reach;
        // Cells and columns that the border cuts.
        let cut = self.cell + COLUMN * metre[0];
        rules.halo() as f64 * self.cell + surfaces + 2.0 * cut
    }

    /// A length in cells, rounded up, at least one.
    pub(super) fn cells(&self, length: f64) -> usize {
        (length / self.cell - 1e-6).ceil().max(1.0) as usize
    }
}

/// The lengths in metres of a unit of x and y, and of one of z; those of metres, if the system does not state
/// any.
///
/// # Errors
/// Usage, if x and y are angles.
pub(super) fn units(system: &System) -> Result<[f64; 2]> {
    if system.horizontal.as_ref().is_some_and(|known| known.is_angular()) {
        return Err(Error::usage(
            "x and y are degrees, and the ground is found with lengths: reproject the points first",
        ));
    }
    let run = system.horizontal.as_ref().map_or(1.0, |known| known.unit.size);
    Ok([run, system.vertical.as_ref().map_or(run, |known| known.unit.size)])
}
