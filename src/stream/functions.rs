//! Encoding and rules of spline functions (sums of B-splines) and of spline coefficients.

use byteorder::{ByteOrder, LittleEndian as LE};

use super::event::Totals;
use crate::model::functions::{Function, FunctionKind};
use spmesh_base::error::{Error, Result};

/// Length of the shortest function in bytes: kind, number of terms, one knot, one term.
const LEAST_LEN: usize = 4 + 4 + 4 + TERM_LEN;
/// Length of a term: two knots and a factor.
const TERM_LEN: usize = 16;

/// For each code of a kind, its name in text twins and its number of knots.
const KINDS: [(&str, usize); 5] = [("edge", 2), ("vertex", 1), ("tent", 2), ("crease", 3), ("face", 4)];

/// The name of a kind in text twins, and its knots.
pub fn function_kind_parts(kind: &FunctionKind) -> (&'static str, &[u32]) {
    let (code, knots) = parts(kind);
    (KINDS[code].0, knots)
}

/// The code and the number of knots of the kind with this name, if there is one.
pub fn function_kind_of_name(name: &[u8]) -> Option<(usize, usize)> {
    let code = KINDS.iter().position(|(known, _)| known.as_bytes() == name)?;
    Some((code, KINDS[code].1))
}

/// The kind with this code and these knots; `None` if there is none with this number of knots.
pub fn function_kind(code: usize, knots: &[u32]) -> Option<FunctionKind> {
    Some(match (code, knots) {
        (0, &[p, q]) => FunctionKind::Edge([p, q]),
        (1, &[p]) => FunctionKind::Vertex(p),
        (2, &[p, q]) => FunctionKind::Tent([p, q]),
        (3, &[p, q, r]) => FunctionKind::Crease([p, q, r]),
        (4, &[p, q, r, s]) => FunctionKind::Face([p, q, r, s]),
        _ => return None,
    })
}

fn parts(kind: &FunctionKind) -> (usize, &[u32]) {
    match kind {
        FunctionKind::Edge(knots) => (0, knots),
        FunctionKind::Vertex(knot) => (1, std::slice::from_ref(knot)),
        FunctionKind::Tent(knots) => (2, knots),
        FunctionKind::Crease(knots) => (3, knots),
        FunctionKind::Face(knots) => (4, knots),
    }
}

/// Appends an encoded function to a payload.
pub(super) fn encode(function: &Function, payload: &mut Vec<u8>) {
    let (code, knots) = parts(&function.kind);
    let words = [code as u32, function.terms.len() as u32];
    words.iter().chain(knots).for_each(|word| payload.extend_from_slice(&word.to_le_bytes()));
    for (set, factor) in &function.terms {
        set.iter().for_each(|knot| payload.extend_from_slice(&knot.to_le_bytes()));
        payload.extend_from_slice(&factor.to_le_bytes());
    }
}

/// Decodes the functions of a payload, which must fill it.
pub(super) fn decode(mut payload: &[u8]) -> Result<Vec<Function>> {
    let mut functions = Vec::with_capacity(payload.len() / LEAST_LEN);
    while !payload.is_empty() {
        functions.push(decode_one(&mut payload)?);
    }
    Ok(functions)
}

fn decode_one(payload: &mut &[u8]) -> Result<Function> {
    let mut take = |len: u64| {
        let found = usize::try_from(len).ok().and_then(|len| payload.split_at_checked(len));
        let (taken, rest) =
            found.ok_or_else(|| Error::malformed("a function is cut off at the end of its block"))?;
        *payload = rest;
        Ok::<_, Error>(taken)
    };
    let [code, terms] = {
        let head = take(8)?;
        [LE::read_u32(head), LE::read_u32(&head[4..])]
    };
    let Some(&(_, count)) = KINDS.get(code as usize) else {
        return Err(Error::malformed(format!(
            "a function of kind {code}, expected 0 to {}",
            KINDS.len() - 1
        )));
    };
    let knots: Vec<u32> = take(4 * count as u64)?.chunks_exact(4).map(LE::read_u32).collect();
    let kind = function_kind(code as usize, &knots).expect("a kind has as many knots as it has");
    let term = |bytes: &[u8]| {
        let set = [LE::read_u32(bytes), LE::read_u32(&bytes[4..])];
        (set, LE::read_f64(&bytes[8..]))
    };
    let terms = take(u64::from(terms) * TERM_LEN as u64)?.chunks_exact(TERM_LEN).map(term).collect();
    Ok(Function { kind, terms })
}

/// Decodes the coefficients of a payload, which must fill it.
pub(super) fn decode_coefficients(payload: &[u8]) -> Result<Vec<f64>> {
    if !payload.len().is_multiple_of(8) {
        return Err(Error::malformed(format!(
            "coefficients in {} bytes, which is no multiple of 8",
            payload.len()
        )));
    }
    Ok(payload.chunks_exact(8).map(LE::read_f64).collect())
}

/// State against which later functions are checked; the reader, the text twin and the writer share it.
#[derive(Debug, Default)]
pub(super) struct FunctionRules {
    last: Option<FunctionKind>,
}

impl FunctionRules {
    /// Checks the next function; `knots` knots came before.
    pub(super) fn function(&mut self, function: &Function, knots: u64) -> Result<()> {
        let (name, of_kind) = function_kind_parts(&function.kind);
        let fail = |what: String| Err(Error::malformed(format!("function {name} {of_kind:?} {what}")));
        if of_kind.iter().any(|&knot| u64::from(knot) >= knots) {
            return fail(format!("is not of numbers of {knots} knots"));
        }
        if (1..of_kind.len()).any(|i| of_kind[..i].contains(&of_kind[i])) {
            return fail("repeats a knot".into());
        }
        if let Some(last) = self.last.replace(function.kind)
            && last >= function.kind
        {
            let (name, of_last) = function_kind_parts(&last);
            return fail(format!("does not follow {name} {of_last:?}"));
        }
        if function.terms.is_empty() {
            return fail("has no term".into());
        }
        for ([p, q], factor) in &function.terms {
            if p >= q || u64::from(*q) >= knots {
                return fail(format!(
                    "has a term of [{p}, {q}], which are no increasing numbers of {knots} knots"
                ));
            }
            if !factor.is_finite() || *factor == 0.0 {
                return fail(format!("has the factor {factor}"));
            }
        }
        if function.terms.windows(2).any(|pair| pair[0].0 >= pair[1].0) {
            return fail("has terms that do not follow each other".into());
        }
        Ok(())
    }
}

/// Checks that coefficients are finite.
pub(super) fn check_coefficients(coefficients: &[f64]) -> Result<()> {
    match coefficients.iter().find(|number| !number.is_finite()) {
        Some(number) => Err(Error::malformed(format!("the coefficient {number} is not finite"))),
        None => Ok(()),
    }
}

/// Checks that a spline has as many coefficients as functions, or any coefficients if its functions are not
/// listed.
pub(super) fn check_end(totals: &Totals) -> Result<()> {
    let Totals { vertices: functions, residual_points: coefficients, .. } = *totals;
    let is_whole = coefficients > 0 && (functions == 0 || functions == coefficients);
    if is_whole {
        return Ok(());
    }
    Err(Error::malformed(format!(
        "END: {coefficients} coefficients of {functions} functions: one each is needed"
    )))
}
