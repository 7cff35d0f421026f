//! Lines of text twins of functions and coefficients of splines (`formats/text.md`).

use std::io::Write;

use crate::sink::write_error;
use crate::twin::write_configurations::numbers;
use spmesh_base::error::Result;
use spmesh_stream::function_kind_parts;
use spmesh_stream::model::decimal::Decimal;
use spmesh_stream::model::functions::Function;

/// A line `function` for each, and a line `term` for each of its B-splines.
pub(crate) fn functions(output: &mut impl Write, functions: &[Function]) -> Result<()> {
    for function in functions {
        let (name, knots) = function_kind_parts(&function.kind);
        numbers(output, &format!("function {name}"), knots)?;
        for ([p, q], factor) in &function.terms {
            let [p, q] = [*p, *q].map(|knot| u64::from(knot) + 1);
            writeln!(output, "term {p} {q} {}", Decimal(*factor)).map_err(write_error)?;
        }
    }
    Ok(())
}

/// A line `coefficient` for each.
pub(crate) fn coefficients(output: &mut impl Write, coefficients: &[f64]) -> Result<()> {
    let mut line = |&number: &f64| writeln!(output, "coefficient {}", Decimal(number)).map_err(write_error);
    coefficients.iter().try_for_each(&mut line)
}
