//! Reads the lines of text twins of functions and coefficients of splines (`formats/text.md`).

use crate::twin::read_configurations::parse_knot;
use crate::twin::tokens::{expect_no_field, next_field, parse_decimal, unexpected};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::functions::{Function, FunctionKind};
use spmesh_stream::{Event, Totals, function_kind, function_kind_of_name};

/// One line, parsed. Knots are counted from 0 here.
pub(crate) enum FunctionLine {
    Function(FunctionKind),
    Term([u32; 2], f64),
    Coefficient(f64),
}

/// Lines that become the next event.
pub(crate) enum FunctionGroup {
    Functions(Vec<Function>),
    Coefficients(Vec<f64>),
}

/// Parses the line of `word` and the `fields` after it; `None` if it is not a line of functions.
pub(crate) fn parse<'a>(
    word: &[u8],
    fields: &mut impl Iterator<Item = &'a [u8]>,
) -> Result<Option<FunctionLine>> {
    let line = match word {
        b"function" => FunctionLine::Function(parse_kind(fields)?),
        b"term" => {
            let set = [parse_knot(next_field(fields)?)?, parse_knot(next_field(fields)?)?];
            FunctionLine::Term(set, parse_decimal(next_field(fields)?)?)
        }
        b"coefficient" => FunctionLine::Coefficient(parse_decimal(next_field(fields)?)?),
        _ => return Ok(None),
    };
    expect_no_field(fields)?;
    Ok(Some(line))
}

fn parse_kind<'a>(fields: &mut impl Iterator<Item = &'a [u8]>) -> Result<FunctionKind> {
    let name = next_field(fields)?;
    let expected = || unexpected(name, "edge, vertex, tent, crease or face");
    let (code, count) = function_kind_of_name(name).ok_or_else(expected)?;
    let knots = (0..count).map(|_| parse_knot(next_field(fields)?)).collect::<Result<Vec<u32>>>()?;
    function_kind(code, &knots).ok_or_else(expected)
}

impl FunctionGroup {
    /// The empty event that `line` starts; `None` if the line is not allowed after these totals.
    pub(crate) fn start(line: &FunctionLine, totals: &Totals) -> Option<FunctionGroup> {
        match line {
            FunctionLine::Function(_) if totals.residual_points == 0 => {
                Some(FunctionGroup::Functions(Vec::new()))
            }
            FunctionLine::Coefficient(_) => Some(FunctionGroup::Coefficients(Vec::new())),
            _ => None,
        }
    }

    /// Whether a line belongs to the event, which has at most `most` entries.
    pub(crate) fn takes(&self, line: &FunctionLine, most: usize) -> bool {
        match (self, line) {
            (FunctionGroup::Functions(functions), FunctionLine::Function(_)) => functions.len() < most,
            (FunctionGroup::Functions(_), FunctionLine::Term(..)) => true,
            (FunctionGroup::Coefficients(numbers), FunctionLine::Coefficient(_)) => numbers.len() < most,
            _ => false,
        }
    }

    /// Adds a line that the event takes.
    pub(crate) fn push(&mut self, line: FunctionLine) -> Result<()> {
        match (self, line) {
            (FunctionGroup::Functions(functions), FunctionLine::Function(kind)) => {
                functions.push(Function { kind, terms: Vec::new() });
            }
            (FunctionGroup::Functions(functions), FunctionLine::Term(set, factor)) => {
                let last = functions.last_mut();
                let last =
                    last.ok_or_else(|| Error::malformed("a term comes after the line \"function\""))?;
                last.terms.push((set, factor));
            }
            (FunctionGroup::Coefficients(numbers), FunctionLine::Coefficient(number)) => numbers.push(number),
            _ => {}
        }
        Ok(())
    }

    pub(crate) fn finish(self) -> Event {
        match self {
            FunctionGroup::Functions(functions) => Event::Functions(functions),
            FunctionGroup::Coefficients(numbers) => Event::Coefficients(numbers),
        }
    }
}
