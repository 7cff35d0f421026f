//! One node of the reduction: triangulate, drop what lies in holes, split final from not final.

use super::duplicates::Duplicates;
use super::residual::Residual;
use crate::bounds::Region;
use crate::delaunay2::{Kernel, NONE, Triangulation};
use crate::error::{Error, Result};
use crate::predicates::PredicateCounts;
use crate::predicates::circle::CircleBounds;
use crate::stream::Coordinates;

/// What every node of one run has in common.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rules {
    pub(super) coordinates: Coordinates,
    pub(super) duplicates: Duplicates,
    /// Whether the run leaves a residual, to be merged with others.
    pub(super) is_partial: bool,
}

impl Rules {
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
    /// Not decided yet.
    Open,
    /// In a hole: a final triangle stands there already, written at a node below.
    Hole,
    /// Final at this node.
    Final,
    /// Not final: triangulated again above.
    Active,
}

/// What becomes of a point of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PointFate {
    /// Not met yet outside of the holes.
    Hidden,
    /// No triangle above this node uses it.
    Done,
    /// Belongs to the residual.
    Residual,
    /// Coincides with another point and is no vertex.
    Merged,
}

/// A node after its triangulation.
#[derive(Debug, Default)]
pub(super) struct Solved {
    /// The points, with the elevations of coinciding points settled.
    pub(super) points: Residual,
    /// What becomes of each point.
    pub(super) fates: Vec<PointFate>,
    /// Triangles that are final at this node, counterclockwise, in Morton order.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Walls of the residual, as indices into `points`.
    pub(super) walls: Vec<[u32; 2]>,
    /// Number of triangles that are not final.
    pub(super) active: usize,
    /// Number of points merged into others.
    pub(super) merged: u64,
}

impl Solved {
    /// The residual: to be called after the final triangles were written and the ids are known.
    pub(super) fn residual(&self) -> Residual {
        let count = self.fates.iter().filter(|&&fate| fate == PointFate::Residual).count();
        let mut residual = Residual::with_capacity(count, self.walls.len());
        let mut index_above = vec![NONE; self.points.len()];
        for (i, fate) in self.fates.iter().enumerate() {
            if *fate == PointFate::Residual {
                index_above[i] = residual.len() as u32;
                residual.push(self.points.point(i), self.points.ids[i]);
            }
        }
        residual.walls.extend(self.walls.iter().map(|wall| wall.map(|end| index_above[end as usize])));
        residual.active = self.active;
        residual
    }
}

/// Triangulates nodes, one after the other, in buffers that are used again.
#[derive(Default)]
pub(super) struct Solver {
    kernel: Kernel,
    triangulation: Triangulation,
    fates: Vec<Fate>,
    /// For each triangle the set of its edges (bit i: opposite to corner i) that are walls of its hole.
    wall_edges: Vec<u8>,
    stack: Vec<u32>,
}

impl Solver {
    /// Triangulates `points` and finds what is final in `region`, outside of which other points may lie.
    ///
    /// # Errors
    /// [`crate::error::ErrorKind::Malformed`] if coinciding points are forbidden or come from different
    /// nodes, or the walls do not fit the points, which only damaged partial results can bring about.
    pub(super) fn solve(&mut self, mut points: Residual, region: &Region, rules: &Rules) -> Result<Solved> {
        self.kernel.triangulate(&points.xy, &mut self.triangulation)?;
        let duplicates = &mut self.triangulation.duplicates;
        if let Some(pair) = duplicates.iter().find(|pair| pair.iter().any(|&i| i as usize >= points.raw)) {
            return Err(overlap(&points, pair[0], pair[1]));
        }
        rules.duplicates.settle(&mut points, duplicates, &rules.coordinates)?;
        self.find_holes(&points.walls)?;
        let everything = *region == Region::PLANE && !rules.is_partial;
        self.find_final(&points, region, everything, rules.circle_bounds());
        self.collect(points, everything)
    }

    /// Decisions of the predicates so far.
    pub(super) fn counts(&self) -> &PredicateCounts {
        self.kernel.counts()
    }

