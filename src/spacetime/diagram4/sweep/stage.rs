//! One stage of a sweep: which cells are closed, open, or spurious.

use super::CellSink;
use super::walls::{Owner, WallIndex, Walls, intersect, side};
use crate::diagram4::merge::Unordered;
use crate::diagram4::sites::Sites;
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_stream::model::cells4::{Cell4, Lists4};

/// What is between two stages.
#[derive(Default)]
pub(super) struct State {
    /// Points that open cells have, in increasing order.
    pub(super) left: Vec<u32>,
    pub(super) walls: Walls,
    /// Number of cells that were closed.
    closed: u32,
}

/// Cells are numbered below this, so that they can be sorted as signed numbers.
const CELLS_MAX: u32 = i32::MAX as u32;

/// The number of a cell that is open or spurious.
const OPEN: u32 = u32::MAX;
const SPURIOUS: u32 = u32::MAX - 1;

/// The cells of a stage.
pub(super) struct Stage<'a> {
    sites: &'a Sites,
    vertices: Lists4,
    neighbours: Lists4,
    is_infinite: Vec<bool>,
    /// For each cell: whether no later point can change it, if it is not spurious.
    is_closed: Vec<bool>,
}

/// A wall that was found again, between a spurious cell and another.
struct Met {
    spurious: u32,
    other: u32,
    wall: u32,
}

