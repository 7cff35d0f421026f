//! Voronoi and Laguerre cells, and periodic boxes, from the command line.

use std::f64::consts::PI;

use super::frames::sample;
use super::molecules::{Record, Rows, pdb};
use crate::programs::{Folder, assert_outcome, outcome, run};
use spmesh_base::limits::IMAGES_SMALL;

/// Coordinates are multiples of 0.001 Å.
const ATOMS: [[f64; 3]; 4] = [[1.0, 2.0, 3.0], [8.5, 2.25, 3.5], [4.0, 7.0, 9.5], [-3.0, 24.0, 5.125]];

const CRYST1: &str = "CRYST1   10.000   11.000   12.000  90.00  90.00  90.00 P 1           1\n";

fn table(text: &str, arguments: &[&str]) -> Rows {
    let output = run("tess3", &[arguments, &["-"]].concat(), text.as_bytes());
    assert!(output.status.success(), "{:?}", outcome(&output));
    Rows::new(&String::from_utf8(output.stdout).unwrap())
}

fn structure(moved: [f64; 3]) -> String {
    let atoms = ATOMS.map(|p| [0, 1, 2].map(|axis| p[axis] + moved[axis]));
    let records: Vec<Record> = (1..).zip(atoms).map(|(serial, at)| Record::carbon(serial, at)).collect();
    CRYST1.to_string() + &pdb(&records)
}

fn texts(rows: &Rows, columns: &[&str]) -> Vec<Vec<String>> {
    (0..rows.len())
        .map(|row| columns.iter().map(|&name| rows.text(row, name).to_string()).collect())
        .collect()
}

#[test]
fn volumes_add_up_to_the_box_wherever_it_begins() {
    const COLUMNS: [&str; 6] = ["serial", "cell", "volume", "area", "faces", "density"];
    let first = table(&structure([0.0; 3]), &["--periodic", "--cells"]);
    let sum: f64 = (0..first.len()).map(|row| first.number(row, "volume")).sum();
    assert!((sum - 1320.0).abs() < 1e-5);
    // Exactly the same, as all numbers are multiples of 0.001.
    let moved = table(&structure([-17.125, 3.5, 100.0]), &["--periodic", "--cells"]);
    assert_eq!(texts(&first, &COLUMNS), texts(&moved, &COLUMNS));
    let stated = table(&structure([0.0; 3]), &["--box", "10,11,12", "--cells"]);
    assert_eq!(texts(&first, &COLUMNS), texts(&stated, &COLUMNS));
    let skewed = table(&structure([0.0; 3]), &["--box", "10,0,0,-20,11,0,30,-11,12", "--cells"]);
    assert_eq!(texts(&first, &COLUMNS), texts(&skewed, &COLUMNS));
    let all =
        table(&structure([0.0; 3]), &["--periodic", "--cells", "--radii", "bondi", "--per", "molecule"]);
    assert_eq!(texts(&all, &["atoms", "cell", "volume"]), [["4", "bounded", "1320"]]);
}

#[test]
fn neighbours_have_the_shift_of_their_image() {
    let text = "1\nLattice=\"4 0 0 0 5 0 0 0 6\" Properties=species:S:1:pos:R:3\nC 1 1 1\n";
    let rows = table(text, &["--periodic", "--cells", "--faces"]);
    let shifts = ["shift_a", "shift_b", "shift_c", "distance", "face", "area"];
    let expected = [
        ["0", "0", "1", "6", "bounded", "20"],
        ["0", "1", "0", "5", "bounded", "24"],
        ["1", "0", "0", "4", "bounded", "30"],
    ];
    assert_eq!(texts(&rows, &shifts), expected);
    let cells = table(text, &["--periodic", "--cells"]);
    assert_eq!(texts(&cells, &["cell", "volume", "area", "faces"]), [["bounded", "120", "148", "6"]]);
    assert!((cells.number(0, "density") - 1.0 / 120.0).abs() < 1e-9);
}

#[test]
fn areas_and_contacts_count_images() {
    let atoms = [Record::carbon(1, [0.5, 5.0, 5.0]), Record::carbon(2, [9.0, 5.0, 5.0])];
    let text = CRYST1.to_string() + &pdb(&atoms);
    let flags = ["--radii", "bondi", "--probe", "0"];
    let alone = table(&text, &[&flags[..], &["--sasa"]].concat());
    assert!((alone.number(0, "area") - 4.0 * PI * 1.7 * 1.7).abs() < 1e-6);
    let areas = table(&text, &[&flags[..], &["--sasa", "--periodic"]].concat());
    assert!((areas.number(0, "area") - 2.0 * PI * 1.7 * (1.7 + 0.75)).abs() < 1e-6);
    let contacts = table(&text, &[&flags[..], &["--contact-areas", "--periodic"]].concat());
    let columns = ["serial1", "serial2", "shift_a", "shift_b", "shift_c", "distance"];
    assert_eq!(texts(&contacts, &columns), [["1", "2", "-1", "0", "0", "1.5"]]);
    assert!((contacts.number(0, "area") - PI * (1.7 * 1.7 - 0.75 * 0.75)).abs() < 1e-6);
    let residues =
        table(&text, &[&flags[..], &["--contact-areas", "--periodic", "--per", "residue"]].concat());
    assert_eq!(texts(&residues, &["contacts"]), [["1"]]);
}

