//! Triangles of a patch as operations and columns.

use super::Fault;
use super::columns::{unzigzag, zigzag};
use super::open_edges::{Border, NONE};
use super::operations::{Apex, Given, Operation};

/// Triangles at a vertex that the encoder looks at.
const SEARCH: usize = 24;

/// Why a triangle is refused in any place.
const REPEATED: Fault = "a triangle that uses a vertex twice";

/// Three vertices of a patch, as local indices.
pub(super) type Triangle = [u32; 3];

/// The columns of the triangles.
#[derive(Default)]
pub(super) struct TriangleColumns {
    pub(super) operations: Vec<u8>,
    pub(super) distances: Vec<u32>,
    pub(super) references: Vec<u32>,
    pub(super) imports: Vec<u32>,
}

/// The state that encoder and decoder share.
struct Walk {
    /// Number of new vertices.
    new: u32,
    border: Border,
    /// For each new vertex the one that predicts its coordinates.
    parents: Vec<u32>,
    /// The next new vertex.
    next: u32,
    /// The last vertex that was given as an import.
    last_import: u32,
}

impl Walk {
    fn new(new: usize, vertices: usize) -> Walk {
        let new = new as u32;
        let parents = (0..new).map(|vertex| vertex.saturating_sub(1)).collect();
        Walk { new, border: Border::new(vertices), parents, next: 0, last_import: new }
    }

    /// Gives parents to the new vertices from `first` on: the greatest lower corner of `triangle`, or else
    /// the vertex before.
    #[inline(always)]
    fn set_parents(&mut self, first: u32, triangle: Triangle) {
        for vertex in first..self.next {
            if let Some(parent) = triangle.into_iter().filter(|&corner| corner < vertex).max() {
                self.parents[vertex as usize] = parent;
            }
        }
    }
}

/// The columns of triangles, whose vertices must be in range and different; and the parents of the new
/// vertices.
pub(super) fn encode(new: usize, vertices: usize, triangles: &[Triangle]) -> (TriangleColumns, Vec<u32>) {
    let mut encoder = Encoder {
        walk: Walk::new(new, vertices),
        corners: Corners::new(vertices, triangles.len()),
        columns: TriangleColumns {
            operations: Vec::with_capacity(triangles.len()),
            ..TriangleColumns::default()
        },
    };
    for (number, &triangle) in (0..).zip(triangles) {
        let first = encoder.walk.next;
        let operation = encoder.triangle(number, triangle);
        encoder.columns.operations.push(operation.code());
        encoder.walk.set_parents(first, triangle);
        encoder.corners.push(triangle);
    }
    (encoder.columns, encoder.walk.parents)
}

struct Encoder {
    walk: Walk,
    corners: Corners,
    columns: TriangleColumns,
}

impl Encoder {
    #[inline(always)]
    fn triangle(&mut self, number: u32, triangle: Triangle) -> Operation {
        let [a, b, c] = triangle;
        let Some((corner, rotation)) = self.corners.latest_beside(triangle) else {
            let given = [self.given(a), self.given(b), self.given(c)];
            self.walk.border.triangle(triangle);
            return Operation::Loose(given);
        };
        let [p, q, x] = [[a, b, c], [b, c, a], [c, a, b]][rotation];
        let apex = self.apex(p, q, x);
        let distance = number - corner / 3;
        if distance > 1 {
            self.columns.distances.push(distance - 2);
        }
        self.walk.border.triangle([p, q, x]);
        let (edge, rotation) = ((corner % 3) as u8, rotation as u8);
        Operation::Attached { is_near: distance == 1, apex, edge, rotation }
    }

    #[inline(always)]
    fn apex(&mut self, p: u32, q: u32, x: u32) -> Apex {
        if x == self.walk.next && x < self.walk.new {
            return Apex::Given(self.given(x));
        }
        let (leave, reach) = (self.walk.border.at(p).to, self.walk.border.at(q).from);
        for age in [0, 1] {
            if leave[age] == x {
                return Apex::LeavesFirst(age);
            }
            if reach[age] == x {
                return Apex::ReachesSecond(age);
            }
        }
        Apex::Given(self.given(x))
    }

    #[inline(always)]
    fn given(&mut self, vertex: u32) -> Given {
        let next = self.walk.next;
        if vertex >= self.walk.new {
            self.columns.imports.push(zigzag(vertex.wrapping_sub(self.walk.last_import) as i32));
            self.walk.last_import = vertex;
            return Given::Import;
        }
        if vertex == next {
            self.walk.next += 1;
            return Given::Next;
        }
        self.columns.references.push(if vertex < next { next - 1 - vertex } else { vertex });
        Given::Reference
    }
}

/// For each vertex the corners of triangles at it, newest first, as linked lists.
struct Corners {
    newest: Vec<u32>,
    /// For each corner the older one at its vertex, and the vertex that follows in the triangle.
    older: Vec<(u32, u32)>,
}

impl Corners {
    fn new(vertices: usize, triangles: usize) -> Corners {
        Corners { newest: vec![NONE; vertices], older: Vec::with_capacity(3 * triangles) }
    }

    #[inline(always)]
    fn push(&mut self, [a, b, c]: Triangle) {
        for (vertex, following) in [(a, b), (b, c), (c, a)] {
            let newest = &mut self.newest[vertex as usize];
            let older = std::mem::replace(newest, self.older.len() as u32);
            self.older.push((older, following));
        }
    }

