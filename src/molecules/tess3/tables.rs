//! Tables of tetrahedra and of contacts.
//!
//! Rows do not depend on how the triangulation was made: the atoms of a row, and the rows, are in the order
//! of the input.

use std::fmt::Write;

use super::Level;
use super::alpha::AlphaComplex;
use super::identity::{self, Named, Origin};
use super::spheres::measure;
use spmesh_base::error::Result;
use spmesh_delaunay::delaunay3::Tetrahedralization;
use spmesh_delaunay::predicates::Point3;
use spmesh_formats::molecules::{AtomView, Selected};
use spmesh_formats::sink::{Column, ColumnKind, TableSink};

/// Columns of the table of tetrahedra.
pub(super) const TETRAHEDRA: &str =
    "file model atom1 atom2 atom3 atom4 serial1 serial2 serial3 serial4 circumradius volume";

/// Columns of the table of contacts.
pub(super) fn contact_columns() -> String {
    format!("{} {} distance tetrahedra", Origin::COLUMNS, pair_columns(Level::Atom))
}

/// Columns of both ends of a contact.
pub(super) fn pair_columns(level: Level) -> String {
    ["1", "2"].map(|end| identity::columns(level, "", end).join(" ")).join(" ")
}

/// The data of the tables of one model.
pub(super) struct ModelTables<'s> {
    pub(super) origin: Origin<'s>,
    /// The atoms that the mesh was made of.
    pub(super) selected: &'s Selected<'s>,
    pub(super) mesh: &'s Tetrahedralization,
    /// The part of the mesh to print, if not all of it.
    pub(super) alpha: Option<&'s AlphaComplex<'s>>,
    /// World units per stored unit.
    pub(super) scale: f64,
}

impl<'s> ModelTables<'s> {
    /// Writes a row per tetrahedron: its atoms, the radius of the circumscribed sphere, and the volume.
    ///
    /// Memory: 16 bytes per tetrahedron, and the names of the atoms.
    pub(super) fn write_tetrahedra(&self, rows: &mut TableSink) -> Result<()> {
        let tetrahedra = self.mesh.tetrahedra().iter().enumerate();
        let kept = tetrahedra.filter(|&(t, _)| self.alpha.is_none_or(|alpha| alpha.has_tetrahedron(t)));
        let mut found: Vec<[u32; 4]> = kept.map(|(_, t)| self.in_order_of_input(t.vertices)).collect();
        found.sort_unstable();
        let names = AtomNames::new(self.selected);
        for row in found {
            self.origin.start_row(rows)?;
            row.iter().for_each(|&index| rows.field(names.name(index as usize)));
            row.iter().try_for_each(|&index| rows.integer(self.selected.label(index as usize)))?;
            let measure = measure(row.map(|index| self.point(index)));
            rows.number(measure.circumradius * self.scale);
            rows.number(measure.volume * self.scale.powi(3));
            rows.end()?;
        }
        Ok(())
    }

    /// Writes a row per edge: its atoms, their distance, and the number of tetrahedra around it.
    ///
    /// Memory: 12 bytes per edge.
    pub(super) fn write_contacts(&self, rows: &mut TableSink) -> Result<()> {
        let mut found: Vec<([u32; 2], u32)> = Vec::new();
        self.mesh.for_each_edge(
            |_| true,
            |ring| -> Result<()> {
                if self.alpha.is_none_or(|alpha| alpha.has_edge(ring)) {
                    let is_kept = |t: u32| self.alpha.is_none_or(|alpha| alpha.has_tetrahedron(t as usize));
                    let tetrahedra = ring.tetrahedra.iter().filter(|&&t| is_kept(t)).count();
                    found.push((self.in_order_of_input(ring.ends), tetrahedra as u32));
                }
                Ok(())
            },
        )?;
        found.sort_unstable();
        for (row, tetrahedra) in found {
            self.origin.start_row(rows)?;
            for atom in row {
                Named::atom(atom).write(self.selected, Level::Atom, Level::Atom, rows)?;
            }
            rows.number(distance(row.map(|index| self.point(index))) * self.scale);
            rows.integer(tetrahedra)?;
            rows.end()?;
        }
        Ok(())
    }

