//! Cuts a mesh that arrives vertex by vertex and triangle by triangle into patches.

use std::collections::HashMap;

use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Patch, Totals};

/// Sizes at which a patch is closed. They keep it far below the greatest length of a block, because each
/// triangle imports at most three vertices and each finalization one: 24 + 24 * 2048 + 8 * (3 * 4096 + 4096)
/// + 12 * 4096 + 4 * 4096 bytes are 240 KiB.
const NEW_MAX: usize = 2048;
const TRIANGLES_MAX: usize = 4096;
const FINALIZED_MAX: usize = 4096;

/// When the vertices of an input are final.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Order {
    /// Vertices come before their triangles, and the input says when they are final (pre-order).
    Stated,
    /// Vertices come after all their triangles, so that they are final on arrival (post-order).
    OnArrival,
    /// The input does not say: all vertices are final at its end. Triangles may precede their vertices.
    AtEnd,
}

/// A vertex that is not finalized yet.
#[derive(Debug, Default, Clone, Copy)]
struct Live {
    /// Number of triangles that use it and wait for another vertex.
    waiting: u32,
    /// The input said that it is final.
    closed: bool,
    /// A triangle uses it.
    used: bool,
}

/// Collects elements into patches. Memory: a patch, the live vertices (the width of the input), and the
/// triangles that wait for their vertices. With [`Order::AtEnd`] no live vertices are held.
pub(crate) struct PatchBuilder {
    order: Order,
    first_id: u64,
    new: Vec<Point>,
    triangles: Vec<[u64; 3]>,
    finalized: Vec<u64>,
    live: HashMap<u64, Live>,
    /// Waiting triangles by serial number, each with the number of vertices it waits for.
    waiting: HashMap<u64, ([u64; 3], u8)>,
    /// Serial numbers of waiting triangles, by the vertex they wait for.
    awaited: HashMap<u64, Vec<u64>>,
    waited: u64,
    triangles_read: u64,
    /// Vertices that the end of the input finalizes, decreasing; filled by [`PatchBuilder::end`].
    remaining: Vec<u64>,
    /// With [`Order::AtEnd`], how many of the last vertices are still to be finalized.
    unfinalized: u64,
}

impl PatchBuilder {
    pub(crate) fn new(order: Order) -> Self {
        PatchBuilder {
            order,
            first_id: 0,
            new: Vec::new(),
            triangles: Vec::new(),
            finalized: Vec::new(),
            live: HashMap::new(),
            waiting: HashMap::new(),
            awaited: HashMap::new(),
            waited: 0,
            triangles_read: 0,
            remaining: Vec::new(),
            unfinalized: 0,
        }
    }

    /// Number of vertices read so far, which is also the id of the next one.
    pub(crate) fn vertices(&self) -> u64 {
        self.first_id + self.new.len() as u64
    }

    /// Number of triangles read so far.
    pub(crate) fn triangles(&self) -> u64 {
        self.triangles_read
    }

    /// Adds the next vertex.
    pub(crate) fn vertex(&mut self, point: Point) {
        let id = self.vertices();
        self.new.push(point);
        let waiting = self.awaited.remove(&id).unwrap_or_default();
        if self.order != Order::AtEnd {
            let closed = self.order == Order::OnArrival;
            self.live.insert(id, Live { waiting: waiting.len() as u32, closed, used: false });
        }
        for number in waiting {
            let (_, missing) = self.waiting.get_mut(&number).expect("an awaited triangle waits");
            *missing -= 1;
            if *missing == 0 {
                let (triangle, _) = self.waiting.remove(&number).expect("it was just there");
                self.triangles.push(triangle);
                triangle.into_iter().for_each(|id| self.release(id));
            }
        }
        self.finalize_if_done(id);
    }

    /// Adds a triangle of the vertices with these ids.
    pub(crate) fn triangle(&mut self, triangle: [u64; 3]) -> Result<()> {
        let [a, b, c] = triangle;
        if a == b || b == c || c == a {
            return Err(Error::malformed(format!(
                "triangle {} {} {} uses a vertex twice",
                a + 1,
                b + 1,
                c + 1
            )));
        }
        let vertices = self.vertices();
        for id in triangle {
            if id >= vertices && self.order == Order::Stated {
                return Err(Error::malformed(format!("triangle uses vertex {} of {vertices}", id + 1)));
            }
            if self.order == Order::AtEnd || id >= vertices {
                continue;
            }
            match self.live.get_mut(&id) {
                Some(live) if !live.closed => live.used = true,
                _ => {
                    let message = format!("vertex {} referenced after finalization", id + 1);
                    return Err(Error::malformed(message));
                }
            }
        }
        self.triangles_read += 1;
        let missing = triangle.iter().filter(|&&id| id >= vertices).count();
        if missing == 0 {
            self.triangles.push(triangle);
            return Ok(());
        }
        for id in triangle {
            if id >= vertices {
                self.awaited.entry(id).or_default().push(self.waited);
            } else if let Some(live) = self.live.get_mut(&id) {
                live.waiting += 1;
            }
        }
        self.waiting.insert(self.waited, (triangle, missing as u8));
        self.waited += 1;
        Ok(())
    }

