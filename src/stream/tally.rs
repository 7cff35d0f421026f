//! Counts the contents of a stream, and compares them with the totals that END states.

use super::chunks::ChunkCheck;
use super::configuration_rules::ConfigurationRules;
use super::constraints::ConstraintRules;
use super::event::{Event, Totals};
use super::functions::{self, FunctionRules};
use super::header::Header;
use super::kind::Kind;
use super::part::{PartName, check_shared};
use super::regions::RegionRules;
use super::rules4::Rules4;
use crate::model::bounds::Bounds;
use spmesh_base::error::{Error, Result};

/// Counts of the events so far, and the rules that span events. Binary streams and their text twins share
/// them.
#[derive(Debug)]
pub struct Tally {
    totals: Totals,
    labels: u64,
    finalized: u64,
    named_residual_points: u64,
    part: Option<PartName>,
    per_simplex: usize,
    per_wall: usize,
    has_vertices: bool,
    rules4: Rules4,
    configuration_rules: ConfigurationRules,
    function_rules: FunctionRules,
    constraint_rules: ConstraintRules,
    chunks: Option<ChunkCheck>,
    /// In a stream of regions.
    regions: Option<RegionRules>,
}

impl Tally {
    /// Starts with zero counts for a stream with this header.
    pub fn new(header: &Header) -> Self {
        let chunks = header.tree.filter(|_| header.chunked).map(ChunkCheck::new);
        let per_simplex = header.kind.vertices_per_simplex();
        let totals = Totals::default();
        Tally {
            totals,
            labels: 0,
            finalized: 0,
            named_residual_points: 0,
            part: header.part,
            per_simplex,
            per_wall: header.kind.vertices_per_wall(),
            has_vertices: header.kind.has_vertices(),
            rules4: Rules4::new(header.kind),
            configuration_rules: ConfigurationRules::new(header.kind),
            function_rules: FunctionRules::default(),
            constraint_rules: ConstraintRules::default(),
            chunks,
            regions: RegionRules::of(header),
        }
    }

    /// The counts so far. The number of points of a mesh is unknown until its end.
    pub fn totals(&self) -> &Totals {
        &self.totals
    }

    /// Checks and counts the next event, which must be allowed for the kind of the stream. END is not
    /// counted.
    ///
    /// # Errors
    /// Malformed, if a chunk holds points of several cells, if there are more labels than vertices so far, or
    /// if regions, constraints, four-dimensional data, configurations or functions break a rule.
    pub fn count(&mut self, event: &Event) -> Result<()> {
        match event {
            Event::Points(points) => {
                let bounds = self.chunks.as_ref().and_then(|_| Bounds::of_points(points));
                self.count_points(points.len(), bounds)?;
            }
            Event::Cells(cells) => {
                self.totals.cells += cells.len() as u64;
                if let Some(chunks) = &mut self.chunks {
                    chunks.cells(cells);
                }
            }
            Event::Region(region) => {
                let regions = self.regions.as_mut().expect("the kind has regions");
                regions.region(region, &mut self.totals)?;
            }
            Event::Patch(patch) => {
                self.constraint_rules.sides(patch)?;
                check_shared(self.part, patch)?;
                self.totals.vertices += patch.new.len() as u64;
                self.totals.simplices += (patch.simplices.len() / self.per_simplex) as u64;
                self.finalized += patch.finalized.len() as u64;
            }
            Event::Labels(labels) => self.count_labels(labels.len())?,
            Event::Segments(segments) => self.constraint_rules.segments(segments)?,
            Event::OpenSegments(open) => self.constraint_rules.open_segments(open)?,
            Event::ResidualPoints(points) => {
                self.totals.residual_points += points.len() as u64;
                self.named_residual_points += points.iter().filter(|(id, _)| id.is_some()).count() as u64;
            }
            Event::Walls(walls) => self.totals.walls += (walls.len() / self.per_wall) as u64,
            Event::Points4(points) => self.rules4.points(points, &mut self.totals)?,
            Event::Cells4(cells) => self.rules4.cells(cells, &mut self.totals)?,
            Event::Simplices4(simplices) => self.rules4.simplices(simplices, &mut self.totals)?,
            Event::Configurations(block) => {
                self.configuration_rules.block(block, self.totals.points)?;
                self.totals.simplices += block.boundaries.len() as u64;
            }
            Event::Functions(functions) => {
                if !functions.is_empty() {
                    self.configuration_rules.check_functions()?;
                }
                let knots = self.totals.points;
                functions.iter().try_for_each(|function| self.function_rules.function(function, knots))?;
                self.totals.vertices += functions.len() as u64;
            }
            Event::Coefficients(coefficients) => {
                functions::check_coefficients(coefficients)?;
                self.totals.residual_points += coefficients.len() as u64;
            }
            Event::End(_) => {}
        }
        Ok(())
    }

