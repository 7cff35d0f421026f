//! Biological assemblies as files state them: which chains are moved by which operators.

use std::collections::{HashMap, HashSet};

use foldhash::fast::FixedState;

use crate::molecules::motion::Motion;
use crate::molecules::names::Name;
use crate::molecules::operators::{check_count, expand};
use spmesh_base::error::{Error, Result};

/// The assemblies that a file states.
#[derive(Debug, Clone, Default)]
pub struct Assemblies {
    pub(crate) generators: Vec<Generator>,
    pub(crate) operators: Vec<Operator>,
}

/// Subchains of an assembly, and what moves them.
#[derive(Debug, Clone)]
pub(crate) struct Generator {
    /// Name of the assembly.
    pub(crate) assembly: String,
    pub(crate) subchains: Vec<Name>,
    /// Operators, as `1,2` or `(1-60)(P)`.
    pub(crate) expression: String,
}

/// An operator. Its motion is `None` if the file states none that can be read.
#[derive(Debug, Clone)]
pub(crate) struct Operator {
    pub(crate) name: String,
    pub(crate) motion: Option<Motion>,
}

impl Assemblies {
    /// The names of all assemblies, in the order in which they appear.
    pub fn names(&self) -> Vec<&str> {
        let mut seen = HashSet::new();
        let names = self.generators.iter().map(|generator| &*generator.assembly);
        names.filter(|&name| seen.insert(name)).collect()
    }

    /// The parts of an assembly: subchains, and the motions of their copies. There are none if the file does
    /// not state the assembly.
    pub(crate) fn parts(&self, assembly: &str) -> Result<Vec<(&[Name], Vec<Motion>)>> {
        let operators: HashMap<&str, Option<Motion>, FixedState> =
            self.operators.iter().map(|operator| (&*operator.name, operator.motion)).collect();
        let find = |name: &str| match operators.get(name) {
            Some(Some(motion)) => Ok(*motion),
            Some(None) => Err(Error::malformed(format!(
                "the operator {name:?} of an assembly has not the twelve numbers of a motion"
            ))),
            None => Err(Error::malformed(format!("the operator {name:?} of an assembly is missing"))),
        };
        let (mut parts, mut count) = (Vec::new(), 0);
        for generator in self.generators.iter().filter(|generator| generator.assembly == assembly) {
            let motions = expand(&generator.expression, &find)?;
            count += motions.len();
            check_count(count)?;
            parts.push((&*generator.subchains, motions));
        }
        Ok(parts)
    }
}
