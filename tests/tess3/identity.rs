//! Residues and chains are told by their places in the file, not by their labels alone.

use std::fmt::Write;

use super::molecules::Rows;
use crate::programs::{assert_outcome, outcome, run};

/// The atoms of residues `chain residue number segment`; "TER" ends a chain.
fn pdb(residues: &[&str], atoms: &[&str]) -> String {
    let (mut text, mut serial) = (String::new(), 0);
    for residue in residues {
        let [chain, name, number, segment] = residue.split(' ').collect::<Vec<_>>()[..] else {
            text += "TER\n";
            continue;
        };
        for atom in atoms {
            serial += 1;
            let (x, y, z) = (f64::from(serial), f64::from(serial % 7), f64::from(serial % 3));
            writeln!(
                text,
                "ATOM  {serial:>5}  {atom:<3} {name:>3} {chain:>1}{number:>4}    {x:>8.3}{y:>8.3}{z:>8.3}  1.00\
                 {segment:>16}"
            )
            .unwrap();
        }
    }
    text
}

/// Labels and counts of atoms of the rows, and the notices.
fn rows(text: &str, flags: &[&str]) -> (Vec<String>, String) {
    let output = run("tess3", &[&["--sasa", "--radii", "bondi", "-"], flags].concat(), text.as_bytes());
    assert!(output.status.success(), "{flags:?}: {:?}", outcome(&output));
    let table = Rows::new(std::str::from_utf8(&output.stdout).unwrap());
    let count = if table.has("serial") { "serial" } else { "atoms" };
    let row = |row: usize| format!("{} {}", table.label(row, ""), table.text(row, count));
    ((0..table.len()).map(row).collect(), String::from_utf8(output.stderr).unwrap())
}

fn assert_rows(text: &str, level: &str, expected: &[&str], notice: &str) {
    let (found, notices) = rows(text, &["--per", level]);
    assert_eq!(found, expected, "{text}");
    assert!(
        notices.contains(notice) && notices.contains("share their labels") != notice.is_empty(),
        "{notices}"
    );
}

#[test]
fn segments_are_chains_without_names() {
    let text = pdb(&[" ALA 1 PROA", " ALA 1 PROB"], &["N", "CA", "C"]);
    assert_rows(&text, "residue", &["PROA/ALA/1 3", "PROB/ALA/1 3"], "");
    assert_rows(&text, "chain", &["PROA 3", "PROB 3"], "");
    // With a name, the name counts, but residues are still apart.
    let named = pdb(&["A ALA 1 PROA", "A ALA 1 PROB"], &["N", "CA", "C"]);
    assert_rows(&named, "residue", &["A/ALA/1 3", "A/ALA/1 3"], "2 residues share their labels");
    assert_rows(&named, "chain", &["A 6"], "");
    // Older files have their code and the number of the line there.
    let old = text.replace("PROA", "1ABC   1").replace("PROB", "1ABC   2");
    assert_rows(&old, "residue", &["/ALA/1 6"], "");
}

#[test]
fn what_ends_a_chain_separates_copies() {
    let copies = [" ALA 1 ", " GLY 2 ", "TER", " ALA 1 ", " GLY 2 ", "TER"];
    let text = pdb(&copies, &["N", "CA"]);
    let expected = ["/ALA/1 2", "/GLY/2 2", "/ALA/1 2", "/GLY/2 2"];
    assert_rows(&text, "residue", &expected, "4 residues share their labels: serial");
    assert_rows(&text, "chain", &[" 4", " 4"], "2 chains share their labels");
    // A name is that of one chain as long as its numbers go on. Water may be counted from 1.
    for (residues, chains) in [
        (&["A ALA 1 ", "TER", "A ALA 2 ", "TER", "A HOH 1 "][..], &["A 6"][..]),
        (&["A ALA 1 ", "TER", "A ALA 1 "], &["A 2", "A 2"]),
        (&["A ALA 1 ", "TER", "B ALA 1 ", "TER", "A LIG 2 ", "B LIG 2 "], &["A 4", "B 4"]),
        (&[" ALA 1 ", "TER", " ALA 2 ", "TER", " HOH 3 "], &[" 2", " 4"]),
    ] {
        assert_eq!(rows(&pdb(residues, &["N", "CA"]), &["--per", "chain"]).0, chains, "{residues:?}");
    }
    let contacts = ["--contact-areas", "--between", "chains", "--radii", "bondi", "-"];
    let text = pdb(&[" ALA 1 ", "TER", " ALA 1 "], &["N"]);
    let output = run("tess3", &contacts, text.as_bytes());
    assert_eq!(String::from_utf8(output.stdout).unwrap().lines().count(), 2);
    assert!(String::from_utf8(output.stderr).unwrap().contains("2 chains share their labels"));
}

#[test]
fn numbers_that_start_again_are_new_residues() {
    for numbers in [["9999", "0", "9999"], ["ffff", "A000", "ffff"]] {
        let residues = numbers.map(|number| format!("W HOH {number} "));
        let text = pdb(&residues.each_ref().map(String::as_str), &["O"]);
        let (found, notices) = rows(&text, &["--per", "residue"]);
        assert_eq!(found.len(), 3, "{found:?}");
        assert!(notices.contains("2 residues share their labels"), "{notices}");
    }
    // Without numbers, an atom that comes again is one of another residue.
    let text = pdb(&["W HOH  ", "W HOH  ", "W HOH **** "], &["O", "H1"]);
    assert_rows(&text, "residue", &["W/HOH/ 2", "W/HOH/ 2", "W/HOH/ 2"], "3 residues share their labels");
}