    /// Counts points with the given bounding box.
    pub(crate) fn count_points(&mut self, count: usize, bounds: Option<Bounds>) -> Result<()> {
        match &mut self.regions {
            Some(regions) => regions.points(count as u64)?,
            None => self.totals.points += count as u64,
        }
        match (&mut self.chunks, bounds) {
            (Some(chunks), Some(bounds)) => chunks.points(bounds),
            _ => Ok(()),
        }
    }

    fn count_labels(&mut self, count: usize) -> Result<()> {
        self.labels += count as u64;
        if self.labels > self.totals.vertices {
            return Err(Error::malformed(format!(
                "{} labels after {} vertices: a label follows its vertex",
                self.labels, self.totals.vertices
            )));
        }
        Ok(())
    }

    /// Compares the totals that END states with the events before (`formats/spmesh.md` 4.15). For a mesh,
    /// points are those of its input: each is a vertex, was merged, or waits in the residual.
    ///
    /// # Errors
    /// Malformed, if they differ, if a vertex is neither final nor in the residual, or if only some vertices
    /// have labels.
    pub fn check_end(&self, header: &Header, stated: &Totals) -> Result<()> {
        stated.check_range()?;
        let mut counted = self.totals;
        if header.kind.is_residual() {
            // The points are those of the region, most of which are vertices in other streams.
            (counted.points, counted.merged) = (stated.points, stated.merged);
        } else if self.has_vertices {
            counted.merged = stated.merged;
            let waiting = counted.residual_points - self.named_residual_points;
            let points = counted.vertices.checked_add(waiting).and_then(|n| n.checked_add(stated.merged));
            counted.points = points.ok_or_else(|| Error::malformed("END: points are beyond counting"))?;
            let retired = self.finalized + self.named_residual_points;
            if self.per_simplex > 0 && retired != counted.vertices {
                return Err(Error::malformed(format!(
                    "END: {retired} of {} vertices were finalized or handed to the residual",
                    counted.vertices
                )));
            }
        }
        if self.labels != 0 && self.labels != counted.vertices {
            return Err(Error::malformed(format!(
                "END: {} labels of {} vertices, expected none, or one for each",
                self.labels, counted.vertices
            )));
        }
        let pairs = stated.fields().into_iter().zip(counted.fields());
        if let Some((name, (stated, counted))) = Totals::NAMES.iter().zip(pairs).find(|(_, (a, b))| a != b) {
            let message = format!("END states {stated} {name}, but the stream holds {counted}");
            return Err(Error::malformed(message));
        }
        if header.points.is_some_and(|points| points != stated.points) {
            return Err(Error::malformed("END: the header states another number of points"));
        }
        if header.kind == Kind::Splines {
            functions::check_end(&counted)?;
        }
        self.configuration_rules.check_end()?;
        self.regions.as_ref().map_or(Ok(()), |regions| regions.check_end(header.points, &counted))?;
        self.rules4.check_end(&counted)?;
        self.chunks.as_ref().map_or(Ok(()), ChunkCheck::end)
    }
}
