//! Whether libraries agree with ours: in numbers of triangles and of targets inside, and in values.

use crate::inputs::Inputs;
use crate::libraries::{Answer, NAMES, Task};
use crate::rounds::Measured;

/// Targets farther from the square than this share of its side are away from the hull: no circle reaches
/// both.
const BORDER: f64 = 0.1;

/// Prints the table of answers.
pub fn print(inputs: &Inputs, all: &[Measured]) {
    println!("\n| | {} |", NAMES.join(" | "));
    println!("|{}", "---|".repeat(NAMES.len() + 1));
    for (place, task) in Task::ALL.into_iter().enumerate() {
        let (title, _) = task.title(inputs);
        let targets = if task == Task::NaturalRaster { &inputs.raster } else { &inputs.random };
        let cells = all.iter().map(|measured| match (&measured.answers[place], &all[0].answers[place]) {
            _ if measured.failure == Some(task) => "panics".to_string(),
            (Some(Answer::Count(count)), _) => count.to_string(),
            (Some(Answer::Values(values)), Some(Answer::Values(ours))) => {
                difference(values, ours, targets, inputs.side)
            }
            _ => String::new(),
        });
        println!("| {title} | {} |", cells.collect::<Vec<_>>().join(" | "));
    }
    let cells = all.iter().map(|measured| match (&measured.linear, &all[0].linear) {
        (Some(values), Some(ours)) => difference(values, ours, &inputs.random, inputs.side),
        _ => String::new(),
    });
    println!("| linear, random | {} |", cells.collect::<Vec<_>>().join(" | "));
}

/// The greatest difference away from the hull, the greatest near it, and how many targets only one of both
/// has a value for.
fn difference(values: &[f64], ours: &[f64], targets: &[[f64; 2]], side: f64) -> String {
    let (mut within, mut border, mut only_one) = (0.0f64, 0.0f64, 0);
    for ((value, our), target) in values.iter().zip(ours).zip(targets) {
        let is_within = target.iter().all(|c| (BORDER * side..(1.0 - BORDER) * side).contains(c));
        match (value.is_nan(), our.is_nan()) {
            (true, true) => {}
            (false, false) if is_within => within = within.max((value - our).abs()),
            (false, false) => border = border.max((value - our).abs()),
            _ => only_one += 1,
        }
    }
    format!("{within:.0e}, {border:.0e}, {only_one}")
}
