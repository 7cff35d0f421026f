//! Meshes of the surface of a union of balls, and of the faces between its cells.
//!
//! Both share the vertices on the circles where spheres meet ([`nodes`]), so neither has cracks. Which arcs
//! of a circle are on the surface follows from the outline (`faces`) of the face there.

mod faces;
mod nodes;
mod patch;

pub use faces::{Faces, faces};
pub use patch::linings;

use super::Balls;
use super::dual::Dual;
use super::shares::length;
use super::tile::{Tile, with_all};
use nodes::Nodes;
use patch::patch;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay3::Kernel;
use spmesh_delaunay::parallel;
use spmesh_delaunay::predicates::Point3;
use spmesh_delaunay::vector::{difference, dot};
use std::f64::consts::PI;
use std::num::NonZeroUsize;

/// Greatest quotient of a radius and the resolution: it bounds the vertices on a sphere.
pub const FINEST: f64 = 200.0;

/// Greatest number of vertices of a mesh: formats number them by 32-bit integers with a sign.
const VERTICES_MAX: usize = i32::MAX as usize;

/// Greatest step on a sphere, in radii: with few vertices on a large patch, triangles would face inwards.
const COARSEST: f64 = 0.5;

/// Least distance of a vertex inside a patch from its border, in steps.
const MARGIN: f64 = 0.5;

/// Balls of one piece of work.
const PIECE: usize = 64;

/// A triangle mesh of the surface of a union of balls. Vertices lie on the spheres.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Surface {
    /// Vertices. Those where spheres meet come first.
    pub points: Vec<Point3>,
    /// For each vertex a unit vector outwards; where spheres meet the mean of theirs.
    pub normals: Vec<Point3>,
    /// For each vertex the ball on whose sphere it is, the least of several.
    pub owners: Vec<u32>,
    /// Triangles, counterclockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// For each triangle the ball on whose sphere its corners are.
    pub balls: Vec<u32>,
    /// Number of balls whose exposed part was left out, as rounding left its border in doubt.
    pub left_out: usize,
}

/// The surface of a union of balls as a closed triangle mesh. Neighbours on circles are at most `step` apart,
/// others about that.
///
/// The mesh has the topology of the surface, whatever the step is, up to arcs shorter than a millionth of a
/// radius. It lies in the union and does not cross itself. The result does not depend on the number of
/// threads.
///
/// # Errors
/// As [`super::measure`]; usage, if the step is not positive, is less than 1/200 of a radius, or makes more
/// vertices than 2^31.
///
/// Cost: the triangulation of all balls on one thread, and some 6 µs per vertex. Memory: 500 bytes per
/// ball, and 150 per vertex.
///
/// ```
/// use spmesh_molecules::balls::{Balls, surface};
/// use std::num::NonZeroUsize;
///
/// let balls = Balls { centres: &[[0.0; 3], [1.0, 0.0, 0.0]], radii: &[1.0, 1.0] };
/// let surface = surface(balls, 0.1, NonZeroUsize::MIN)?;
/// // A closed surface of genus 0: F = 2 (V - 2).
/// assert_eq!(surface.triangles.len(), 2 * (surface.points.len() - 2));
/// # Ok::<(), spmesh_base::error::Error>(())
/// ```
pub fn surface(balls: Balls<'_>, step: f64, threads: NonZeroUsize) -> Result<Surface> {
    check_step(balls, step)?;
    with_all(balls, |tile| of_tile(tile, balls, step, threads))
}

fn of_tile(tile: &Tile<'_>, balls: Balls<'_>, step: f64, threads: NonZeroUsize) -> Result<Surface> {
    let borders = Borders::new(&Dual::new(tile), step);
    let exposed = borders.exposed();
    let pieces: Vec<&[u32]> = exposed.chunks(PIECE).collect();
    let patches = parallel::map(threads, pieces, |piece| {
        let mut kernel = Kernel::new();
        piece.iter().map(|&v| borders.patch(v, step, &mut kernel)).collect::<Result<Vec<_>>>()
    })?;
    let mut surface = Surface { points: borders.nodes.clone(), ..Surface::default() };
    for (&v, patch) in exposed.iter().zip(patches.into_iter().flatten()) {
        surface.add(tile.ball(v).unwrap_or_default(), patch)?;
    }
    surface.finish(balls);
    Ok(surface)
}

fn check_step(balls: Balls<'_>, step: f64) -> Result<()> {
    super::check(balls)?;
    let greatest = balls.radii.iter().copied().fold(0.0, f64::max);
    // Not the opposite comparison, which NaN would pass.
    if step > 0.0 && step * FINEST >= greatest {
        return Ok(());
    }
    Err(Error::usage(format!("a step of {step:e} is too fine: at least {:e} fits", greatest / FINEST)))
}

