//! Columns that identify rows, and areas by kind, relative to maxima, and buried, against sums that are made
//! here.

use super::molecules::{Record, Rows, cloud, pdb};
use crate::programs::{assert_outcome, outcome, run, sample};

fn table(text: &str, flags: &[&str]) -> Rows {
    let output = run("tess3", &[flags, &["-"]].concat(), text.as_bytes());
    assert!(output.status.success(), "{flags:?}: {:?}", outcome(&output));
    Rows::new(&String::from_utf8(output.stdout).unwrap())
}

fn sum(rows: &Rows, column: &str) -> f64 {
    (0..rows.len()).map(|row| rows.number(row, column)).sum()
}

fn assert_near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-5 * (1.0 + expected.abs()), "{found}, not {expected}");
}

/// Chain, label of the chain, segment, residue, class, atom.
const MMCIF: &str = "data_a
loop_
_atom_site.group_PDB
_atom_site.id
_atom_site.type_symbol
_atom_site.label_atom_id
_atom_site.label_alt_id
_atom_site.label_comp_id
_atom_site.label_asym_id
_atom_site.auth_asym_id
_atom_site.auth_seq_id
_atom_site.pdbx_PDB_ins_code
_atom_site.Cartn_x
_atom_site.Cartn_y
_atom_site.Cartn_z
_atom_site.pdbx_PDB_model_num
ATOM 1 N N . GLY A H 82 A 0 0 0 1
ATOM 2 C CA B GLY A H 82 A 1.5 0 0 1
HETATM 3 ZN ZN . ZN B H 201 . 4 0 0 1
HETATM 4 O O . HOH C H 301 . 9 0 0 1
";

#[test]
fn columns_identify_atoms_residues_and_chains() {
    let fields = |rows: &Rows, row: usize, columns: &[&str]| {
        columns.iter().map(|column| rows.text(row, column).to_string()).collect::<Vec<_>>().join(" ")
    };
    let residue = ["file", "model", "chain", "label_chain", "segment", "residue_number", "insertion_code"];
    let residue = [&residue[..], &["residue_name", "class"]].concat();
    let atom = [&residue[..], &["atom_name", "element", "altloc", "serial"]].concat();
    let rows = table(MMCIF, &["--sasa"]);
    assert_eq!(fields(&rows, 1, &atom), "stdin 1 H A  82 A GLY polymer CA C B 2");
    assert_eq!(fields(&rows, 2, &atom), "stdin 1 H B  201  ZN ion ZN Zn  3");
    let rows = table(MMCIF, &["--sasa", "--per", "residue"]);
    assert_eq!(fields(&rows, 0, &residue), "stdin 1 H A  82 A GLY polymer");
    assert_eq!((rows.len(), rows.has("serial"), rows.text(2, "class")), (3, false, "water"));
    // A chain of several parts has no label of its own.
    let rows = table(MMCIF, &["--sasa", "--per", "chain"]);
    assert_eq!(fields(&rows, 0, &["chain", "label_chain", "atoms"]), "H  4");
    let rows = table(MMCIF, &["--sasa", "--per", "chain", "--classes", "polymer"]);
    assert_eq!(fields(&rows, 0, &["chain", "label_chain", "atoms"]), "H A 2");
    let rows = table(MMCIF, &["--contact-areas"]);
    let pair = ["chain1", "atom_name1", "element1", "serial1", "chain2", "atom_name2", "element2", "serial2"];
    assert_eq!(fields(&rows, 1, &pair), "H CA C 2 H ZN Zn 3");
    let rows = table(MMCIF, &["--pockets", "--per", "atom"]);
    assert!(atom.iter().all(|column| rows.has(column)));
    let line = Record { number: -3, ..Record::carbon(7, [0.0; 3]) }.line();
    let text = format!("{:<72}SEG1\n", line.trim_end().get(..66).unwrap());
    let rows = table(&text, &["--sasa"]);
    assert_eq!(fields(&rows, 0, &atom), "stdin 1 A A SEG1 -3  ALA polymer CA C  7");
}

