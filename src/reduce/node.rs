//! One node of the reduction: triangulate, drop what lies in holes, split final from not final.

use super::disks::Disks;
use super::duplicates::Duplicates;
use super::patches::PatchBuilder;
use super::residual::Residual;
use crate::bounds::Region;
use crate::delaunay2::{Corner, Kernel, NONE, Triangulation};
use crate::error::{Error, Result};
use crate::predicates::PredicateCounts;
use crate::predicates::circle::CircleBounds;
use crate::stream::{Coordinates, Header, PatchBlocks, PointCode};

/// What every node of one run has in common.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rules {
    coordinates: Coordinates,
    code: PointCode,
    duplicates: Duplicates,
    /// Whether the run leaves a residual, to be merged with others.
    pub(super) is_partial: bool,
}

impl Rules {
    /// The rules for a mesh with the given header.
    pub(super) fn new(header: &Header, duplicates: Duplicates, is_partial: bool) -> Self {
        let code = PointCode::of(header);
        Rules { coordinates: header.coordinates, code, duplicates, is_partial }
    }

    fn circle_bounds(&self) -> CircleBounds {
        match self.coordinates {
            Coordinates::F64 => CircleBounds::FLOAT,
            Coordinates::I32 { .. } => CircleBounds::INTEGER,
        }
    }
}

/// What became of a triangle of a node's triangulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Fate {
    /// Not in a hole, and not found active.
    Open,
    /// In a hole: a final triangle stands there already, written at a node below.
    Hole,
    /// Not final: triangulated again above.
    Active,
}

/// What is known of a point of a node beside the triangles that it is in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mark {
    /// Nothing: it is done with its last final triangle.
    None,
    /// On the hull, where there are no points beyond: done, and maybe in no final triangle of this node.
    Hull,
    /// Belongs to the residual.
    Residual,
    /// Coincides with another point and is no vertex.
    Merged,
}

/// What a node leaves.
#[derive(Debug, Default)]
pub(super) struct Solved {
    /// Its final triangles.
    pub(super) blocks: PatchBlocks,
    /// What the node above has to triangulate.
    pub(super) residual: Residual,
    /// For each point of the residual, the reference that stands for its id.
    pub(super) references: Vec<u64>,
    /// Number of points merged into others.
    pub(super) merged: u64,
}

/// Triangulates nodes, one after the other, in buffers that are used again.
pub(super) struct Solver {
    rules: Rules,
    kernel: Kernel,
    triangulation: Triangulation,
    fates: Vec<Fate>,
    /// For each triangle the set of its edges (bit i: opposite to corner i) that are walls of its hole.
    wall_edges: Vec<u8>,
    stack: Vec<u32>,
    marks: Vec<Mark>,
    /// Triangles that are not final.
    active: Vec<u32>,
    /// Walls of the residual, as three times a triangle that is done plus the corner opposite to the wall.
    walls: Vec<u64>,
    builder: PatchBuilder,
    index_above: Vec<u32>,
}

impl Solver {
    pub(super) fn new(rules: Rules) -> Self {
        Solver {
            rules,
            kernel: Kernel::new(),
            triangulation: Triangulation::default(),
            fates: Vec::new(),
            wall_edges: Vec::new(),
            stack: Vec::new(),
            marks: Vec::new(),
            active: Vec::new(),
            walls: Vec::new(),
            builder: PatchBuilder::default(),
            index_above: Vec::new(),
        }
    }

