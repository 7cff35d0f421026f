//! Draws triangles on tiles.

use std::ops::Range;

use super::centers::Centers;
use super::facet::{Facet, place};
use super::options::{Interpolation, Options, Quantity};
use super::span::{Edges, Span};
use super::tile::overlap;
use super::tile_cache::{TileCache, TilePlace};
use crate::surface::{LongEdges, is_counterclockwise};
use spmesh_core::error::Result;
use spmesh_crs::System;
use spmesh_geometry::predicates::{FiniteFloatPredicates, Point2};
use spmesh_io::raster::{Grid, TILE};
use spmesh_model::bounds::Point;
use spmesh_stream::Coordinates;

/// Takes the values of complete tiles.
pub(super) type TileSink<'a> = dyn FnMut(TilePlace, &[f32]) -> Result<()> + 'a;

/// Draws triangles on the tiles of a grid, one by one.
#[derive(Debug)]
pub(super) struct Rasterizer {
    centers: Centers,
    quantity: Quantity,
    /// Units of x and y that one unit of z is.
    unit_of_z: f64,
    long_edges: LongEdges,
    pub(super) cache: TileCache,
    pub(super) predicates: FiniteFloatPredicates,
    /// Number of triangles left out because of a long edge.
    pub(super) killed: u64,
    /// Number of triangles left out because the value of a corner is unknown.
    pub(super) unknown: u64,
    /// The spans of a triangle in one row of tiles; a field so that the allocation is reused.
    spans: Vec<Span>,
}

impl Rasterizer {
    /// Nothing drawn so far.
    ///
    /// # Errors
    /// As [`TileCache::new`].
    pub(super) fn new(
        grid: Grid,
        coordinates: &Coordinates,
        options: &Options,
        system: &System,
    ) -> Result<Rasterizer> {
        Ok(Rasterizer {
            centers: Centers::new(grid, coordinates),
            quantity: options.quantity.clone(),
            unit_of_z: system.vertical_ratio().unwrap_or(1.0),
            long_edges: LongEdges::new(options.kill, coordinates),
            cache: TileCache::new(grid, options.memory, options.raster.temp_dir.as_deref())?,
            predicates: FiniteFloatPredicates::default(),
            killed: 0,
            unknown: 0,
            spans: Vec::with_capacity(TILE),
        })
    }

    /// Draws a triangle with corners in stored coordinates and values of the world, NaN if unknown. Tiles that become
    /// complete go to `complete`, if there is one.
    ///
    /// # Errors
    /// [`spmesh_core::error::ErrorKind::Malformed`], if it is clockwise, or overlaps another triangle at a
    /// centre; those of `complete` and of temporary files.
    pub(super) fn draw(&mut self, corners: [Point; 3], mut complete: Option<&mut TileSink>) -> Result<()> {
        let corners = least_first(corners);
        let places = corners.map(place);
        if self.is_unknown(corners) {
            self.unknown += 1;
            return Ok(());
        }
        if self.long_edges.are_in(places) {
            self.killed += 1;
            return Ok(());
        }
        let [bottom, top] = range(places, 1);
        let rows = self.centers.rows.cells(bottom, top);
        if rows.is_empty() {
            return Ok(());
        }
        let [left, right] = range(places, 0);
        let columns = self.centers.columns.cells(left, right);
        if columns.is_empty() || !is_counterclockwise(places, &mut self.predicates)? {
            return Ok(());
        }
        let (facet, edges) = (Facet::of(corners), Edges::of(places, &self.centers.columns));
        let mut from = rows.start;
        while from < rows.end {
            let band = from as usize / TILE;
            let end = rows.end.min(((band + 1) * TILE) as u32);
            self.draw_band(&facet, &edges, columns.clone(), from..end, &mut complete)?;
            from = end;
        }
        Ok(())
    }

    /// Whether no cell can have a value: linear values need those of all corners.
    fn is_unknown(&self, corners: [Point; 3]) -> bool {
        let unknown = corners.iter().filter(|corner| corner[2].is_nan()).count();
        match self.quantity.interpolation() {
            Interpolation::Linear => unknown > 0,
            Interpolation::Nearest => unknown == 3,
        }
    }