#[test]
fn areas_by_kind_add_up_and_relative_ones_have_maxima() {
    let lysozyme = |flags: &[&str]| {
        let output = run("tess3", &[&[&sample("1aki.pdb")[..], "--sasa"], flags].concat(), b"");
        Rows::new(&String::from_utf8(output.stdout).unwrap())
    };
    let atoms = lysozyme(&[]);
    let rows = lysozyme(&["--per", "residue", "--by-kind", "--relative", "tien"]);
    let miller = lysozyme(&["--per", "residue", "--relative", "miller"]);
    let kinds = ["polar", "apolar", "main_chain", "side_chain"];
    let (mut at, mut waters) = (0, 0);
    for row in 0..rows.len() {
        let mut expected = [0.0; 4];
        for _ in 0..rows.number(row, "atoms") as usize {
            let (area, name) = (atoms.number(at, "area"), atoms.text(at, "atom_name"));
            let is_main = ["N", "CA", "C", "O", "OXT"].contains(&name);
            expected[usize::from(atoms.text(at, "element") == "C")] += area;
            if atoms.text(at, "class") == "polymer" {
                expected[if is_main { 2 } else { 3 }] += area;
            }
            at += 1;
        }
        kinds.iter().zip(expected).for_each(|(kind, expected)| assert_near(rows.number(row, kind), expected));
        let most = match rows.text(row, "residue_name") {
            "LYS" => (236.0, 211.0),
            "VAL" => (174.0, 160.0),
            "HOH" => {
                assert_eq!((rows.text(row, "relative"), miller.text(row, "relative")), ("", ""));
                waters += 1;
                continue;
            }
            _ => continue,
        };
        let area = rows.number(row, "area");
        assert_near(rows.number(row, "relative"), area / most.0);
        assert_near(miller.number(row, "relative"), area / most.1);
    }
    assert_eq!(at, atoms.len());
    assert!(waters > 0);
    let molecule = lysozyme(&["--per", "molecule", "--by-kind"]);
    kinds.iter().for_each(|kind| assert_near(molecule.number(0, kind), sum(&rows, kind)));
}

/// Hydrogens are of the kind of the atom that they are bonded to.
#[test]
fn hydrogens_are_of_the_kind_of_their_atom() {
    let atom = |serial, name, element, x| Record {
        name,
        element,
        number: 1,
        ..Record::carbon(serial, [x, 0.0, 0.0])
    };
    let carbon = [atom(1, "CB", "C", 0.0), atom(2, "HB1", "H", 1.1)];
    let nitrogen = [atom(3, "N", "N", 9.0), atom(4, "H", "H", 10.0)];
    let flags = ["--sasa", "--radii", "bondi", "--per", "molecule"];
    let part = |atoms: &[Record]| table(&pdb(atoms), &flags).number(0, "area");
    let rows =
        table(&pdb(&[carbon.clone(), nitrogen.clone()].concat()), &[&flags[..], &["--by-kind"]].concat());
    for (column, expected) in
        [("apolar", &carbon), ("side_chain", &carbon), ("polar", &nitrogen), ("main_chain", &nitrogen)]
    {
        assert_near(rows.number(0, column), part(expected));
    }
}

/// Three chains side by side, with a ligand in the second.
fn complex() -> Vec<Record> {
    let mut atoms = cloud(90, 12_000, 31);
    for atom in &mut atoms {
        atom.chain = ['A', 'B', 'C'][(atom.at[0] / 4.0) as usize];
    }
    atoms.sort_by_key(|atom| atom.chain);
    let at = atoms[40].at;
    for (number, x) in [(500, 1.0), (501, 2.0)] {
        let ligand = Record { residue: "ATP", record: "HETATM", chain: 'B', number, ..atoms[40].clone() };
        atoms.push(Record { serial: 2_000 + number as u32, at: [at[0] + x, at[1] + 1.0, at[2]], ..ligand });
    }
    atoms
}

