//! The content of a stream of configurations that the audit needs.

use super::{Configurations, Knots};
use crate::exact::plane::Xy;
use spmesh_base::error::Result;
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
