//! The molecular surface as a mesh: where the distance from the places of the probe's centre is its radius.
//!
//! Space is divided into cubes, and these into six tetrahedra each, around a diagonal (Kuhn 1960). A
//! tetrahedron with corners on both sides of the surface gets one or two triangles, so the mesh is closed
//! whatever the surface is (marching tetrahedra: Doi and Koide 1991). Vertices are found on the edges by the
//! distance itself. So they lie on the surface, also next to its creases, and the step decides only what lies
//! between them.

use super::reach::{Boundary, Nearby};
use crate::balls::shares::length;
use crate::balls::surface::{Surface, check_count};
use crate::balls::tile::Tile;
use crate::balls::tiles::{self, TILE_MAX};
use crate::balls::{Balls, check};
use foldhash::HashMap;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::parallel;
use spmesh_delaunay::predicates::Point3;
use spmesh_delaunay::vector::difference;
use spmesh_stream::model::bounds::Bounds;
use std::num::NonZeroUsize;

/// Least number of cubes along the side of a block. The side is about the greatest radius: then few balls are
/// near a block, and few blocks near a ball, whatever the step is.
const BLOCK_MIN: usize = 4;

/// Cubes along an axis: three of their numbers fit into a word.
const CUBES_MAX: f64 = (1 << 20) as f64;

/// Steps towards the surface on an edge: a few suffice where it is smooth.
const STEPS_MAX: usize = 24;

/// The corners of the six tetrahedra of a cube, whose bits are x, y and z, and whether each is right-handed.
const TETRAHEDRA: [([usize; 4], bool); 6] = [
    ([0, 1, 3, 7], true),
    ([0, 2, 6, 7], true),
    ([0, 4, 5, 7], true),
    ([0, 2, 3, 7], false),
    ([0, 4, 6, 7], false),
    ([0, 1, 5, 7], false),
];

/// The molecular surface as a closed triangle mesh, made in cubes of side `step`. The radii of the balls
/// include that of the probe, which is positive. Each vertex and each triangle has the ball in whose cell it
/// is.
///
/// Vertices lie on the surface; between them the mesh is off it by at most about the square of the step over
/// eight times the radius of the least ball without the probe.
///
/// # Errors
/// As [`super::molecular_surface`]; usage, if the step is not positive, or so small that there are 2^20 cubes
/// along an axis.
///
/// Cost: proportional to the vertices. Memory: 200 bytes per vertex, 2 kB per ball.
pub fn molecular_mesh(balls: Balls<'_>, probe: f64, step: f64, threads: NonZeroUsize) -> Result<Surface> {
    check(balls)?;
    super::check_probe(balls, probe)?;
    if !(probe > 0.0 && step > 0.0) {
        let message = format!("a probe of {probe:e} and a step of {step:e}: both must be positive");
        return Err(Error::usage(message));
    }
    let members = tiles::cut(balls, TILE_MAX);
    let parts = parallel::map(threads, members.iter(), |members| {
        Ok(Boundary::of_tile(&Tile::new(balls, members)?, members))
    })?;
    let mut boundary = Boundary::default();
    parts.into_iter().for_each(|part| boundary.extend(part));
    let Some(grid) = Grid::new(balls, probe, step)? else { return Ok(Surface::default()) };
    let blocks = Blocks::new(&grid, &boundary);
    let pieces = parallel::map(threads, blocks.near_surface(), |block| Ok(grid.piece(block, &blocks)))?;
    let mut surface = Surface::default();
    let mut numbers = HashMap::default();
    for piece in pieces {
        piece.add_to(&mut surface, &mut numbers)?;
    }
    Ok(surface)
}

/// The cubes.
struct Grid<'b> {
    balls: Balls<'b>,
    probe: f64,
    lower: Point3,
    step: f64,
    /// Cubes along the side of a block, a power of two.
    block: usize,
}

/// Numbers of a block, a cube or a corner, from 0.
type Place = [usize; 3];

