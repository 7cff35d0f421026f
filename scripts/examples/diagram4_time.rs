//! Times the 4D diagram, on one thread unless told otherwise.
//!
//! `diagram4_time POINTS [--threads N]` is our contestant in `scripts/bench`: the engine takes ownership of the points in
//! memory. With `--audit` it also proves the diagram. With `--direct`, in a build with `--features
//! experiments`, it takes the other route. POINTS has quadruples of little-endian f64.

use std::error::Error;
use std::fs::File;
use std::num::NonZeroUsize;

use spmesh_experiments::files::{read_tuples, timed};
use spmesh_spacetime::diagram4::{Route, Stats, diagram_by};
use spmesh_stream::model::cells4::Cells4;
use spmesh_stream::model::diagram4::Diagram4;

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [points, flags @ ..] = &words[..] else {
        return Err("usage: diagram4_time POINTS [--threads N] [--audit] [--direct]".into());
    };
    let has = |flag: &str| flags.iter().any(|word| word == flag);
    let route = if has("--direct") { Route::Direct } else { Route::Simplices };
    let threads = match flags.iter().position(|word| word == "--threads") {
        Some(at) => flags.get(at + 1).ok_or("--threads needs a number")?.parse()?,
        None => NonZeroUsize::MIN,
    };
    let points = read_tuples(&mut File::open(points)?)?;
    let (result, seconds) = timed(|| diagram_by(route, threads, points, None));
    let (diagram, stats) = result?;
    report(&diagram, &stats, seconds);
    if has("--audit") {
        println!("{:?}", spmesh_audit::diagram::check(&diagram.points, &diagram.cells));
    }
    Ok(())
}

/// Prints the results as a line of JSON.
fn report(diagram: &Diagram4, stats: &Stats, seconds: f64) {
    let sizes = Sizes::of(&diagram.cells);
    let times = [stats.order, stats.insertion, stats.merge].map(|time| time.as_secs_f64());
    let figures = [
        ("points", diagram.points.len() as u64),
        ("cells", sizes.finite),
        ("infinite_cells", sizes.infinite),
        ("non_simplicial", sizes.non_simplicial),
        ("vertex_references", sizes.vertices),
        ("neighbour_references", sizes.neighbours),
        ("simplices", stats.simplices),
        ("infinite_simplices", stats.infinite_simplices),
        ("created", stats.created),
        ("in_sphere_tests", stats.in_sphere_tests),
    ];
    let figures: Vec<String> = figures.iter().map(|(key, count)| format!("\"{key}\": {count}")).collect();
    let names = ["order_seconds", "insertion_seconds", "merge_seconds", "seconds"];
    let times = names.iter().zip([times[0], times[1], times[2], seconds]);
    let times: Vec<String> = times.map(|(key, time)| format!("\"{key}\": {time:.6}")).collect();
    println!("{{{}, {}}}", figures.join(", "), times.join(", "));
}

/// Counts over all cells. The faraway point counts as a vertex of infinite cells.
#[derive(Default)]
struct Sizes {
    finite: u64,
    infinite: u64,
    /// Cells with more than five vertices.
    non_simplicial: u64,
    vertices: u64,
    neighbours: u64,
}

impl Sizes {
    fn of(cells: &Cells4) -> Sizes {
        let mut sizes = Sizes::default();
        for cell in cells.iter() {
            let vertices = cell.vertices.len() as u64 + u64::from(cell.is_infinite);
            sizes.finite += u64::from(!cell.is_infinite);
            sizes.infinite += u64::from(cell.is_infinite);
            sizes.non_simplicial += u64::from(vertices > 5);
            sizes.vertices += vertices;
            sizes.neighbours += cell.neighbours.len() as u64;
        }
        sizes
    }
}