    /// Indices in the selection, increasing, of vertices of the mesh.
    fn in_order_of_input<const N: usize>(&self, vertices: [u32; N]) -> [u32; N] {
        let mut indices = vertices.map(|v| self.mesh.vertices()[v as usize].index);
        indices.sort_unstable();
        indices
    }

    fn point(&self, index: u32) -> Point3 {
        self.selected.points()[index as usize]
    }
}

/// The names of all selected atoms, one behind the other.
#[derive(Debug, Default)]
struct AtomNames {
    text: String,
    ends: Vec<usize>,
}

impl AtomNames {
    /// The names of the atoms: `chain/residue/number/atom`. The number includes its insertion code.
    /// `/location` follows if an atom has alternate locations. Points without names have their numbers.
    fn new(selected: &Selected<'_>) -> Self {
        let mut names = AtomNames::default();
        for index in 0..selected.points().len() {
            names.push(selected.atom(index), selected.label(index));
        }
        names
    }

    /// The name of the atom at `index` of the selection.
    fn name(&self, index: usize) -> &str {
        let start = index.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.text[start..self.ends[index]]
    }

    fn push(&mut self, atom: Option<AtomView<'_>>, label: u64) {
        let text = &mut self.text;
        match atom {
            None => write!(text, "{label}").expect("a string takes all"),
            Some(atom) => {
                push_residue(text, &atom);
                text.push('/');
                push_name(text, atom.name());
                if !atom.altloc().is_empty() {
                    text.push('/');
                    push_name(text, atom.altloc());
                }
            }
        }
        self.ends.push(text.len());
    }
}

/// Appends the name of the residue of an atom: `chain/residue/number`.
fn push_residue(text: &mut String, atom: &AtomView<'_>) {
    push_name(text, atom.chain());
    text.push('/');
    push_name(text, atom.residue_name());
    text.push('/');
    if let Some(number) = atom.residue_number() {
        write!(text, "{number}").expect("a string takes all");
    }
    push_name(text, atom.insertion_code());
}

/// Appends a name. In it, slashes are written as in addresses of the web, so that those between names are
/// alone.
fn push_name(text: &mut String, name: &str) {
    if name.bytes().any(|byte| matches!(byte, b'/' | b'%')) {
        text.push_str(&name.replace('%', "%25").replace('/', "%2F"));
    } else {
        text.push_str(name);
    }
}

/// The columns of these names. A name has the same type in all tables.
pub(super) fn columns(names: &str) -> Vec<Column> {
    let column = |name: &str| Column { name: name.to_string(), kind: kind(name) };
    names.split(' ').map(column).collect()
}

/// The type of the column of a name; numbers unless it is listed.
fn kind(name: &str) -> ColumnKind {
    match name.trim_start_matches("partner_").trim_end_matches(|c: char| c.is_ascii_digit()) {
        "model" | "frame" | "serial" | "tetrahedra" | "atoms" | "contacts" | "pocket" | "mouth"
        | "mouths" | "residue_number" | "faces" | "shift_a" | "shift_b" | "shift_c" => ColumnKind::Integer,
        "file" | "kind" | "cell" | "face" | "atom" | "chain" | "label_chain" | "segment"
        | "insertion_code" | "residue_name" | "class" | "atom_name" | "element" | "altloc" => {
            ColumnKind::Text
        }
        _ => ColumnKind::Number,
    }
}

/// Distance of two points.
pub(super) fn distance([p, q]: [Point3; 2]) -> f64 {
    (0..3).map(|axis| (p[axis] - q[axis]).powi(2)).sum::<f64>().sqrt()
}
