//! Draws triangles on tiles.

use std::ops::Range;
use std::sync::Arc;

use super::axis::Centers;
use super::cell_mask::CellMask;
use super::covering::Covering;
use super::facet::{Facet, place};
use super::natural::Natural;
use super::options::{Interpolation, Options, Quantity};
use super::span::{Edges, Span};
use super::tile::overlap;
use super::tile_cache::TileCache;
use crate::files::TilePlace;
use crate::surface::is_counterclockwise;
use spmesh_base::error::Result;
use spmesh_delaunay::predicates::FiniteFloatPredicates;
use spmesh_formats::outline::{ConcaveOutline, EdgeLimit, Waiting};
use spmesh_formats::raster::{Grid, TILE};
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::Point;

/// Takes the values of complete tiles.
pub(super) type TileSink<'a> = dyn FnMut(TilePlace, &[f32]) -> Result<()> + 'a;

/// Draws triangles on the tiles of a grid, one by one.
#[derive(Debug)]
pub(super) struct Rasterizer {
    centers: Centers,
    quantity: Quantity,
    /// Units of x and y that one unit of z is.
    pub(super) unit_of_z: f64,
    long_edges: EdgeLimit,
    /// Finds the triangles outside of the concave outline.
    outline: Option<ConcaveOutline>,
    pub(super) cache: TileCache,
    /// The surface over whole cells, if these are not sampled at their centres.
    pub(super) covering: Option<Covering>,
    /// The weights of natural neighbours, if these interpolate.
    pub(super) natural: Option<Natural>,
    /// The elevations, if the quantity of filled cells is derived from them.
    pub(super) heights: Option<TileCache>,
    /// Whether triangles that are left out are marked as holes, which are filled later.
    marks_holes: bool,
    pub(super) predicates: FiniteFloatPredicates,
    /// Number of triangles left out because of a long edge.
    pub(super) killed: u64,
    /// Number of triangles left out because the value of a corner is unknown.
    pub(super) unknown: u64,
    /// Number of triangles outside of the concave outline.
    pub(super) outside: u64,
    /// The spans of a triangle in one row of tiles; a field so that the allocation is reused.
    spans: Vec<Span>,
}

impl Rasterizer {
    /// Nothing drawn so far. One unit of z is `unit_of_z` units of x and y. `memory` is for tiles, and for
    /// triangles that wait for the outline. Units: bytes.
    pub(super) fn new(
        grid: Grid,
        coordinates: &Coordinates,
        options: &Options,
        unit_of_z: f64,
        memory: u64,
    ) -> Result<Rasterizer> {
        let temp_dir = options.raster.temp_dir.as_deref();
        // A part of the memory is for triangles that wait for the outline.
        let for_outline = if options.concave.is_some() { options.memory / 4 } else { 0 };
        let for_tiles = memory.saturating_sub(for_outline);
        let quantity = options.drawn();
        let has_heights = options.fill.is_some() && quantity.is_derived();
        let for_cache = if has_heights { for_tiles / 2 } else { for_tiles };
        let mask = options.mask.as_ref().map(|mask| Arc::new(CellMask::new(mask, grid)));
        let cache = || TileCache::new(grid, for_cache, temp_dir, mask.clone());
        Ok(Rasterizer {
            centers: Centers::new(grid, coordinates, unit_of_z),
            unit_of_z,
            quantity,
            long_edges: EdgeLimit::new(options.kill, coordinates),
            outline: options
                .concave
                .map(|length| ConcaveOutline::new(length, coordinates, for_outline, temp_dir)),
            cache: cache()?,
            covering: None,
            natural: None,
            heights: has_heights.then(cache).transpose()?,
            marks_holes: options.fill.is_some(),
            predicates: FiniteFloatPredicates::default(),
            killed: 0,
            unknown: 0,
            outside: 0,
            spans: Vec::with_capacity(TILE),
        })
    }

    /// The centres of cells.
    pub(super) fn centers(&self) -> Centers {
        self.centers
    }

