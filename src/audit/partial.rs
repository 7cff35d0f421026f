//! Audit of the final simplices of a region and its residual.
//!
//! It proves what another program needs to complete the mesh: the final simplices are correct, exactly the
//! walls and the residual are open, the residual fits the final simplices ([`super::residual_fit`]), and the
//! region loses no point and has none outside it. The audit of the merged mesh proves that parts fit
//! together.

use std::cmp::Ordering;
use std::collections::HashSet;

use foldhash::fast::RandomState;

use super::check::{Check, Ledger, Violation};
use super::corner::Corner;
use super::facets::OpenFacets;
use super::residual_fit::{self, Wall, WallGeometry};
use super::triangles::Standard;
use super::vertices::Vertices;
use spmesh_stream::model::bounds::{Point, Region};
use spmesh_stream::{Event, Header, Patch, Totals};

/// What can be proved of final simplices one by one, with the vertices that are live and the facets that are
/// open.
pub(super) trait FinalSimplices<const D: usize>: WallGeometry<D> {
    /// Names of simplices and their facets in messages.
    const NAMES: [&'static str; 2];

    /// The check that facets meet their twins.
    const FACETS: Check;

    /// The data of a vertex.
    type Star: Copy + Default;

    fn new(standard: Standard) -> Self;

    /// Checks a patch; a vertex that it finalizes must be closed on all sides: an open facet would be a wall,
    /// whose corners are in the residual.
    fn patch(&mut self, patch: &Patch, ledger: &mut Ledger) -> Result<(), Violation>;

    fn vertices(&self) -> &Vertices<Self::Star>;

    fn facets(&self) -> &OpenFacets<D, Corner<D>>;

    fn facets_mut(&mut self) -> &mut OpenFacets<D, Corner<D>>;

    /// How many of its simplices a vertex has in the direction of [`super::winding`].
    fn ahead(star: &Self::Star) -> u16;

    /// Converts the corners of a facet between the order of a wall and the order of its simplex.
    fn turned(facet: [u64; D]) -> [u64; D];
}

/// State of the audit of a partial mesh. Memory: the width of the stream and the residual.
pub(super) struct PartialAudit<S, const D: usize> {
    region: Region<3>,
    standard: Standard,
    simplices: S,
    residual: Vec<(Option<u64>, Point)>,
    /// The corners of all walls, D each.
    walls: Vec<u32>,
}

impl<S: FinalSimplices<D>, const D: usize> PartialAudit<S, D> {
    /// Checks that every partial mesh must pass, in any case.
    pub(super) const CHECKS: [Check; 9] = [
        Check::Orientation,
        S::FACETS,
        Check::Delaunay,
        Check::Vertices,
        Check::Finalization,
        Check::Counts,
        Check::Region,
        Check::Residual,
        Check::Walls,
    ];

    pub(super) fn new(header: &Header, standard: Standard) -> Self {
        PartialAudit {
            region: header.region.unwrap_or(Region::EVERYTHING),
            standard,
            simplices: S::new(standard),
            residual: Vec::new(),
            walls: Vec::new(),
        }
    }

    /// Checks the next event.
    pub(super) fn event(&mut self, event: &Event, ledger: &mut Ledger) -> Result<(), Violation> {
        match event {
            Event::Patch(patch) => self.patch(patch, ledger),
            Event::ResidualPoints(points) => self.residual_points(points, ledger),
            Event::Walls(walls) => {
                self.walls.extend_from_slice(walls);
                Ok(())
            }
            Event::End(totals) => self.end(totals, ledger),
            _ => unreachable!("the reader lets no such block into a partial mesh"),
        }
    }

    fn patch(&mut self, patch: &Patch, ledger: &mut Ledger) -> Result<(), Violation> {
        for (&at, id) in patch.new.iter().zip(patch.first_id..) {
            self.check_region(Some(id), at, ledger)?;
        }
        self.simplices.patch(patch, ledger)
    }

    fn residual_points(
        &mut self,
        points: &[(Option<u64>, Point)],
        ledger: &mut Ledger,
    ) -> Result<(), Violation> {
        for &(id, at) in points {
            self.check_region(id, at, ledger)?;
        }
        self.residual.extend_from_slice(points);
        Ok(())
    }

    fn end(&mut self, totals: &Totals, ledger: &mut Ledger) -> Result<(), Violation> {
        self.check_written(ledger)?;
        self.check_distinct(ledger)?;
        let walls = self.check_walls(ledger)?;
        let vertices = self.simplices.vertices();
        let ahead = |id: u64| vertices.live(id).map_or(0, |vertex| S::ahead(&vertex.star));
        residual_fit::check::<S, D>(&self.residual, &walls, self.standard, ahead, ledger)?;
        let unwritten = self.residual.iter().filter(|(id, _)| id.is_none()).count() as u64;
        ledger.add(Check::Counts, 1);
        let vertices = self.simplices.vertices().seen();
        if (vertices + unwritten).checked_add(totals.merged) != Some(totals.points) {
            let message = format!(
                "{vertices} vertices, {unwritten} residual points that are none and {} merged points are not the {} points",
                totals.merged, totals.points
            );
            return Err(Violation::new(Check::Counts, message));
        }
        Ok(())
    }

