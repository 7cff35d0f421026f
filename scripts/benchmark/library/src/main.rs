//! The library of the plane beside its peers: processor time of one thread, memory, and whether answers
//! agree.
//!
//! `spmesh-library-bench KIND COUNT ROUNDS` measures one kind of points, and prints tables in Markdown.
//! `spmesh-library-bench KIND COUNT memory LIBRARY` prints the peak of one build in bytes per point.

#![warn(missing_docs)]

mod checks;
mod inputs;
mod libraries;
mod memory;
#[path = "../../rust/src/random.rs"]
mod random;
mod rounds;
mod table;

use inputs::{Inputs, Kind};
use std::process::ExitCode;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    match run(&words) {
        Some(()) => ExitCode::SUCCESS,
        None => {
            eprintln!(
                "usage: spmesh-library-bench uniform|rows|lattice|repeated COUNT ROUNDS|memory LIBRARY"
            );
            ExitCode::FAILURE
        }
    }
}

/// `None` if the command line cannot be understood.
fn run(words: &[&str]) -> Option<()> {
    let [kind, count, rest @ ..] = words else { return None };
    let kind = Kind::named(kind)?;
    let count = count.parse().ok()?;
    match rest {
        ["memory", library] => println!("{:.0}", memory::peak_of_build(kind, count, library)?),
        [rounds] => {
            let inputs = Inputs::new(kind, count);
            let results = rounds::measure(&inputs, rounds.parse().ok()?);
            table::print(&inputs, &results);
            checks::print(&inputs, &results);
        }
        _ => return None,
    }
    Some(())
}
