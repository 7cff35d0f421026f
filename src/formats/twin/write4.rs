//! Lines of text twins of four dimensions (`formats/text.md`).

use std::io::Write;

use crate::sink::write_error;
use spmesh_base::error::Result;
use spmesh_base::limits::TEXT_NUMBERS_MAX;
use spmesh_stream::Points4;
use spmesh_stream::model::cells4::Cells4;
use spmesh_stream::model::decimal::Decimal;

/// Lines `v4`.
pub(crate) fn points(output: &mut impl Write, points: &Points4) -> Result<()> {
    for (number, [x, y, z, t]) in points.points.iter().enumerate() {
        let [x, y, z, t] = [x, y, z, t].map(|&coordinate| Decimal(coordinate));
        let written = match points.values.as_ref().map(|values| values[number]) {
            None => writeln!(output, "v4 {x} {y} {z} {t}"),
            Some(value) if value.is_nan() => writeln!(output, "v4 {x} {y} {z} {t} nan"),
            Some(value) => writeln!(output, "v4 {x} {y} {z} {t} {}", Decimal(value)),
        };
        written.map_err(write_error)?;
    }
    Ok(())
}

/// Lines `c4` or `i4`, then `n4`; lists too long for a line continue in lines `+4`.
pub(crate) fn cells(output: &mut impl Write, cells: &Cells4) -> Result<()> {
    for cell in cells.iter() {
        numbers(output, if cell.is_infinite { "i4" } else { "c4" }, cell.vertices)?;
        numbers(output, "n4", cell.neighbours)?;
    }
    Ok(())
}

/// Lines `s4`.
pub(crate) fn simplices(output: &mut impl Write, simplices: &[[u32; 5]]) -> Result<()> {
    simplices.iter().try_for_each(|simplex| numbers(output, "s4", simplex))
}

/// A line of numbers counted from 1, continued in lines `+4` after every [`TEXT_NUMBERS_MAX`] numbers.
fn numbers(output: &mut impl Write, word: &str, numbers: &[u32]) -> Result<()> {
    let (first, _) = numbers.split_at(numbers.len().min(TEXT_NUMBERS_MAX));
    let rest = numbers[first.len()..].chunks(TEXT_NUMBERS_MAX).map(|numbers| ("+4", numbers));
    for (word, numbers) in std::iter::once((word, first)).chain(rest) {
        output.write_all(word.as_bytes()).map_err(write_error)?;
        numbers
            .iter()
            .try_for_each(|&number| write!(output, " {}", u64::from(number) + 1))
            .map_err(write_error)?;
        output.write_all(b"\n").map_err(write_error)?;
    }
    Ok(())
}