    /// Draws a triangle of vertices with ids, or keeps it until [`Rasterizer::draw_inside`] if it may be outside
    /// of the outline. The rest is as for [`Rasterizer::draw`].
    #[inline]
    pub(super) fn take(
        &mut self,
        vertices: [&(u64, Point); 3],
        complete: Option<&mut TileSink>,
    ) -> Result<()> {
        if let Some(natural) = &mut self.natural {
            natural.add(vertices)?;
        }
        if self.outline.is_some() && self.keeps(vertices)? {
            return Ok(());
        }
        self.draw(vertices.map(|(_, corner)| corner), complete)
    }

    /// Keeps a triangle if it may be outside of the outline, and returns whether it did.
    fn keeps(&mut self, vertices: [&(u64, Point); 3]) -> Result<bool> {
        let Some(outline) = &mut self.outline else { return Ok(false) };
        let corners = vertices.map(|(_, corner)| *corner);
        let triangle = Waiting { ids: vertices.map(|(id, _)| *id), corners, number: 0 };
        outline.take(corners.map(place), triangle)
    }

    /// Draws the kept triangles that are inside of the outline.
    pub(super) fn draw_inside(&mut self, mut complete: Option<&mut TileSink>) -> Result<()> {
        let Some(outline) = self.outline.take() else { return Ok(()) };
        let mut inside = outline.finish()?;
        self.outside = inside.outside;
        while let Some(triangle) = inside.next_triangle()? {
            // Reborrows the sink for each triangle.
            let complete: Option<&mut TileSink> = match &mut complete {
                Some(complete) => Some(&mut **complete),
                None => None,
            };
            self.draw(triangle.corners.each_ref(), complete)?;
        }
        Ok(())
    }

    /// Draws a triangle with corners in stored coordinates and values of the world, NaN if unknown. Tiles that become
    /// complete go to `complete`, if there is one. Corners are references because loads right after a copy would
    /// wait for it, which takes half of the time where triangles are small.
    ///
    /// # Errors
    /// [`spmesh_base::error::ErrorKind::Malformed`], if it is clockwise, or overlaps another triangle at a
    /// centre; those of `complete` and of temporary files.
    #[inline]
    pub(super) fn draw(&mut self, corners: [&Point; 3], complete: Option<&mut TileSink>) -> Result<()> {
        let is_unknown = self.is_unknown(corners);
        let is_hole = is_unknown || self.has_long_edge(corners);
        if is_hole {
            *(if is_unknown { &mut self.unknown } else { &mut self.killed }) += 1;
            if !self.marks_holes {
                return Ok(());
            }
        }
        if let Some(covering) = &mut self.covering {
            let corners = least_first(corners.map(|corner| *corner));
            let is_known = !is_hole && is_counterclockwise(corners.map(place), &mut self.predicates)?;
            return if is_known { covering.add(corners) } else { Ok(()) };
        }
        // Where triangles are smaller than cells, most contain no centre.
        let [bottom, top] = range(corners, 1);
        let rows = self.centers.rows.cells(bottom, top);
        if rows.is_empty() {
            return Ok(());
        }
        let [left, right] = range(corners, 0);
        let columns = self.centers.columns.cells(left, right);
        if columns.is_empty() {
            return Ok(());
        }
        self.draw_cells(least_first(corners.map(|corner| *corner)), is_hole, columns, rows, complete)
    }

    /// Draws a triangle that starts with its least corner; the cells with centres in it are in these columns and
    /// rows.
    fn draw_cells(
        &mut self,
        corners: [Point; 3],
        is_hole: bool,
        columns: Range<u32>,
        rows: Range<u32>,
        mut complete: Option<&mut TileSink>,
    ) -> Result<()> {
        let places = corners.map(place);
        if !is_counterclockwise(places, &mut self.predicates)? {
            return Ok(());
        }
        let edges = Edges::of(places, &self.centers.columns);
        let facet = (!is_hole).then(|| Facet::of(corners));
        let mut from = rows.start;
        while from < rows.end {
            let band = from as usize / TILE;
            let end = rows.end.min(((band + 1) * TILE) as u32);
            self.draw_band(facet.as_ref(), &edges, columns.clone(), from..end, &mut complete)?;
            from = end;
        }
        Ok(())
    }