impl<'a> Stage<'a> {
    /// The cells of a triangulation; in the last stage, all are closed.
    pub(super) fn new(sites: &'a Sites, unordered: Unordered, is_last: bool) -> Stage<'a> {
        let Unordered { vertices, mut neighbours, joined, marked, .. } = unordered;
        for lists in &mut neighbours {
            for class in 0..lists.len() {
                lists.get_mut(class).iter_mut().for_each(|other| *other = joined.place(*other));
            }
        }
        let mut is_infinite = vec![true; vertices.len()];
        joined.finite().into_iter().for_each(|places| is_infinite[places].fill(false));
        let neighbours = Lists4::joined(neighbours);
        let is_closed =
            marked.iter().zip(&is_infinite).map(|(&closed, &infinite)| closed && (is_last || !infinite));
        let is_closed = is_closed.collect();
        Stage { sites, vertices, neighbours, is_infinite, is_closed }
    }

    /// Gives closed cells to the sink, and replaces the state.
    pub(super) fn close(self, state: &mut State, sink: &mut impl CellSink) -> Result<()> {
        let met = self.met(&state.walls)?;
        let numbers = self.numbers(&met, state.closed)?;
        state.walls = self.give(&met, &numbers, state, sink)?;
        state.left = self.left(&numbers);
        state.closed += numbers.iter().filter(|&&number| number < SPURIOUS).count() as u32;
        Ok(())
    }

    /// Finds the walls among the facets, in the order of spurious cells.
    fn met(&self, walls: &Walls) -> Result<Vec<Met>> {
        if walls.len() == 0 {
            return Ok(Vec::new());
        }
        let index = WallIndex::of(walls, self.sites.points.len());
        let (mut met, mut facet) = (Vec::with_capacity(walls.len()), Vec::new());
        for cell in (0..self.vertices.len()).filter(|&cell| !self.is_infinite[cell]) {
            let vertices = self.vertices.get(cell);
            if !index.may_have(vertices) {
                continue;
            }
            for &other in self.neighbours.get(cell) {
                // Each pair once, at a finite cell.
                if !self.is_infinite[other as usize] && (other as usize) < cell {
                    continue;
                }
                intersect(vertices, self.vertices.get(other as usize), &mut facet);
                let Some(wall) = index.find(&facet) else { continue };
                let is_spurious = side(self.sites, &facet, vertices) == walls.owner(wall).side;
                let pair = [cell as u32, other];
                let [spurious, other] = if is_spurious { pair } else { [pair[1], pair[0]] };
                met.push(Met { spurious, other, wall: wall as u32 });
            }
        }
        if met.len() != walls.len() {
            return Err(broken(&format!("{} of {} walls are facets", met.len(), walls.len())));
        }
        met.sort_unstable_by_key(|met| (met.spurious, met.other));
        Ok(met)
    }

    /// The numbers of all cells; closed ones are numbered on.
    fn numbers(&self, met: &[Met], closed: u32) -> Result<Vec<u32>> {
        let mut numbers = vec![OPEN; self.vertices.len()];
        let mut stack = Vec::new();
        for met in met {
            if std::mem::replace(&mut numbers[met.spurious as usize], SPURIOUS) == OPEN {
                stack.push(met.spurious);
            }
        }
        while let Some(cell) = stack.pop() {
            let walls = met_by(met, cell);
            for &other in self.neighbours.get(cell as usize) {
                let is_wall = || walls.binary_search_by_key(&other, |met| met.other).is_ok();
                if numbers[other as usize] == OPEN && !is_wall() {
                    if self.is_infinite[other as usize] {
                        return Err(broken("an infinite cell is in the place of closed ones"));
                    }
                    numbers[other as usize] = SPURIOUS;
                    stack.push(other);
                }
            }
        }
        if met.iter().any(|met| numbers[met.other as usize] != OPEN) {
            return Err(broken("a wall has spurious cells on both sides"));
        }
        let are_open = numbers.iter_mut().zip(&self.is_closed);
        let fresh = are_open.filter(|(number, is_closed)| **number == OPEN && **is_closed);
        for (next, (number, _)) in (closed..).zip(fresh) {
            if next == CELLS_MAX {
                return Err(Error::new(ErrorKind::Io, format!("more than {CELLS_MAX} cells")));
            }
            *number = next;
        }
        Ok(numbers)
    }

    /// Gives cells with numbers to the sink. Returns the walls around closed cells.
    fn give(&self, met: &[Met], numbers: &[u32], state: &State, sink: &mut impl CellSink) -> Result<Walls> {
        let mut walls = Walls::default();
        let mut open: Vec<&Met> = met.iter().collect();
        open.sort_unstable_by_key(|met| (met.other, met.spurious));
        let mut open = &open[..];
        let (mut neighbours, mut facet) = (Vec::new(), Vec::new());
        for (cell, &number) in numbers.iter().enumerate() {
            let (here, rest) =
                open.split_at(open.iter().take_while(|met| met.other as usize == cell).count());
            open = rest;
            if number >= SPURIOUS {
                here.iter().for_each(|met| {
                    walls.push(state.walls.facet(met.wall as usize), state.walls.owner(met.wall as usize))
                });
                continue;
            }
            neighbours.clear();
            let vertices = self.vertices.get(cell);
            for &other in self.neighbours.get(cell) {
                match numbers[other as usize] {
                    SPURIOUS => {}
                    OPEN => {
                        intersect(vertices, self.vertices.get(other as usize), &mut facet);
                        let owner =
                            Owner { number, first: vertices[0], side: side(self.sites, &facet, vertices) };
                        walls.push(&facet, owner);
                    }
                    other => neighbours.push(other),
                }
            }
            for met in here {
                let owner = state.walls.owner(met.wall as usize);
                neighbours.push(owner.number);
                sink.neighbour(owner.number, owner.first, number)?;
            }
            let is_infinite = self.is_infinite[cell];
            sink.cell(number, Cell4 { is_infinite, vertices, neighbours: &neighbours })?;
        }
        Ok(walls)
    }

    /// The points of open cells.
    fn left(&self, numbers: &[u32]) -> Vec<u32> {
        let mut is_left = vec![false; self.sites.points.len()];
        for (cell, _) in numbers.iter().enumerate().filter(|(_, number)| **number == OPEN) {
            self.vertices.get(cell).iter().for_each(|&vertex| is_left[vertex as usize] = true);
        }
        (0..).zip(is_left).filter_map(|(number, is_left)| is_left.then_some(number)).collect()
    }
}

/// What theory excludes. Cells would be lost or doubled.
#[cold]
fn broken(what: &str) -> Error {
    Error::new(ErrorKind::Io, format!("internal error in stages of --memory: {what}; please report it"))
}

/// The walls met at a spurious cell.
fn met_by(met: &[Met], spurious: u32) -> &[Met] {
    let start = met.partition_point(|met| met.spurious < spurious);
    let count = met[start..].iter().take_while(|met| met.spurious == spurious).count();
    &met[start..][..count]
}
