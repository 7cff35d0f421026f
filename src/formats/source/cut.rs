//! What is left of a file that was cut off.

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
        match self.lost {
            Some(lost) => format!("{file} was cut off: read {} points, lost {lost}", self.read),
            None => format!("{file} was cut off: read {} points, lost an unknown number", self.read),
        }
    }
}
