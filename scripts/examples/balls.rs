//! Measures balls, for `scripts/check-balls`.
//!
//! `balls BALLS PROBE`: BALLS has lines `x y z radius`; the probe is added to each radius. Prints a line
//! `cell INDEX AREA VOLUME` for each ball and a line `contact INDEX INDEX AREA` for each face, with all
//! digits.

use std::error::Error;
use std::io::Write;
use std::num::NonZeroUsize;

use spmesh_geometry::balls::{Balls, measure};

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [file, probe] = &words[..] else { return Err("usage: balls BALLS PROBE".into()) };
    let probe: f64 = probe.parse()?;
    let text = std::fs::read_to_string(file)?;
    let (mut centres, mut radii) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let numbers: Vec<f64> = line.split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
        let [x, y, z, radius] = numbers[..] else { return Err(format!("not x y z radius: {line}").into()) };
        centres.push([x, y, z]);
        radii.push(radius + probe);
    }
    let cells = measure(Balls { centres: &centres, radii: &radii }, Some(0.0), NonZeroUsize::MIN)?;
    let mut output = std::io::BufWriter::new(std::io::stdout().lock());
    for (index, cell) in cells.cells.iter().enumerate() {
        writeln!(output, "cell {index} {} {}", cell.area, cell.volume)?;
    }
    for contact in cells.contacts.iter() {
        let [i, j] = contact.balls;
        writeln!(output, "contact {i} {j} {}", contact.area)?;
    }
    output.flush()?;
    Ok(())
}