    /// Marks the triangles in holes: floods from the left sides of the walls, and stops at walls.
    fn find_holes(&mut self, walls: &[[u32; 2]]) -> Result<()> {
        let triangulation = &self.triangulation;
        self.fates.clear();
        self.fates.resize(triangulation.triangles.len(), Fate::Open);
        self.wall_edges.clear();
        self.wall_edges.resize(triangulation.triangles.len(), 0);
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
                let beyond = triangulation.neighbours[triangle as usize][corner];
                let Some(fate) = self.fates.get_mut(beyond as usize) else {
                    self.stack.clear();
                    return Err(Error::malformed("the walls of a residual do not close a hole"));
                };
                if *fate == Fate::Open {
                    *fate = Fate::Hole;
                    self.stack.push(beyond);
                }
            }
        }
        Ok(())
    }

    /// Decides the triangles that are not in holes. Where no other point exists, `everything` is final.
    fn find_final(&mut self, points: &Residual, region: &Region, everything: bool, bounds: CircleBounds) {
        for (fate, &triangle) in self.fates.iter_mut().zip(&self.triangulation.triangles) {
            if *fate == Fate::Open {
                let [a, b, c] = triangle.map(|v| points.xy[v as usize]);
                let is_final = everything || bounds.disk_inside(a, b, c, region);
                *fate = if is_final { Fate::Final } else { Fate::Active };
            }
        }
    }

    /// Gathers final triangles, the fates of the points, and the walls. If `everything` is final, the
    /// infinite triangles are, too.
    ///
    /// # Errors
    /// If a point has no triangle outside of the holes: no node leaves such a point.
    fn collect(&self, points: Residual, everything: bool) -> Result<Solved> {
        let Triangulation { triangles, neighbours, hull, duplicates, .. } = &self.triangulation;
        let mut fates = vec![PointFate::Hidden; points.len()];
        let on_hull = if everything { PointFate::Done } else { PointFate::Residual };
        hull.iter().for_each(|&v| fates[v as usize] = on_hull);
        let mut solved = Solved { merged: duplicates.len() as u64, ..Solved::default() };
        for (t, triangle) in triangles.iter().enumerate() {
            match self.fates[t] {
                Fate::Active => {
                    solved.active += 1;
                    triangle.iter().for_each(|&v| fates[v as usize] = PointFate::Residual);
                }
                Fate::Final => {
                    for &v in triangle {
                        if fates[v as usize] == PointFate::Hidden {
                            fates[v as usize] = PointFate::Done;
                        }
                    }
                    solved.triangles.push(*triangle);
                    self.collect_walls(triangle, &neighbours[t], everything, &mut solved.walls);
                }
                _ => self.collect_walls(triangle, &neighbours[t], everything, &mut solved.walls),
            }
        }
        duplicates.iter().for_each(|&[point, _]| fates[point as usize] = PointFate::Merged);
        if let Some(hidden) = fates.iter().position(|&fate| fate == PointFate::Hidden) {
            let point = points.point(hidden);
            return Err(Error::malformed(format!(
                "residual point {point:?} lies inside of a final triangle"
            )));
        }
        Ok(Solved { points, fates, ..solved })
    }

    /// Adds the edges of a triangle that is done beyond which lies one that is not.
    fn collect_walls(
        &self,
        triangle: &[u32; 3],
        neighbours: &[u32; 3],
        everything: bool,
        walls: &mut Vec<[u32; 2]>,
    ) {
        for corner in 0..3 {
            let beyond_is_done = match neighbours[corner] {
                NONE => everything,
                beyond => self.fates[beyond as usize] != Fate::Active,
            };
            if !beyond_is_done {
                walls.push([triangle[(corner + 1) % 3], triangle[(corner + 2) % 3]]);
            }
        }
    }
}

fn overlap(points: &Residual, point: u32, vertex: u32) -> Error {
    let [a, b] = [point, vertex].map(|i| points.point(i as usize));
    Error::malformed(format!(
        "point {a:?} coincides with {b:?} of another cell or tile (stored coordinates): regions overlap"
    ))
}