    /// Records that no later triangle uses a vertex.
    pub(crate) fn finalize(&mut self, id: u64) -> Result<()> {
        let vertices = self.vertices();
        match self.live.get_mut(&id) {
            Some(live) if !live.closed => live.closed = true,
            _ if id < vertices => {
                return Err(Error::malformed(format!("vertex {} finalized twice", id + 1)));
            }
            _ => return Err(Error::malformed(format!("vertex {} finalized before it came", id + 1))),
        }
        self.finalize_if_done(id);
        Ok(())
    }

    /// Number of vertices that a triangle uses and that the input has not declared final so far.
    pub(crate) fn open(&self) -> usize {
        self.live.values().filter(|live| live.used && !live.closed).count()
    }

    /// Whether the patch should be taken before more is added.
    pub(crate) fn is_full(&self) -> bool {
        self.new.len() >= NEW_MAX
            || self.triangles.len() >= TRIANGLES_MAX
            || self.finalized.len() >= FINALIZED_MAX
    }

    /// Ends the input: all live vertices are final.
    pub(crate) fn end(&mut self) -> Result<()> {
        if let Some(id) = self.awaited.keys().min() {
            let vertices = self.vertices();
            return Err(Error::malformed(format!("a triangle uses vertex {} of {vertices}", id + 1)));
        }
        self.remaining = std::mem::take(&mut self.live).into_keys().collect();
        self.remaining.sort_unstable_by_key(|&id| std::cmp::Reverse(id));
        self.unfinalized = if self.order == Order::AtEnd { self.vertices() } else { 0 };
        Ok(())
    }

    /// The next patch after [`PatchBuilder::end`]; `None` when nothing is left.
    pub(crate) fn take_remaining(&mut self) -> Option<Patch> {
        let room = FINALIZED_MAX.saturating_sub(self.finalized.len());
        let from_list = self.remaining.len().saturating_sub(room);
        self.finalized.extend(self.remaining.drain(from_list..));
        if self.order == Order::AtEnd {
            let end = self.vertices();
            let start = end - self.unfinalized;
            let stop = end.min(start + room as u64);
            self.finalized.extend(start..stop);
            self.unfinalized -= stop - start;
        }
        let is_empty = self.new.is_empty() && self.triangles.is_empty() && self.finalized.is_empty();
        (!is_empty).then(|| self.take())
    }

    /// Totals of the input, for the END block.
    pub(crate) fn totals(&self) -> Totals {
        let vertices = self.vertices();
        Totals { points: vertices, vertices, simplices: self.triangles_read, ..Totals::default() }
    }

    /// Returns the patch so far and starts a new one. One vertex can complete any number of triangles: those
    /// beyond the size of a patch stay for the next one, and finalizations wait for the triangles before
    /// them.
    pub(crate) fn take(&mut self) -> Patch {
        let first_id = self.first_id;
        let new = std::mem::take(&mut self.new);
        let triangles: Vec<_> = drain_at_most(&mut self.triangles, TRIANGLES_MAX);
        let finals = if self.triangles.is_empty() { FINALIZED_MAX } else { 0 };
        let finalized = drain_at_most(&mut self.finalized, finals);
        self.first_id += new.len() as u64;
        patch_of_ids(first_id, new, triangles.as_flattened(), &finalized)
    }

    /// Records that one triangle that used the vertex no longer waits.
    fn release(&mut self, id: u64) {
        if let Some(live) = self.live.get_mut(&id) {
            live.waiting -= 1;
        }
        self.finalize_if_done(id);
    }

    fn finalize_if_done(&mut self, id: u64) {
        if self.live.get(&id).is_some_and(|live| live.closed && live.waiting == 0) {
            self.live.remove(&id);
            self.finalized.push(id);
        }
    }
}

/// The patch of the vertices `new`, whose ids count from `first_id`. `simplices` (concatenated) and
/// `finalized` are ids of these or earlier vertices.
pub(crate) fn patch_of_ids(first_id: u64, new: Vec<Point>, simplices: &[u64], finalized: &[u64]) -> Patch {
    let used = simplices.iter().chain(finalized);
    let mut imported: Vec<u64> = used.copied().filter(|&id| id < first_id).collect();
    imported.sort_unstable();
    imported.dedup();
    let local = |id: &u64| match id.checked_sub(first_id) {
        Some(new) => new as u32,
        None => (new.len() + imported.binary_search(id).expect("it was collected")) as u32,
    };
    let simplices = simplices.iter().map(local).collect();
    let mut finalized: Vec<u32> = finalized.iter().map(local).collect();
    finalized.sort_unstable();
    Patch { first_id, new, imported, simplices, finalized, ..Patch::default() }
}

fn drain_at_most<T>(items: &mut Vec<T>, most: usize) -> Vec<T> {
    if items.len() <= most { std::mem::take(items) } else { items.drain(..most).collect() }
}
