//! Triangles that wait until all that they are triangulated anew with have come.
//!
//! Two neighbours belong together if a segment crosses their common edge, or if the circles of both contain
//! new vertices, or may do so where a segment leaves the mesh. Any other edge stays: no segment crosses it,
//! and the circle of one of its triangles is empty of all vertices. A component of such triangles is *whole*
//! when no edge of it can get a neighbour that belongs to it.
//!
//! * Whether a segment crosses an edge follows from one of its triangles. The other one must come, unless the
//!   edge is on the border of the mesh.
//! * Whether the other circle contains a vertex is not known. The edge waits.
//! * An edge with an end that is final gets no further triangle.

use super::near::Meeting;
use foldhash::HashMap;
use spmesh_stream::model::bounds::Point;

/// Bytes of a triangle that waits, with its part of corners and of what is open at them.
const TRIANGLE_BYTES: u64 = 400;

/// Bytes of a number in a list, whose allocation may double.
const LISTED_BYTES: u64 = 8;

/// A triangle that waits.
#[derive(Debug)]
pub(super) struct Held {
    /// Numbers of its corners in [`Holding`].
    pub(super) corners: [u32; 3],
    pub(super) segments: Vec<u32>,
    pub(super) vertices: Vec<u32>,
    is_hit: bool,
    component: u32,
}

impl Held {
    /// Numbers of segments and vertices that it lists.
    fn listed(&self) -> usize {
        self.segments.len() + self.vertices.len()
    }

    /// What it takes alone.
    pub(super) fn bytes(&self) -> u64 {
        bytes(1, self.listed())
    }
}

fn bytes(triangles: usize, listed: usize) -> u64 {
    TRIANGLE_BYTES * triangles as u64 + LISTED_BYTES * listed as u64
}

/// A vertex of triangles that wait.
#[derive(Debug)]
pub(super) struct Corner {
    /// Its id in the input.
    pub(super) id: u64,
    pub(super) point: Point,
    /// Number of triangles that wait.
    uses: u32,
    /// Whether no further triangle of the input has it.
    is_final: bool,
    /// Other ends of edges that wait.
    open: Vec<u32>,
}

#[derive(Debug, Default)]
struct Component {
    triangles: Vec<u32>,
    /// Edges that wait for a neighbour.
    pending: u32,
}

/// All that waits.
#[derive(Debug, Default)]
pub(super) struct Holding {
    corners: Slots<Corner>,
    triangles: Slots<Held>,
    components: Slots<Component>,
    by_id: HashMap<u64, u32>,
    /// Edges with one triangle, which may get a neighbour in the same component.
    open: HashMap<[u32; 2], u32>,
    whole: Vec<u32>,
    /// Numbers of segments and vertices that waiting triangles list.
    listed: usize,
    /// The most triangles that waited at once.
    pub(super) triangles_max: usize,
}

/// Values with numbers, which are used again.
#[derive(Debug)]
struct Slots<T> {
    values: Vec<Option<T>>,
    free: Vec<u32>,
}

impl<T> Default for Slots<T> {
    fn default() -> Self {
        Slots { values: Vec::new(), free: Vec::new() }
    }
}

impl<T> Slots<T> {
    fn add(&mut self, value: T) -> u32 {
        if let Some(number) = self.free.pop() {
            self.values[number as usize] = Some(value);
            return number;
        }
        self.values.push(Some(value));
        (self.values.len() - 1) as u32
    }

    fn take(&mut self, number: u32) -> T {
        self.free.push(number);
        self.values[number as usize].take().expect("the slot is in use")
    }

    fn get(&self, number: u32) -> &T {
        self.values[number as usize].as_ref().expect("the slot is in use")
    }

    fn get_mut(&mut self, number: u32) -> &mut T {
        self.values[number as usize].as_mut().expect("the slot is in use")
    }

    fn len(&self) -> usize {
        self.values.len() - self.free.len()
    }
}

impl Holding {
    /// The number of a vertex that waiting triangles have.
    pub(super) fn number(&self, id: u64) -> Option<u32> {
        self.by_id.get(&id).copied()
    }

    /// What waiting triangles take, with what is open at them.
    pub(super) fn bytes(&self) -> u64 {
        bytes(self.len(), self.listed)
    }

    /// Number of triangles that wait.
    pub(super) fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Whether nothing waits.
    pub(super) fn is_empty(&self) -> bool {
        self.corners.len() == 0
    }

    /// The number of a vertex that no waiting triangle has yet; [`Holding::hold`] must follow.
    pub(super) fn enter(&mut self, id: u64, point: Point) -> u32 {
        let number = self.corners.add(Corner { id, point, uses: 0, is_final: false, open: Vec::new() });
        self.by_id.insert(id, number);
        number
    }

