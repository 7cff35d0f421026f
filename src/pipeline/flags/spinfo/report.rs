//! What `spinfo` prints: a table for people, or one JSON object.

use serde_json::{Value, json};

use super::{attributes, census, configurations, diagram};
use spmesh_audit::diagram::{Proof, Violation};
use spmesh_audit::{Counts, Inventory, Report};
use spmesh_base::error::Error;
use spmesh_shell::messages::escaped;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Constrained, Coordinates, Crs, Header, Kind, Weighted};

/// Everything that is known of a stream after it was read.
pub(super) struct Summary<'a> {
    pub(super) name: &'a str,
    pub(super) header: &'a Header,
    pub(super) inventory: &'a Inventory,
    pub(super) audit: Option<Report>,
    pub(super) census: Option<&'a Counts>,
    pub(super) diagram: Option<&'a Result<Proof, Violation>>,
    pub(super) configurations: Option<&'a Result<configurations::Proof, configurations::Violation>>,
    pub(super) failure: Option<&'a Error>,
    pub(super) bytes: u64,
    /// The bytes if no block were compressed.
    pub(super) plain_bytes: u64,
}

impl Summary<'_> {
    /// Lines of a name and a value each; the audit has a line per check.
    pub(super) fn text(&self) -> String {
        let mut text = format!("{}: {}\n", escaped(self.name), self.header.kind.name());
        let mut line = |name: &str, value: String| text += &format!("  {name:<12} {value}\n");
        line("producer", escaped(&self.header.producer));
        line("coordinates", self.coordinates_text());
        line("bounds", self.world_bounds().map_or("none".into(), |bounds| self.bounds_text(&bounds)));
        line("CRS", escaped(&crs_text(&self.header.crs)));
        for attribute in &self.header.attributes {
            line("attribute", attributes::text(attribute));
        }
        if let Some(tree) = &self.header.tree {
            let shape = if tree.dims() == 2 { "quadtree" } else { "octree" };
            let origin = words(&tree.origin()[..usize::from(tree.dims())]);
            line(
                "tree",
                format!("{shape}, depth {}, origin {origin}, side {} (stored)", tree.depth(), tree.side()),
            );
        }
        if let Some(region) = &self.header.region {
            let [min, max] =
                [region.min, region.max].map(|side| words(&side[..usize::from(self.header.dims)]));
            line("region", format!("from {min} to {max} (stored)"));
        }
        if let Some(Constrained { is_cut, kill }) = self.header.constrained {
            let border = if is_cut { "cut" } else { "the convex hull" };
            let step = match self.header.coordinates {
                Coordinates::F64 => 1.0,
                Coordinates::I32 { scale, .. } => scale[0],
            };
            let kill = match kill * step {
                0.0 => String::new(),
                kill => format!(", its edges have at most {}", (1e9 * kill).round() / 1e9),
            };
            line("constrained", format!("yes, the border is {border}{kill}"));
        }
        if let Some(Weighted { greatest }) = self.header.weighted {
            line("weighted", format!("yes, no weight is above {greatest} (squares of stored units)"));
        }
        self.counts(&mut line);
        if let Some(report) = &self.audit {
            text += &self.audit_text(report);
        }
        if let Some(verdict) = self.diagram {
            text += &diagram::text(verdict);
        }
        if let Some(verdict) = self.configurations {
            text += &configurations::text(verdict);
        }
        if let Some(counts) = self.census {
            text += &census::text(counts);
        }
        text
    }

    /// Counts of what was read; counts that the kind does not have are left out.
    fn counts(&self, line: &mut impl FnMut(&str, String)) {
        let totals = self.inventory.totals();
        let [vertices, residual] = match self.header.kind.has_knots() {
            true => ["functions", "coefficients"],
            false => ["vertices", "residual"],
        };
        let constraints = self.inventory.constraints();
        let counts = [
            ("points", totals.points),
            ("merged", totals.merged),
            (vertices, totals.vertices),
            (self.simplices(), totals.simplices),
            ("labels", self.inventory.labels()),
            ("cells", totals.cells),
            (residual, totals.residual_points),
            ("walls", totals.walls),
            ("lines", constraints.lines()),
            ("segments", constraints.segments),
            ("open", constraints.open_segments),
            ("sides", constraints.sides),
        ];
        for (name, count) in counts {
            if count > 0 || name == "points" {
                line(name, count.to_string());
            }
        }
        if self.header.kind.vertices_per_simplex() > 0 {
            let largest = self.inventory.largest_patch();
            line("width", format!("{} live vertices", self.inventory.width()));
            line(
                "patches",
                format!(
                    "{}, largest: {} {}, {} new and {} imported vertices",
                    self.inventory.patches(),
                    largest.simplices,
                    self.simplices(),
                    largest.new,
                    largest.imported
                ),
            );
        } else if self.header.kind.is_4d() {
            self.counts4(line);
        } else if self.header.kind.has_knots() {
            let degrees = self.inventory.configurations().degrees();
            configurations::counts(degrees).for_each(|(name, value)| line(&name, value));
        } else if self.header.kind == Kind::RegionPoints {
            let regions = self.inventory.regions();
            line("regions", format!("{}, largest: {} points", regions.regions, regions.points_max));
            line("copies", format!("{} points, in regions after their first", regions.copies));
        } else {
            let cells = self.inventory.cell_points();
            line("chunked", if self.header.chunked { "yes" } else { "no" }.into());
            if let Some(mean) = mean(cells.points, cells.runs) {
                line("points/tag", format!("mean {mean:.1}, max {} before {} tags", cells.max, cells.runs));
            }
        }
        line("bytes", self.bytes.to_string());
        if self.header.compressed {
            let ratio = self.plain_bytes as f64 / self.bytes as f64;
            line("compressed", format!("yes, from {} bytes: {ratio:.1} to 1", self.plain_bytes));
        }
    }

    /// Counts of cells or simplices of four dimensions.
    fn counts4(&self, line: &mut impl FnMut(&str, String)) {
        let four = self.inventory.four();
        if self.header.has_elevation {
            line("values", format!("{} known", four.values_known));
        }
        if self.header.kind == Kind::Cells4 {
            line("finite", format!("{} cells, {} of them simplices", four.finite, four.simplices));
            line("infinite", format!("{} cells", four.infinite));
            line(
                "largest",
                format!("{} vertices, {} neighbours of a cell", four.vertices_max, four.neighbours_max),
            );
        }
    }

    /// The counts of `counts4`; null for other kinds.
    fn json4(&self) -> Value {
        let four = self.inventory.four();
        if !self.header.kind.is_4d() {
            return Value::Null;
        }
        json!({
            "values_known": four.values_known,
            "finite_cells": four.finite,
            "infinite_cells": four.infinite,
            "finite_simplices": four.simplices,
            "cell_vertices_max": four.vertices_max,
            "cell_neighbours_max": four.neighbours_max,
        })
    }

    /// Counts of regions; null for other kinds.
    fn regions_json(&self) -> Value {
        let regions = self.inventory.regions();
        match self.header.kind {
            Kind::RegionPoints => json!({
                "count": regions.regions, "copies": regions.copies, "points_max": regions.points_max,
            }),
            _ => Value::Null,
        }
    }

    /// The counts of each degree; null for other kinds.
    fn configurations_json(&self) -> Value {
        match self.header.kind {
            kind if kind.has_knots() => {
                configurations::counts_json(self.inventory.configurations().degrees())
            }
            _ => Value::Null,
        }
    }

    /// One object; counts of what was read so far if the audit failed.
    pub(super) fn json(&self) -> String {
        let header = self.header;
        let (totals, largest, cells) =
            (self.inventory.totals(), self.inventory.largest_patch(), self.inventory.cell_points());
        let dims = usize::from(header.dims);
        let [vertices, residual] = match header.kind.has_knots() {
            true => ["functions", "coefficients"],
            false => ["vertices", "residual_points"],
        };
        let constraints = self.inventory.constraints();
        let object = json!({
            "input": self.name,
            "kind": header.kind.name(),
            "producer": header.producer,
            "dims": header.dims,
            "has_elevation": header.has_elevation,
            "coordinates": coordinates_json(&header.coordinates),
            "bounds": self.world_bounds().map(|[min, max]| json!({"min": min, "max": max})),
            "crs": crs_json(&header.crs),
            "attributes": header.attributes.iter().map(attributes::json).collect::<Vec<_>>(),
            "tree": header.tree.map(|tree| json!({
                "dims": tree.dims(),
                "depth": tree.depth(),
                "origin": tree.origin()[..dims],
                "side": tree.side(),
            })),
            "region": header.region.map(|region| json!({
                "min": region.min.map(finite)[..dims], "max": region.max.map(finite)[..dims],
            })),
            "chunked": header.chunked,
            "counts": {
                "points": totals.points,
                vertices: totals.vertices,
                self.simplices(): totals.simplices,
                "labels": self.inventory.labels(),
                "cells": totals.cells,
                "merged": totals.merged,
                residual: totals.residual_points,
                "walls": totals.walls,
            },
            "constrained": header.constrained.map(|Constrained { is_cut, kill }| json!({
                "is_cut": is_cut,
                "kill": kill,
                "lines": constraints.lines(),
                "segments": constraints.segments,
                "open_segments": constraints.open_segments,
                "sides": constraints.sides,
            })),
            "greatest_weight": header.weighted.map(|Weighted { greatest }| greatest),
            "width": self.inventory.width(),
            "patches": self.inventory.patches(),
            "largest_patch": {
                self.simplices(): largest.simplices, "new": largest.new, "imported": largest.imported,
            },
            "four_dimensions": self.json4(),
            "configurations": self.configurations_json(),
            "regions": self.regions_json(),
            "points_per_tag": {"runs": cells.runs, "mean": mean(cells.points, cells.runs), "max": cells.max},
            "bytes": self.bytes,
            "compressed": header.compressed,
            "plain_bytes": self.plain_bytes,
            "audit": self.audit_json(),
            "census": self.census.map(census::json),
        });
        format!("{object:#}\n")
    }

    fn audit_json(&self) -> Value {
        if let Some(verdict) = self.diagram {
            return diagram::json(verdict, self.failure);
        }
        if let Some(verdict) = self.configurations {
            return configurations::json(verdict, self.failure);
        }
        let Some(report) = &self.audit else { return Value::Null };
        let checks: Vec<Value> = report
            .lines
            .iter()
            .map(|line| {
                json!({
                    "check": line.check.name(),
                    "claim": line.check.claim(),
                    "ok": line.passed,
                    "tests": line.tests,
                    "exact": line.exactly,
                })
            })
            .collect();
        let violation = report.violation.as_ref().map(|violation| {
            let vertices: Vec<Value> = violation
                .vertices
                .iter()
                .map(|&(id, stored)| json!({"id": id, "at": self.world(stored)}))
                .collect();
            json!({
                "check": violation.check.name(),
                "message": self.failure.map(Error::to_string),
                "vertices": vertices,
            })
        });
        json!({
            "ok": report.violation.is_none(),
            "checks": checks,
            "violation": violation,
            "live_max": report.live_max,
            if self.is_solid() { "open_facets_max" } else { "open_edges_max" }: report.open_max,
        })
    }

    fn coordinates_text(&self) -> String {
        let header = self.header;
        let elevation = match (header.has_elevation, header.kind.is_4d()) {
            (false, _) => "",
            (true, false) => " with elevation",
            (true, true) => " with a value",
        };
        let encoding = match &header.coordinates {
            Coordinates::F64 => "f64".to_string(),
            Coordinates::I32 { scale, offset } => {
                format!("i32, scale {}, offset {}", words(scale), words(offset))
            }
        };
        format!("{}D{elevation}, {encoding}", header.dims)
    }

    /// Box of the header, or of what was read where the header states none: min and max.
    fn world_bounds(&self) -> Option<[Vec<f64>; 2]> {
        if let Some([min, max]) = self.inventory.four().found_bounds {
            return Some([min.to_vec(), max.to_vec()]);
        }
        let bounds = self.header.bounds.or(self.inventory.found_bounds())?;
        Some([self.world(bounds.min), self.world(bounds.max)])
    }

    fn bounds_text(&self, [min, max]: &[Vec<f64>; 2]) -> String {
        let source = if self.header.bounds.is_some() { "" } else { " (found, not stated)" };
        format!("{} to {}{source}", words(min), words(max))
    }

    /// World coordinates, as many as a point of the stream has.
    fn world(&self, stored: Point) -> Vec<f64> {
        let world = self.header.coordinates.to_decimal(stored);
        world[..self.header.coordinates_per_point()].to_vec()
    }

    /// What the simplices of the stream are called.
    fn simplices(&self) -> &'static str {
        match self.header.kind {
            Kind::TetrahedralMesh | Kind::PartialTetrahedralMesh => "tetrahedra",
            Kind::Cells4 => "cells4",
            Kind::Simplices4 => "simplices",
            Kind::Configurations | Kind::Splines => "configurations",
            _ => "triangles",
        }
    }

    fn is_solid(&self) -> bool {
        self.header.kind.vertices_per_simplex() == 4
    }

    fn audit_text(&self, report: &Report) -> String {
        let verdict = if report.violation.is_none() { "passed" } else { "FAILED" };
        let mut text = format!("audit {verdict}");
        if report.live_max > 0 {
            text += &format!(
                ", with at most {} vertices and {} open {} in memory",
                report.live_max,
                report.open_max,
                if self.is_solid() { "facets" } else { "edges" }
            );
        }
        text.push('\n');
        for line in &report.lines {
            let (verdict, name) = (if line.passed { "ok" } else { "FAILED" }, line.check.name());
            text += &format!("  {name:<12} {verdict:<6} {:>11} tests", line.tests);
            if line.exactly > 0 {
                text += &format!(" ({} exact)", line.exactly);
            }
            text += &format!(": {}\n", line.check.claim());
        }
        text
    }
}

