//! From simplices to cells: cospherical neighbours are one.

use super::Stats;
use super::simplices::{Complex, FACETS, INFINITE, facet_of, simplex_of};
use crate::cells4::{Cell4, Cells4};
use std::cmp::Ordering;

/// What has no class.
const NONE: u32 = u32::MAX;

/// The cells of the diagram, in canonical order.
///
/// The triangulation is one of the diagram of the points as they are (a limit of diagrams of perturbed points), so each
/// cell is a union of its simplices, and two simplices at a facet are in one cell exactly if the vertex of one is on
/// the sphere of the other. A facet of the diagram on the hull is the union of those facets of simplices of one cell
/// that are in one hyperplane (thesis 4.3.6).
pub(super) fn cells(complex: Complex, stats: &mut Stats) -> Cells4 {
    let mut sets = Sets::new(complex.simplices.len());
    join_finite(&complex, &mut sets);
    join_infinite(&complex, &mut sets);
    let classes = Classes::of(&complex, sets);
    let mut gather = Gather::new(&complex, &classes);
    let unordered = gather.all();
    stats.simplices = classes.simplices;
    stats.infinite_simplices = classes.members.len() as u64 - classes.simplices;
    drop(classes);
    drop(complex);
    canonical(&unordered)
}

/// Joins finite simplices across facets between cospherical points.
fn join_finite(complex: &Complex, sets: &mut Sets) {
    for (number, simplex) in
        complex.simplices.iter().enumerate().filter(|&(number, _)| complex.is_finite(number))
    {
        for beyond in simplex.beyond {
            let other = simplex_of(beyond);
            if other < number {
                let apex = complex.simplices[other].vertices[facet_of(beyond)];
                if apex != INFINITE && complex.sign(number, apex) == Ordering::Equal {
                    sets.join(number as u32, other as u32);
                }
            }
        }
    }
}

/// Joins infinite simplices of one cell that are beyond the same hyperplane.
fn join_infinite(complex: &Complex, sets: &mut Sets) {
    let inside = |number: usize| complex.neighbour_inside(number).map(|finite| finite as u32);
    for (number, simplex) in
        complex.simplices.iter().enumerate().filter(|&(number, _)| complex.is_infinite(number))
    {
        for beyond in simplex.beyond {
            let other = simplex_of(beyond);
            if other < number && complex.is_infinite(other) {
                let apex = complex.simplices[other].vertices[facet_of(beyond)];
                let of_one_cell = inside(number).map(|n| sets.find(n)) == inside(other).map(|n| sets.find(n));
                if of_one_cell && complex.sign(number, apex) == Ordering::Equal {
                    sets.join(number as u32, other as u32);
                }
            }
        }
    }
}

/// Disjoint sets of numbers (Tarjan, 1975), paths halved.
struct Sets(Vec<u32>);

impl Sets {
    fn new(count: usize) -> Sets {
        Sets((0..count as u32).collect())
    }

    fn find(&mut self, mut number: u32) -> u32 {
        let parents = &mut self.0;
        while parents[number as usize] != number {
            parents[number as usize] = parents[parents[number as usize] as usize];
            number = parents[number as usize];
        }
        number
    }

    /// The root of the union is the least number.
    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

/// The simplices of each cell.
struct Classes {
    /// The class of each simplex; [`NONE`] for dead ones.
    of: Vec<u32>,
    /// Simplices by class.
    members: Vec<u32>,
    /// Where the members of each class begin, and where the last ones end.
    starts: Vec<u32>,
    /// Finite simplices.
    simplices: u64,
}

impl Classes {
    fn of(complex: &Complex, mut sets: Sets) -> Classes {
        let count = complex.simplices.len();
        let mut of = vec![NONE; count];
        let mut starts = vec![0u32];
        let mut simplices = 0;
        for number in (0..count).filter(|&number| !complex.is_dead(number)) {
            // Roots come first: they are the least of their set.
            let root = sets.find(number as u32) as usize;
            if root == number {
                of[number] = starts.len() as u32 - 1;
                starts.push(0);
            }
            of[number] = of[root];
            starts[of[number] as usize + 1] += 1;
            simplices += u64::from(complex.is_finite(number));
        }
        drop(sets);
        for class in 1..starts.len() {
            starts[class] += starts[class - 1];
        }
        let mut members = vec![0; *starts.last().unwrap_or(&0) as usize];
        let mut next = starts.clone();
        for (number, &class) in of.iter().enumerate().filter(|&(_, &class)| class != NONE) {
            members[next[class as usize] as usize] = number as u32;
            next[class as usize] += 1;
        }
        Classes { of, members, starts, simplices }
    }

