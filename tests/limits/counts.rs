//! Limits of what multiplies at both sides: assemblies, links, lines of contours.

use std::f64::consts::TAU;
use std::fmt::Write;

use spmesh_base::limits::{
    ASSEMBLY_CHAINS_MAX, ASSEMBLY_COPIES_MAX, CONTOURS_PER_TRIANGLE_MAX, CONTOURS_PER_TRIANGLE_MEAN_MAX,
    LINK_VERTICES_MAX,
};

use super::sides::assert_sides;
use crate::programs::{Folder, outcome, run};

/// A structure of one atom in chain A, with so many operators, and an assembly of these parts: operators and
/// chains.
fn assembly(operators: usize, parts: &[(&str, &str)]) -> String {
    let mut text = "data_a\nloop_\n_pdbx_struct_assembly_gen.assembly_id\n\
                    _pdbx_struct_assembly_gen.oper_expression\n_pdbx_struct_assembly_gen.asym_id_list\n"
        .to_string();
    parts.iter().for_each(|(operators, chains)| writeln!(text, "1 {operators} {chains}").unwrap());
    text += "loop_\n_pdbx_struct_oper_list.id\n";
    for row in 1..=3 {
        (1..=3).for_each(|at| writeln!(text, "_pdbx_struct_oper_list.matrix[{row}][{at}]").unwrap());
        writeln!(text, "_pdbx_struct_oper_list.vector[{row}]").unwrap();
    }
    let (wide, deep) = (|i: usize| i % 128, |i: usize| i / 128);
    for i in 1..=operators {
        writeln!(text, "{i} 1 0 0 {} 0 1 0 {} 0 0 1 {}", wide(i), deep(i), i * i % 97).unwrap();
    }
    text + "loop_\n_atom_site.id\n_atom_site.label_asym_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n\
            _atom_site.Cartn_z\n1 A 0 0 0\n"
}

#[test]
fn assemblies() {
    let table = ["tess3", "--assembly", "1", "--table", "-o", "/dev/null", "-"];
    let copies = |count: usize| assembly(count, &[(&format!("1-{count}"), "A")]).into_bytes();
    assert_sides(&table, ASSEMBLY_COPIES_MAX, "more than 16384 operators", copies);
    // As many operators as there may be, and the last one has the chains that are beyond the others.
    let names = |count: usize| (1..count).fold("A".to_string(), |all, chain| format!("{all},X{chain}"));
    let each = ASSEMBLY_CHAINS_MAX / ASSEMBLY_COPIES_MAX;
    let first = format!("1-{}", ASSEMBLY_COPIES_MAX - 1);
    let chains = |count: usize| {
        let last = names(count - each * (ASSEMBLY_COPIES_MAX - 1));
        let parts = [(&first[..], &names(each)[..]), (&ASSEMBLY_COPIES_MAX.to_string(), &last)];
        assembly(ASSEMBLY_COPIES_MAX, &parts).into_bytes()
    };
    assert_sides(&table, ASSEMBLY_CHAINS_MAX, "more than 1048576 copies of chains", chains);
}

/// A knot in the middle of a circle of others is linked with all of them.
#[test]
fn links_without_circles() {
    let star = |count: usize| {
        let mut text = "0 0\n".to_string();
        for i in 0..count {
            let angle = TAU * i as f64 / count as f64;
            writeln!(text, "{:.6} {:.6}", 1000.0 * angle.cos(), 1000.0 * angle.sin()).unwrap();
        }
        text.into_bytes()
    };
    let configgen = ["configgen", "--degree", "1", "--rule", "random", "-o", "/dev/null", "-"];
    assert_sides(&configgen, LINK_VERTICES_MAX, "it has 513 vertices", star);
}

/// Levels are the whole numbers from 1 on, and both triangles have all of them.
#[test]
fn levels_on_average() {
    let folder = Folder::new();
    let most = (CONTOURS_PER_TRIANGLE_MAX + 2 * CONTOURS_PER_TRIANGLE_MEAN_MAX) / 2;
    for (top, is_refused) in [(most, false), (most + 1, true)] {
        let points = format!("0 0 0.5\n9 0 {top}.5\n0 9 {top}.5\n8 8 0.5\n");
        let points = run("spfinalize", &["-"], points.as_bytes()).stdout;
        let mesh = folder.write("mesh.spm", run("spdelaunay2d", &[], &points).stdout);
        let arguments = ["--contours", "1", "--format", "geojson", "-o", "/dev/null", &mesh];
        let (code, message) = outcome(&run("spdem", &arguments, &[]));
        assert_eq!(code == Some(2), is_refused, "{message}");
        assert_eq!(message.contains("at most 256 per triangle"), is_refused, "{message}");
    }
}
