//! Measures balls, for `scripts/check-balls`.
//!
//! `balls BALLS PROBE [--surface]`: BALLS has lines `x y z radius`; the probe is added to each radius.
//! Prints a line `cell INDEX AREA VOLUME` for each ball and a line `contact INDEX INDEX AREA` for each face,
//! with all digits. With `--surface` it prints only `surface INDEX AREA VOLUME`, of the molecular surface.

use std::error::Error;
use std::io::Write;
use std::num::NonZeroUsize;

use spmesh_molecules::balls::{Balls, measure, molecular_surface};

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let (file, probe, is_surface) = match &words[..] {
        [file, probe] => (file, probe, false),
        [file, probe, flag] if flag == "--surface" => (file, probe, true),
        _ => return Err("usage: balls BALLS PROBE [--surface]".into()),
    };
    let probe: f64 = probe.parse()?;
    let text = std::fs::read_to_string(file)?;
    let (mut centres, mut radii) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let numbers: Vec<f64> = line.split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
        let [x, y, z, radius] = numbers[..] else { return Err(format!("not x y z radius: {line}").into()) };
        centres.push([x, y, z]);
        radii.push(radius + probe);
    }
    let balls = Balls { centres: &centres, radii: &radii };
    let mut output = std::io::BufWriter::new(std::io::stdout().lock());
    if is_surface {
        for (index, cell) in molecular_surface(balls, probe, NonZeroUsize::MIN)?.iter().enumerate() {
            writeln!(output, "surface {index} {} {}", cell.area, cell.volume)?;
        }
        output.flush()?;
        return Ok(());
    }
    let cells = measure(balls, Some(0.0), NonZeroUsize::MIN)?;
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
