//! Inputs that are deep, or whose parts multiply.

use std::fmt::Write;

use crate::cases::{Case, accepted, malformed};

/// Deep inputs.
pub fn cases() -> Vec<Case> {
    const LINES: &str = "spconstrain --lines IN.geojson MESH -o OUT.spm";
    let deep = |start: &str, open: &str, count: usize| format!("{start}{}", open.repeat(count));
    let collections = "{\"type\":\"GeometryCollection\",\"geometries\":[".repeat(350);
    vec![
        malformed(
            "coordinates",
            LINES,
            deep("{\"type\":\"LineString\",\"coordinates\":", "[", 16_000),
            "lists in lists",
        ),
        malformed(
            "properties",
            LINES,
            deep("{\"type\":\"Feature\",\"properties\":", "[", 16_000),
            "recursion",
        ),
        malformed("collections", LINES, collections, "recursion"),
        malformed(
            "polygons of text",
            "spdem --columns 9 --mask IN.wkt MESH -o OUT.tif",
            deep("POLYGON", "(", 16_000),
            "coordinates",
        ),
        malformed(
            "a system",
            "spfinalize --crs IN.prj DATA/hextest.las -o OUT.spm",
            deep("", "A[", 8_000),
            "levels of brackets",
        )
        .with_code(2),
        malformed(
            "a plan",
            "spnode list IN.json",
            deep("{\"format\":\"spmesh plan\",\"x\":", "[", 16_000),
            "no plan",
        ),
        malformed(
            "a manifest",
            "spinfo IN.json",
            deep("{\"format\":\"spmesh mesh in parts\",\"x\":", "[", 16_000),
            "no manifest",
        ),
        malformed(
            "elements",
            "spfinalize IN.vtu -o OUT.spm",
            deep("<VTKFile type=\"UnstructuredGrid\" version=\"1.0\">", "<a>", 5_000),
            "more than 64 elements",
        ),
        malformed(
            "loops of mmCIF",
            "tess3 IN.cif -o OUT.spm",
            deep("data_a\n", "loop_\n_a.b\nc\n", 1_000),
            "found no atom",
        ),
    ]
}

/// An mmCIF file of `atoms` atoms and an assembly of 16,384 operators: all products of two of 128.
fn assembly(atoms: usize, subchains: &str) -> String {
    let mut text = format!(
        "data_a\nloop_\n_pdbx_struct_assembly_gen.assembly_id\n_pdbx_struct_assembly_gen.oper_expression\n\
         _pdbx_struct_assembly_gen.asym_id_list\n1 (1-128)(1-128) {subchains}\nloop_\n_pdbx_struct_oper_list.id\n"
    );
    for row in 1..=3 {
        for column in 1..=3 {
            writeln!(text, "_pdbx_struct_oper_list.matrix[{row}][{column}]").expect("memory takes it");
        }
        writeln!(text, "_pdbx_struct_oper_list.vector[{row}]").expect("memory takes it");
    }
    for i in 1..=128 {
        let [x, y] = if i <= 64 { [i, 0] } else { [0, 99 * i] };
        writeln!(text, "{i} 1 0 0 {x} 0 1 0 {y} 0 0 1 {}", i * i).expect("memory takes it");
    }
    text += "loop_\n_atom_site.id\n_atom_site.label_asym_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n";
    for i in 0..atoms {
        writeln!(text, "{i} A {} {} {}", i % 97, i % 89, i % 7).expect("memory takes it");
    }
    text
}

/// Inputs whose parts multiply.
pub fn products() -> Vec<Case> {
    const TABLE: &str = "tess3 --assembly 1 --table IN.cif -o OUT.tsv";
    let names: Vec<String> = (0..1500).map(|i| format!("{i:x}")).collect();
    let line = |i: usize| format!("line {:.2} 0 1 {:.2} 9 1\n", i as f64 * 0.015, 9.0 - i as f64 * 0.015);
    let crossing: String = (0..600).map(line).collect();
    vec![
        malformed("atoms of an assembly", TABLE, assembly(700, "A"), "--assembly"),
        malformed("chains of an assembly", TABLE, assembly(1, &names.join(",")), "copies of chains"),
        accepted("operators of an assembly", TABLE, assembly(7, "A")),
        accepted("lines that cross", "spconstrain --lines IN.txt MESH -o OUT.spm", crossing),
        malformed(
            "parts of a line",
            "spconstrain --densify 0.001 --lines IN.txt MESH -o OUT.spm",
            "line 0 0 1 1e6 1e6 2\n",
            "more than 16777216 vertices",
        ),
    ]
}
