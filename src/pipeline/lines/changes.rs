//! What was changed about lines.

use spmesh_delaunay::noding::NodingChange;
use spmesh_stream::model::points::Point2;

/// A kind of change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ChangeKind {
    /// A new vertex where lines cross.
    Crossing,
    /// A vertex to which a passing line was bent.
    Touch,
    /// A segment that several lines, or parts of one, have in common.
    Overlap,
    /// A part of a line that goes back along the part before it.
    Spike,
    /// A vertex that repeats the one before it.
    RepeatedVertex,
    /// A part whose ends are at one place of the grid.
    ZeroLength,
    /// A line of one place.
    SingleVertex,
    /// A vertex with several elevations, of which the lowest counts.
    ConflictingElevation,
    /// A vertex whose unknown elevation was interpolated along its line.
    FilledElevation,
    /// A vertex that divides a long part.
    Densified,
    /// A vertex that rounding moved by more than half a millimetre.
    Rounded,
}

impl ChangeKind {
    /// All kinds.
    pub const ALL: [ChangeKind; 11] = [
        ChangeKind::Crossing,
        ChangeKind::Touch,
        ChangeKind::Overlap,
        ChangeKind::Spike,
        ChangeKind::RepeatedVertex,
        ChangeKind::ZeroLength,
        ChangeKind::SingleVertex,
        ChangeKind::ConflictingElevation,
        ChangeKind::FilledElevation,
        ChangeKind::Densified,
        ChangeKind::Rounded,
    ];

    /// Name in reports and in JSON.
    pub fn name(self) -> &'static str {
        match self {
            ChangeKind::Crossing => "crossing",
            ChangeKind::Touch => "touch",
            ChangeKind::Overlap => "overlap",
            ChangeKind::Spike => "spike",
            ChangeKind::RepeatedVertex => "repeated_vertex",
            ChangeKind::ZeroLength => "zero_length",
            ChangeKind::SingleVertex => "single_vertex",
            ChangeKind::ConflictingElevation => "conflicting_elevation",
            ChangeKind::FilledElevation => "filled_elevation",
            ChangeKind::Densified => "densified",
            ChangeKind::Rounded => "rounded",
        }
    }

    pub(crate) fn of(change: NodingChange) -> ChangeKind {
        match change {
            NodingChange::Crossing => ChangeKind::Crossing,
            NodingChange::Touch => ChangeKind::Touch,
            NodingChange::Overlap => ChangeKind::Overlap,
            NodingChange::Spike => ChangeKind::Spike,
            NodingChange::ZeroLength => ChangeKind::ZeroLength,
            NodingChange::SingleVertex => ChangeKind::SingleVertex,
            NodingChange::ConflictingElevation => ChangeKind::ConflictingElevation,
        }
    }
}

/// A change at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// What was changed.
    pub kind: ChangeKind,
    /// Number of a line that it concerns, from 0.
    pub line: u32,
    /// World coordinates.
    pub place: Point2,
}

/// What was changed about lines.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Changes {
    counts: [u64; ChangeKind::ALL.len()],
    list: Option<Vec<Change>>,
    /// Messages for the user.
    pub notices: Vec<String>,
}

impl Changes {
    pub(crate) fn new(lists_changes: bool) -> Changes {
        Changes { list: lists_changes.then(Vec::new), ..Changes::default() }
    }

    pub(crate) fn note(&mut self, kind: ChangeKind, line: u32, place: impl FnOnce() -> Point2) {
        self.counts[kind as usize] += 1;
        if let Some(list) = &mut self.list {
            list.push(Change { kind, line, place: place() });
        }
    }

    /// How many changes of a kind there are.
    pub fn count(&self, kind: ChangeKind) -> u64 {
        self.counts[kind as usize]
    }

    /// The changes, if they were asked for.
    pub fn list(&self) -> &[Change] {
        self.list.as_deref().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_numbered_in_order() {
        assert!(ChangeKind::ALL.iter().enumerate().all(|(number, &kind)| number == kind as usize));
    }
}