impl<'b> Grid<'b> {
    fn new(balls: Balls<'b>, probe: f64, step: f64) -> Result<Option<Grid<'b>>> {
        let all = balls.centres.iter().zip(balls.radii);
        let boxes = all.map(|(at, r)| Bounds { min: at.map(|c| c - r), max: at.map(|c| c + r) });
        let Some(bounds) = boxes.reduce(Bounds::union) else { return Ok(None) };
        let greatest = balls.radii.iter().copied().fold(0.0, f64::max);
        let mut block = BLOCK_MIN;
        while step * (2 * block) as f64 <= greatest {
            block *= 2;
        }
        let mut grid = Grid { balls, probe, lower: bounds.min, step, block };
        grid.lower = bounds.min.map(|c| c - 2.0 * grid.reach());
        let extent = (0..3).map(|axis| bounds.max[axis] - grid.lower[axis]).fold(0.0, f64::max);
        if (extent + 2.0 * grid.reach()) / step < CUBES_MAX {
            return Ok(Some(grid));
        }
        Err(Error::usage(format!("a step of {step:e} is too fine for balls {extent:e} apart")))
    }

    /// Distances beyond are not told apart.
    fn reach(&self) -> f64 {
        self.probe + self.half_diagonal(self.block / 2) + self.step
    }

    /// From the middle of so many cubes along each axis to their corners, and a step more.
    fn half_diagonal(&self, cubes: usize) -> f64 {
        self.step * (0.5 * 3f64.sqrt() * cubes as f64 + 1.0)
    }

    /// A corner; halves of numbers are middles of cubes.
    fn at(&self, place: [f64; 3]) -> Point3 {
        [0, 1, 2].map(|axis| self.lower[axis] + self.step * place[axis])
    }

    /// Positive inside of the surface, zero on it, and not greater than the distance from it.
    fn depth(&self, nearby: &Nearby, at: Point3) -> f64 {
        nearby.nearest(self.balls, at, self.reach()).distance - self.probe
    }

    /// The mesh in a block.
    fn piece(&self, block: Place, blocks: &Blocks<'_>) -> Piece<'_> {
        let mut piece = Piece {
            grid: self,
            nearby: blocks.nearby(block),
            depths: HashMap::default(),
            numbers: HashMap::default(),
            vertices: Vec::new(),
            triangles: Vec::new(),
        };
        piece.search(block.map(|c| c * self.block), self.block);
        piece
    }

    /// The vertex on an edge between two corners: by false position, halving what does not move (Illinois).
    fn vertex(&self, ends: [Place; 2], depths: [f64; 2], nearby: &Nearby) -> Vertex {
        let [p, q] = ends.map(|end| self.at(end.map(|c| c as f64)));
        let at = |share: f64| [0, 1, 2].map(|axis| p[axis] + share * (q[axis] - p[axis]));
        let (mut low, mut high) = ((0.0, depths[0]), (1.0, depths[1]));
        let (mut share, mut was_high) = (0.5, None);
        for _ in 0..STEPS_MAX {
            share = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
            let depth = self.depth(nearby, at(share));
            if depth.abs() <= 1e-7 * self.step || high.0 - low.0 <= 1e-7 {
                break;
            }
            let is_high = (depth > 0.0) == (high.1 > 0.0);
            let (moved, kept) = if is_high { (&mut high, &mut low) } else { (&mut low, &mut high) };
            *moved = (share, depth);
            kept.1 *= if was_high == Some(is_high) { 0.5 } else { 1.0 };
            was_high = Some(is_high);
        }
        let at = at(share);
        let towards = nearby.nearest(self.balls, at, self.reach()).at.map(|probe| difference(probe, at));
        let normal = towards.map(|v| v.map(|c| c / length(v))).unwrap_or_default();
        Vertex { at, normal, owner: nearby.owner(self.balls, at) }
    }
}

fn key([x, y, z]: Place) -> u64 {
    (x as u64) << 42 | (y as u64) << 21 | z as u64
}

/// A corner of a cube of this side, whose bits are x, y and z.
fn corner_of([x, y, z]: Place, bits: usize, side: usize) -> Place {
    [x + side * (bits & 1), y + side * (bits >> 1 & 1), z + side * (bits >> 2)]
}

/// The triangles of a tetrahedron, counterclockwise seen from outside: for each vertex the ends of its edge.
fn crossing(is_inside: [bool; 4], is_right_handed: bool) -> Vec<[[usize; 2]; 3]> {
    let side = |wanted: bool| (0..4).filter(move |&i| is_inside[i] == wanted);
    let order: Vec<usize> = side(true).chain(side(false)).collect();
    // Exchanges that sort the corners.
    let swaps =
        (0..4).flat_map(|j| (0..j).map(move |i| (i, j))).filter(|&(i, j)| order[i] > order[j]).count();
    let [a, b, c, d] = [order[0], order[1], order[2], order[3]];
    let mut triangles = match side(true).count() {
        1 => vec![[[a, b], [a, c], [a, d]]],
        2 => vec![[[a, c], [b, d], [b, c]], [[a, c], [a, d], [b, d]]],
        3 => vec![[[a, d], [b, d], [c, d]]],
        _ => Vec::new(),
    };
    if is_right_handed != (swaps % 2 == 0) {
        triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
    triangles
}

/// The parts of the boundary by blocks, sorted by these.
struct Blocks<'g> {
    boundary: &'g Boundary,
    balls: Vec<(Place, u32)>,
    circles: Vec<(Place, u32)>,
    corners: Vec<(Place, u32)>,
    is_exposed: Vec<bool>,
}

impl<'g> Blocks<'g> {
    fn new(grid: &Grid<'_>, boundary: &'g Boundary) -> Blocks<'g> {
        let Balls { centres, radii } = grid.balls;
        let mut is_exposed = vec![false; centres.len()];
        boundary.exposed.iter().for_each(|&ball| is_exposed[ball as usize] = true);
        Blocks {
            boundary,
            balls: sorted(grid, centres.iter().zip(radii).map(|(&at, &radius)| (at, radius))),
            circles: sorted(grid, boundary.circles.iter().map(|circle| (circle.middle, circle.radius))),
            corners: sorted(grid, boundary.corners.iter().map(|&at| (at, 0.0))),
            is_exposed,
        }
    }

    /// The blocks in reach of exposed balls.
    fn near_surface(&self) -> Vec<Place> {
        let near = self.balls.iter().filter(|(_, ball)| self.is_exposed[*ball as usize]);
        let mut blocks: Vec<Place> = near.map(|&(block, _)| block).collect();
        blocks.dedup();
        blocks
    }

    fn nearby(&self, block: Place) -> Nearby {
        let of = |all: &[(Place, u32)]| -> Vec<u32> {
            let first = all.partition_point(|(other, _)| *other < block);
            all[first..].iter().take_while(|(other, _)| *other == block).map(|&(_, number)| number).collect()
        };
        let circle = |number: u32| self.boundary.circles[number as usize];
        Nearby {
            balls: of(&self.balls).into_iter().map(|ball| (ball, self.is_exposed[ball as usize])).collect(),
            circles: of(&self.circles).into_iter().map(circle).collect(),
            corners: of(&self.corners)
                .into_iter()
                .map(|number| self.boundary.corners[number as usize])
                .collect(),
        }
    }
}

/// The blocks that each of some spheres reaches.
fn sorted(grid: &Grid<'_>, spheres: impl Iterator<Item = (Point3, f64)>) -> Vec<(Place, u32)> {
    let mut found = Vec::new();
    for (number, (at, radius)) in (0..).zip(spheres) {
        let reach = radius + grid.reach() + grid.step;
        let side = grid.step * grid.block as f64;
        let block = |axis: usize, c: f64| ((c - grid.lower[axis]) / side).max(0.0) as usize;
        let range = |axis: usize| block(axis, at[axis] - reach)..=block(axis, at[axis] + reach);
        for x in range(0) {
            for y in range(1) {
                found.extend(range(2).map(|z| ([x, y, z], number)));
            }
        }
    }
    found.sort_unstable();
    found
}

/// A vertex of the mesh.
struct Vertex {
    at: Point3,
    normal: Point3,
    owner: u32,
}

/// The mesh in a block.
struct Piece<'g> {
    grid: &'g Grid<'g>,
    nearby: Nearby,
    /// Depths of corners.
    depths: HashMap<u64, f64>,
    /// Numbers of vertices by the ends of their edges.
    numbers: HashMap<[u64; 2], u32>,
    /// Vertices by these ends, which neighbouring blocks have, too.
    vertices: Vec<([u64; 2], Vertex)>,
    /// Triangles with their balls.
    triangles: Vec<([u32; 3], u32)>,
}

