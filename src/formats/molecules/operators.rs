//! Expressions of operators in mmCIF: `1,2,5`, `(1-60)`, and products such as `(1-60)(61-88)`.

use crate::molecules::motion::Motion;
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::ASSEMBLY_COPIES_MAX;

/// The motions that an expression denotes; `find` gives that of an operator by its name. The first factor of
/// a product is the outer loop, and moves last.
pub(crate) fn expand(expression: &str, find: &dyn Fn(&str) -> Result<Motion>) -> Result<Vec<Motion>> {
    let mut product: Option<Vec<Motion>> = None;
    for factor in factors(expression)? {
        let motions = list(factor, find)?;
        let before = match product {
            None => {
                product = Some(motions);
                continue;
            }
            Some(before) => before,
        };
        check_count(before.len().saturating_mul(motions.len()))?;
        let pairs = before.iter().flat_map(|last| motions.iter().map(|first| last.after(first)));
        product = Some(pairs.collect());
    }
    product.filter(|motions| !motions.is_empty()).ok_or_else(|| unexpected(expression))
}

/// The texts of the factors, without their parentheses.
fn factors(expression: &str) -> Result<Vec<&str>> {
    let text = expression.trim();
    let Some(inner) = text.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')) else {
        return if text.contains(['(', ')']) { Err(unexpected(expression)) } else { Ok(vec![text]) };
    };
    let split = inner.split(')').enumerate().map(|(place, factor)| match place {
        0 => Some(factor),
        _ => factor.trim_start().strip_prefix('('),
    });
    let factors: Option<Vec<&str>> = split.collect();
    factors.filter(|all| all.iter().all(|factor| !factor.contains('('))).ok_or_else(|| unexpected(expression))
}

/// The motions of a list of operators and ranges of operators.
fn list(text: &str, find: &dyn Fn(&str) -> Result<Motion>) -> Result<Vec<Motion>> {
    let mut motions = Vec::new();
    for item in text.split(',').map(str::trim) {
        match range(item) {
            Some((first, last)) => {
                check_count(usize::try_from(last.saturating_sub(first)).unwrap_or(usize::MAX))?;
                for number in first..=last {
                    motions.push(find(&number.to_string())?);
                    check_count(motions.len())?;
                }
            }
            None if item.is_empty() => return Err(unexpected(text)),
            None => motions.push(find(item)?),
        }
        check_count(motions.len())?;
    }
    Ok(motions)
}

/// The ends of a range `1-60`.
fn range(item: &str) -> Option<(u64, u64)> {
    let (first, last) = item.split_once('-')?;
    let (first, last) = (first.trim().parse().ok()?, last.trim().parse().ok()?);
    (first <= last).then_some((first, last))
}

pub(crate) fn check_count(count: usize) -> Result<()> {
    if count <= ASSEMBLY_COPIES_MAX {
        return Ok(());
    }
    Err(Error::malformed(format!("an assembly of more than {ASSEMBLY_COPIES_MAX} operators, the maximum")))
}

fn unexpected(expression: &str) -> Error {
    let shown: String = expression.chars().take(60).collect();
    Error::malformed(format!("the operators {shown:?} of an assembly, expected such as 1,2 or (1-60)(61-88)"))
}
