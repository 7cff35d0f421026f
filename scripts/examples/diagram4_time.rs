//! Times the 4D diagram of points from a file of f64 (x, y, z, t), and proves it on request.
//!
//! ```text
//! cargo run --release --example diagram4_time -- FILE [--audit] [--direct]
//! ```

use std::time::Instant;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let bytes = std::fs::read(&arguments[0]).expect("a file of points");
    let numbers: Vec<f64> =
        bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().expect("8 bytes"))).collect();
    let points = numbers.chunks_exact(4).map(|p| [p[0], p[1], p[2], p[3]]).collect();
    let started = Instant::now();
    let is_direct = arguments.iter().any(|word| word == "--direct");
    let route = if is_direct { spmesh::diagram4::Route::Direct } else { spmesh::diagram4::Route::Simplices };
    let (diagram, stats) = spmesh::diagram4::diagram_by(route, points, None).expect("a diagram");
    let seconds = started.elapsed().as_secs_f64();
    let finite = diagram.cells.iter().filter(|cell| !cell.is_infinite).count();
    println!("{seconds:.3} s, {finite} cells, {} infinite, {stats:?}", diagram.cells.len() - finite);
    if arguments.iter().any(|word| word == "--audit") {
        println!("{:?}", spmesh::audit::diagram::check(&diagram.points, &diagram.cells));
    }
}