fn coordinates_json(coordinates: &Coordinates) -> Value {
    match coordinates {
        Coordinates::F64 => json!({"type": "f64"}),
        Coordinates::I32 { scale, offset } => json!({"type": "i32", "scale": scale, "offset": offset}),
    }
}

fn crs_text(crs: &Crs) -> String {
    let name = spmesh_formats::crs::name(crs).unwrap_or_else(|| "unnamed".to_string());
    match crs {
        Crs::Unknown => "unknown".into(),
        Crs::Wkt(text) => format!("{name} (WKT, {} bytes)", text.len()),
        Crs::GeoKeys { .. } => format!("{name} (GeoKeys)"),
    }
}

fn crs_json(crs: &Crs) -> Value {
    match crs {
        Crs::Unknown => Value::Null,
        Crs::Wkt(text) => json!({"encoding": "wkt", "name": spmesh_formats::crs::name(crs), "wkt": text}),
        Crs::GeoKeys { .. } => json!({"encoding": "geokeys", "name": spmesh_formats::crs::name(crs)}),
    }
}

fn words(values: &[f64]) -> String {
    // Scales of hundreds of digits tell no one anything.
    let is_short = |value: f64| value == 0.0 || (1e-20..1e20).contains(&value.abs());
    let word = |&value: &f64| if is_short(value) { value.to_string() } else { format!("{value:e}") };
    let words: Vec<String> = values.iter().map(word).collect();
    format!("({})", words.join(", "))
}

/// JSON has no infinity: an open side of a region is null.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

fn mean(sum: u64, count: u64) -> Option<f64> {
    (count > 0).then(|| sum as f64 / count as f64)
}
