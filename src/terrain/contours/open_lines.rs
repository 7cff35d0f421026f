//! Open lines, which may still grow: pieces in triangles are joined where they meet.

use std::collections::VecDeque;

use foldhash::{HashMap, HashMapExt};

use super::crossings::{Crossing, Side};
use super::smooth::Place;
use spmesh_base::error::{Error, ErrorKind, Result, counted};

/// Sweep again when held > 2 x (held after the last sweep) + a slack of at most `SLACK`, in open ends and points.
const SLACK: usize = 1 << 16;

/// Memory has room for so many slacks, for small budgets. Units: bytes.
const SLACK_BYTES: u64 = 256;

/// Bytes of an end in the hash table with its free neighbours, whose old half is freed after it has grown.
const END_LEN: u64 = (size_of::<(Crossing, (usize, End))>() as u64 + 1) * 8 / 7 * 3 / 2;

/// Points that a new line has room for.
const POINTS_FIRST: usize = 8;

/// A complete line, or a part of a line that was cut.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Contour<P> {
    pub(super) level: i64,
    /// Places. A ring does not repeat its first one at the end.
    pub(super) points: Vec<P>,
    pub(super) is_closed: bool,
    /// Of a ring: whether the ground along it is lower inside than outside.
    pub(super) is_depression: bool,
}

/// One of the ends of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    First,
    Last,
}

#[derive(Debug)]
struct Line<P> {
    points: VecDeque<P>,
    /// The crossings where it may grow, at its first and its last point.
    ends: [Option<Crossing>; 2],
    /// The least corner of its triangles: outside of it, if it is a ring.
    least: Side,
}

/// All open lines.
///
/// Cost: amortised, constant time for each piece and logarithmic time for each point joined, because the
/// shorter line is moved to the longer one.
///
/// Memory: the points of these lines, and some 50 bytes for each end. Sweeps over all ends find lines that
/// cannot grow; a sweep is due when twice as much is held as after the last one.
#[derive(Debug)]
pub(super) struct OpenLines<P> {
    waiting: HashMap<Crossing, (usize, End)>,
    lines: Vec<Line<P>>,
    free: Vec<usize>,
    /// Lines with this many points are cut.
    points_limit: usize,
    /// Number of points held.
    points: usize,
    /// The high-water mark of points.
    pub(super) points_max: usize,
    /// The high-water mark of open ends.
    pub(super) ends_max: usize,
    /// Number of cuts.
    pub(super) cuts: u64,
    /// Bytes that lines may take.
    pub(super) bytes_max: u64,
    /// The most points of a line so far.
    longest: usize,
    /// Open ends and points held after the last sweep.
    held_after_sweep: usize,
    /// Complete lines that the caller has not taken yet.
    pub(super) complete: Vec<Contour<P>>,
}

impl<P: Place> OpenLines<P> {
    /// No lines. Lines with `points_limit` points, at least two, will be cut.
    pub(super) fn new(points_limit: usize) -> OpenLines<P> {
        OpenLines {
            waiting: HashMap::new(),
            lines: Vec::new(),
            free: Vec::new(),
            points_limit,
            points: 0,
            points_max: 0,
            ends_max: 0,
            cuts: 0,
            bytes_max: u64::MAX,
            longest: 0,
            held_after_sweep: 0,
            complete: Vec::new(),
        }
    }

    /// Adds the piece of a line in a triangle, from one crossing to another of the same level; `place`
    /// computes the place of the first (0) or the second (1), and `least` is the least corner.
    ///
    /// # Errors
    /// [`ErrorKind::Malformed`], if another triangle is on the same side of one of the
    /// edges; [`ErrorKind::Memory`], if lines exceed theirs; those of `place`.
    pub(super) fn add(
        &mut self,
        [from, to]: [Crossing; 2],
        least: Side,
        place: impl Fn(usize) -> Result<P>,
    ) -> Result<()> {
        let line = match (self.take(from, End::Last)?, self.take(to, End::First)?) {
            (None, None) => {
                let mut points = VecDeque::with_capacity(POINTS_FIRST);
                points.extend([place(0)?, place(1)?]);
                self.points += 2;
                let line = self.insert(Line { points, ends: [None; 2], least });
                self.wait(line, End::First, from);
                self.wait(line, End::Last, to);
                line
            }
            (Some(line), None) => {
                self.lines[line].points.push_back(place(1)?);
                self.points += 1;
                self.wait(line, End::Last, to);
                line
            }
            (None, Some(line)) => {
                self.lines[line].points.push_front(place(0)?);
                self.points += 1;
                self.wait(line, End::First, from);
                line
            }
            (Some(before), Some(after)) if before == after => {
                self.lines[before].least = self.lines[before].least.min(least);
                self.finish(before, from.level, true);
                return Ok(());
            }
            (Some(before), Some(after)) => self.join(before, after),
        };
        self.lines[line].least = self.lines[line].least.min(least);
        self.points_max = self.points_max.max(self.points);
        self.ends_max = self.ends_max.max(self.waiting.len());
        self.longest = self.longest.max(self.lines[line].points.len());
        if self.bytes() > self.bytes_max {
            return Err(self.too_many());
        }
        if self.lines[line].ends == [None; 2] {
            // A line between two cuts, or between a cut and the border.
            self.finish(line, from.level, false);
        } else if self.lines[line].points.len() >= self.points_limit {
            self.cut(line, from.level);
        }
        Ok(())
    }