    /// Triangulates the points of node `number`, and finds what is final in `region`, outside of which other points
    /// may lie. Nodes are numbered in the order in which they are written. The memory of `blocks` is used again.
    ///
    /// # Errors
    /// [`crate::error::ErrorKind::Malformed`] if coinciding points are forbidden or come from different
    /// nodes, or the walls do not fit the points, which only damaged partial results can bring about.
    pub(super) fn solve(
        &mut self,
        number: u64,
        points: &mut Residual,
        region: &Region,
        mut blocks: PatchBlocks,
    ) -> Result<Solved> {
        blocks.clear();
        self.kernel.triangulate(&points.xy, &mut self.triangulation)?;
        let duplicates = &mut self.triangulation.duplicates;
        if let Some(pair) = duplicates.iter().find(|pair| pair.iter().any(|&i| i as usize >= points.raw)) {
            return Err(overlap(points, pair[0], pair[1]));
        }
        self.rules.duplicates.settle(points, duplicates, &self.rules.coordinates)?;
        self.find_holes(&points.walls)?;
        let everything = *region == Region::PLANE && !self.rules.is_partial;
        self.split(points, region, everything, &mut blocks)?;
        self.mark_points(points.len(), everything);
        self.finish_patches(points, &mut blocks)?;
        self.find_walls(everything);
        let (residual, references) = self.residual(number, points);
        let merged = self.triangulation.duplicates.len() as u64;
        Ok(Solved { blocks, residual, references, merged })
    }

    /// Decisions of the predicates so far.
    pub(super) fn counts(&self) -> &PredicateCounts {
        self.kernel.counts()
    }

    /// Marks the triangles in holes: floods from the left sides of the walls, and stops at walls.
    fn find_holes(&mut self, walls: &[[u32; 2]]) -> Result<()> {
        let triangulation = &self.triangulation;
        self.fates.clear();
        self.fates.resize(triangulation.triangles().len(), Fate::Open);
        if walls.is_empty() {
            return Ok(());
        }
        self.wall_edges.clear();
        self.wall_edges.resize(triangulation.triangles().len(), 0);
        self.stack.clear();
        for &[a, b] in walls {
            let Some(edge) = triangulation.left_of(a, b) else {
                return Err(Error::malformed("a wall of a residual is no edge of the triangulation"));
            };
            self.wall_edges[edge.triangle as usize] |= 1 << edge.corner;
            if self.fates[edge.triangle as usize] == Fate::Open {
                self.fates[edge.triangle as usize] = Fate::Hole;
                self.stack.push(edge.triangle);
            }
        }
        while let Some(triangle) = self.stack.pop() {
            for corner in 0..3 {
                if self.wall_edges[triangle as usize] & 1 << corner != 0 {
                    continue;
                }
                let Some(beyond) = triangulation.triangles()[triangle as usize].across(corner) else {
                    return Err(Error::malformed("the walls of a residual do not close a hole"));
                };
                let fate = &mut self.fates[beyond.triangle as usize];
                if *fate == Fate::Open {
                    *fate = Fate::Hole;
                    self.stack.push(beyond.triangle);
                }
            }
        }
        Ok(())
    }

    /// Decides the triangles that are not in holes: final ones go into patches, the others are active. Where no
    /// other point exists, `everything` is final.
    fn split(
        &mut self,
        points: &Residual,
        region: &Region,
        everything: bool,
        blocks: &mut PatchBlocks,
    ) -> Result<()> {
        let disks = Disks::new(self.rules.circle_bounds(), *region);
        self.builder.start(points.len());
        self.active.clear();
        for ((t, fate), triangle) in (0..).zip(&mut self.fates).zip(self.triangulation.triangles()) {
            if *fate == Fate::Hole {
                continue;
            }
            let [a, b, c] = triangle.vertices.map(|v| points.xy[v as usize]);
            if everything || disks.inside(a, b, c) {
                self.builder.triangle(&triangle.vertices, points, self.rules.code, blocks)?;
            } else {
                *fate = Fate::Active;
                self.active.push(t);
            }
        }
        Ok(())
    }

    /// Finds out what becomes of the points. If `everything` is final, the infinite triangles are, too.
    fn mark_points(&mut self, points: usize, everything: bool) {
        let Triangulation { hull, duplicates, .. } = &self.triangulation;
        let triangles = self.triangulation.triangles();
        self.marks.clear();
        self.marks.resize(points, Mark::None);
        let on_hull = if everything { Mark::Hull } else { Mark::Residual };
        hull.iter().for_each(|&v| self.marks[v as usize] = on_hull);
        for v in self.active.iter().flat_map(|&t| triangles[t as usize].vertices) {
            self.marks[v as usize] = Mark::Residual;
        }
        duplicates.iter().for_each(|&[point, _]| self.marks[point as usize] = Mark::Merged);
    }

