//! A mesh against check points.
//!
//! Terms are those of the ASPRS Positional Accuracy Standards for Digital Geospatial Data, edition 2, version
//! 2 (2024), sections 7.4 and 7.11 to 7.16.

use std::num::NonZeroUsize;

use super::classes::class_name;
use super::figures::Figures;
use crate::height::{Ground, Heights, Outside, Slopes, Unit, unit_of};
use spmesh_base::error::Result;
use spmesh_formats::source::{Alignment, LabelledPoints};
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::{Bounds, Point};

/// Fewest check points of a test, says the standard.
pub const POINTS_MIN: u64 = 30;
/// Where classes of slopes begin and end. Units: degrees.
const SLOPES: [f64; 6] = [0.0, 5.0, 10.0, 20.0, 30.0, 90.0];
/// Points whose heights are found at once.
const BATCH_LEN: usize = 1 << 18;
/// A stored coordinate nearer to an integer is meant to be one.
const WHOLE: f64 = 1e-6;
/// Words that say that a check point is in vegetation, and the classes of LAS points that do.
const VEGETATED: [&str; 2] = ["vva", "vegetated"];
const VEGETATION: [&str; 3] = ["3", "4", "5"];

/// Differences of a mesh and check points: its elevation minus theirs.
#[derive(Debug)]
pub struct Accuracy {
    /// What the check points are called in messages.
    pub name: String,
    /// Check points, those outside of the mesh among them.
    pub points: u64,
    /// Check points outside of the mesh.
    pub outside: u64,
    /// All differences.
    pub all: Group,
    /// Those of check points that are not in vegetation, and that are; `None` if check points have no words.
    pub by_cover: Option<[Group; 2]>,
    /// Those of each word.
    pub by_class: Vec<Group>,
    /// Those in triangles of each class of slopes.
    pub by_slope: Vec<Group>,
    /// Differences in ascending order.
    pub differences: Vec<f64>,
    /// The accuracy of the check points themselves, as root of a mean square.
    pub of_survey: Option<f64>,
}

/// Differences at some check points.
#[derive(Debug)]
pub struct Group {
    /// What they have in common.
    pub name: String,
    /// `None` if there are none.
    pub figures: Option<Figures>,
}

/// How check points are read.
#[derive(Debug, Clone, Default)]
pub struct CheckOptions {
    /// The accuracy of the check points, as root of a mean square.
    pub of_survey: Option<f64>,
    /// Words that say that a check point is in vegetation, beside the usual ones.
    pub vegetated: Vec<String>,
    /// How many units of x one of z is.
    pub unit_of_z: f64,
}

/// The box of check points.
pub fn window(points: &LabelledPoints) -> Option<Bounds> {
    let boxes = points.points.iter().map(|&[x, y, _]| Bounds::over([x, y], [x, y]));
    boxes.reduce(Bounds::union)
}

/// Compares a mesh with check points, which are called `name`.
///
/// Memory: 24 bytes for each check point, and 16 MB.
///
/// # Errors
/// Usage, if the coordinate reference systems differ; if the mesh cannot be read again.
pub fn check(
    ground: &Ground,
    points: &LabelledPoints,
    name: String,
    options: &CheckOptions,
    threads: NonZeroUsize,
) -> Result<Accuracy> {
    ground.check_system(&points.crs).map_err(|e| e.of_input(&name))?;
    let alignment = Alignment::between(&Coordinates::F64, ground.coordinates());
    let unit = unit_of(ground.coordinates());
    let mut heights = Heights::new(ground, Unit::Stored, Outside::NoData, threads);
    let (mut placed, mut above, mut steep) = (Vec::new(), Vec::new(), Vec::new());
    let mut found = Found::new(points);
    for (batch, first) in points.points.chunks(BATCH_LEN).zip((0..).step_by(BATCH_LEN)) {
        placed.clear();
        placed.extend(batch.iter().map(|&point| on_grid(alignment.place(point), ground.coordinates())));
        heights.with_slopes(&placed, Slopes::OfTriangles, &mut above, &mut steep)?;
        for (number, (height, slope)) in above.iter().zip(&steep).enumerate() {
            let degrees = (slope * slope_unit(ground.coordinates()) * options.unit_of_z).atan().to_degrees();
            found.add(points.numbers[first + number], -height * unit, degrees);
        }
    }
    Ok(found.accuracy(points, name, options))
}

