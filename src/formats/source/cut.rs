//! What is left of a file that was cut off.

use spmesh_base::error::counted;

/// What a file has before it was cut off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Cut {
    /// Whole points before the cut.
    pub(crate) read: u64,
    /// Points after the cut, if the file states how many it had.
    pub(crate) lost: Option<u64>,
}

impl Cut {
    /// A message for the user.
    pub(crate) fn describe(&self, file: &str) -> String {
        let read = counted(self.read, "point", "points");
        let lost = self.lost.map_or("an unknown number".to_string(), |lost| lost.to_string());
        format!("{file} was cut off: read {read}, lost {lost}")
    }
}
