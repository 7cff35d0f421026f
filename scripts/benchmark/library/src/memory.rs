//! Memory of one build in a process of its own.

use crate::inputs::{self, Kind};
use crate::libraries::{self, NAMES};

/// The peak of a build in bytes per point, beyond what the process held before. `None` if there is no such
/// library, or the system tells nothing.
pub fn peak_of_build(kind: Kind, count: usize, library: &str) -> Option<f64> {
    let number = NAMES.iter().position(|&name| name == library)?;
    let (_, points) = inputs::points(kind, count);
    let before = status("VmRSS:")?;
    let _library = libraries::build(number, &points);
    Some((status("VmHWM:")? - before) / points.len() as f64)
}

/// Bytes of a field of the status of this process.
fn status(field: &str) -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(field))?;
    Some(1024.0 * line.split_whitespace().next()?.parse::<f64>().ok()?)
}