#[test]
fn alternate_locations_are_of_one_residue() {
    let mut lines: Vec<String> =
        pdb(&["A PRO 2 ", "A SER 2 ", "A GLY 3 "], &["N", "CA"]).lines().map(str::to_string).collect();
    for (line, altloc) in lines.iter_mut().zip(["A", "A", "B", "B"]) {
        line.replace_range(16..17, altloc);
    }
    // The residues at one place alternate atom by atom.
    lines.swap(1, 2);
    let text = lines.join("\n") + "\n";
    let (found, notices) = rows(&text, &["--per", "residue", "--altloc", "all"]);
    assert_eq!(found, ["A/PRO/2 2", "A/SER/2 2", "A/GLY/3 2"]);
    assert!(!notices.contains("labels"), "{notices}");
    assert_rows(&text, "residue", &["A/PRO/2 2", "A/GLY/3 2"], "");
}

fn mmcif(tags: &str, rows: &str) -> String {
    let tags: String = tags.split(' ').map(|tag| format!("_atom_site.{tag}\n")).collect();
    format!("data_a\nloop_\n{tags}{rows}")
}

#[test]
fn waters_without_numbers_are_residues() {
    let tags = "group_PDB id type_symbol label_atom_id label_alt_id label_comp_id auth_asym_id label_seq_id \
                Cartn_x Cartn_y Cartn_z";
    let waters = "ATOM 1 C CA . ALA A 7 0 0 0\nATOM 2 C CB . ALA A 7 1.5 0 0\nHETATM 3 O O . HOH A . 9 0 0\n\
                  HETATM 4 O O . HOH A . 19 0 0\nHETATM 5 O O A HOH A . 29 0 0\n\
                  HETATM 6 O O B HOH A . 29 1 0\n";
    let text = mmcif(tags, waters);
    let (found, _) = rows(&text, &["--per", "residue", "--altloc", "all"]);
    assert_eq!(found, ["A/ALA/7 2", "A/HOH/ 1", "A/HOH/ 1", "A/HOH/ 2"]);
}

/// A slash in a name is no separator where slashes are.
#[test]
fn slashes_in_names_are_written_as_numbers_in_labels() {
    let text = mmcif(
        "id type_symbol label_atom_id label_comp_id auth_asym_id auth_seq_id Cartn_x Cartn_y Cartn_z",
        "1 C 'C/A' 'L/G' 'A/B' 1 0 0 0\n2 O O* L%G '' 2 5 0 0\n",
    );
    assert_eq!(rows(&text, &[]).0, ["A/B/L/G/1/C/A 1", "/L%G/2/O* 2"]);
    let four = text.clone() + "3 O O L 'A/B' 3 0 5 0\n4 O O L 'A/B' 4 0 0 5\n";
    let table = run("tess3", &["--table", "-"], four.as_bytes());
    let table = Rows::new(std::str::from_utf8(&table.stdout).unwrap());
    assert_eq!([table.text(0, "atom1"), table.text(0, "atom2")], ["A%2FB/L%2FG/1/C%2FA", "/L%25G/2/O*"]);
    assert_eq!(rows(&text, &["--per", "chain"]).0, ["A/B 1", " 1"]);
}

#[test]
fn models_are_said_and_may_be_joined() {
    let model = pdb(&["A ALA 1 ", "B ALA 1 "], &["N", "CA"]);
    let moved = model.replace(".000  1.00", ".500  1.00");
    let text = format!("MODEL        1\n{model}ENDMDL\nMODEL        2\n{moved}ENDMDL\n");
    let (found, notices) = rows(&text, &["--per", "chain"]);
    assert_eq!(found, ["A 2", "B 2"]);
    assert!(notices.contains("only the first of 2 models is taken: see --model N"), "{notices}");
    for model in ["1", "2"] {
        assert!(!rows(&text, &["--per", "chain", "--model", model]).1.contains("models"));
    }
    let (found, notices) = rows(&text, &["--per", "chain", "--model", "joined"]);
    assert_eq!(found, ["A 2", "B 2", "A-2 2", "B-2 2"]);
    assert!(!notices.contains("models"), "{notices}");
    let (found, _) = rows(&text, &["--model", "joined", "--chain", "B-2"]);
    assert_eq!(found, ["B-2/ALA/1/N 7", "B-2/ALA/1/CA 8"]);
    assert_outcome("tess3", &["--sasa", "--model", "both", "-"], &[], 2, "all or joined");
}

/// What is not of a polymer counts by default, which a table does not tell.
#[test]
fn other_molecules_are_counted_in_a_notice() {
    let text = pdb(&["A ALA 1 ", "A HOH 2 ", "A HOH 3 ", "A LIG 4 "], &["N"]);
    let words = "count, too: 1 of ligands, 2 of water; see --classes polymer";
    let flags: [(&[&str], bool); 4] = [
        (&["--sasa"], true),
        (&["--contact-areas"], true),
        (&["--contacts"], true),
        (&["--sasa", "--classes", "polymer"], false),
    ];
    for (flags, expected) in flags {
        let (_, message) = outcome(&run("tess3", &[flags, &["-"]].concat(), text.as_bytes()));
        assert_eq!(message.contains(words), expected, "{flags:?}: {message}");
        assert_eq!(message.contains("--classes polymer"), expected, "{flags:?}: {message}");
    }
    let waters = pdb(&["A HOH 2 ", "A HOH 3 "], &["O"]);
    let (_, message) = outcome(&run("tess3", &["--sasa", "-"], waters.as_bytes()));
    assert!(!message.contains("--classes"), "{message}");
}
