//! Which atoms are triangulated, by default and on request.

use super::mesh::Mesh;
use super::molecules::{Record, cloud, pdb};
use crate::programs::{outcome, run};

/// Twelve atoms of chain A, one of them a hydrogen; eight of chain B; two ions and three waters; one atom has
/// two alternate locations.
fn molecule() -> String {
    let mut atoms = cloud(26, 9_000, 40);
    for (i, atom) in atoms.iter_mut().enumerate() {
        atom.name = if i % 4 == 0 { "CA" } else { "CB" };
        match i {
            3 => (atom.name, atom.element) = ("HA", "H"),
            12..20 => atom.chain = 'B',
            20 | 21 => {
                (atom.record, atom.residue, atom.name, atom.element) = ("HETATM", "CA", "CA", "CA");
            }
            22..25 => {
                (atom.record, atom.residue, atom.name, atom.element) = ("HETATM", "HOH", "O", "O");
            }
            _ => {}
        }
    }
    let twin = atoms[25].clone();
    (atoms[25].altloc, atoms[25].occupancy) = ('A', 0.4);
    atoms.push(Record { altloc: 'B', occupancy: 0.6, serial: 270, at: [1.0, 2.0, 3.0], ..twin });
    pdb(&atoms)
}

fn serials(arguments: &[&str]) -> Vec<u64> {
    let output = run("tess3", &[arguments, &["-"]].concat(), molecule().as_bytes());
    assert!(output.status.success(), "{:?}", outcome(&output));
    let mut labels = Mesh::read(&output.stdout).labels;
    labels.sort_unstable();
    labels
}

fn tens(numbers: impl IntoIterator<Item = u64>) -> Vec<u64> {
    numbers.into_iter().map(|i| 10 * i).collect()
}

#[test]
fn by_default_all_atoms_but_only_the_best_location() {
    assert_eq!(serials(&[]), tens((1..=25).chain([27])));
}

#[test]
fn flags_choose_atoms() {
    let cases: [(&[&str], Vec<u64>); 10] = [
        (&["--altloc", "first"], tens(1..=26)),
        (&["--altloc", "A"], tens(1..=26)),
        (&["--altloc", "B"], tens((1..=25).chain([27]))),
        (&["--altloc", "all"], tens(1..=27)),
        (&["--altloc", "C"], tens(1..=25)),
        (&["--hetatm", "off"], tens((1..=20).chain([27]))),
        (&["--atoms", "heavy"], tens((1..=3).chain(5..=25).chain([27]))),
        (&["--atoms", "ca"], tens([1, 5, 9, 13, 17])),
        (&["--chain", "B"], tens(13..=20)),
        (&["--chain", "B,A", "--atoms", "ca", "--hetatm", "off"], tens([1, 5, 9, 13, 17])),
    ];
    for (arguments, expected) in cases {
        assert_eq!(serials(arguments), expected, "{arguments:?}");
    }
}

#[test]
fn a_location_that_is_missing_is_a_notice() {
    let cases: [(&[&str], &str); 3] = [
        (&["--altloc", "C"], "no atom has the alternate location \"C\", only A, B"),
        (&["--altloc", "A", "--chain", "B"], "no atom has the alternate location \"A\", nor any other"),
        (&["--altloc", "A"], ""),
    ];
    for (arguments, words) in cases {
        let output = run("tess3", &[arguments, &["-"]].concat(), molecule().as_bytes());
        assert!(output.status.success());
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(
            message.contains(words) && message.is_empty() == words.is_empty(),
            "{arguments:?}: {message}"
        );
    }
}

#[test]
fn nothing_selected_is_an_error_that_says_what_there_is() {
    let waters: Vec<Record> = cloud(5, 9_000, 41)
        .into_iter()
        .map(|atom| Record { record: "HETATM", residue: "HOH", name: "O", element: "O", chain: 'W', ..atom })
        .collect();
    type Case<'a> = (String, &'a [&'a str], &'a [&'a str]);
    let cases: [Case; 5] = [
        (pdb(&waters), &["--hetatm", "off"], &["of 5", "5 HETATM", "chain W", "--hetatm on"]),
        (pdb(&waters), &["--atoms", "ca"], &["no atom is selected", "--atoms all", "would be 5"]),
        (molecule(), &["--chain", "C"], &["\"C\"", "A, B"]),
        (molecule(), &["--model", "7"], &["\"7\"", "1"]),
        ("1 2 3\n4 5 6\n".into(), &["--chain", "A"], &["without names"]),
    ];
    for (text, arguments, words) in cases {
        for product in [&[][..], &["--table"], &["--contacts"]] {
            let arguments = [arguments, product, &["-"]].concat();
            let output = run("tess3", &arguments, text.as_bytes());
            let (code, message) = outcome(&output);
            assert_eq!(code, Some(2), "{arguments:?}: {message}");
            let mark: &[u8] = if product.is_empty() { b"\nspmesh: failed 002\n" } else { b"" };
            assert!(output.stdout == mark);
            for word in words {
                assert!(message.contains(word), "{arguments:?}: no {word:?} in {message}");
            }
        }
    }
}
