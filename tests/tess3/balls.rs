//! Areas, volumes, contacts and pockets of atoms as balls, against closed forms and sampling.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use super::molecules::{Record, Rows, cloud, models, pdb};
use crate::programs::{Folder, assert_outcome, outcome, run, sample};

/// Radius of carbon by Bondi with a probe of 1.4 Å.
const CARBON: f64 = 1.7 + 1.4;

fn table(text: &str, arguments: &[&str]) -> Rows {
    let output = run("tess3", &[arguments, &["-"]].concat(), text.as_bytes());
    assert!(output.status.success(), "{:?}", outcome(&output));
    Rows::new(&String::from_utf8(output.stdout).unwrap())
}

fn of_sample(name: &str, arguments: &[&str]) -> Rows {
    let output = run("tess3", &[&[&sample(name)[..]], arguments].concat(), b"");
    assert!(output.status.success(), "{:?}", outcome(&output));
    Rows::new(&String::from_utf8(output.stdout).unwrap())
}

fn sum(rows: &Rows, column: &str) -> f64 {
    (0..rows.len()).map(|row| rows.number(row, column)).sum()
}

fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found}, not {expected}");
}

#[test]
fn two_atoms_by_closed_forms() {
    let atoms = [Record::carbon(1, [0.0; 3]), Record::carbon(2, [1.5, 0.0, 0.0])];
    let text = pdb(&atoms);
    let rows = table(&text, &["--sasa", "--volumes", "--radii", "bondi"]);
    let cap = CARBON - 0.75;
    let area = 4.0 * PI * CARBON * CARBON - 2.0 * PI * CARBON * cap;
    let volume = 4.0 / 3.0 * PI * CARBON.powi(3) - PI * cap * cap * (3.0 * CARBON - cap) / 3.0;
    for row in 0..2 {
        assert_near(rows.number(row, "area"), area, 1e-6);
        assert_near(rows.number(row, "volume"), volume, 1e-6);
        assert_eq!(rows.text(row, "serial"), (row + 1).to_string());
    }
    let contacts = table(&text, &["--contact-areas", "--radii", "bondi"]);
    assert_eq!(contacts.len(), 1);
    assert_near(contacts.number(0, "area"), PI * (CARBON * CARBON - 0.75 * 0.75), 1e-6);
    assert_eq!(contacts.text(0, "distance"), "1.5");
    let alone = table(&text, &["--sasa", "--radii", "bondi", "--probe", "0", "--per", "molecule"]);
    assert_near(alone.number(0, "area"), 2.0 * 2.0 * PI * 1.7 * (1.7 + 0.75), 1e-6);
}

/// Radii of heavy atoms include their hydrogens by default. An atom may be one by its name alone.
#[test]
fn hydrogens_that_count_twice_are_noticed() {
    let carbon = Record::carbon(1, [0.0; 3]);
    let hydrogen = |name, element| Record { name, element, ..Record::carbon(2, [1.1, 0.0, 0.0]) };
    for (name, element, expected) in
        [("HA", "H", true), ("HA", "", true), ("1HB", "", true), ("CB", "", false)]
    {
        let text = pdb(&[carbon.clone(), hydrogen(name, element)]);
        let (code, message) = outcome(&run("tess3", &["--sasa", "-"], text.as_bytes()));
        assert_eq!(code, Some(0), "{message}");
        assert_eq!(message.contains("1 hydrogen counts twice"), expected, "{name} {element}: {message}");
    }
}

/// A probe rolls around the axis of two atoms.
#[test]
fn the_molecular_surface_of_two_atoms() {
    let text = pdb(&[Record::carbon(1, [0.0; 3]), Record::carbon(2, [1.5, 0.0, 0.0])]);
    let rows = table(&text, &["--ses", "--radii", "bondi"]);
    let (r, p) = (1.7f64, 1.4f64);
    let rho = (CARBON * CARBON - 0.75 * 0.75).sqrt();
    let angle = (0.75 / rho).atan();
    let saddle = 2.0 * PI * p * (rho * angle - p * angle.sin());
    let area = 2.0 * PI * r * (r + 0.75 * r / CARBON) + saddle;
    for row in 0..2 {
        assert_near(rows.number(row, "area"), area, 1e-6);
        assert_eq!(rows.text(row, "serial"), (row + 1).to_string());
    }
    // Without a probe, all surfaces are one.
    let spheres = of_sample("1aki.pdb", &["--sasa", "--volumes", "--probe", "0"]);
    let surface = of_sample("1aki.pdb", &["--ses", "--probe", "0"]);
    for row in 0..spheres.len() {
        for column in ["area", "volume"] {
            assert_eq!(surface.text(row, column), spheres.text(row, column));
        }
    }
}

