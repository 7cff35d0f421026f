//! Configurations for figures, and tests of link triangulation in many runs.
//!
//! `config_runs random:N|zp:N DEGREE SEED` prints knots and configurations of all degrees as JSON: N random
//! knots with random flips and random rules, or a grid of N by N knots with ZP links. `config_runs runs COUNT
//! DEGREE SEED` makes COUNT runs up to a degree, with random knots, flips and rules. It checks that facets
//! match, and prints a tab-separated row per degree.

use spmesh_audit::configurations as audit;
use spmesh_base::error::Result;
use spmesh_base::random::Random;
use spmesh_configurations::special::{self, ZpSplit};
use spmesh_configurations::{self as configurations, Configurations, Knots, Rule, Start};

/// The random number generator of a run.
fn random_of(seed: u64) -> Random {
    Random::new(seed.wrapping_mul(0xd134_2543_de82_ef95))
}

/// A random number below `count`, almost uniform.
fn below(random: &mut Random, count: u64) -> u64 {
    random.bits() % count
}

/// The counts of one degree.
#[derive(Default, Clone)]
struct Row {
    runs: usize,
    links: usize,
    null: usize,
    infinite: usize,
    largest: usize,
    configurations: usize,
    failures: usize,
}

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    match words[..] {
        ["runs", count, degree, seed] => runs(count.parse()?, degree.parse()?, seed.parse()?),
        [source, degree, seed] => {
            let (degree, seed) = (degree.parse()?, seed.parse()?);
            match source.split_once(':') {
                Some(("random", count)) => {
                    let knots = Knots::new(points(&mut random_of(seed), count.parse()?, 0))?;
                    let start = flipped(&knots, count.parse::<usize>()? / 3, seed)?;
                    print(&knots, &configurations::generate(&knots, start, &Rule::Random(seed), degree)?);
                }
                Some(("zp", side)) => {
                    let side: u32 = side.parse()?;
                    let at = |site: u32| [f64::from(site % side), f64::from(site / side)];
                    let knots = Knots::new((0..side * side).map(at).collect())?;
                    let zp = special::zp(&knots, ZpSplit::default())?;
                    print(&knots, &zp.generate(&Rule::Delaunay, degree)?);
                }
                _ => return Err("knots must be random:N or zp:N".into()),
            }
        }
        _ => return Err("usage: config_runs random:N|zp:N DEGREE SEED | runs COUNT DEGREE SEED".into()),
    }
    Ok(())
}

fn flipped(knots: &Knots, flips: usize, seed: u64) -> Result<Configurations> {
    let mut start = Start::delaunay(knots)?;
    start.flip_random(knots, flips, seed);
    Ok(start.configurations())
}

/// Random knots: in general position, on a small grid, or with copies.
fn points(random: &mut Random, count: usize, family: u64) -> Vec<[f64; 2]> {
    let mut coordinate = || match family {
        0 => random.unit(),
        1 => below(random, 7) as f64,
        _ => below(random, 4) as f64,
    };
    (0..count).map(|_| [coordinate(), coordinate()]).collect()
}

fn rule(random: &mut Random, count: usize) -> Rule {
    match below(random, 7) {
        0 => Rule::Delaunay,
        1 => Rule::MinWeight,
        2 => Rule::Ear,
        3 => Rule::Fan,
        4 => Rule::Aligned(below(random, 180) as f64),
        5 => Rule::Data((0..count).map(|_| below(random, 1000) as f64).collect()),
        _ => Rule::Random(random.bits()),
    }
}

fn runs(count: u64, degree: usize, seed: u64) {
    let mut rows = vec![Row::default(); degree + 1];
    for run in 0..count {
        let mut random = random_of(seed.wrapping_add(run));
        let knots = (degree + 4) as u64 + below(&mut random, 20);
        let points = points(&mut random, knots as usize, run % 3);
        let Ok(knots) = Knots::new(points) else { continue };
        // Collinear knots have no configurations.
        let Ok(mut lower) = flipped(&knots, below(&mut random, 60) as usize, random.bits()) else { continue };
        for row in rows.iter_mut().skip(1) {
            match step(&knots, &lower, &rule(&mut random, knots.len()), row) {
                Ok(upper) => lower = upper,
                Err(error) => {
                    row.failures += 1;
                    eprintln!("run {run}: {error}");
                    break;
                }
            }
        }
    }
    println!("degree\truns\tlinks\tnull\tinfinite\tlargest\tconfigurations\tfailures");
    for (degree, row) in rows.iter().enumerate().skip(1) {
        let Row { runs, links, null, infinite, largest, configurations, failures } = row;
        println!("{degree}\t{runs}\t{links}\t{null}\t{infinite}\t{largest}\t{configurations}\t{failures}");
    }
}

/// The configurations in the types of the audit.
fn held(of: &Configurations) -> Result<audit::Configurations> {
    let mut held = audit::Configurations::new(of.degree(), of.claim());
    for group in of.groups() {
        for boundaries in [group.triangles, group.infinite].into_iter().filter(|all| !all.is_empty()) {
            held.extend(group.interior, boundaries)?;
        }
    }
    Ok(held)
}

/// Generates the next degree and counts its links.
fn step(knots: &Knots, lower: &Configurations, rule: &Rule, row: &mut Row) -> Result<Configurations> {
    row.runs += 1;
    for link in configurations::links(knots, lower)?.iter() {
        row.links += 1;
        row.null += usize::from(link.is_null());
        row.infinite += usize::from(link.is_infinite());
        row.largest = row.largest.max(link.polygon.len());
    }
    let upper = configurations::link_triangulate(knots, lower, rule)?;
    audit::check_facets(&held(lower)?, &held(&upper)?)?;
    row.configurations += upper.len();
    Ok(upper)
}

fn print(knots: &Knots, all: &[Configurations]) {
    let pairs = |configurations: &Configurations| -> String {
        let each: Vec<String> = configurations.iter().map(|(b, i)| format!("[{b:?}, {i:?}]")).collect();
        format!("[{}]", each.join(", "))
    };
    let degrees: Vec<String> = all.iter().map(pairs).collect();
    println!("{{\"knots\": {:?}, \"degrees\": [{}]}}", knots.points(), degrees.join(",\n"));
}
