//! Points from bytes: the fewer bits a coordinate has, the more degenerate is the set.

/// Decodes at most `count` points, all of them finite.
///
/// The first byte selects the coordinates: integers of 2, 4 or 8 bits (cocircular and repeated points), i16,
/// i32 plus a large offset, multiples of 0.1, or any f64.
pub fn points<const D: usize>(bytes: &[u8], count: usize) -> Vec<[f64; D]> {
    let Some((&mode, rest)) = bytes.split_first() else { return Vec::new() };
    let coordinates: Vec<f64> = match mode % 7 {
        0 => rest.iter().flat_map(|b| [0, 2, 4, 6].map(|shift| f64::from(b >> shift & 3))).collect(),
        1 => rest.iter().flat_map(|b| [b & 15, b >> 4]).map(f64::from).collect(),
        2 => rest.iter().map(|&b| f64::from(b)).collect(),
        3 => words(rest).map(|w| f64::from(i16::from_le_bytes(w))).collect(),
        4 => words(rest).map(|w| f64::from(i32::from_le_bytes(w)) + 1e9).collect(),
        5 => rest.iter().map(|&b| 0.1 * f64::from(b as i8)).collect(),
        _ => words(rest).map(f64::from_le_bytes).filter(|c| c.is_finite()).collect(),
    };
    coordinates.as_chunks().0.iter().take(count).copied().collect()
}

/// As [`points`], but without arbitrary f64: integers of up to 33 bits, and multiples of 0.1.
pub fn moderate<const D: usize>(bytes: &[u8], count: usize) -> Vec<[f64; D]> {
    let mut bytes = bytes.to_vec();
    if let Some(mode) = bytes.first_mut() {
        *mode %= 6;
    }
    points(&bytes, count)
}

fn words<const N: usize>(bytes: &[u8]) -> impl Iterator<Item = [u8; N]> + '_ {
    bytes.as_chunks().0.iter().copied()
}