    /// Adds the points that are done but in no triangle written here: vertices of the hull whose triangles were all
    /// written below, and at the root the points of an input without triangles.
    ///
    /// # Errors
    /// If a point has no triangle outside of the holes: no node leaves such a point.
    fn finish_patches(&mut self, points: &Residual, blocks: &mut PatchBlocks) -> Result<()> {
        let (builder, marks) = (&mut self.builder, &self.marks);
        let mut unused = Vec::new();
        for (v, &mark) in (0..).zip(marks) {
            match mark {
                Mark::Hull if builder.is_unused(v) => unused.push(v),
                Mark::None if builder.is_unused(v) => {
                    let point = points.point(v as usize);
                    return Err(Error::malformed(format!(
                        "residual point {point:?} lies inside of a final triangle"
                    )));
                }
                _ => {}
            }
        }
        builder.finish(unused.into_iter(), points, self.rules.code, blocks)?;
        builder.finalize(|v| matches!(marks[v as usize], Mark::None | Mark::Hull), blocks);
        Ok(())
    }

    /// Finds the edges of triangles that are done beyond which there is one that is not, finite or infinite.
    fn find_walls(&mut self, everything: bool) {
        let Triangulation { hull, triangle_of_vertex, .. } = &self.triangulation;
        let triangles = self.triangulation.triangles();
        let is_done = |t: u32| self.fates[t as usize] != Fate::Active;
        self.walls.clear();
        for &t in &self.active {
            let beyond = (0..3).filter_map(|side| triangles[t as usize].across(side));
            self.walls.extend(beyond.filter(|beyond| is_done(beyond.triangle)).map(wall));
        }
        for &v in hull.iter().filter(|_| !everything) {
            // The first triangle at a vertex of the hull is the one at the edge of the hull that leaves it.
            let t = triangle_of_vertex[v as usize];
            if t != NONE && is_done(t) {
                let corner = (0..).zip(triangles[t as usize].vertices).find(|&(_, vertex)| vertex == v);
                self.walls
                    .extend(corner.map(|(corner, _)| wall(Corner { triangle: t, corner: (corner + 2) % 3 })));
            }
        }
        self.walls.sort_unstable();
    }

    /// The residual, with references for the ids of its points.
    fn residual(&mut self, number: u64, points: &Residual) -> (Residual, Vec<u64>) {
        let count = self.marks.iter().filter(|&&mark| mark == Mark::Residual).count();
        let mut residual = Residual::with_capacity(count, self.walls.len());
        let mut references = Vec::with_capacity(count);
        self.index_above.resize(self.index_above.len().max(points.len()), NONE);
        for (v, _) in (0..).zip(&self.marks).filter(|&(_, &mark)| mark == Mark::Residual) {
            let reference = self.builder.reference(v, points);
            self.index_above[v as usize] = residual.len() as u32;
            residual.push(points.point(v as usize), self.builder.key(v, number, points));
            references.push(reference);
        }
        residual.walls.extend(self.walls.iter().map(|&wall| {
            let (triangle, corner) = (&self.triangulation.triangles()[(wall / 3) as usize], wall % 3);
            [1, 2].map(|k| self.index_above[triangle.vertices[(corner as usize + k) % 3] as usize])
        }));
        residual.active = self.active.len();
        (residual, references)
    }
}

fn wall(edge: Corner) -> u64 {
    3 * u64::from(edge.triangle) + u64::from(edge.corner)
}

fn overlap(points: &Residual, point: u32, vertex: u32) -> Error {
    let [a, b] = [point, vertex].map(|i| points.point(i as usize));
    Error::malformed(format!(
        "point {a:?} coincides with {b:?} of another cell or tile (stored coordinates): regions overlap"
    ))
}
