//! The functions of quadratic splines name B-splines by pairs of knots, which must have links.

use std::collections::HashSet;

use foldhash::fast::RandomState;

use super::{Configurations, FARAWAY};
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_stream::model::functions::Function;

/// Checks that the pair of each term has a link: that a configuration (B, I) of degree 1 has I and a knot of B
/// in it. `pairs` are the configurations of degree 1, if there are any.
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