/// Stored units of z over those of x, in those of the world.
fn slope_unit(coordinates: &Coordinates) -> f64 {
    match coordinates {
        Coordinates::F64 => 1.0,
        Coordinates::I32 { scale, .. } => scale[2] / scale[0],
    }
}

/// A place in stored coordinates without roundings of decimals, which would move vertices out of the mesh.
fn on_grid(place: Point, coordinates: &Coordinates) -> Point {
    if *coordinates == Coordinates::F64 {
        return place;
    }
    place.map(|at| if (at - at.round()).abs() < WHOLE { at.round() } else { at })
}

/// Differences by word and by slope.
struct Found {
    all: Vec<f64>,
    by_class: Vec<Vec<f64>>,
    by_slope: [Vec<f64>; SLOPES.len() - 1],
    outside: u64,
}

impl Found {
    fn new(points: &LabelledPoints) -> Found {
        let by_class = vec![Vec::new(); points.labels.len()];
        Found { all: Vec::new(), by_class, by_slope: Default::default(), outside: 0 }
    }

    fn add(&mut self, label: u32, difference: f64, degrees: f64) {
        if difference.is_nan() {
            self.outside += 1;
            return;
        }
        self.all.push(difference);
        self.by_class[label as usize].push(difference);
        let class = SLOPES[1..SLOPES.len() - 1].iter().filter(|end| degrees >= **end).count();
        self.by_slope[class].push(difference);
    }

    fn accuracy(mut self, points: &LabelledPoints, name: String, options: &CheckOptions) -> Accuracy {
        let has_words = points.labels.iter().any(|label| !label.is_empty());
        let is_vegetated = |label: &str| {
            let own = options.vegetated.iter().map(String::as_str);
            VEGETATED.into_iter().chain(own).any(|word| word.eq_ignore_ascii_case(label))
                || points.are_classes && VEGETATION.contains(&label)
        };
        let by_cover = has_words.then(|| {
            [("NVA", false), ("VVA", true)].map(|(name, wanted)| {
                let labels = points.labels.iter().zip(&self.by_class);
                let chosen = labels.filter(|(label, _)| is_vegetated(label) == wanted);
                group(name, chosen.flat_map(|(_, differences)| differences).copied().collect())
            })
        });
        let mut by_class: Vec<(&String, Vec<f64>)> = points.labels.iter().zip(self.by_class).collect();
        // Numbers by size, words by letters.
        by_class.sort_by_key(|(label, _)| (label.parse().unwrap_or(u64::MAX), label.to_string()));
        let by_class = by_class.into_iter().filter(|_| has_words);
        let by_class =
            by_class.map(|(label, differences)| group(&shown(label, points.are_classes), differences));
        let by_class = by_class.collect();
        let ends = SLOPES.windows(2).map(|ends| format!("{}° to {}°", ends[0], ends[1]));
        let by_slope = ends.zip(self.by_slope).map(|(name, differences)| group(&name, differences)).collect();
        self.all.sort_unstable_by(f64::total_cmp);
        Accuracy {
            name,
            points: points.points.len() as u64,
            outside: self.outside,
            all: group("all", self.all.clone()),
            by_cover,
            by_class,
            by_slope,
            differences: self.all,
            of_survey: options.of_survey,
        }
    }
}

fn group(name: &str, differences: Vec<f64>) -> Group {
    Group { name: name.to_string(), figures: Figures::of(differences) }
}

/// A word, as tables show it.
fn shown(label: &str, is_class: bool) -> String {
    match label.parse() {
        Ok(class) if is_class => format!("{class} {}", class_name(class)),
        _ if label.is_empty() => "none".to_string(),
        _ => label.to_string(),
    }
}

impl Accuracy {
    /// The accuracy of a product with this error against the check points, whose own error adds to it:
    /// `RMSE_V`.
    pub fn rmse_v(&self, rmse: f64) -> Option<f64> {
        self.of_survey.map(|survey| rmse.hypot(survey))
    }
}