#[test]
fn buried_areas_are_those_of_three_runs() {
    let text = pdb(&complex());
    let area = |flags: &[&str]| {
        let all = ["--sasa", "--per", "molecule", "--radii", "bondi"];
        table(&text, &[&all[..], flags].concat()).number(0, "area")
    };
    let flags = ["--buried-areas", "--radii", "bondi", "--classes", "polymer"];
    let rows = table(&text, &flags);
    let residues = table(&text, &[&flags[..], &["--per", "residue"]].concat());
    let atoms = table(&text, &[&flags[..], &["--per", "atom"]].concat());
    assert_eq!(
        rows.len(),
        3 - usize::from(
            !(0..rows.len()).any(|row| rows.label(row, "2") == "C" && rows.label(row, "1") == "A")
        )
    );
    for row in 0..rows.len() {
        let [p, q] = ["1", "2"].map(|end| rows.label(row, end));
        let polymer = |chains: &str| area(&["--classes", "polymer", "--chain", chains]);
        let expected = polymer(&p) + polymer(&q) - polymer(&format!("{p},{q}"));
        assert_near(rows.number(row, "buried1") + rows.number(row, "buried2"), expected);
        assert_near(rows.number(row, "buried"), expected / 2.0);
        for table in [&residues, &atoms] {
            let of_pair = (0..table.len()).filter(|&at| {
                let pair = [table.text(at, "chain"), table.text(at, "partner_chain")];
                pair == [&p[..], &q[..]] || pair == [&q[..], &p[..]]
            });
            assert_near(of_pair.map(|at| table.number(at, "buried")).sum(), expected);
        }
    }
    // A ligand against the chain that has its name: with a list, it is one part.
    let expected = area(&["--classes", "polymer"]) + area(&["--classes", "ligand"]) - area(&[]);
    for list in ["B/ATP", "B:500-501", "/ATP", "B:500,B:501/ATP"] {
        let rows = table(&text, &["--buried-areas", "--radii", "bondi", "--between", list]);
        assert_eq!(rows.len(), 1);
        assert_near(rows.number(0, "buried1") + rows.number(0, "buried2"), expected);
        // The list comes first; the ligand has two atoms.
        assert_eq!(rows.number(0, "atoms1"), 2.0);
    }
    let rows = table(&text, &["--buried-areas", "--radii", "bondi", "--between", "classes"]);
    let of_ligands =
        |row: usize| rows.text(row, "class2") == "ligand" && rows.text(row, "class1") == "polymer";
    assert!(!rows.rows.is_empty() && (0..rows.len()).all(of_ligands));
    assert_eq!((rows.text(0, "residue_number1"), rows.text(0, "residue_name2")), ("", "ATP"));
    let large =
        table(&text, &["--buried-areas", "--radii", "bondi", "--between", "classes", "--min-area", "9"]);
    assert_eq!(large.len(), (0..rows.len()).filter(|&row| rows.number(row, "buried") >= 9.0).count());
}

#[test]
fn contacts_between_classes_and_lists() {
    let text = pdb(&complex());
    let all = table(&text, &["--contact-areas"]);
    let is_ligand = |row: usize, end: &str| all.text(row, &format!("class{end}")) == "ligand";
    let expected: Vec<_> = (0..all.len())
        .filter(|&row| is_ligand(row, "1") != is_ligand(row, "2"))
        .map(|row| &all.rows[row])
        .collect();
    assert!(!expected.is_empty());
    for between in ["classes", "B/ATP", "B:500-501"] {
        let found = table(&text, &["--contact-areas", "--between", between]);
        assert_eq!(found.rows.iter().collect::<Vec<_>>(), expected, "{between}");
    }
}

#[test]
fn flags_that_do_not_fit_together_are_refused() {
    let text = pdb(&complex());
    for (flags, part) in [
        (
            &["--contact-areas", "--between", "D:1"][..],
            "has no residue \"D:1\", only chain A, chain B, chain C",
        ),
        (&["--contact-areas", "--between", "A:9-1"], "names no residues"),
        (
            &["--buried-areas", "--between", "B/ATP", "--classes", "polymer"],
            "no atom that was selected is in the residues B/ATP",
        ),
        (&["--sasa", "--between", "chains"], "--between goes with --contact-areas or --buried-areas"),
        (&["--buried-areas", "--within", "3"], "--within goes with --contact-areas"),
        (&["--buried-areas", "--per", "molecule"], "--buried-areas needs --per atom"),
        (&["--buried-areas", "--between", "residues"], "--between chains, classes or a list"),
        (&["--sasa", "--by-kind"], "--by-kind goes with"),
        (&["--sasa", "--relative", "tien", "--per", "chain"], "--relative goes with --sasa --per residue"),
        (&["--sasa", "--relative", "rose"], "tien"),
        (&["--sasa", "--gradients", "--per", "residue"], "--gradients goes with"),
        (&["--ses", "--gradients"], "--gradients goes with"),
    ] {
        assert_outcome("tess3", &[flags, &["-"]].concat(), text.as_bytes(), 2, part);
    }
}
