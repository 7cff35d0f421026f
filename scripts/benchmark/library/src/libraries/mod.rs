//! What is measured of each library.

mod builders;
mod ours;
mod spade;
mod startin;

use crate::inputs::Inputs;

/// Ours is the first; ratios are to it.
pub const NAMES: [&str; 6] = ["spmesh-delaunay", "spade", "spade, hierarchy", "startin", "delaunator", "geo"];

/// The libraries that insert each point by a walk from a distant one, so that more points take minutes.
pub fn points_max(number: usize) -> usize {
    if matches!(NAMES[number], "startin" | "geo") { 200_000 } else { usize::MAX }
}

/// Builds a triangulation by the library of this number.
pub fn build(number: usize, points: &[[f64; 3]]) -> Box<dyn Library> {
    match number {
        0 => Box::new(ours::Ours::new(points)),
        1 => Box::new(spade::Spade::<::spade::LastUsedVertexHintGenerator>::new(points, false)),
        2 => Box::new(spade::Spade::<::spade::HierarchyHintGenerator<f64>>::new(points, true)),
        3 => Box::new(startin::Startin::new(points)),
        4 => Box::new(builders::delaunator(points)),
        5 => Box::new(builders::geo(points)),
        _ => unreachable!("a library of NAMES"),
    }
}

/// Which targets come one after another.
#[derive(Clone, Copy, PartialEq)]
pub enum Order {
    /// In no order.
    Random,
    /// Each near the one before.
    Raster,
}

/// A triangulation with heights. `None` is what a library does not have.
pub trait Library {
    /// Number of triangles.
    fn triangles(&self) -> usize;

    /// How many of the targets are inside of the hull or on it, each located by itself.
    fn locate(&mut self, _: &[[f64; 2]], _: Order) -> Option<usize> {
        None
    }

    /// As `locate`, with all targets at once.
    fn locate_all(&mut self, _: &[[f64; 2]]) -> Option<usize> {
        None
    }

    /// Values of linear interpolation at the targets, which are in no order; NaN outside.
    fn linear(&mut self, _: &[[f64; 2]]) -> Option<Vec<f64>> {
        None
    }

    /// Values of natural neighbours at the targets, NaN outside.
    fn natural(&mut self, _: &[[f64; 2]], _: Order) -> Option<Vec<f64>> {
        None
    }

    /// Inserts the points one by one.
    fn insert(&mut self, _: &[[f64; 3]]) -> Option<()> {
        None
    }
}

/// What is measured. Insertion changes the triangulation, and so is the last.
#[derive(Clone, Copy, PartialEq)]
pub enum Task {
    Build,
    LocateRandom,
    LocateAll,
    LocateRaster,
    NaturalRandom,
    NaturalRaster,
    Insert,
}

/// What a task answers, to be compared.
pub enum Answer {
    /// Number of triangles, or of targets inside.
    Count(usize),
    /// Values at the targets, NaN outside.
    Values(Vec<f64>),
}

impl Task {
    /// All tasks, in the order in which they run.
    pub const ALL: [Task; 7] = [
        Task::Build,
        Task::LocateRandom,
        Task::LocateAll,
        Task::LocateRaster,
        Task::NaturalRandom,
        Task::NaturalRaster,
        Task::Insert,
    ];

    /// What it is called in tables, and how many items it has.
    pub fn title(self, inputs: &Inputs) -> (&'static str, usize) {
        match self {
            Task::Build => ("build", inputs.points.len()),
            Task::LocateRandom => ("locate, random", inputs.random.len()),
            Task::LocateAll => ("locate, random, all at once", inputs.random.len()),
            Task::LocateRaster => ("locate, raster", inputs.raster.len()),
            Task::NaturalRandom => ("natural neighbours, random", inputs.natural.len()),
            Task::NaturalRaster => ("natural neighbours, raster", inputs.raster.len()),
            Task::Insert => ("insert, random", inputs.inserted.len()),
        }
    }

    /// Does a task other than to build; `None` if the library cannot.
    pub fn run(self, library: &mut dyn Library, inputs: &Inputs) -> Option<Answer> {
        match self {
            Task::Build => None,
            Task::LocateRandom => library.locate(&inputs.random, Order::Random).map(Answer::Count),
            Task::LocateAll => library.locate_all(&inputs.random).map(Answer::Count),
            Task::LocateRaster => library.locate(&inputs.raster, Order::Raster).map(Answer::Count),
            Task::NaturalRandom => library.natural(&inputs.natural, Order::Random).map(Answer::Values),
            Task::NaturalRaster => library.natural(&inputs.raster, Order::Raster).map(Answer::Values),
            Task::Insert => library.insert(&inputs.inserted).map(|()| Answer::Count(library.triangles())),
        }
    }
}
