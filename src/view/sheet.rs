//! The sheet of a picture: the place of the map, and the title, legend and scale around it.

use super::picture::Frame;
use super::svg::{self, Anchor};
use super::ticks;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::Point2;
use spmesh_formats::crs::System;
use spmesh_formats::raster::colour_map::{Colour, ColourMap, hex};
use spmesh_stream::Crs;

/// The margin of the sheet. Units: lengths of the picture, as all lengths here.
const MARGIN: f64 = 16.0;
/// Height of the title above the map.
const HEAD: f64 = 44.0;
/// Height of the colour bar and the scale bar below the map.
const FOOT: f64 = 58.0;
/// Height of a row of marks and their words.
const ROW: f64 = 22.0;
/// The greatest and the least height of the map, as parts of its width.
const TALLEST: f64 = 1.2;
const FLATTEST: f64 = 0.1;
/// Number of rectangles in a colour bar.
const STEPS: usize = 64;
/// Length of the tips of a colour bar.
const TIP: f64 = 8.0;
/// Sizes of text.
const TITLE: u32 = 16;
const LABEL: u32 = 12;
/// Colour of text and lines.
const DARK: &str = "#24292f";

/// The place of the map.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sheet {
    width: f64,
    /// The upper left corner of the map.
    pub(super) corner: Point2,
    /// Width and height of the map.
    pub(super) size: [usize; 2],
}

/// A colour map and its meaning.
pub(super) struct Legend {
    pub(super) label: String,
    pub(super) colour_map: &'static ColourMap,
    pub(super) range: [f64; 2],
    /// The range of all values; those beyond `range` have the colours of the ends.
    pub(super) all: [f64; 2],
    /// Whether the numbers are counts.
    pub(super) is_count: bool,
}

impl Legend {
    /// Whether there are values below the range, and above it.
    fn is_beyond(&self) -> [bool; 2] {
        [self.all[0] < self.range[0], self.all[1] > self.range[1]]
    }

    /// The label, with the range of all values if the colours do not span it.
    fn words(&self) -> String {
        let [low, high] = self.all;
        if !self.is_beyond().contains(&true) {
            return self.label.clone();
        }
        // Three digits of the range are enough.
        let tick = 10f64.powf((0.5 * high - 0.5 * low).log10().floor() - 1.0);
        let [low, high] = [low, high].map(|end| ticks::number(end, tick));
        format!("{} (all: {low} to {high})", self.label)
    }
}

/// The form of a mark.
pub(super) enum Shape {
    Dot,
    Line,
    Area,
}

/// A mark and its meaning.
pub(super) struct Mark {
    pub(super) shape: Shape,
    pub(super) colour: Colour,
    pub(super) words: &'static str,
}

/// Everything around a map.
pub(super) struct Furniture<'a> {
    pub(super) title: &'a str,
    pub(super) legend: Option<Legend>,
    pub(super) marks: &'a [&'a Mark],
    /// World units for one length of the picture, in a view from above, and their name.
    pub(super) unit: Option<(f64, &'a str)>,
}

impl Sheet {
    /// The sheet of a box of the plane, in any units, with a margin of `pad` inside the map; and the frame of
    /// the box.
    pub(super) fn of(min: Point2, max: Point2, pad: f64, width: u32) -> Result<(Sheet, Frame)> {
        let width = f64::from(width);
        let across = width - 2.0 * MARGIN;
        // Halves first: the difference itself may overflow.
        let half = [0, 1].map(|axis| 0.5 * max[axis] - 0.5 * min[axis]);
        let largest = min.into_iter().chain(max).fold(0.0, |largest: f64, side| largest.max(side.abs()));
        let half = if half[0].max(half[1]) > 0.0 {
            half
        } else {
            // A single place gets some space around it.
            [0.5f64.max(largest * 1e-6); 2]
        };
        let inner = across - 2.0 * pad;
        let unit = 2.0 * (half[0] / inner).max(half[1] / (TALLEST * inner));
        if !(unit.is_normal() && (unit * width * 4.0).is_finite()) {
            let what =
                "coordinates are too great, or too near to each other, to be drawn: shift and scale them";
            return Err(Error::usage(what));
        }
        let height = (2.0 * (half[1] / unit + pad)).ceil().max((FLATTEST * across).ceil());
        let corner = [MARGIN, HEAD];
        let centre = [corner[0] + 0.5 * across, corner[1] + 0.5 * height];
        let middle = [0, 1].map(|axis| 0.5 * min[axis] + 0.5 * max[axis]);
        let frame = Frame { left: middle[0] - unit * centre[0], top: middle[1] + unit * centre[1], unit };
        Ok((Sheet { width, corner, size: [across as usize, height as usize] }, frame))
    }