/// Points of a grid tell by themselves what is excluded: what is within the balls, and at least the radius of
/// the probe away from all other points of the grid.
#[test]
fn the_molecular_volume_of_a_peptide_against_a_grid() {
    let atoms: Vec<([f64; 3], f64, &'static str)> = std::fs::read_to_string(sample("1aki.pdb"))
        .unwrap()
        .lines()
        .filter(|line| line.starts_with("ATOM"))
        .take(30)
        .map(|line| {
            let at = [30, 38, 46].map(|i| line[i..i + 8].trim().parse().unwrap());
            let (radius, element) = match line[76..78].trim() {
                "C" => (1.7, "C"),
                "N" => (1.55, "N"),
                "O" => (1.52, "O"),
                "S" => (1.8, "S"),
                other => panic!("element {other}"),
            };
            (at, radius, element)
        })
        .collect();
    let records: Vec<Record> = (1..)
        .zip(&atoms)
        .map(|(serial, &(at, _, element))| Record { element, name: element, ..Record::carbon(serial, at) })
        .collect();
    let found = table(&pdb(&records), &["--ses", "--radii", "bondi", "--per", "molecule"]);
    let probe = 1.4;
    let step = 0.35;
    let end = |axis: usize, sign: f64| {
        atoms.iter().map(|(at, ..)| sign * at[axis]).fold(f64::NEG_INFINITY, f64::max) + 5.0
    };
    let lower = [0, 1, 2].map(|axis| -end(axis, -1.0));
    let counts = [0, 1, 2].map(|axis| ((end(axis, 1.0) - lower[axis]) / step) as usize);
    let at = |cell: [usize; 3]| [0, 1, 2].map(|axis| lower[axis] + cell[axis] as f64 * step);
    let square = |p: [f64; 3], q: [f64; 3]| (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>();
    let cells = || {
        (0..counts[0]).flat_map(|x| (0..counts[1]).flat_map(move |y| (0..counts[2]).map(move |z| [x, y, z])))
    };
    let number = |[x, y, z]: [usize; 3]| (x * counts[1] + y) * counts[2] + z;
    let is_inside: Vec<bool> = cells()
        .map(|cell| atoms.iter().any(|&(q, r, _)| square(at(cell), q) < (r + probe).powi(2)))
        .collect();
    // Only cells within the probe matter: at most so many steps away.
    let reach = (probe / step).ceil() as usize;
    let near = |cell: [usize; 3]| {
        let range =
            move |axis: usize| cell[axis].saturating_sub(reach)..(cell[axis] + reach + 1).min(counts[axis]);
        range(0).flat_map(move |x| range(1).flat_map(move |y| range(2).map(move |z| [x, y, z])))
    };
    let is_excluded = |&cell: &[usize; 3]| {
        let is_touched =
            |&other: &[usize; 3]| !is_inside[number(other)] && square(at(cell), at(other)) < probe * probe;
        is_inside[number(cell)] && !near(cell).any(|other| is_touched(&other))
    };
    let excluded = cells().filter(is_excluded).count();
    let volume = found.number(0, "volume");
    // Distances to points of the grid are too great by about 0.37 of its step.
    let expected = excluded as f64 * f64::powi(step, 3) - 0.37 * step * found.number(0, "area");
    assert_near(volume, expected, 0.03 * expected);
}

/// Points on each sphere tell by themselves what is exposed (Shrake and Rupley, 1973).
#[test]
fn areas_of_a_protein_against_points_on_spheres() {
    let rows = of_sample("1aki.pdb", &["--sasa", "--radii", "bondi", "--chain", "A", "--hetatm", "off"]);
    let text = std::fs::read_to_string(sample("1aki.pdb")).unwrap();
    let atoms: Vec<([f64; 3], f64)> = text
        .lines()
        .filter(|line| line.starts_with("ATOM"))
        .map(|line| {
            let at = [30, 38, 46].map(|i| line[i..i + 8].trim().parse().unwrap());
            let radius = match line[76..78].trim() {
                "C" => 1.7,
                "N" => 1.55,
                "O" => 1.52,
                "S" => 1.8,
                other => panic!("element {other}"),
            };
            (at, radius + 1.4)
        })
        .collect();
    assert_eq!(rows.len(), atoms.len());
    let square = |p: [f64; 3], q: [f64; 3]| (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>();
    let mut total = 0.0;
    for (row, &(at, radius)) in atoms.iter().enumerate() {
        let near: Vec<_> = atoms
            .iter()
            .enumerate()
            .filter(|&(i, (p, r))| i != row && square(*p, at) < (r + radius).powi(2))
            .map(|(_, atom)| *atom)
            .collect();
        let points = 600;
        let exposed = (0..points)
            .map(|i| {
                // A spiral of equal steps in height.
                let height = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(points);
                let (sin, cos) = (2.399_963_229_728_653 * f64::from(i)).sin_cos();
                let ring = (1.0 - height * height).sqrt();
                [at[0] + radius * ring * cos, at[1] + radius * ring * sin, at[2] + radius * height]
            })
            .filter(|&p| near.iter().all(|&(q, r)| square(p, q) > r * r))
            .count();
        let sphere = 4.0 * PI * radius * radius;
        let expected = exposed as f64 / f64::from(points) * sphere;
        assert_near(rows.number(row, "area"), expected, 0.02 * sphere);
        total += expected;
    }
    assert_near(sum(&rows, "area"), total, 0.003 * total);
}

#[test]
fn levels_add_up() {
    for (column, flags) in
        ["area", "volume"].into_iter().flat_map(|c| [(c, &["--sasa", "--volumes"][..]), (c, &["--ses"])])
    {
        let atoms = of_sample("1aki.pdb", flags);
        let mut residues: BTreeMap<String, f64> = BTreeMap::new();
        for row in 0..atoms.len() {
            let name = atoms.label(row, "");
            let residue = name.rsplit_once('/').unwrap().0.to_string();
            *residues.entry(residue).or_default() += atoms.number(row, column);
        }
        let rows = of_sample("1aki.pdb", &[flags, &["--per", "residue"]].concat());
        assert_eq!(rows.len(), residues.len());
        for row in 0..rows.len() {
            assert_near(rows.number(row, column), residues[&rows.label(row, "")], 1e-5);
        }
        for level in ["chain", "molecule"] {
            let rows = of_sample("1aki.pdb", &[flags, &["--per", level]].concat());
            assert_eq!(rows.len(), 1);
            assert_near(rows.number(0, column), sum(&atoms, column), 1e-3);
        }
    }
}

#[test]
fn contacts_of_residues_are_sums_of_those_of_atoms() {
    let atoms = of_sample("1aki.pdb", &["--contact-areas"]);
    let mut sums: BTreeMap<[String; 2], (u32, f64)> = BTreeMap::new();
    for row in 0..atoms.len() {
        let residue = |end| atoms.label(row, end).rsplit_once('/').unwrap().0.to_string();
        let (p, q) = (residue("1"), residue("2"));
        if p != q {
            let mut pair = [p, q];
            pair.sort();
            let entry = sums.entry(pair).or_default();
            *entry = (entry.0 + 1, entry.1 + atoms.number(row, "area"));
        }
    }
    let rows = of_sample("1aki.pdb", &["--contact-areas", "--per", "residue"]);
    assert_eq!(rows.len(), sums.len());
    for row in 0..rows.len() {
        let mut pair = ["1", "2"].map(|end| rows.label(row, end));
        pair.sort();
        let (contacts, area) = sums[&pair];
        assert_eq!(rows.text(row, "contacts"), contacts.to_string());
        assert_near(rows.number(row, "area"), area, 1e-5);
    }
    let large = of_sample("1aki.pdb", &["--contact-areas", "--per", "residue", "--min-area", "20"]);
    assert_eq!(large.len(), sums.values().filter(|(_, area)| *area >= 20.0).count());
}

#[test]
fn contacts_are_filtered() {
    let all = of_sample("1l2y.pdb.gz", &["--contact-areas"]);
    let count = |is_wanted: &dyn Fn(usize) -> bool| (0..all.len()).filter(|&row| is_wanted(row)).count();
    let near = of_sample("1l2y.pdb.gz", &["--contact-areas", "--within", "3.5"]);
    assert_eq!(near.len(), count(&|row| all.number(row, "distance") <= 3.5));
    assert!(near.len() > 100 && near.len() < all.len());
    let between = of_sample("1l2y.pdb.gz", &["--contact-areas", "--between", "residues"]);
    let residue = |row: usize, end| all.label(row, end).rsplit_once('/').unwrap().0.to_string();
    assert_eq!(between.len(), count(&|row| residue(row, "1") != residue(row, "2")));
    let two = [Record::carbon(1, [0.0; 3]), Record { chain: 'B', ..Record::carbon(2, [2.0, 0.0, 0.0]) }];
    for (chains, expected) in [(['A', 'B'], 1), (['A', 'A'], 0)] {
        let atoms = [0, 1].map(|i| Record { chain: chains[i], ..two[i].clone() });
        let rows = table(&pdb(&atoms), &["--contact-areas", "--between", "chains"]);
        assert_eq!(rows.len(), expected);
    }
}

#[test]
fn threads_and_models() {
    let text = pdb(&cloud(400, 20_000, 5));
    let output =
        |threads| run("tess3", &["--contact-areas", "--threads", threads, "-"], text.as_bytes()).stdout;
    assert_eq!(output("1"), output("3"));
    let two = models(&[cloud(30, 6_000, 1), cloud(40, 6_000, 2)]);
    let rows = table(&two, &["--sasa", "--model", "all", "--per", "molecule"]);
    assert_eq!((rows.text(0, "atoms"), rows.text(1, "atoms"), rows.text(1, "model")), ("30", "40", "2"));
}

#[test]
fn a_cage_of_carbon_has_a_void() {
    let range = || 0..=6;
    let sites = range().flat_map(|x| range().flat_map(move |y| range().map(move |z| [x, y, z])));
    let shell = sites.filter(|p: &[i32; 3]| p.iter().any(|&c| c == 0 || c == 6));
    let atoms: Vec<Record> =
        (1..).zip(shell).map(|(serial, p)| Record::carbon(serial, p.map(|c| f64::from(c) * 2.0))).collect();
    let text = pdb(&atoms);
    let rows = table(&text, &["--pockets", "--radii", "bondi", "--probe", "0"]);
    assert_eq!((rows.text(0, "kind"), rows.text(0, "mouths")), ("void", "0"));
    // Spheres of the corners leave little between them.
    assert!((1..rows.len()).all(|row| rows.text(row, "kind") == "void" && rows.number(row, "volume") < 1e-3));
    // The corners are around these.
    assert_eq!(rows.text(0, "atoms"), (atoms.len() - 8).to_string());
    // Within the cube of side 12, without half of the balls' slabs of thickness about 1.5.
    let volume = rows.number(0, "volume");
    assert!((8.6f64.powi(3)..11.0f64.powi(3)).contains(&volume), "{volume}");
    let around = table(&text, &["--pockets", "--radii", "bondi", "--probe", "0", "--per", "atom"]);
    assert_eq!((0..around.len()).filter(|&row| around.text(row, "pocket") == "1").count(), atoms.len() - 8);
    // A hole makes it a pocket with a mouth.
    let open: Vec<Record> = atoms.into_iter().filter(|atom| atom.at != [6.0, 6.0, 0.0]).collect();
    let rows = table(&pdb(&open), &["--pockets", "--radii", "bondi", "--probe", "0"]);
    assert_eq!((rows.text(0, "kind"), rows.text(0, "mouths")), ("pocket", "1"));
    assert!(rows.number(0, "mouth_area") > 0.1 && rows.number(0, "depth") >= 12.0);
}

#[test]
fn what_users_may_not_expect_is_noticed() {
    let hydrogen = |serial, at| Record { element: "H", name: "H", ..Record::carbon(serial, at) };
    let text = pdb(&[Record::carbon(1, [0.0; 3]), hydrogen(2, [0.3, 0.0, 0.0])]);
    let notices = |arguments: &[&str]| outcome(&run("tess3", arguments, text.as_bytes())).1;
    let united = notices(&["--sasa", "-"]);
    assert!(united.contains("1 hydrogen counts twice"), "{united}");
    assert!(united.contains("1 of 2 atoms has no cell"), "{united}");
    let bondi = notices(&["--sasa", "--radii", "bondi", "-"]);
    assert!(!bondi.contains("twice"), "{bondi}");
    // An error leaves no line of columns.
    let unknown = pdb(&[Record { element: "X", name: "Q", ..Record::carbon(1, [0.0; 3]) }]);
    assert!(run("tess3", &["--sasa", "-"], unknown.as_bytes()).stdout.is_empty());
}

#[test]
fn filtrations_take_radii_as_weights() {
    let text = pdb(&[Record::carbon(1, [0.0; 3]), Record::carbon(2, [1.5, 0.0, 0.0])]);
    let output = run("tess3", &["--filtration", "--radii", "bondi", "-"], text.as_bytes());
    assert!(output.status.success(), "{:?}", outcome(&output));
    // Squares of radii, negative, and the power of the middle between the atoms: 0.75² - 1.7².
    assert_eq!(String::from_utf8(output.stdout).unwrap(), "0 0 -2.89 0\n0 1 -2.89 0\n1 0 1 -2.3275 0\n");
    let plain = run("tess3", &["--filtration", "-"], text.as_bytes());
    assert!(String::from_utf8(plain.stdout).unwrap().ends_with("1 0 1 0.5625 0\n"));
    assert_outcome(
        "tess3",
        &["--filtration", "--probe", "1", "-"],
        text.as_bytes(),
        2,
        "--probe needs --radii",
    );
}

#[test]
fn radii_of_a_file() {
    let folder = Folder::new();
    let radii = folder.write("radii", "C 1.0\n");
    let text = pdb(&[Record::carbon(1, [0.0; 3])]);
    let rows = table(&text, &["--sasa", "--radii", &radii, "--probe", "0.25"]);
    assert_near(rows.number(0, "area"), 4.0 * PI * 1.25 * 1.25, 1e-6);
    let comma = folder.write("comma", "C 1,7\n");
    assert_outcome("tess3", &["--sasa", "--radii", &comma, "-"], text.as_bytes(), 3, "decimals of a radius");
    // A sweep notices that the file has changed, and that its format is given.
    let input = folder.write("one.pdb", &text);
    let out = folder.path("out");
    let arguments = [&input[..], "--sasa", "--radii", &radii, "--out-dir", &out, "--resume"];
    let area = || {
        let output = run("tess3", &arguments, b"");
        assert!(output.status.success(), "{:?}", outcome(&output));
        let text = std::fs::read_to_string(format!("{out}/one.cells.tsv")).unwrap();
        Rows::new(&text).number(0, "area")
    };
    assert_near(area(), 4.0 * PI * 2.4 * 2.4, 1e-6);
    folder.write("radii", "C 2.0\n");
    assert_near(area(), 4.0 * PI * 3.4 * 3.4, 1e-6);
    let output = run("tess3", &[&arguments[..], &["--from", "mmcif"]].concat(), b"");
    assert_eq!(output.status.code(), Some(1), "{:?}", outcome(&output));
}

#[test]
fn errors_name_remedies() {
    let text = pdb(&[Record { element: "X", name: "Q", ..Record::carbon(1, [0.0; 3]) }]);
    assert_outcome("tess3", &["--sasa", "-"], text.as_bytes(), 2, "state it in a file for --radii");
    let carbon = pdb(&[Record::carbon(1, [0.0; 3])]);
    for (arguments, part) in [
        (&["--radii", "bondi", "--table"][..], "--radii goes with meshes, --sasa"),
        (&["--radii", "bondi", "--per", "chain"], "--per does not go with a mesh"),
        (&["--probe", "1"], "--probe needs --radii"),
        (&["--sasa", "--probe", "1.23456"], "three decimals"),
        (&["--sasa", "--probe=-1"], "--probe"),
        (&["--sasa", "--probe", "nan"], "--probe"),
        (&["--sasa", "--radii", "nowhere"], "expected a file of radii, or one of protor, bondi, united"),
        (&["--contact-areas", "--per", "molecule"], "a molecule has no pairs"),
        (&["--ses", "--sasa"], "cannot be used with"),
        (&["--ses", "--pockets"], "cannot be used with"),
        (&["--ses", "--min-area", "3"], "--min-area goes with --contact-areas"),
        (&["--filtration", "--radii", "bondi", "--per", "atom"], "--per does not go with --filtration"),
        (&["--within", "3"], "--within goes with --contact-areas"),
        (&["--contacts", "--between", "chains"], "--between goes with --contact-areas"),
        (&["--sasa", "--min-area", "3"], "--min-area goes with --contact-areas"),
    ] {
        assert_outcome("tess3", &[arguments, &["-"]].concat(), carbon.as_bytes(), 2, part);
    }
    assert_outcome("tess3", &["--sasa", "-"], b"1 2 3\n4 5 6\n", 2, "points have no elements");
}