#[test]
fn unbounded_cells_have_no_numbers() {
    // The cell of the middle is the octahedron |x| + |y| + |z| <= 3/2.
    let cube = "0 0 0\n2 0 0\n0 2 0\n2 2 0\n0 0 2\n2 0 2\n0 2 2\n2 2 2\n1 1 1\n1 1 1\n";
    let rows = table(cube, &["--cells"]);
    assert_eq!(texts(&rows, &["cell", "volume", "density"])[0], ["unbounded", "", ""]);
    assert_eq!(texts(&rows, &["cell", "volume"])[8..], [["bounded", "4.5"], ["duplicate", "0"]]);
    // Two points, and a star that fills the cube.
    assert_eq!([rows.number(8, "density"), rows.number(9, "density")], [1.0, 1.0]);
    let json = run("tess3", &["--cells", "--format", "jsonl", "-"], cube.as_bytes());
    assert!(String::from_utf8(json.stdout).unwrap().contains("\"cell\":\"unbounded\",\"volume\":null"));
    let flat = table("0 0 0\n1 0 0\n0 1 0\n", &["--cells"]);
    assert_eq!(texts(&flat, &["cell", "volume", "faces"])[0], ["flat", "", ""]);
}

#[test]
fn what_has_no_box_or_takes_none_is_refused() {
    let atoms = pdb(&[Record::carbon(1, [0.0; 3])]);
    let refused = |arguments: &[&str], part: &str| {
        assert_outcome("tess3", &[arguments, &["-"]].concat(), atoms.as_bytes(), 2, part);
    };
    refused(&["--periodic", "--cells"], "states no periodic box");
    refused(&["--periodic"], "--cells, --sasa");
    refused(&["--box", "9,9,9", "--pockets"], "--cells, --sasa");
    refused(&["--box", "9,9,9", "--contacts"], "--cells --faces");
    refused(&["--box", "9,9,9", "--sasa", "-o", "surface.ply"], "no mesh");
    refused(&["--box", "9,9,9", "--sasa", "--gradients"], "without images");
    refused(&["--box", "9,9,9", "--buried-areas"], "--cells, --sasa");
    refused(&["--box", "9,9", "--cells"], "2 numbers");
    refused(&["--box", "9,9,0", "--cells"], "side of 0");
    refused(&["--faces"], "--cells");
    refused(&["--cells", "--faces", "--per", "chain"], "--per atom");
    refused(&["--cells", "--probe", "1"], "--radii");
    refused(&["--box", "1,1,1000000", "--cells"], &format!("more than {IMAGES_SMALL} images"));
    let damaged =
        "CRYST1   10.000   1x.000   12.000  90.00  90.00  90.00 P 1           1\n".to_string() + &atoms;
    assert_outcome("tess3", &["--periodic", "--cells", "-"], damaged.as_bytes(), 2, "line 1");
    let crystal = CRYST1.replace("P 1  ", "P 21 ") + &atoms;
    assert_outcome("tess3", &["--periodic", "--cells", "-"], crystal.as_bytes(), 0, "space group is P 21");
}

/// Each file of a sweep has its own box, and those without one fail.
#[test]
fn sweeps_take_the_box_of_each_file() {
    let folder = Folder::new();
    let with = folder.write("with.pdb", structure([0.0; 3]));
    let without = folder.write("without.pdb", pdb(&[Record::carbon(1, [0.0; 3])]));
    let out = folder.path("out");
    assert_outcome(
        "tess3",
        &["--periodic", "--cells", "--out-dir", &out, &with, &without],
        b"",
        1,
        "no periodic box",
    );
    let cells = std::fs::read_to_string(format!("{out}/with.voronoi-cells.tsv")).unwrap();
    assert_eq!(cells.lines().count(), 5);
    let summary = std::fs::read_to_string(format!("{out}/summary.tsv")).unwrap();
    assert!(summary.contains("--cells --periodic"), "{summary}");
}

#[test]
fn frames_repeat_in_their_own_boxes() {
    let volumes = |arguments: &[&str]| {
        let output =
            run("tess3", &[&["--periodic", "--cells", "--per", "molecule"], arguments].concat(), b"");
        assert!(output.status.success(), "{:?}", outcome(&output));
        let rows = Rows::new(&String::from_utf8(output.stdout).unwrap());
        texts(&rows, &["frame", "atoms", "volume"])
    };
    let [gro, xtc, trr, dcd] = ["gro", "xtc", "trr", "dcd"].map(|ending| sample(&format!("frames.{ending}")));
    let cubes = ["0", "1", "2"].map(|frame| [frame, "170", "216000"]);
    for trajectory in [&gro, &xtc, &trr, &dcd] {
        assert_eq!(volumes(&["--top", &gro, "--frames", "::", trajectory]), cubes);
    }
    // Another box in each frame, of which the last is none.
    let text = std::fs::read_to_string(&gro).unwrap();
    let mut parts = text.split("   6.00000   6.00000   6.00000\n");
    let boxes = ["6 6 6", "6 5 7 0 0 1 0 -2 1.5", "0 0 0"];
    let frames: String = boxes.iter().map(|sides| parts.next().unwrap().to_string() + sides + "\n").collect();
    let folder = Folder::new();
    let file = folder.write("boxes.gro", frames);
    for top in [&[][..], &["--top", &gro]] {
        let found = volumes(&[top, &["--frames", ":2", &file]].concat());
        assert_eq!(found, [["0", "170", "216000"], ["1", "170", "210000"]]);
        let arguments = [&["--periodic", "--cells", "--frames", "::"], top, &[&file]].concat();
        assert_outcome("tess3", &arguments, b"", 2, "frame 2 states no periodic box");
        // A stated box holds for all frames.
        let arguments = [&["--box", "100,50,50", "--frames", "2"], top, &[&file]].concat();
        assert_eq!(volumes(&arguments), [["2", "170", "250000"]]);
    }
}