pub(super) fn check_count(points: &[Point3]) -> Result<()> {
    if points.len() > VERTICES_MAX {
        return Err(Error::usage("more than 2^31 - 1 vertices: take a coarser resolution"));
    }
    Ok(())
}

/// A ball as another one sees it: the cap that it cuts off.
struct Cap {
    /// Direction of the other centre.
    normal: Point3,
    /// Signed distance of the plane.
    height: f64,
}

/// The borders of the exposed parts.
struct Borders<'t> {
    tile: &'t Tile<'t>,
    nodes: Vec<Point3>,
    /// For each ball the chords around its exposed part, which is on their left.
    chords: Vec<Vec<[u32; 2]>>,
    caps: Vec<Vec<Cap>>,
    /// Whether each ball has a cell.
    has_cell: Vec<bool>,
}

/// A patch: vertices on the border, those inside, and triangles of both, in this order.
struct Patch {
    border: Vec<u32>,
    inside: Vec<Point3>,
    triangles: Option<Vec<[u32; 3]>>,
}

impl<'t> Borders<'t> {
    fn new(dual: &Dual<'t>, step: f64) -> Self {
        let tile = dual.tile;
        let mut nodes = Nodes::new(dual, step);
        let mut chords: Vec<Vec<[u32; 2]>> = vec![Vec::new(); tile.vertices() as usize];
        let mut caps: Vec<Vec<Cap>> = (0..tile.vertices()).map(|_| Vec::new()).collect();
        tile.for_each_pair(|ring, pair| {
            let [first, second] = ring.ends.map(|v| v as usize);
            let (normal, _) = pair.circle();
            caps[first].push(Cap { normal, height: pair.heights[0] });
            caps[second].push(Cap { normal: normal.map(|c| -c), height: pair.heights[1] });
            nodes.for_each_arc(ring, pair, |arc| {
                for link in arc.windows(2) {
                    chords[first].push([link[1], link[0]]);
                    chords[second].push([link[0], link[1]]);
                }
            });
        });
        let same = nodes.merged();
        for chords in &mut chords {
            merge(chords, &same);
        }
        let mut has_cell = vec![false; tile.vertices() as usize];
        tile.tetrahedra().iter().flat_map(|t| t.vertices).for_each(|v| has_cell[v as usize] = true);
        Borders { tile, nodes: nodes.points, chords, caps, has_cell }
    }

    /// The vertices whose spheres are exposed.
    fn exposed(&self) -> Vec<u32> {
        let is_exposed = |&v: &u32| {
            let v = v as usize;
            !self.chords[v].is_empty() || self.is_whole(v as u32)
        };
        (0..self.tile.vertices()).filter(|&v| self.tile.ball(v).is_some()).filter(is_exposed).collect()
    }

    /// Whether no ball covers any of a sphere that no circle divides.
    fn is_whole(&self, v: u32) -> bool {
        let caps = &self.caps[v as usize];
        let is_free = |cap: &Cap| self.tile.radius(v) * cap.normal[2] <= cap.height;
        self.has_cell[v as usize] && self.tile.radius(v) > 0.0 && caps.iter().all(is_free)
    }

    fn patch(&self, v: u32, step: f64, kernel: &mut Kernel) -> Result<Patch> {
        let chords = &self.chords[v as usize];
        let centre = self.tile.point(v);
        let mut border: Vec<u32> = chords.iter().flatten().copied().collect();
        border.sort_unstable();
        border.dedup();
        let mut inside = self.inside(v, step);
        let mut points: Vec<Point3> =
            border.iter().map(|&node| difference(self.nodes[node as usize], centre)).collect();
        if inside.is_empty()
            && let Some(apex) = self.apex(v)
        {
            inside.push(apex);
        }
        points.extend(&inside);
        let place = |node: u32| border.binary_search(&node).unwrap_or_default() as u32;
        let local: Vec<[u32; 2]> = chords.iter().map(|chord| chord.map(place)).collect();
        let triangles = patch(&points, &local, kernel)?;
        let inside = inside.into_iter().map(|p| [0, 1, 2].map(|axis| centre[axis] + p[axis])).collect();
        Ok(Patch { border, inside, triangles })
    }