    /// Draws the part of a triangle in one row of tiles.
    fn draw_band(
        &mut self,
        facet: &Facet,
        edges: &Edges,
        columns: Range<u32>,
        rows: Range<u32>,
        complete: &mut Option<&mut TileSink>,
    ) -> Result<()> {
        let mut spans = std::mem::take(&mut self.spans);
        spans.clear();
        spans.extend(rows.clone().map(|row| {
            let y = self.centers.rows.at(row);
            edges.span(y, columns.clone(), &self.centers.columns, &mut self.predicates)
        }));
        let filled = || spans.iter().map(|span| &span.cells).filter(|cells| !cells.is_empty());
        let ends = filled().map(|cells| cells.start).min().zip(filled().map(|cells| cells.end).max());
        let tiles = ends.map_or(0..0, |(start, end)| start as usize / TILE..(end as usize).div_ceil(TILE));
        let band = rows.start as usize / TILE;
        for column in tiles {
            self.draw_tile(facet, [column, band], rows.start, &spans)?;
            if let Some(complete) = complete.as_deref_mut()
                && let Some(tile) = self.cache.take_complete([column, band])
            {
                complete([column, band], &tile.values)?;
                self.cache.recycle(tile);
            }
        }
        self.spans = spans;
        Ok(())
    }

    /// Draws the part of the spans in one tile; they start at a row.
    fn draw_tile(&mut self, facet: &Facet, at: TilePlace, first_row: u32, spans: &[Span]) -> Result<()> {
        let [left, top] = at.map(|place| (place * TILE) as u32);
        let within = |cells: &Range<u32>| cells.start.max(left)..cells.end.min(left + TILE as u32);
        if spans.iter().all(|span| within(&span.cells).is_empty()) {
            return Ok(());
        }
        let interpolation = self.quantity.interpolation();
        let gradient = self.centers.gradient_to_world(facet.gradient).map(|part| part * self.unit_of_z);
        let flat = self.quantity.of_plane(gradient)?;
        let Some(tile) = self.cache.tile(at)? else {
            // All cells of a written tile belong to other triangles, so this one may only touch them.
            let is_owner = |span: &Span| !within(&(span.cells.start..span.owned_end)).is_empty();
            return if spans.iter().any(is_owner) { Err(overlap()) } else { Ok(()) };
        };
        for (row, span) in (first_row..).zip(spans) {
            let y = self.centers.rows.at(row);
            let values_of = |cells: Range<u32>, values: &mut [f32]| match flat {
                Some(value) => {
                    values.fill(value);
                    Ok(())
                }
                None => {
                    let abscissae = cells.map(|column| self.centers.columns.at(column));
                    match interpolation {
                        Interpolation::Linear => facet.row(y, abscissae, values)?,
                        Interpolation::Nearest => facet.row_of_nearest(y, abscissae, values),
                    }
                    Ok(())
                }
            };
            let place = |cells: &Range<u32>| (cells.start - left) as usize..(cells.end - left) as usize;
            let owned = within(&(span.cells.start..span.owned_end));
            if !owned.is_empty() {
                let values = tile.own((row - top) as usize, place(&owned))?;
                values_of(owned, values)?;
            }
            for column in within(&(span.owned_end..span.cells.end)) {
                let mut value = [0.0];
                values_of(column..column + 1, &mut value)?;
                tile.touch((row - top) as usize, (column - left) as usize, value[0]);
            }
        }
        Ok(())
    }
}

/// The same triangle, starting at the corner that is least in x, then y, so that values do not depend on the
/// order of corners in the stream.
fn least_first([a, b, c]: [Point; 3]) -> [Point; 3] {
    let is_less = |p: Point, q: Point| place(p) < place(q);
    if is_less(a, b) && is_less(a, c) {
        [a, b, c]
    } else if is_less(b, c) {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// The least and the greatest coordinate along an axis.
fn range([a, b, c]: [Point2; 3], axis: usize) -> [f64; 2] {
    [a[axis].min(b[axis]).min(c[axis]), a[axis].max(b[axis]).max(c[axis])]
}