    /// Most vertices that were live at once, and number of open facets.
    pub(super) fn width(&self) -> (usize, usize) {
        (self.simplices.vertices().live_max(), self.simplices.facets().len())
    }

    fn check_region(&self, id: Option<u64>, at: Point, ledger: &mut Ledger) -> Result<(), Violation> {
        ledger.add(Check::Region, 1);
        if self.region.contains(at) {
            return Ok(());
        }
        let Region { min, max } = self.region;
        let message =
            format!("a point lies outside of the region from {min:?} to {max:?} (stored coordinates)");
        Err(Violation::new(Check::Region, message).with(id, at))
    }

    /// Checks that the residual points with an id are the live vertices, each once and where the vertex is.
    fn check_written(&self, ledger: &mut Ledger) -> Result<(), Violation> {
        let fail = |message: String| Violation::new(Check::Residual, message);
        let mut seen: HashSet<u64, RandomState> = HashSet::default();
        for &(id, at) in &self.residual {
            let Some(id) = id else { continue };
            ledger.add(Check::Residual, 1);
            let Some(vertex) = self.simplices.vertices().live(id) else {
                return Err(fail(format!("vertex {id} of the residual was finalized")).with(id, at));
            };
            if vertex.at != at {
                let violation = fail(format!("vertex {id} of the residual lies elsewhere in its patch"));
                return Err(violation.with(id, at).with(id, vertex.at));
            }
            if !seen.insert(id) {
                return Err(fail(format!("vertex {id} is in the residual twice")).with(id, at));
            }
        }
        match self.simplices.vertices().first_live(|vertex| !seen.contains(&vertex.id)) {
            None => Ok(()),
            Some(lost) => {
                let message = format!("vertex {} is neither finalized nor in the residual", lost.id);
                Err(fail(message).with(lost.id, lost.at))
            }
        }
    }

    /// Checks that no two residual points are at one place; elevation does not count.
    fn check_distinct(&self, ledger: &mut Ledger) -> Result<(), Violation> {
        let place =
            |at: Point| -> [f64; 3] { std::array::from_fn(|axis| if axis < D { at[axis] } else { 0.0 }) };
        let mut sorted = self.residual.clone();
        sorted.sort_by(|&(p, at_p), &(q, at_q)| {
            let order = place(at_p).partial_cmp(&place(at_q)).unwrap_or(Ordering::Equal);
            order.then(p.cmp(&q))
        });
        ledger.add(Check::Residual, sorted.len().saturating_sub(1) as u64);
        match sorted.windows(2).find(|pair| place(pair[0].1) == place(pair[1].1)) {
            None => Ok(()),
            Some(pair) => {
                let violation = Violation::new(Check::Residual, "two residual points coincide");
                Err(pair.iter().fold(violation, |violation, &(id, at)| violation.with(id, at)))
            }
        }
    }

    /// Checks that every wall is an open facet and every open facet has a wall, with the final simplex on the
    /// same side of both. Returns the walls with their simplices.
    fn check_walls(&mut self, ledger: &mut Ledger) -> Result<Vec<Wall<D>>, Violation> {
        let [simplex, facet] = S::NAMES;
        let mut walls = Vec::with_capacity(self.walls.len() / D);
        for wall in self.walls.as_chunks().0 {
            ledger.add(Check::Walls, 1);
            let corners: Vec<_> = wall.iter().map(|&corner| self.residual[corner as usize]).collect();
            let ids: Option<Vec<u64>> = corners.iter().map(|&(id, _)| id).collect();
            let facet_of = |ids: Vec<u64>| ids.try_into().ok().map(S::turned);
            let Some(apex) =
                ids.and_then(facet_of).and_then(|facet| self.simplices.facets_mut().close(facet))
            else {
                let message = format!(
                    "the wall from residual point {} is no open {facet} of a final {simplex} on its side",
                    named(wall)
                );
                let violation = Violation::new(Check::Walls, message);
                return Err(corners.iter().fold(violation, |violation, &(id, at)| violation.with(id, at)));
            };
            let corner = |number: u32| {
                let (id, at) = self.residual[number as usize];
                Corner::new(id.unwrap_or_default(), std::array::from_fn(|axis| at[axis]))
            };
            walls.push(Wall { numbers: *wall, corners: wall.map(corner), apex });
        }
        match self.simplices.facets().first().map(S::turned) {
            None => Ok(walls),
            Some(ids) => {
                let message = format!("the open {facet} {} has no wall", named(&ids));
                let live = ids.iter().filter_map(|&id| self.simplices.vertices().live(id));
                let violation = Violation::new(Check::Walls, message);
                Err(live.fold(violation, |violation, vertex| violation.with(vertex.id, vertex.at)))
            }
        }
    }
}

/// Numbers of corners, as they are written in messages.
fn named<T: ToString>(corners: &[T]) -> String {
    corners.iter().map(T::to_string).collect::<Vec<_>>().join(" to ")
}