    /// The whole picture: the map, and the furniture around it.
    pub(super) fn svg(&self, map: &str, furniture: &Furniture) -> String {
        let ([left, top], [across, down]) = (self.corner, self.size.map(|size| size as f64));
        let (below, rows) = self.marks(top + down, furniture);
        let width = self.width;
        let foot = if furniture.legend.is_some() || furniture.unit.is_some() { FOOT } else { 0.0 };
        let height = top + down + foot + rows + MARGIN;
        let title = svg::escape(furniture.title);
        let background = |y: f64, height: f64| {
            format!("<rect y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n")
        };
        let head = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
             height=\"{height}\" \
             role=\"img\" font-family=\"'DejaVu Sans', sans-serif\">\n<title>{title}</title>\n{}\
             <clipPath id=\"window\"><rect x=\"{left}\" y=\"{top}\" width=\"{across}\" height=\"{down}\"/></clipPath>\n\
             <g id=\"map\">\n<g clip-path=\"url(#window)\">\n",
            background(0.0, height)
        );
        // Keeps the furniture legible when a page moves or zooms the map below it.
        let ends = [background(0.0, top - 4.0), background(top + down + 4.0, height - top - down - 4.0)];
        let parts = [
            head,
            map.to_string(),
            format!("</g>\n</g>\n<g id=\"furniture\" fill=\"{DARK}\">\n"),
            ends.concat(),
            self.title(furniture.title),
            furniture.legend.as_ref().map_or_else(String::new, |legend| self.colour_bar(top + down, legend)),
            below,
            furniture.unit.map_or_else(String::new, |unit| self.scale(top + down, unit)),
            "</g>\n</svg>\n".to_string(),
        ];
        parts.concat()
    }

    fn title(&self, title: &str) -> String {
        let room = self.width - 2.0 * MARGIN;
        let mut shown = title.to_string();
        if svg::text_width(TITLE, title) > room {
            while svg::text_width(TITLE, &shown) + svg::text_width(TITLE, "...") > room {
                shown.pop();
            }
            shown += "...";
        }
        svg::text([MARGIN, 28.0], TITLE, Anchor::Start, &shown)
    }

    fn colour_bar(&self, below: f64, legend: &Legend) -> String {
        let across = (0.5 * (self.width - 3.0 * MARGIN)).min(360.0).floor();
        let (top, step) = (below + 24.0, across / STEPS as f64);
        let mut text = svg::text([MARGIN, below + 18.0], LABEL, Anchor::Start, &legend.words());
        for at in 0..STEPS {
            let (left, colour) =
                (MARGIN + step * at as f64, legend.colour_map.at(at as f64 / (STEPS - 1) as f64));
            // Each rectangle overlaps the next one, so that no gap shows.
            let reach = if at + 1 < STEPS { step + 1.0 } else { step };
            let [left, reach] = [left, reach].map(svg::length);
            text += &format!(
                "<rect x=\"{left}\" y=\"{top}\" width=\"{reach}\" height=\"12\" fill=\"{}\"/>\n",
                hex(colour)
            );
        }
        // A tip at each end beyond which there are values.
        let is_beyond = legend.is_beyond();
        for (end, side, tip) in [(0, MARGIN, -TIP), (1, MARGIN + across, TIP)] {
            if is_beyond[end] {
                let colour = hex(legend.colour_map.at(end as f64));
                text += &format!(
                    "<path class=\"tip\" d=\"M{} {top}v12l{tip} -6z\" fill=\"{colour}\"/>\n",
                    svg::length(side)
                );
            }
        }
        let [low, high] = legend.range;
        let words = |at: f64, tick: f64| {
            if legend.is_count { ticks::count(at.max(0.0) as u64) } else { ticks::number(at, tick) }
        };
        // As many numbers as there is room for.
        let fits = |(places, tick): &(Vec<f64>, f64)| {
            let widest =
                places.iter().map(|&at| svg::text_width(LABEL - 1, &words(at, *tick))).fold(0.0, f64::max);
            1.15 * widest * places.len() as f64 <= across
        };
        let some = (1..=6).rev().map(|count| ticks::ticks(legend.range, count)).find(fits);
        let (places, tick) = some.unwrap_or((vec![low], 0.0));
        for &at in &places {
            let part = if high > low { (at / 2.0 - low / 2.0) / (high / 2.0 - low / 2.0) } else { 0.5 };
            let x = MARGIN + across * part;
            let words = words(at, tick);
            let half = 0.5 * svg::text_width(LABEL - 1, &words);
            let (at, anchor) =
                if x - half < MARGIN - 6.0 { (MARGIN, Anchor::Start) } else { (x, Anchor::Middle) };
            text += &format!("<path d=\"M{} {}v5\" stroke=\"{DARK}\"/>\n", svg::length(x), top + 12.0);
            text += &svg::text([at, top + 29.0], LABEL - 1, anchor, &words);
        }
        text
    }

    /// A scale bar of round length.
    fn scale(&self, below: f64, (unit, name): (f64, &str)) -> String {
        let length = ticks::round_below(0.25 * (self.width - 2.0 * MARGIN) * unit);
        let (drawn, right, y) = (length / unit, self.width - MARGIN, below + 30.0);
        let words = format!("{} {name}", ticks::number(length, length));
        format!(
            "<g id=\"scale\">\n<path d=\"M{} {}v8h{}v-8\" fill=\"none\" stroke=\"{DARK}\" stroke-width=\"1.5\"/>\n{}</g>\n",
            svg::length(right - drawn),
            y - 4.0,
            svg::length(drawn),
            svg::text([right, y + 23.0], LABEL - 1, Anchor::End, &words)
        )
    }

    /// The marks with their words, in as many rows as needed, and the height of the rows.
    fn marks(&self, below: f64, furniture: &Furniture) -> (String, f64) {
        let foot = if furniture.legend.is_some() || furniture.unit.is_some() { FOOT } else { 0.0 };
        let (mut text, mut x, mut y) = (String::new(), MARGIN, below + foot + 16.0);
        for mark in furniture.marks {
            let width = 24.0 + svg::text_width(LABEL, mark.words);
            if x > MARGIN && x + width > self.width - MARGIN {
                (x, y) = (MARGIN, y + ROW);
            }
            let colour = hex(mark.colour);
            text += &match mark.shape {
                Shape::Dot => {
                    format!("<circle cx=\"{}\" cy=\"{}\" r=\"3.5\" fill=\"{colour}\"/>\n", x + 7.0, y - 4.0)
                }
                Shape::Line => {
                    format!("<path d=\"M{x} {}h15\" stroke=\"{colour}\" stroke-width=\"2\"/>\n", y - 4.0)
                }
                Shape::Area => format!(
                    "<rect x=\"{x}\" y=\"{}\" width=\"14\" height=\"10\" fill=\"{colour}\" stroke=\"{DARK}\" stroke-width=\"0.5\"/>\n",
                    y - 9.0
                ),
            };
            text += &svg::text([x + 20.0, y], LABEL, Anchor::Start, mark.words);
            x += width + MARGIN;
        }
        let rows = if furniture.marks.is_empty() { 0.0 } else { y + ROW - (below + foot + 16.0) };
        (text, rows)
    }
}

/// The units of a stream.
#[derive(Debug, Clone)]
pub(super) struct Units {
    /// What lengths of the plan are called.
    pub(super) plan: String,
    /// What heights are called, if that is known.
    heights: Option<String>,
    /// Units of the plan that one unit of height is.
    pub(super) of_heights: f64,
}

impl Units {
    pub(super) fn of(crs: &Crs) -> Units {
        let system = System::of(crs);
        let plan = system.horizontal.as_ref().map(|horizontal| horizontal.unit.symbol.clone());
        Units {
            plan: plan.unwrap_or_else(|| "units".into()),
            heights: system.vertical.as_ref().map(|vertical| vertical.unit.symbol.clone()),
            of_heights: system.vertical_ratio().unwrap_or(1.0),
        }
    }

    /// The label of elevations.
    pub(super) fn elevation(&self) -> String {
        self.heights.as_ref().map_or("Elevation".into(), |unit| format!("Elevation ({unit})"))
    }
}
