//! The values of `--at` and `--snapshot`.

/// A moment of a stream.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Moment {
    /// After this part of it, from 0 to 1.
    Part(f64),
    /// After this number of triangles or points.
    Count(u64),
}

/// A number of triangles or points between pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Every(pub(super) u64);

/// Parses a moment: an integer is a count, any other number a part.
pub(super) fn parse_moment(text: &str) -> Result<Moment, String> {
    if let Ok(count) = text.parse() {
        return Ok(Moment::Count(count));
    }
    match text.parse::<f64>() {
        Ok(part) if (0.0..=1.0).contains(&part) => Ok(Moment::Part(part)),
        _ => Err(format!("{text:?} is neither a part between 0.0 and 1.0 nor an integer")),
    }
}

/// Parses `every=N` with N above zero.
pub(super) fn parse_every(text: &str) -> Result<Every, String> {
    let count = text.strip_prefix("every=").and_then(|count| count.parse().ok());
    count.filter(|&count| count > 0).map(Every).ok_or_else(|| format!("{text:?} is not like every=1000000"))
}