    /// What all lines take, at most: room for points doubles, and the longest line is smoothed alone.
    fn bytes(&self) -> u64 {
        let of_line = size_of::<Line<P>>() + size_of::<usize>() + POINTS_FIRST * size_of::<P>();
        let of_points = 2 * self.points * size_of::<P>() + self.longest * P::SMOOTHED_BYTES;
        (self.lines.capacity() * of_line + of_points) as u64 + self.waiting.capacity() as u64 * END_LEN
    }

    fn too_many(&self) -> Error {
        let points = counted(self.points as u64, "point", "points");
        let ends = counted(self.waiting.len() as u64, "end", "ends");
        let message =
            format!("open contour lines have {points} and {ends} so far, which --memory has no room for");
        Error::new(
            ErrorKind::Memory,
            format!("{message}: raise it, take a larger distance, or cut lines with --contour-points"),
        )
    }

    /// Whether enough is held to make [`OpenLines::finish_ended`] worth its time.
    pub(super) fn is_sweep_due(&self) -> bool {
        let slack = SLACK.min((self.bytes_max / SLACK_BYTES) as usize);
        self.waiting.len() + self.points > 2 * self.held_after_sweep + slack
    }

    /// Completes lines whose ends no later triangle can meet, because a vertex of the edge is not live.
    pub(super) fn finish_ended(&mut self, is_live: impl Fn(u64) -> bool) {
        let is_over = |crossing: &&Crossing| !crossing.edge.iter().all(|&vertex| is_live(vertex));
        let mut over: Vec<Crossing> = self.waiting.keys().filter(is_over).copied().collect();
        // The order of the table varies from run to run.
        over.sort_unstable();
        for crossing in over {
            let Some((line, end)) = self.waiting.remove(&crossing) else { continue };
            self.lines[line].ends[end as usize] = None;
            if self.lines[line].ends == [None; 2] {
                self.finish(line, crossing.level, false);
            }
        }
        self.held_after_sweep = self.waiting.len() + self.points;
    }

    /// Takes the line that waits with this end at a crossing.
    #[inline]
    fn take(&mut self, crossing: Crossing, end: End) -> Result<Option<usize>> {
        match self.waiting.remove(&crossing) {
            None => Ok(None),
            Some((line, found)) if found == end => {
                self.lines[line].ends[end as usize] = None;
                Ok(Some(line))
            }
            Some(_) => {
                let [p, q] = crossing.edge;
                Err(Error::malformed(format!(
                    "two triangles have the edge between vertices {p} and {q} on the same side"
                )))
            }
        }
    }

    /// Registers that a line waits at a crossing for its next piece.
    #[inline]
    fn wait(&mut self, line: usize, end: End, crossing: Crossing) {
        self.lines[line].ends[end as usize] = Some(crossing);
        self.waiting.insert(crossing, (line, end));
    }

    fn insert(&mut self, line: Line<P>) -> usize {
        match self.free.pop() {
            Some(place) => {
                self.lines[place] = line;
                place
            }
            None => {
                self.lines.push(line);
                self.lines.len() - 1
            }
        }
    }

    fn remove(&mut self, line: usize) -> Line<P> {
        self.free.push(line);
        let Line { least, .. } = self.lines[line];
        std::mem::replace(&mut self.lines[line], Line { points: VecDeque::new(), ends: [None; 2], least })
    }

    /// Joins two lines; the second one starts where the first one ends. Moves the shorter one.
    fn join(&mut self, before: usize, after: usize) -> usize {
        let is_first_longer = self.lines[before].points.len() >= self.lines[after].points.len();
        let (kept, moved, end) = if is_first_longer {
            (before, self.remove(after), End::Last)
        } else {
            (after, self.remove(before), End::First)
        };
        let points = &mut self.lines[kept].points;
        match end {
            End::Last => points.extend(moved.points),
            End::First => moved.points.into_iter().rev().for_each(|point| points.push_front(point)),
        }
        self.lines[kept].least = self.lines[kept].least.min(moved.least);
        if let Some(crossing) = moved.ends[end as usize] {
            self.wait(kept, end, crossing);
        }
        kept
    }

    /// Completes a line as it is. Pieces that come at its ends start new lines from the points there.
    fn cut(&mut self, line: usize, level: i64) {
        let Line { points, ends, least } = self.remove(line);
        let corners = [points.front().copied(), points.back().copied()];
        self.points -= points.len();
        self.cuts += 1;
        let points = points.into();
        self.complete.push(Contour { level, points, is_closed: false, is_depression: false });
        for (end, (crossing, corner)) in
            [End::First, End::Last].into_iter().zip(ends.into_iter().zip(corners))
        {
            if let (Some(crossing), Some(corner)) = (crossing, corner) {
                let rest = self.insert(Line { points: VecDeque::from([corner]), ends: [None; 2], least });
                self.points += 1;
                self.wait(rest, end, crossing);
            }
        }
    }

    fn finish(&mut self, line: usize, level: i64, is_closed: bool) {
        let Line { points, least, .. } = self.remove(line);
        self.points -= points.len();
        let is_depression = is_closed && least.is_above;
        // A single point is left over from a cut, and already in the other part.
        if points.len() > 1 {
            self.complete.push(Contour { level, points: points.into(), is_closed, is_depression });
        }
    }
}