    /// Keeps a triangle.
    pub(super) fn hold(&mut self, corners: [u32; 3], meeting: Meeting) {
        corners.iter().for_each(|&corner| self.corners.get_mut(corner).uses += 1);
        let component = self.components.add(Component::default());
        let is_hit = meeting.is_hit();
        let Meeting { segments, vertices, is_crossed, .. } = meeting;
        self.listed += segments.len() + vertices.len();
        let number = self.triangles.add(Held { corners, segments, vertices, is_hit, component });
        self.components.get_mut(component).triangles.push(number);
        for (place, is_crossed) in is_crossed.into_iter().enumerate() {
            let [from, to] = [1, 2].map(|turn| corners[(place + turn) % 3]);
            self.meet(number, [from.min(to), from.max(to)], is_crossed);
        }
        self.note_whole(self.triangles.get(number).component);
        self.triangles_max = self.triangles_max.max(self.triangles.len());
    }

    /// Joins a new triangle with its neighbour at an edge if they belong together. Lets the edge wait if it
    /// has no neighbour yet and may get one.
    fn meet(&mut self, number: u32, edge: [u32; 2], is_crossed: bool) {
        let Some(other) = self.open.remove(&edge) else {
            if is_crossed || self.triangles.get(number).is_hit {
                self.open.insert(edge, number);
                self.components.get_mut(self.triangles.get(number).component).pending += 1;
                let [a, b] = edge;
                self.corners.get_mut(a).open.push(b);
                self.corners.get_mut(b).open.push(a);
            }
            return;
        };
        self.close(edge, other);
        let is_hit = |triangle: u32| self.triangles.get(triangle).is_hit;
        if is_crossed || (is_hit(number) && is_hit(other)) {
            self.join(number, other);
        } else if let [own, component] =
            [number, other].map(|triangle| self.triangles.get(triangle).component)
            && own != component
        {
            self.note_whole(component);
        }
    }

    /// An edge that was removed from `open` waits no longer.
    fn close(&mut self, [a, b]: [u32; 2], triangle: u32) {
        self.corners.get_mut(a).open.retain(|&end| end != b);
        self.corners.get_mut(b).open.retain(|&end| end != a);
        self.components.get_mut(self.triangles.get(triangle).component).pending -= 1;
    }

    /// Joins the components of two triangles: the smaller one goes into the larger one.
    fn join(&mut self, first: u32, second: u32) {
        let [first, second] = [first, second].map(|triangle| self.triangles.get(triangle).component);
        if first == second {
            return;
        }
        let is_larger =
            self.components.get(first).triangles.len() > self.components.get(second).triangles.len();
        let [into, from] = if is_larger { [first, second] } else { [second, first] };
        let Component { triangles, pending } = self.components.take(from);
        for &triangle in &triangles {
            self.triangles.get_mut(triangle).component = into;
        }
        let component = self.components.get_mut(into);
        component.pending += pending;
        component.triangles.extend(triangles);
    }

    /// No further triangle of the input has this vertex.
    pub(super) fn finalize(&mut self, number: u32) {
        let corner = self.corners.get_mut(number);
        corner.is_final = true;
        for end in std::mem::take(&mut corner.open) {
            let edge = [number.min(end), number.max(end)];
            let triangle = self.open.remove(&edge).expect("the edge waits");
            self.close(edge, triangle);
            self.note_whole(self.triangles.get(triangle).component);
        }
    }

    fn note_whole(&mut self, component: u32) {
        if self.components.get(component).pending == 0 {
            self.whole.push(component);
        }
    }

    /// Takes a component that is whole out, if there is one: its triangles.
    pub(super) fn take_whole(&mut self) -> Option<Vec<Held>> {
        let component = self.components.take(self.whole.pop()?);
        let triangles: Vec<Held> =
            component.triangles.into_iter().map(|triangle| self.triangles.take(triangle)).collect();
        self.listed -= triangles.iter().map(Held::listed).sum::<usize>();
        Some(triangles)
    }

    /// A vertex of triangles that wait or were just taken out.
    pub(super) fn vertex(&self, number: u32) -> &Corner {
        self.corners.get(number)
    }

    /// One triangle less waits at a vertex. Returns whether the vertex is final now: the input has no further
    /// triangle with it, and none waits.
    pub(super) fn release(&mut self, number: u32) -> bool {
        let corner = self.corners.get_mut(number);
        corner.uses -= 1;
        if corner.uses > 0 {
            return false;
        }
        let corner = self.corners.take(number);
        self.by_id.remove(&corner.id);
        corner.is_final
    }
}
