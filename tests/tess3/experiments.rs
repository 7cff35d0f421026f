//! Flags for experiments: they may change some outputs, and must not change others.

use super::mesh::Mesh;
use super::molecules::{Rows, cloud, pdb};
use crate::programs::{Folder, outcome, run};

fn mesh(text: &str, arguments: &[&str]) -> Mesh {
    let output = run("tess3", &[arguments, &["-q", "-"]].concat(), text.as_bytes());
    assert!(output.status.success(), "{arguments:?}: {:?}", outcome(&output));
    Mesh::read(&output.stdout)
}

fn stats(text: &str, arguments: &[&str]) -> serde_json::Value {
    let output =
        run("tess3", &[arguments, &["-q", "--stats=json", "-o", "/dev/null", "-"]].concat(), text.as_bytes());
    let (code, message) = outcome(&output);
    assert_eq!(code, Some(0), "{arguments:?}: {message}");
    serde_json::from_str(&message).unwrap()
}

#[test]
fn no_order_changes_the_triangulation() {
    let lattice: String = (0..216).map(|i| format!("{} {} {}\n", i % 6, i / 6 % 6, i / 36)).collect();
    for text in [pdb(&cloud(300, 9_000, 50)), lattice] {
        let expected = mesh(&text, &[]);
        expected.prove();
        for order in ["hilbert", "morton", "gray", "row-major", "random"] {
            for others in [&["--sequence", "pass"][..], &["--bit-levels", "on"], &["--seed", "7"]] {
                let found = mesh(&text, &[&["--order", order], others].concat());
                assert!(found.by_label() == expected.by_label(), "{order} {others:?}");
            }
        }
    }
}

#[test]
fn statistics_have_the_columns_of_the_thesis() {
    let text = pdb(&cloud(400, 9_000, 51));
    let found = stats(&text, &["--timed"]);
    let count = |key: &str| found[key].as_u64().unwrap_or_else(|| panic!("no {key} in {found}"));
    assert_eq!((count("models"), count("points"), count("vertices")), (1, 400, 400));
    assert_eq!(count("tetrahedra") as usize, mesh(&text, &[]).tetrahedra.len());
    assert!(count("tetrahedra_created") > count("tetrahedra"));
    assert!(count("in_sphere_tests") > 0);
    assert!((100..1000).contains(&(count("kernel_bytes") / 400)), "{found}");
    assert!(found["kernel_bytes_per_point"].as_f64().unwrap() > 100.0);
    let decisions: u64 = ["filter", "integer", "pairs", "residues", "bigint"]
        .map(|stage| count(&format!("predicates_{stage}")))
        .iter()
        .sum();
    assert!(decisions > 0);
    for part in ["", "_read", "_triangulate", "_order", "_locate", "_predicates", "_update", "_write"] {
        assert!(found[format!("seconds{part}")].as_f64().is_some(), "{part}: {found}");
    }
    assert!(stats(&text, &[])["seconds_locate"].is_null(), "what was not measured is not there");
}

#[test]
fn floating_point_is_right_where_nothing_is_rounded() {
    let text = pdb(&cloud(300, 1 << 10, 52));
    mesh(&text, &["--arithmetic", "float"]).prove();
    let found = stats(&text, &["--arithmetic", "float", "--check-signs"]);
    for key in ["wrong_signs", "wrong_zeros", "rounded", "missing"] {
        assert_eq!(found[key], 0, "{key}");
    }
    assert!(found["in_sphere_tests"].as_u64().unwrap() > 1000);
}

#[test]
fn floating_point_is_what_the_mesh_says_it_is() {
    let wide = pdb(&cloud(300, 1 << 23, 53));
    let found = stats(&wide, &["--arithmetic", "float", "--check-signs"]);
    assert!(found["rounded"].as_u64().unwrap() > 0, "{found}");
    assert!(mesh(&wide, &["--arithmetic", "float"]).producer.contains("floating-point"));
    assert!(!mesh(&wide, &[]).producer.contains("floating-point"));
    let (code, message) = outcome(&run("tess3", &["--check-signs", "-"], wide.as_bytes()));
    assert_eq!(code, Some(2));
    assert!(message.contains("--arithmetic float"), "{message}");
}

/// The audit counts with its own arithmetic. No tetrahedron here is inverted, so none counts twice there.
#[test]
fn sweeps_count_wrong_tetrahedra_as_the_audit_does() {
    let cylinder: String = (0..40)
        .flat_map(|z| (0..30).map(move |i| (f64::from(z), f64::from(i) * std::f64::consts::TAU / 30.0)))
        .map(|(z, angle)| format!("{} {} {z}\n", 10.0 * angle.cos(), 10.0 * angle.sin()))
        .collect();
    let folder = Folder::new();
    let files =
        [folder.write("cylinder.xyz", cylinder), folder.write("cloud.pdb", pdb(&cloud(300, 9_000, 54)))];
    let out = folder.path("out");
    let flags = ["--arithmetic", "float", "--out-dir", &out, &files[0], &files[1]];
    let output = run("tess3", &flags, &[]);
    assert!(output.status.success(), "{:?}", outcome(&output));
    let summary = Rows::new(&std::fs::read_to_string(folder.path("out/summary.tsv")).unwrap());
    for (file, is_wrong) in [("cylinder.xyz", true), ("cloud.pdb", false)] {
        let row = summary.of_file(file);
        let mesh = folder.path(&format!("out/{}", summary.text(row, "output")));
        let audit = run("spinfo", &["--audit", "--count-violations", "--json", &mesh], &[]);
        let audit: serde_json::Value = serde_json::from_slice(&audit.stdout).unwrap();
        let count = |key: &str| audit["census"]["exact"][key].as_u64().unwrap_or_else(|| panic!("{audit}"));
        assert_eq!(count("inverted"), 0);
        let found = summary.number(row, "violations") as u64;
        assert_eq!(found, count("flat") + count("inside"), "{file}");
        assert_eq!(found > 0, is_wrong, "{file}");
    }
}