    fn len(&self) -> usize {
        self.starts.len() - 1
    }

    fn members(&self, class: usize) -> &[u32] {
        &self.members[self.starts[class] as usize..self.starts[class + 1] as usize]
    }
}

/// Makes cells of classes.
struct Gather<'a> {
    complex: &'a Complex<'a>,
    classes: &'a Classes,
    /// The last class that each vertex, or class, was listed for.
    seen_vertices: Vec<u32>,
    seen_classes: Vec<u32>,
    vertices: Vec<u32>,
    neighbours: Vec<u32>,
}

impl<'a> Gather<'a> {
    fn new(complex: &'a Complex<'a>, classes: &'a Classes) -> Gather<'a> {
        Gather {
            complex,
            classes,
            seen_vertices: vec![NONE; complex.order.len()],
            seen_classes: vec![NONE; classes.len()],
            vertices: Vec::new(),
            neighbours: Vec::new(),
        }
    }

    fn all(&mut self) -> Cells4 {
        let mut cells = Cells4::default();
        for class in 0..self.classes.len() {
            let is_infinite = self.gather(class);
            cells.push(Cell4 { is_infinite, vertices: &self.vertices, neighbours: &self.neighbours });
        }
        cells
    }

    /// Lists the vertices of a class, by number of their site, and its neighbours; says whether it is infinite.
    fn gather(&mut self, class: usize) -> bool {
        let mark = class as u32;
        self.vertices.clear();
        self.neighbours.clear();
        self.seen_classes[class] = mark;
        let mut is_infinite = false;
        for &member in self.classes.members(class) {
            let simplex = &self.complex.simplices[member as usize];
            for side in 0..FACETS {
                let (vertex, other) =
                    (simplex.vertices[side], self.classes.of[simplex_of(simplex.beyond[side])]);
                if vertex == INFINITE {
                    is_infinite = true;
                } else if std::mem::replace(&mut self.seen_vertices[vertex as usize], mark) != mark {
                    self.vertices.push(self.complex.order[vertex as usize]);
                }
                if std::mem::replace(&mut self.seen_classes[other as usize], mark) != mark {
                    self.neighbours.push(other);
                }
            }
        }
        self.vertices.sort_unstable();
        is_infinite
    }
}

/// Finite cells first, both kinds by their vertices; neighbours renumbered.
fn canonical(unordered: &Cells4) -> Cells4 {
    // The kind and the first vertices decide mostly: no cell has to be looked at for these.
    let key = |number: u32| {
        let cell = unordered.get(number as usize);
        let first = u64::from(cell.vertices[0]) << 31 | u64::from(cell.vertices[1]) >> 1;
        (u64::from(cell.is_infinite) << 63 | first, number)
    };
    let mut order: Vec<(u64, u32)> = (0..unordered.len() as u32).map(key).collect();
    let vertices = |number: u32| unordered.get(number as usize).vertices;
    order.sort_unstable_by(|&(key, a), &(other, b)| {
        key.cmp(&other).then_with(|| vertices(a).cmp(vertices(b)))
    });
    let mut places = vec![0; order.len()];
    for (place, &(_, number)) in (0u32..).zip(&order) {
        places[number as usize] = place;
    }
    let mut cells = Cells4::with_room_of(unordered);
    let mut neighbours = Vec::new();
    for &(_, number) in &order {
        let cell = unordered.get(number as usize);
        neighbours.clear();
        neighbours.extend(cell.neighbours.iter().map(|&other| places[other as usize]));
        neighbours.sort_unstable();
        cells.push(Cell4 { neighbours: &neighbours, ..cell });
    }
    cells
}
