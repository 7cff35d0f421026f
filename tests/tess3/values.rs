//! Atoms with their values as temperature factors and as attributes, and pockets as spheres.

use std::fs;

use super::molecules::{Record, Rows, pdb};
use crate::programs::{Folder, assert_outcome, outcome, run, sample};

fn made(folder: &Folder, name: &str, arguments: &[&str]) -> String {
    let path = folder.path(name);
    let output = run("tess3", &[arguments, &["-q", "-o", &path]].concat(), b"");
    assert_eq!(outcome(&output), (Some(0), String::new()), "{arguments:?}");
    fs::read_to_string(path).unwrap()
}

fn table(arguments: &[&str]) -> Rows {
    Rows::new(&String::from_utf8(run("tess3", &[arguments, &["-q"]].concat(), b"").stdout).unwrap())
}

/// The lines of atoms.
fn atoms(text: &str) -> Vec<&str> {
    text.lines().filter(|line| line.starts_with("ATOM") || line.starts_with("HETATM")).collect()
}

#[test]
fn structures_have_values_as_temperature_factors() {
    let folder = Folder::new();
    let file = sample("1aki.cif");
    for (flags, column) in [(&["--sasa"][..], "area"), (&["--volumes"], "volume"), (&["--ses"], "area")] {
        let rows = table(&[&[&file[..]], flags].concat());
        let text = made(&folder, "a.pdb", &[&[&file[..]], flags].concat());
        assert_eq!(atoms(&text).len(), rows.len());
        for (row, line) in atoms(&text).into_iter().enumerate() {
            assert_eq!(line[60..66].trim(), format!("{:.2}", rows.number(row, column)));
        }
        // The atoms are the same ones.
        for name in ["a.pdb", "a.cif"] {
            made(&folder, name, &[&[&file[..]], flags].concat());
            let again = table(&[&[&folder.path(name)[..]], flags].concat());
            assert_eq!(again.len(), rows.len());
            for row in 0..rows.len() {
                for column in ["serial", "element", "class", column] {
                    assert_eq!(again.text(row, column), rows.text(row, column), "{name} {row}");
                }
                assert_eq!(again.label(row, ""), rows.label(row, ""));
            }
        }
    }
    let flags = [&file, "--classes", "polymer", "--sasa", "--per", "residue", "--relative", "tien"];
    let rows = table(&flags);
    let text = made(&folder, "r.pdb", &flags);
    let mut lines = atoms(&text).into_iter();
    for row in 0..rows.len() {
        for line in lines.by_ref().take(rows.number(row, "atoms") as usize) {
            assert_eq!(line[60..66].trim(), format!("{:.2}", rows.number(row, "relative")));
        }
    }
    let text = made(&folder, "r.defattr", &flags);
    let mut lines = text.lines();
    let head = ["attribute: tess3_relative", "match mode: any", "recipient: residues"];
    assert_eq!(lines.by_ref().take(3).collect::<Vec<_>>(), head);
    assert_eq!(lines.next(), Some(&format!("\t/A:1\t{:.4}", rows.number(0, "relative"))[..]));
    assert_eq!(lines.count(), rows.len() - 1);
    let text = made(&folder, "a.defattr", &[&file, "--sasa"]);
    assert!(text.contains("recipient: atoms\n\t/A:1@N\t"), "{text}");
}

