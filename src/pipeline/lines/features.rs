//! The features of water among the lines of files, before noding.

use std::sync::Arc;

use super::Target;
use super::areas::Role;
use super::banks::Bank;
use super::numbered::{Numbered, numbered};
use super::water::{Place, Stated};
use spmesh_base::error::{Error, Result};
use spmesh_formats::source::{Breakline, Breaklines, Properties};

/// A feature of water, or one ring of it.
pub(crate) struct Feature {
    pub(crate) line: u32,
    pub(crate) kind: FeatureKind,
    /// Of a lake: its level, if the file states one.
    pub(crate) level: Option<Stated>,
    properties: Arc<Properties>,
    /// Whether it has elevations.
    pub(crate) is_hard: bool,
    /// Whether all of its vertices have elevations.
    pub(crate) is_complete: bool,
    pub(crate) position: Place,
}

/// What a feature of water is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FeatureKind {
    /// A ring of a polygon; polygons are numbered over all files.
    Ring(u32),
    Centre,
    Bank(Bank),
    /// A line between the ends of two banks.
    End,
}

impl Feature {
    /// The name of its river.
    pub(crate) fn river(&self) -> Option<&str> {
        self.properties.river.as_deref()
    }

    /// The polygon that it is a ring of.
    pub(crate) fn polygon(&self) -> Option<u32> {
        match self.kind {
            FeatureKind::Ring(polygon) => Some(polygon),
            _ => None,
        }
    }
}

/// The features of water among the lines of files.
///
/// # Errors
/// Malformed, if a feature is no polygon, centre line or bank, or its level makes no sense; usage, if points
/// have no elevation.
pub(crate) fn features(files: &[(Role, String, Breaklines)], target: &Target) -> Result<Vec<Feature>> {
    if files.iter().any(|(role, ..)| *role == Role::Water) && !target.has_elevation {
        return Err(Error::usage("points have no elevation: --flatten needs x, y and z"));
    }
    let of_water = numbered(files).filter(|line| matches!(line.role, Role::Water | Role::Ends));
    of_water.map(|line| feature(&line, target)).collect()
}

fn feature(numbered: &Numbered, target: &Target) -> Result<Feature> {
    let &Numbered { file, number, line, .. } = numbered;
    let position = Place { file: file.to_string(), position: Arc::clone(&line.position) };
    let kind = kind(numbered).map_err(|message| position.fault(message))?;
    if matches!(kind, FeatureKind::Ring(_)) {
        line.check_ring().map_err(|error| error.at(&*line.position).of_input(file))?;
    }
    let level = level(line, target).map_err(|message| position.fault(message))?;
    let is_hard = line.elevations.iter().any(Option::is_some);
    let is_complete = line.elevations.iter().all(Option::is_some);
    let properties = Arc::clone(&line.properties);
    Ok(Feature { line: number, kind, level, properties, is_hard, is_complete, position })
}

fn kind(&Numbered { role, polygon, line, .. }: &Numbered) -> std::result::Result<FeatureKind, String> {
    if role == Role::Ends {
        return Ok(FeatureKind::End);
    }
    match (polygon, Bank::of(&line.properties)?) {
        (Some(_), Some(_)) => {
            Err("a polygon has the property bank, expected a line: a bank is one side of a \
                                   river; remove the property, or write the bank as a line"
                .into())
        }
        (Some(polygon), None) => Ok(FeatureKind::Ring(polygon)),
        (None, Some(_)) if line.properties.river.is_none() => {
            Err("a bank has no property river: give both banks of a river the same one".into())
        }
        (None, None) if line.properties.river.is_none() => {
            Err("found a line, expected polygons, or lines with the property river".into())
        }
        (None, Some(bank)) => Ok(FeatureKind::Bank(bank)),
        (None, None) => Ok(FeatureKind::Centre),
    }
}

/// The level that a ring of a lake states.
fn level(line: &Breakline, target: &Target) -> std::result::Result<Option<Stated>, String> {
    if line.polygon.is_none() || line.properties.river.is_some() {
        return Ok(None);
    }
    let mut stated: Option<f64> = None;
    for &z in line.elevations.iter().flatten() {
        match stated {
            Some(known) if known != z => {
                let remedy = "write it without elevations, for example with ogr2ogr -dim XY, or give it the property \
                              river if it falls";
                return Err(format!(
                    "a shore of a lake has the elevations {known} and {z}, expected one: {remedy}"
                ));
            }
            _ => stated = Some(z),
        }
    }
    let by_property = stated.is_none();
    if let Some(text) = &line.properties.level {
        let level: Option<f64> = text.trim().parse().ok().filter(|level: &f64| level.is_finite());
        let level = level.ok_or_else(|| format!("the property level is {text:?}, expected a number"))?;
        if stated.is_some_and(|stated| stated != level) {
            return Err(format!("the property level is {text}, but the shore has another elevation"));
        }
        stated = Some(level);
    }
    let Some(level) = stated else { return Ok(None) };
    let stored = target.coordinates.to_stored([0.0, 0.0, level])[2];
    if !target.coordinates.can_store(stored) {
        return Err(format!("the level {level:?} is beyond the grid of the points"));
    }
    Ok(Some(Stated { level: stored, by_property }))
}