    #[inline]
    fn has_long_edge(&self, corners: [&Point; 3]) -> bool {
        self.long_edges.is_limited() && self.long_edges.is_exceeded(corners.map(|corner| place(*corner)))
    }

    /// Whether no cell can have a value: linear values need those of all corners.
    #[inline]
    fn is_unknown(&self, corners: [&Point; 3]) -> bool {
        let unknown = corners.iter().filter(|corner| corner[2].is_nan()).count();
        match self.quantity.interpolation() {
            Interpolation::Linear => unknown > 0,
            Interpolation::Nearest => unknown == 3,
        }
    }

    /// Draws the part of a triangle in one row of tiles; a hole has no plane.
    fn draw_band(
        &mut self,
        facet: Option<&Facet>,
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
            let at = [column, band];
            draw_tile(&mut self.cache, &self.centers, &self.quantity, facet, at, rows.start, &spans)?;
            if let Some(heights) = &mut self.heights {
                draw_tile(heights, &self.centers, &Quantity::Elevation, facet, at, rows.start, &spans)?;
            }
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
}

/// Draws the part of the spans in one tile; they start at a row. A hole has no plane.
fn draw_tile(
    cache: &mut TileCache,
    centers: &Centers,
    quantity: &Quantity,
    facet: Option<&Facet>,
    at: TilePlace,
    first_row: u32,
    spans: &[Span],
) -> Result<()> {
    let [left, top] = at.map(|place| (place * TILE) as u32);
    let within = |cells: &Range<u32>| cells.start.max(left)..cells.end.min(left + TILE as u32);
    if spans.iter().all(|span| within(&span.cells).is_empty()) {
        return Ok(());
    }
    let interpolation = quantity.interpolation();
    let gradient = facet.map(|facet| centers.gradient_to_world(facet.gradient));
    let flat = gradient.map_or(Ok(None), |gradient| quantity.of_plane(gradient))?;
    let Some(tile) = cache.tile(at)? else {
        // All cells of a written tile belong to other triangles, so this one may only touch them, or is a hole that
        // overlaps them.
        let is_owner = |span: &Span| !within(&(span.cells.start..span.owned_end)).is_empty();
        return if spans.iter().any(is_owner) { Err(overlap()) } else { Ok(()) };
    };
    let place = |cells: &Range<u32>| (cells.start - left) as usize..(cells.end - left) as usize;
    let Some(facet) = facet else {
        for (row, span) in (first_row..).zip(spans) {
            let cells = within(&span.cells);
            if !cells.is_empty() {
                tile.mark_hole((row - top) as usize, place(&cells));
            }
        }
        return Ok(());
    };
    for (row, span) in (first_row..).zip(spans) {
        let y = centers.rows.at(row);
        let values_of = |cells: Range<u32>, values: &mut [f32]| {
            let abscissae = cells.map(|column| centers.columns.at(column));
            match (flat, interpolation) {
                (Some(value), _) => values.fill(value),
                (None, Interpolation::Linear) => facet.row(y, abscissae, values)?,
                (None, Interpolation::Nearest) => facet.row_of_nearest(y, abscissae, values),
            }
            Ok(())
        };
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

/// The same triangle, starting at the corner that is least in x, then y, so that values do not depend on the
/// order of corners in the stream.
pub(super) fn least_first([a, b, c]: [Point; 3]) -> [Point; 3] {
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
fn range([a, b, c]: [&Point; 3], axis: usize) -> [f64; 2] {
    [a[axis].min(b[axis]).min(c[axis]), a[axis].max(b[axis]).max(c[axis])]
}