    /// Points of the exposed part that are not next to its border, relative to the centre: a spiral of equal
    /// areas, which each cap thins out.
    fn inside(&self, v: u32, step: f64) -> Vec<Point3> {
        let radius = self.tile.radius(v);
        let step = step.min(COARSEST * radius);
        // A triangle has half the area that a point has, in a mesh of equilateral ones.
        let share = 0.75f64.sqrt() * step * step;
        let count = (4.0 * PI * radius * radius / share).ceil() as usize;
        let limits: Vec<(Point3, f64)> = self.caps[v as usize]
            .iter()
            .filter(|cap| cap.height < radius)
            .map(|cap| {
                let angle = (cap.height / radius).max(-1.0).acos() + MARGIN * step / radius;
                (cap.normal, if angle < PI { angle.cos() } else { -2.0 })
            })
            .collect();
        let turn = PI * (3.0 - 5f64.sqrt());
        let direction = |number: usize| {
            let z = 1.0 - (2.0 * number as f64 + 1.0) / count as f64;
            let (y, x) = (turn * number as f64).sin_cos();
            let flat = (1.0 - z * z).sqrt();
            [flat * x, flat * y, z]
        };
        let is_free = |p: &Point3| limits.iter().all(|&(normal, most)| dot(*p, normal) <= most);
        (0..count).map(direction).filter(is_free).map(|p| p.map(|c| c * radius)).collect()
    }

    /// The point opposite to the only cap whose border is a whole circle: with the circle alone, the hull
    /// would be flat.
    fn apex(&self, v: u32) -> Option<Point3> {
        let caps = &self.caps[v as usize];
        let radius = self.tile.radius(v);
        let most = caps
            .iter()
            .filter(|cap| cap.height.abs() < radius)
            .min_by(|p, q| p.height.total_cmp(&q.height))?;
        let apex = most.normal.map(|c| -c);
        caps.iter().all(|cap| radius * dot(apex, cap.normal) < cap.height).then(|| apex.map(|c| c * radius))
    }
}

/// Replaces merged vertices; chords without length, and pairs there and back, vanish.
fn merge(chords: &mut Vec<[u32; 2]>, same: &[u32]) {
    chords.iter_mut().for_each(|chord| *chord = chord.map(|node| same[node as usize]));
    chords.retain(|[from, to]| from != to);
    chords.sort_unstable();
    let sorted = chords.clone();
    chords.retain(|&[from, to]| sorted.binary_search(&[to, from]).is_err());
}

impl Surface {
    /// Keeps only the triangles whose numbers `is_wanted` accepts, and their vertices.
    pub fn retain(&mut self, is_wanted: impl Fn(usize) -> bool) {
        let kept: Vec<usize> = (0..self.triangles.len()).filter(|&number| is_wanted(number)).collect();
        self.triangles = kept.iter().map(|&number| self.triangles[number]).collect();
        self.balls = kept.iter().map(|&number| self.balls[number]).collect();
        let mut numbers = vec![u32::MAX; self.points.len()];
        self.triangles.iter().flatten().for_each(|&corner| numbers[corner as usize] = 0);
        let used: Vec<usize> = (0..numbers.len()).filter(|&place| numbers[place] == 0).collect();
        (0..).zip(&used).for_each(|(number, &place)| numbers[place] = number);
        self.points = used.iter().map(|&place| self.points[place]).collect();
        self.normals = used.iter().map(|&place| self.normals[place]).collect();
        self.owners = used.iter().map(|&place| self.owners[place]).collect();
        self.triangles.iter_mut().for_each(|corners| *corners = corners.map(|c| numbers[c as usize]));
    }

    fn add(&mut self, ball: u32, patch: Patch) -> Result<()> {
        let Some(triangles) = patch.triangles else {
            self.left_out += 1;
            return Ok(());
        };
        let first = self.points.len();
        self.points.extend(&patch.inside);
        check_count(&self.points)?;
        let on_border = patch.border.len();
        let number = |local: u32| match patch.border.get(local as usize) {
            Some(&node) => node,
            None => (first + local as usize - on_border) as u32,
        };
        self.balls.extend(std::iter::repeat_n(ball, triangles.len()));
        self.triangles.extend(triangles.into_iter().map(|triangle| triangle.map(number)));
        Ok(())
    }

    /// Drops vertices without triangles, and finds normals and owners.
    fn finish(&mut self, balls: Balls<'_>) {
        self.owners = vec![u32::MAX; self.points.len()];
        self.normals = vec![[0.0; 3]; self.points.len()];
        for (triangle, &ball) in self.triangles.iter().zip(&self.balls) {
            for node in triangle.map(|node| node as usize) {
                self.owners[node] = self.owners[node].min(ball);
                let outwards = difference(self.points[node], balls.centres[ball as usize]);
                (0..3)
                    .for_each(|axis| self.normals[node][axis] += outwards[axis] / balls.radii[ball as usize]);
            }
        }
        self.normals.iter_mut().for_each(|normal| *normal = normal.map(|c| c / length(*normal)));
        self.retain(|_| true);
    }
}
