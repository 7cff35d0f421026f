//! The table of times: ours in microseconds, those of peers as ratios to ours.

use crate::inputs::Inputs;
use crate::libraries::{NAMES, Task};
use crate::rounds::Measured;

/// Prints the table.
pub fn print(inputs: &Inputs, all: &[Measured]) {
    println!("\n{} points, {}\n", inputs.points.len(), inputs.kind.name());
    println!("| task | ours, µs | {} |", NAMES[1..].join(" | "));
    println!("|{}", "---|".repeat(NAMES.len() + 1));
    for (place, task) in Task::ALL.into_iter().enumerate() {
        let (title, count) = task.title(inputs);
        let ours = &all[0].seconds[place];
        let ratios: Vec<String> = all[1..].iter().map(|peer| ratio(&peer.seconds[place], ours)).collect();
        let each =
            median(ours).map_or(String::new(), |seconds| format!("{:.3}", 1e6 * seconds / count as f64));
        println!("| {title} | {each} | {} |", ratios.join(" | "));
    }
}

/// The median of the ratios of rounds, with the least and the greatest; of one round, against our median.
fn ratio(peer: &[f64], ours: &[f64]) -> String {
    if peer.len() < ours.len() {
        let once = peer.first().zip(median(ours));
        return once.map_or(String::new(), |(peer, ours)| format!("{:.2} (once)", peer / ours));
    }
    let mut ratios: Vec<f64> = peer.iter().zip(ours).map(|(peer, ours)| peer / ours).collect();
    ratios.sort_by(f64::total_cmp);
    match (median(&ratios), ratios.first(), ratios.last()) {
        (Some(middle), Some(least), Some(greatest)) => format!("{middle:.2} ({least:.2} to {greatest:.2})"),
        _ => String::new(),
    }
}

fn median(values: &[f64]) -> Option<f64> {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
