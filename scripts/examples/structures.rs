//! Prints the atoms of structures as lines of text, or the time that reading them takes, for
//! `scripts/check-structures`.
//!
//!     cargo run --release --package spmesh-experiments --example structures -- [--time | --assembly NAME] FILE...

use std::io::Write;
use std::path::Path;
use std::time::Instant;

use spmesh_formats::molecules::{Class, Models, Selection, Structure, read_structure};

fn main() -> std::io::Result<()> {
    let mut files: Vec<String> = std::env::args().skip(1).collect();
    let mut assembly = None;
    if files.first().is_some_and(|flag| flag == "--assembly") {
        files.remove(0);
        assembly = Some(files.remove(0));
    }
    let is_timed = files.first().is_some_and(|flag| flag == "--time");
    if is_timed {
        files.remove(0);
    }
    let mut output = std::io::BufWriter::new(std::io::stdout().lock());
    for file in files {
        let start = Instant::now();
        let result = read_structure(Path::new(&file), None);
        let seconds = start.elapsed().as_secs_f64();
        let result = match &assembly {
            Some(name) => result.and_then(|structure| structure.assembled(name)),
            None => result,
        };
        match result {
            Err(error) => writeln!(output, "refused\t{error}")?,
            Ok(structure) if is_timed => {
                let points: usize = structure.models.iter().map(|model| model.points.len()).sum();
                writeln!(output, "{file}\t{points}\t{:.3} ms", seconds * 1e3)?;
            }
            Ok(structure) => print(&structure, &mut output)?,
        }
    }
    output.flush()
}

fn print(structure: &Structure, output: &mut impl Write) -> std::io::Result<()> {
    for warning in &structure.warnings {
        writeln!(output, "warning\t{warning}")?;
    }
    let altlocs = spmesh_formats::molecules::Altlocs::All;
    let all = Selection { models: Models::All, altlocs, ..Selection::default() };
    let selected = structure.select(&all).expect("all atoms can be selected");
    for index in 0..selected.points().len() {
        let [x, y, z] = structure.coordinates.to_world(selected.points()[index]);
        let Some(atom) = selected.atom(index) else {
            writeln!(output, "point\t{x}\t{y}\t{z}")?;
            continue;
        };
        let number = atom.residue_number().map_or(String::new(), |number| number.to_string());
        let class = match atom.residue().class {
            Class::Polymer => "polymer",
            Class::Water => "water",
            Class::Ion => "ion",
            Class::Ligand => "ligand",
        };
        let group = if atom.atom.is_hetatm { "HETATM" } else { "ATOM" };
        writeln!(
            output,
            "{group}\t{}\t{}\t{}\t{}\t{}\t{}\t{}\t{number}\t{}\t{}\t{class}\t{x:.6}\t{y:.6}\t{z:.6}",
            atom.model,
            atom.atom.serial,
            atom.name(),
            atom.element(),
            atom.altloc(),
            atom.chain(),
            atom.residue_name(),
            atom.insertion_code(),
            atom.atom.occupancy,
        )?;
    }
    Ok(())
}
