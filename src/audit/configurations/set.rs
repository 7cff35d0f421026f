//! The content of a stream of configurations that the audit needs, and what functions name of it.

use std::collections::HashSet;

use super::{Configurations, FARAWAY, Knots};
use crate::exact::plane::Xy;
use foldhash::fast::RandomState;
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_stream::Event;
use spmesh_stream::model::functions::Function;

/// Knots and their configurations, to be proved by [`super::check`].
#[derive(Debug, Clone, Default)]
pub struct ConfigurationSet {
    /// The knots, in stored coordinates.
    pub knots: Knots,
    /// Configurations, by increasing degree.
    pub degrees: Vec<Configurations>,
    /// Functions of quadratic splines.
    pub functions: Vec<Function>,
}

/// Gathers knots, configurations and functions from events; other content is ignored.
#[derive(Debug, Default)]
pub(super) struct Collector {
    points: Vec<Xy>,
    degrees: Vec<Configurations>,
    functions: Vec<Function>,
}

impl Collector {
    /// Adds the next event.
    pub(super) fn event(&mut self, event: &Event) -> Result<()> {
        match event {
            Event::Points(points) => self.points.extend(points.iter().map(|&[x, y, _]| [x, y])),
            Event::Configurations(block) => {
                let degree = block.degree as usize;
                if self.degrees.last().is_none_or(|last| last.degree() != degree) {
                    self.degrees.push(Configurations::new(degree, block.claim));
                }
                if let Some(last) = self.degrees.last_mut() {
                    block
                        .groups()
                        .try_for_each(|(interior, boundaries)| last.extend(interior, boundaries))?;
                }
            }
            Event::Functions(functions) => self.functions.extend_from_slice(functions),
            _ => {}
        }
        Ok(())
    }

    /// Everything gathered.
    pub(super) fn finish(self) -> Result<ConfigurationSet> {
        let Collector { points, degrees, functions } = self;
        Ok(ConfigurationSet { knots: Knots::new(points)?, degrees, functions })
    }
}

/// Checks that the pair of each term has a link: that a configuration (B, I) of degree 1 has I and a knot of
/// B in it. `pairs` are the configurations of degree 1, if there are any.
///
/// Memory: three pairs for each configuration.
///
/// # Errors
/// The first pair without a link (kind [`ErrorKind::Audit`]).
pub fn check_functions(pairs: Option<&Configurations>, functions: &[Function]) -> Result<()> {
    if functions.is_empty() {
        return Ok(());
    }
    let mut links: HashSet<[u32; 2], RandomState> = HashSet::default();
    for group in pairs.iter().flat_map(|pairs| pairs.groups()) {
        let &[inside] = group.interior else { continue };
        let knots = group.boundaries.as_flattened().iter().filter(|&&knot| knot != FARAWAY);
        links.extend(knots.map(|&knot| [inside.min(knot), inside.max(knot)]));
    }
    for (number, function) in functions.iter().enumerate() {
        if let Some(([p, q], _)) = function.terms.iter().find(|(pair, _)| !links.contains(pair)) {
            let message = format!("function {number} has a term of the pair {p}, {q}, which has no link");
            return Err(Error::new(ErrorKind::Audit, message));
        }
    }
    Ok(())
}