    /// Of the edges that earlier triangles have in the other direction, one of the latest triangle: the
    /// corner where it starts there, and the place where it starts in this triangle.
    #[inline(always)]
    fn latest_beside(&self, [a, b, c]: Triangle) -> Option<(u32, usize)> {
        let mut latest: Option<(u32, usize)> = None;
        for (rotation, (from, to)) in [(a, b), (b, c), (c, a)].into_iter().enumerate() {
            if let Some(corner) = self.find(to, from)
                && latest.is_none_or(|(other, _)| corner / 3 > other / 3)
            {
                latest = Some((corner, rotation));
            }
        }
        latest
    }

    /// The newest corner at `vertex` that `following` follows, if it is among the first few.
    #[inline(always)]
    fn find(&self, vertex: u32, following: u32) -> Option<u32> {
        let mut corner = self.newest[vertex as usize];
        for _ in 0..SEARCH {
            if corner == NONE {
                return None;
            }
            let (older, to) = self.older[corner as usize];
            if to == following {
                return Some(corner);
            }
            corner = older;
        }
        None
    }
}

/// The triangles of the columns, and the parents of the new vertices. Vertices of triangles are in range and
/// different.
pub(super) fn decode(
    new: usize,
    vertices: usize,
    operations: &[u8],
    numbers: [&[u32]; 3],
) -> Result<(Vec<Triangle>, Vec<u32>), Fault> {
    let [distances, references, imports] = numbers.map(<[u32]>::iter);
    let mut decoder = Decoder {
        walk: Walk::new(new, vertices),
        vertices: vertices as u32,
        triangles: Vec::with_capacity(operations.len()),
        distances,
        references,
        imports,
    };
    let table: [Option<Operation>; 256] = std::array::from_fn(|code| Operation::of_code(code as u8).ok());
    for &code in operations {
        let first = decoder.walk.next;
        let operation = table[usize::from(code)].ok_or("an operation above 152")?;
        let triangle = decoder.triangle(operation)?;
        decoder.walk.set_parents(first, triangle);
        decoder.triangles.push(triangle);
    }
    Ok((decoder.triangles, decoder.walk.parents))
}

struct Decoder<'a> {
    walk: Walk,
    vertices: u32,
    triangles: Vec<Triangle>,
    distances: std::slice::Iter<'a, u32>,
    references: std::slice::Iter<'a, u32>,
    imports: std::slice::Iter<'a, u32>,
}

impl Decoder<'_> {
    #[inline(always)]
    fn triangle(&mut self, operation: Operation) -> Result<Triangle, Fault> {
        let (is_near, apex, edge, rotation) = match operation {
            Operation::Loose([a, b, c]) => {
                let triangle = [self.given(a)?, self.given(b)?, self.given(c)?];
                let [a, b, c] = triangle;
                if a == b || b == c || c == a {
                    return Err(REPEATED);
                }
                self.walk.border.triangle(triangle);
                return Ok(triangle);
            }
            Operation::Attached { is_near, apex, edge, rotation } => (is_near, apex, edge, rotation),
        };
        let [a, b, c] = self.base(is_near)?;
        let (p, q) = match edge {
            0 => (b, a),
            1 => (c, b),
            _ => (a, c),
        };
        let x = match apex {
            Apex::Given(given) => self.given(given)?,
            Apex::LeavesFirst(age) => self.walk.border.at(p).to[age],
            Apex::ReachesSecond(age) => self.walk.border.at(q).from[age],
        };
        if x == NONE {
            return Err("an open edge that does not exist");
        }
        if x == p || x == q {
            return Err(REPEATED);
        }
        self.walk.border.triangle([p, q, x]);
        Ok(match rotation {
            0 => [p, q, x],
            1 => [x, p, q],
            _ => [q, x, p],
        })
    }

    /// The triangle that this one is attached to.
    #[inline(always)]
    fn base(&mut self, is_near: bool) -> Result<Triangle, Fault> {
        let distance = if is_near { 1 } else { u64::from(next_of(&mut self.distances)?) + 2 };
        let index = (self.triangles.len() as u64).checked_sub(distance);
        index.map(|index| self.triangles[index as usize]).ok_or("a distance to before the first triangle")
    }

    #[inline(always)]
    fn given(&mut self, given: Given) -> Result<u32, Fault> {
        let Walk { new, next, last_import, .. } = &mut self.walk;
        let vertex = match given {
            Given::Next => {
                *next += 1;
                *next - 1
            }
            Given::Reference => {
                let reference = next_of(&mut self.references)?;
                if reference < *next { *next - 1 - reference } else { reference }
            }
            Given::Import => {
                *last_import = last_import.wrapping_add_signed(unzigzag(next_of(&mut self.imports)?));
                let is_import = (*new..self.vertices).contains(last_import);
                return if is_import {
                    Ok(*last_import)
                } else {
                    Err("an imported vertex that does not exist")
                };
            }
        };
        if vertex < *new { Ok(vertex) } else { Err("a new vertex that does not exist") }
    }
}

/// The next number of a column, which has as many as the operations take.
#[inline(always)]
fn next_of(numbers: &mut std::slice::Iter<u32>) -> Result<u32, Fault> {
    numbers.next().copied().ok_or("a column that is too short")
}