impl Piece<'_> {
    /// Divides cubes until the surface is too far from their middle, or there is one.
    fn search(&mut self, first: Place, cubes: usize) {
        let half = 0.5 * cubes as f64;
        let middle = self.grid.at(first.map(|c| c as f64 + half));
        let is_far = |depth: f64| depth.abs() > self.grid.half_diagonal(cubes);
        if cubes < self.grid.block && is_far(self.grid.depth(&self.nearby, middle)) {
            return;
        }
        if cubes == 1 {
            return self.cube(first);
        }
        for bits in 0..8 {
            self.search(corner_of(first, bits, cubes / 2), cubes / 2);
        }
    }

    /// Adds the triangles in a cube.
    fn cube(&mut self, first: Place) {
        let places: [Place; 8] = std::array::from_fn(|bits| corner_of(first, bits, 1));
        let depths = places.map(|place| self.depth_at(place));
        for (corners, is_right_handed) in TETRAHEDRA {
            for triangle in crossing(corners.map(|bits| depths[bits] > 0.0), is_right_handed) {
                let triangle = triangle.map(|ends| {
                    let [i, j] = ends.map(|end| corners[end]);
                    let ends = [i.min(j), i.max(j)];
                    self.vertex(ends.map(|end| places[end]), ends.map(|end| depths[end]))
                });
                let corners = triangle.map(|vertex| self.vertices[vertex as usize].1.at);
                let middle = [0, 1, 2].map(|axis| corners.iter().map(|p| p[axis]).sum::<f64>() / 3.0);
                let owner = self.nearby.owner(self.grid.balls, middle);
                self.triangles.push((triangle, owner));
            }
        }
    }

    fn depth_at(&mut self, place: Place) -> f64 {
        let at = self.grid.at(place.map(|c| c as f64));
        *self.depths.entry(key(place)).or_insert_with(|| self.grid.depth(&self.nearby, at))
    }

    /// The number of the vertex on an edge.
    fn vertex(&mut self, ends: [Place; 2], depths: [f64; 2]) -> u32 {
        let keys = ends.map(key);
        *self.numbers.entry(keys).or_insert_with(|| {
            self.vertices.push((keys, self.grid.vertex(ends, depths, &self.nearby)));
            self.vertices.len() as u32 - 1
        })
    }

    fn add_to(self, surface: &mut Surface, numbers: &mut HashMap<[u64; 2], u32>) -> Result<()> {
        let mut own = Vec::with_capacity(self.vertices.len());
        for (ends, vertex) in self.vertices {
            let number = *numbers.entry(ends).or_insert_with(|| {
                surface.points.push(vertex.at);
                surface.normals.push(vertex.normal);
                surface.owners.push(vertex.owner);
                surface.points.len() as u32 - 1
            });
            own.push(number);
        }
        check_count(&surface.points)?;
        for (triangle, ball) in self.triangles {
            surface.triangles.push(triangle.map(|vertex| own[vertex as usize]));
            surface.balls.push(ball);
        }
        Ok(())
    }
}