#[test]
fn names_of_any_letters_are_written_in_mmcif() {
    let folder = Folder::new();
    let head = "data_a\nloop_\n_atom_site.id\n_atom_site.type_symbol\n_atom_site.label_atom_id\n\
                _atom_site.label_comp_id\n_atom_site.auth_asym_id\n_atom_site.auth_seq_id\n\
                _atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n";
    let names = ["O5'", "\"x\"", "\"a b' c\"", "'d\" e'", "'loop_'", "_x", "'?'"];
    let row = |(at, name): (usize, &&str)| {
        let name = if *name == "_x" { "'_x'" } else { name };
        format!("{} C {name} 'data_' 'A B' {at} {at}0 0 0\n", at + 1)
    };
    let text: String = names.iter().enumerate().map(row).collect();
    let file = folder.write("odd.cif", format!("{head}{text}"));
    made(&folder, "out.cif", &[&file, "--sasa"]);
    let [rows, again] = [&file, &folder.path("out.cif")].map(|file| table(&[file, "--sasa"]));
    assert_eq!(rows.len(), names.len());
    for row in 0..rows.len() {
        assert_eq!(again.label(row, ""), rows.label(row, ""));
        assert_eq!(again.text(row, "area"), rows.text(row, "area"));
    }
}

#[test]
fn pockets_are_spheres_between_atoms() {
    let range = || 0..=6;
    let sites = range().flat_map(|x| range().flat_map(move |y| range().map(move |z| [x, y, z])));
    let shell = sites.filter(|p: &[i32; 3]| p.iter().any(|&c| c == 0 || c == 6) && *p != [3, 3, 0]);
    let records: Vec<Record> =
        (1..).zip(shell).map(|(serial, p)| Record::carbon(serial, p.map(|c| f64::from(c) * 2.0))).collect();
    let folder = Folder::new();
    let file = folder.write("cage.pdb", pdb(&records));
    let flags = [&file[..], "--pockets", "--radii=bondi", "--probe", "0.2"];
    let pockets = table(&flags);
    let text = made(&folder, "pockets.pdb", &flags);
    let tetrahedra: f64 = (0..pockets.len()).map(|row| pockets.number(row, "tetrahedra")).sum();
    assert_eq!(atoms(&text).len() as f64, tetrahedra);
    for line in atoms(&text) {
        let at: Vec<f64> = [30, 38, 46].map(|i| line[i..i + 8].trim().parse().unwrap()).to_vec();
        let radius: f64 = line[60..66].trim().parse().unwrap();
        let gap = |record: &Record| {
            (0..3).map(|axis| (at[axis] - record.at[axis]).powi(2)).sum::<f64>().sqrt() - 1.7
        };
        let nearest = records.iter().map(gap).fold(f64::INFINITY, f64::min);
        assert!((nearest - radius).abs() < 0.01, "{line}: {nearest}");
        let number: usize = line[22..26].trim().parse().unwrap();
        assert_eq!(&line[17..20] == "VOI", pockets.text(number - 1, "kind") == "void");
    }
    assert!(text.contains("PCK") && text.ends_with("END\n"));
}

#[test]
fn what_does_not_fit_is_refused() {
    let folder = Folder::new();
    let file = folder.write("one.pdb", pdb(&[Record::carbon(1, [0.0; 3])]));
    let long =
        folder.write("long.cif", fs::read_to_string(sample("1aki.cif")).unwrap().replace(" A ", " AXP "));
    let (pdb, cif) = (folder.path("a.pdb"), folder.path("a.cif"));
    for (flags, part) in [
        (&[&file[..], "--sasa", "--volumes", "-o", &pdb][..], "an atom has one value"),
        (&[&file, "--sasa", "--resolution", "1", "-o", &pdb], "--resolution goes with -o FILE.ply"),
        (&[&file, "--pockets", "--per", "atom", "-o", &pdb], "leave out --mouths and --per"),
        (&[&file, "--sasa", "--gradients", "-o", &cif], "for tables"),
        (&[&file, "--sasa", "--per", "molecule", "-o", &cif], "no value of their own"),
        (&[&file, "--sasa", "--probe", "99", "-o", &pdb], "does not fit the columns of PDB: write mmCIF"),
        (&[&long, "--sasa", "-o", &pdb], "name of the chain \"AXP\" does not fit"),
    ] {
        assert_outcome("tess3", flags, b"", 2, part);
    }
    assert!(!fs::exists(&pdb).unwrap() && !fs::exists(&cif).unwrap());
}
